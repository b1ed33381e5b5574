use nalgebra::Vector6;

/// What the loop of one arm sees in place of the truth, at one sample.
#[derive(Clone, Copy, Debug)]
pub(in crate::planner) struct Disturbance {
    /// To be added to the task error.
    pub(in crate::planner) error: Vector6<f64>,
    /// To be added to the twist of the reference.
    pub(in crate::planner) twist: Vector6<f64>,
}
