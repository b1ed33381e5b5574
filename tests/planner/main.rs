//! Whole runs of the planner, and the laws and searches that it relies on.

mod approach;
mod doors;
mod inverse;
mod law_near_singularity;
mod laws;
mod noise;
mod paper;
mod shared;
mod side_by_side;
mod stops;
mod surroundings;
mod tasks;
mod waypoints;
