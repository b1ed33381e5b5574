use nalgebra::Vector6;

/// One arm at the present sample.
#[derive(Clone, Copy, Debug)]
pub struct ArmState<'a> {
    /// Joint positions [rad or m].
    pub positions: &'a [f64],
    /// Feedforward joint velocities [rad/s or m/s].
    pub velocities: &'a [f64],
    /// Task error (linear \[m\]; angular \[rad\]).
    pub error: Vector6<f64>,
    /// Whether the law damped its answer here.
    pub damped: bool,
}
