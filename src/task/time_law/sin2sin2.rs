use super::{Sin2, TimeLaw, TimeLawKind};
use crate::kind::Kind;

/// `u = sin^2((pi / 2) sin^2(pi tau / 2))`: three derivatives vanish at both ends.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sin2Sin2;

impl TimeLaw for Sin2Sin2 {
    fn progress(&self, tau: f64) -> (f64, f64) {
        let (inner, inner_rate) = Sin2.progress(tau);
        let (outer, outer_rate) = Sin2.progress(inner);
        (outer, outer_rate * inner_rate)
    }
}

pub(super) const KIND: TimeLawKind = Kind::new(
    "sin2sin2",
    "sin^2((pi/2) sin^2(pi t / 2T)): velocity, acceleration and jerk vanish at both ends.",
    &[],
    |_| Box::new(Sin2Sin2),
);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_begins_and_ends_at_rest() {
        assert!(Sin2Sin2.progress(0.0).1.abs() < 1e-15 && Sin2Sin2.progress(1.0).1.abs() < 1e-15);
    }
}
