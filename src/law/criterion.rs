/// What redundant joints do beside the task: the `c` of `x' = J^+ (phi' - k e) + (I - J^+ J) c`.
pub trait Criterion: Send {
    /// Writes the joint velocity `c(q)` [rad/s or m/s] that the null-space projector is applied to.
    fn velocity(&self, q: &[f64], c: &mut [f64]);

    /// The largest rate [1/s] of `c`: `lambda` for `c = -lambda (q - q_0)`. The planner checks it against the row.
    fn rate(&self) -> f64;
}
