//! Shapes about links and obstacles: distances, fits, files, and how distances change with the joints.

#![allow(clippy::unwrap_used, reason = "a test that can not go on stops")]

mod distances;
mod embedded;
mod files;
mod fits;
mod gradients;
mod reference;
