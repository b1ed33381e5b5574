//! Shapes about links and obstacles: distances, fits, files, and how distances change with the joints.

mod distances;
mod embedded;
mod files;
mod fits;
mod gradients;
mod reference;
