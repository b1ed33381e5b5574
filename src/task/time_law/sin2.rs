use super::{TimeLaw, TimeLawKind};
use crate::kind::Kind;
use std::f64::consts::{FRAC_PI_2, PI};

/// `u = sin^2(pi tau / 2)`: at rest at both ends, accelerating at once.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sin2;

impl TimeLaw for Sin2 {
    fn progress(&self, tau: f64) -> (f64, f64) {
        let (sine, cosine) = (FRAC_PI_2 * tau).sin_cos();
        (sine * sine, PI * sine * cosine)
    }
}

pub(super) const KIND: TimeLawKind =
    Kind::new("sin2", "sin^2(pi t / 2T): at rest at both ends.", &[], |_| Box::new(Sin2));

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_begins_and_ends_at_rest() {
        assert!(Sin2.progress(0.0).1.abs() < 1e-15 && Sin2.progress(1.0).1.abs() < 1e-15);
    }
}
