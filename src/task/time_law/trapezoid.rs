use super::{TimeLaw, TimeLawKind};
use crate::kind::{Form, Parameter, Parameters};

/// The share of the duration that speeds up unless given: a third to speed up, a third at constant speed, a third to slow down.
const RAMP: f64 = 1.0 / 3.0;

/// A velocity that rises evenly over the share `ramp` of the duration, stays, and falls over the same share: with
/// `V = 1 / (1 - ramp)` and `A = V / ramp`
///
/// ```text
/// u = A tau^2 / 2            tau <= ramp
/// u = V (tau - ramp / 2)     between
/// u = 1 - A (1 - tau)^2 / 2  tau >= 1 - ramp
/// ```
///
/// Along a path of length `L` in a time `T` the speed is at most `V L / T`, the acceleration `A L / T^2`. It jumps at four
/// instants, so that errors fall like `sigma^2` at best.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trapezoid {
    /// The share of the duration in which it speeds up, and again slows down: above 0 and at most 1/2.
    pub ramp: f64,
}

impl Trapezoid {
    /// The law that covers a length in the shortest time with a largest velocity and a largest acceleration, and that
    /// time: `L / v + v / a`, or `2 sqrt(L / a)` where the velocity is not reached. Any units that go together.
    ///
    /// ```
    /// use kinstep::task::Trapezoid;
    /// // 1 m at 0.5 m/s and 1 m/s^2: half a second to speed up, and 2.5 s in all.
    /// let (law, duration) = Trapezoid::fastest(1.0, 0.5, 1.0);
    /// assert_eq!((law.ramp, duration), (0.2, 2.5));
    /// ```
    pub fn fastest(length: f64, velocity: f64, acceleration: f64) -> (Self, f64) {
        if velocity * velocity >= length * acceleration {
            return (Self { ramp: 0.5 }, 2.0 * (length / acceleration).sqrt());
        }
        let ramp = velocity / acceleration;
        let duration = length / velocity + ramp;
        (Self { ramp: ramp / duration }, duration)
    }

    /// `(int u, u, u')` at `tau`.
    pub(super) fn with_integral(self, tau: f64) -> (f64, f64, f64) {
        let ramp = self.ramp;
        let speed = 1.0 / (1.0 - ramp);
        let acceleration = speed / ramp;
        if tau <= ramp {
            let rate = acceleration * tau;
            return (rate * tau * tau / 6.0, 0.5 * rate * tau, rate);
        }
        if tau <= 1.0 - ramp {
            let since = tau - 0.5 * ramp;
            let integral = 0.5 * speed * (since * since - 0.25 * ramp * ramp) + speed * ramp * ramp / 6.0;
            return (integral, speed * since, speed);
        }
        // Point symmetry about the middle: u(tau) = 1 - u(1 - tau).
        let (integral, u, rate) = self.with_integral(1.0 - tau);
        (tau - 0.5 + integral, 1.0 - u, rate)
    }
}

impl TimeLaw for Trapezoid {
    fn progress(&self, tau: f64) -> (f64, f64) {
        let (_, u, rate) = self.with_integral(tau);
        (u, rate)
    }

    fn smoothness(&self) -> Option<usize> {
        Some(1)
    }
}

/// The share of the duration in which a law speeds up.
pub(super) const RAMP_PARAMETER: Parameter = Parameter::optional(
    "ramp",
    Form::Positive { noun: "share" },
    "",
    "Share of the duration in which it speeds up, and again slows down: at most 1/2. Default: 1/3.",
);

pub(super) fn ramp(given: &Parameters) -> f64 {
    given.number("ramp").unwrap_or(RAMP)
}

/// What is wrong with a share of the duration.
pub(super) fn ramp_objection(given: &Parameters) -> Option<String> {
    let ramp = ramp(given);
    (ramp > 0.5).then(|| format!("ramp = {ramp} leaves no time to slow down; it is at most 0.5"))
}

pub(super) const KIND: TimeLawKind = TimeLawKind::new(
    "trapezoid",
    "Speeds up evenly, keeps its speed, slows down evenly; the acceleration jumps.",
    &[RAMP_PARAMETER],
    |given| Box::new(Trapezoid { ramp: ramp(given) }),
)
.with_objection(ramp_objection);

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn the_fastest_keeps_both_limits_and_reaches_one(
            length in 0.01..10.0_f64, velocity in 0.01..10.0_f64, acceleration in 0.01..10.0_f64,
        ) {
            let (law, duration) = Trapezoid::fastest(length, velocity, acceleration);
            let top = length / duration * law.progress(0.5).1;
            let steepest = top / (law.ramp * duration);
            prop_assert!((steepest / acceleration - 1.0).abs() < 1e-12);
            prop_assert!(top <= velocity * (1.0 + 1e-12));
            prop_assert!(law.ramp == 0.5 || (top / velocity - 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn it_follows_the_closed_form() {
        let law = Trapezoid { ramp: 0.25 };
        // V = 4/3, A = 16/3.
        for (tau, u, rate) in [
            (0.0, 0.0, 0.0),
            (0.125, 1.0 / 24.0, 2.0 / 3.0),
            (0.5, 0.5, 4.0 / 3.0),
            (0.875, 23.0 / 24.0, 2.0 / 3.0),
        ] {
            let found = law.progress(tau);
            assert!((found.0 - u).abs() < 1e-15 && (found.1 - rate).abs() < 1e-15, "{tau} {found:?}");
        }
    }

    #[test]
    fn a_ramp_beyond_the_middle_is_refused() {
        let objection = |ramp: f64| ramp_objection(&Parameters::new().with("ramp", ramp));
        assert_eq!(objection(0.5), None);
        assert!(objection(0.6).unwrap().contains("at most 0.5"));
    }
}
