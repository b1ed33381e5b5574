//! Trajectories written and read back.

mod trajectories;
mod trajectory_csv;
mod trajectory_formats;
