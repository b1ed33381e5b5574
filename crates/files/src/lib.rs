//! Files around the planner [`kinstep`]: scenarios that say what to plan, and trajectories that a run leaves.
//!
//! [`scenario::ScenarioText`] reads what people write, [`scenario::Scenario`] makes planners of it;
//! [`trajectory::Trajectory`] holds the samples of a run, and every [`trajectory::TrajectoryFormat`] hands them on.

pub mod scenario;
pub mod trajectory;
