//! Trajectories written and read back.

mod inspection;
mod own_kinds;
mod trajectories;
mod trajectory_csv;
mod trajectory_formats;
mod trajectory_others;
mod waypoints;
