use super::super::{Instant, SystemShape};

/// What redundant joints do beside the tasks: the `c` of `q' = J^+ (phi' - k e) + (I - J^+ J) c`.
pub trait Criterion: Send {
    /// Allocates what systems of this shape need; called once, before the first [`velocity`](Criterion::velocity).
    fn prepare(&mut self, _shape: &SystemShape) {}

    /// Why this criterion does not fit systems of a shape, as the end of a sentence that begins with "this law"; `None` if it
    /// does.
    fn objection(&self, _shape: &SystemShape) -> Option<String> {
        None
    }

    /// Writes the joint velocity `c` [rad/s or m/s], one entry per joint, that the null-space projector is applied to.
    fn velocity(&mut self, instant: &Instant<'_>, c: &mut [f64]);

    /// The largest rate [1/s] of `c`: `lambda` for `c = -lambda (q - q_0)`. The planner checks it against the row before the
    /// run. `None` where it depends on the configuration: then [`rate_at`](Criterion::rate_at) is watched during the run.
    fn rate(&self) -> Option<f64>;

    /// The rate [1/s] of `c` at an instant: the largest modulus of the eigenvalues of `dc / dq`.
    fn rate_at(&self, _instant: &Instant<'_>) -> f64 {
        self.rate().unwrap_or(0.0)
    }

    /// Whether [`Instant::avoidance`] is to be there.
    fn keeps_distances(&self) -> bool {
        false
    }
}

impl Criterion for Box<dyn Criterion> {
    fn prepare(&mut self, shape: &SystemShape) {
        (**self).prepare(shape);
    }

    fn objection(&self, shape: &SystemShape) -> Option<String> {
        (**self).objection(shape)
    }

    fn velocity(&mut self, instant: &Instant<'_>, c: &mut [f64]) {
        (**self).velocity(instant, c);
    }

    fn rate(&self) -> Option<f64> {
        (**self).rate()
    }

    fn rate_at(&self, instant: &Instant<'_>) -> f64 {
        (**self).rate_at(instant)
    }

    fn keeps_distances(&self) -> bool {
        (**self).keeps_distances()
    }
}
