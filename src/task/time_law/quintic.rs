use super::{TimeLaw, TimeLawKind};
use crate::kind::Kind;

/// `u = 10 tau^3 - 15 tau^4 + 6 tau^5`: velocity and acceleration vanish at both ends.
#[derive(Clone, Copy, Debug, Default)]
pub struct Quintic;

impl TimeLaw for Quintic {
    fn progress(&self, tau: f64) -> (f64, f64) {
        let square = tau * tau;
        let value = square * tau * (10.0 + tau * (6.0 * tau - 15.0));
        (value, 30.0 * square * (1.0 - tau) * (1.0 - tau))
    }
}

pub(super) const KIND: TimeLawKind = Kind::new(
    "quintic",
    "The polynomial of degree 5 with velocity and acceleration zero at both ends.",
    &[],
    |_| Box::new(Quintic),
);

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_begins_and_ends_at_rest() {
        assert!(Quintic.progress(0.0).1.abs() < 1e-15 && Quintic.progress(1.0).1.abs() < 1e-15);
    }
}
