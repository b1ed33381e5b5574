use super::{TimeLaw, TimeLawKind};
use crate::kind::Kind;

/// `u = tau`: constant speed, with a jump of the velocity at both ends.
#[derive(Clone, Copy, Debug, Default)]
pub struct Linear;

impl TimeLaw for Linear {
    fn progress(&self, tau: f64) -> (f64, f64) {
        (tau, 1.0)
    }
}

pub(super) const KIND: TimeLawKind = Kind::new("linear", "t / T.", &[], |_| Box::new(Linear));

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_never_rests() {
        assert_eq!((Linear.progress(0.0), Linear.progress(1.0)), ((0.0, 1.0), (1.0, 1.0)));
    }
}
