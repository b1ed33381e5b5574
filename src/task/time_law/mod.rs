//! Time laws: one file each, one row in [`TIME_LAWS`].

mod linear;
mod quintic;
mod s_curve;
mod sin2;
mod sin2sin2;
#[expect(clippy::module_inception, reason = "the file is named after the trait that it holds")]
mod time_law;
mod time_law_kind;
mod trapezoid;

pub use linear::Linear;
pub use quintic::Quintic;
pub use s_curve::SCurve;
pub use sin2::Sin2;
pub use sin2sin2::Sin2Sin2;
pub use time_law::TimeLaw;
pub use time_law_kind::{MakeTimeLaw, TimeLawKind};
pub use trapezoid::Trapezoid;

/// Every built-in time law; the first is the one that is taken unless another is named.
pub const TIME_LAWS: &[TimeLawKind] =
    &[sin2::KIND, sin2sin2::KIND, linear::KIND, quintic::KIND, trapezoid::KIND, s_curve::KIND];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kind::Parameters;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn rates_are_the_derivatives(tau in 0.01..0.99_f64) {
            for kind in TIME_LAWS {
                let (law, step) = ((kind.make)(&Parameters::new()), 1e-5);
                let difference = (law.progress(tau + step).0 - law.progress(tau - step).0) / (2.0 * step);
                // Across a jump of the acceleration a difference is off by the jump times the step.
                let tolerance = if law.smoothness() == Some(1) { 1e-4 } else { 1e-7 };
                prop_assert!((difference - law.progress(tau).1).abs() < tolerance, "{}", kind.name);
            }
        }
    }

    #[test]
    fn every_law_runs_from_zero_to_one() {
        for kind in TIME_LAWS {
            let law = (kind.make)(&Parameters::new());
            assert!(law.progress(0.0).0.abs() < 1e-15, "{}", kind.name);
            assert!((law.progress(1.0).0 - 1.0).abs() < 1e-15, "{}", kind.name);
        }
    }
}
