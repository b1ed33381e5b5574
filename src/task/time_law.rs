use std::f64::consts::{FRAC_PI_2, PI};

/// How the progress `u` along a path runs with the time: `u(tau)` on `tau = t / T` in [0, 1].
///
/// A start of multistep formulas is smooth to the order to which `u` begins at rest.
pub trait TimeLaw: Send + Sync {
    /// The progress `u` and its derivative `du / dtau`.
    fn progress(&self, tau: f64) -> (f64, f64);
}

impl TimeLaw for Box<dyn TimeLaw> {
    fn progress(&self, tau: f64) -> (f64, f64) {
        (**self).progress(tau)
    }
}

/// `u = sin^2(pi tau / 2)`: at rest at both ends, accelerating at once.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sin2;

/// `u = sin^2((pi / 2) sin^2(pi tau / 2))`: three derivatives vanish at both ends.
#[derive(Clone, Copy, Debug, Default)]
pub struct Sin2Sin2;

/// `u = tau`: constant speed, with a jump of the velocity at both ends.
#[derive(Clone, Copy, Debug, Default)]
pub struct Linear;

/// `u = 10 tau^3 - 15 tau^4 + 6 tau^5`: velocity and acceleration vanish at both ends.
#[derive(Clone, Copy, Debug, Default)]
pub struct Quintic;

impl TimeLaw for Sin2 {
    fn progress(&self, tau: f64) -> (f64, f64) {
        let (sine, cosine) = (FRAC_PI_2 * tau).sin_cos();
        (sine * sine, PI * sine * cosine)
    }
}

impl TimeLaw for Sin2Sin2 {
    fn progress(&self, tau: f64) -> (f64, f64) {
        let (inner, inner_rate) = Sin2.progress(tau);
        let (outer, outer_rate) = Sin2.progress(inner);
        (outer, outer_rate * inner_rate)
    }
}

impl TimeLaw for Linear {
    fn progress(&self, tau: f64) -> (f64, f64) {
        (tau, 1.0)
    }
}

impl TimeLaw for Quintic {
    fn progress(&self, tau: f64) -> (f64, f64) {
        let square = tau * tau;
        let value = square * tau * (10.0 + tau * (6.0 * tau - 15.0));
        (value, 30.0 * square * (1.0 - tau) * (1.0 - tau))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn rates_are_the_derivatives(tau in 0.01..0.99_f64) {
            for law in [&Sin2 as &dyn TimeLaw, &Sin2Sin2, &Linear, &Quintic] {
                let step = 1e-5;
                let difference = (law.progress(tau + step).0 - law.progress(tau - step).0) / (2.0 * step);
                prop_assert!((difference - law.progress(tau).1).abs() < 1e-7);
            }
        }
    }

    #[test]
    fn every_law_runs_from_zero_to_one() {
        for law in [&Sin2 as &dyn TimeLaw, &Sin2Sin2, &Linear, &Quintic] {
            assert!(law.progress(0.0).0.abs() < 1e-15);
            assert!((law.progress(1.0).0 - 1.0).abs() < 1e-15);
        }
    }

    #[test]
    fn the_smooth_laws_end_at_rest() {
        for law in [&Sin2 as &dyn TimeLaw, &Sin2Sin2, &Quintic] {
            assert!(law.progress(0.0).1.abs() < 1e-15 && law.progress(1.0).1.abs() < 1e-15);
        }
    }
}
