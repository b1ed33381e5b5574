use super::trapezoid::{RAMP_PARAMETER, Trapezoid, ramp, ramp_objection};
use super::{TimeLaw, TimeLawKind};
use crate::kind::{Form, Parameter, Parameters};

/// A trapezoid of the velocity with rounded corners: over the share `ramp` of the duration the velocity rises to
/// `V = 1 / (1 - ramp)`, with an acceleration that itself is a trapezoid which rises and falls in the share `rounding` of
/// the ramp. The jerk is bounded and jumps.
///
/// With `r = rounding / 2` the acceleration is at most `A = V / (ramp (1 - r))`, the jerk `A / (r ramp)`; along a path of
/// length `L` in a time `T` they are `A L / T^2` and `A / (r ramp) L / T^3`. Errors fall like `sigma^3` at best.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SCurve {
    /// The share of the duration in which it speeds up, and again slows down: above 0 and at most 1/2.
    pub ramp: f64,
    /// The share of the ramp in which the acceleration changes: above 0 and at most 1.
    pub rounding: f64,
}

impl SCurve {
    /// The law that covers a length in the shortest time with a largest velocity, acceleration and jerk, and that time. Any
    /// units that go together.
    ///
    /// ```
    /// use kinstep::task::SCurve;
    /// // 1 m at 0.5 m/s, 1 m/s^2 and 4 m/s^3: 0.75 s to speed up, 2.75 s in all.
    /// let (law, duration) = SCurve::fastest(1.0, 0.5, 1.0, 4.0);
    /// assert_eq!(duration, 2.75);
    /// assert_eq!((law.ramp, law.rounding), (0.75 / 2.75, 0.5 / 0.75));
    /// ```
    pub fn fastest(length: f64, velocity: f64, acceleration: f64, jerk: f64) -> (Self, f64) {
        let (ramp, changing) = time_to_speed(velocity, acceleration, jerk);
        if velocity * ramp <= length {
            let duration = ramp + length / velocity;
            return (Self { ramp: ramp / duration, rounding: changing / ramp }, duration);
        }
        // Half the length to speed up and half to slow down: V t(V) = L.
        let change = acceleration / jerk;
        let top = 0.5 * acceleration * ((change * change + 4.0 * length / acceleration).sqrt() - change);
        let top = if top >= acceleration * change { top } else { (0.25 * length * length * jerk).cbrt() };
        let (ramp, changing) = time_to_speed(top, acceleration, jerk);
        (Self { ramp: 0.5, rounding: changing / ramp }, 2.0 * ramp)
    }
}

/// How long it takes from rest to a velocity, and for how long of that the acceleration changes.
fn time_to_speed(velocity: f64, acceleration: f64, jerk: f64) -> (f64, f64) {
    let change = acceleration / jerk;
    if velocity >= acceleration * change {
        (velocity / acceleration + change, 2.0 * change)
    } else {
        let change = (velocity / jerk).sqrt();
        (2.0 * change, 2.0 * change)
    }
}

impl TimeLaw for SCurve {
    fn progress(&self, tau: f64) -> (f64, f64) {
        let ramp = self.ramp;
        let speed = 1.0 / (1.0 - ramp);
        if tau > 0.5 {
            let (u, rate) = self.progress(1.0 - tau);
            return (1.0 - u, rate);
        }
        if tau >= ramp {
            return (speed * (tau - 0.5 * ramp), speed);
        }
        // The velocity rises as the way of a trapezoid does.
        let (way, velocity, _) = Trapezoid { ramp: 0.5 * self.rounding }.with_integral(tau / ramp);
        (speed * ramp * way, speed * velocity)
    }

    fn smoothness(&self) -> Option<usize> {
        Some(2)
    }
}

fn rounding(given: &Parameters) -> f64 {
    given.number("rounding").unwrap_or(1.0)
}

pub(super) const KIND: TimeLawKind = TimeLawKind::new(
    "s-curve",
    "A trapezoid of the velocity with rounded corners; the jerk is bounded and jumps.",
    &[
        RAMP_PARAMETER,
        Parameter::optional(
            "rounding",
            Form::Positive { noun: "share" },
            "",
            "Share of the ramp in which the acceleration changes: at most 1. Default: 1.",
        ),
    ],
    |given| Box::new(SCurve { ramp: ramp(given), rounding: rounding(given) }),
)
.with_objection(|given| {
    let rounding = rounding(given);
    let beyond = || format!("rounding = {rounding} is more than the whole ramp; it is at most 1");
    ramp_objection(given).or_else(|| (rounding > 1.0).then(beyond))
});

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The largest velocity, acceleration and jerk over a length in a time, by the closed forms.
    fn peaks(law: SCurve, length: f64, duration: f64) -> [f64; 3] {
        let round = 0.5 * law.rounding;
        let velocity = 1.0 / (1.0 - law.ramp);
        let acceleration = velocity / (law.ramp * (1.0 - round));
        let jerk = acceleration / (round * law.ramp);
        [
            velocity * length / duration,
            acceleration * length / duration.powi(2),
            jerk * length / duration.powi(3),
        ]
    }

    proptest! {
        #[test]
        fn the_fastest_keeps_all_limits_and_reaches_its_jerk(
            length in 0.01..10.0_f64, limits in prop::array::uniform3(0.05..10.0_f64),
        ) {
            let (law, duration) = SCurve::fastest(length, limits[0], limits[1], limits[2]);
            let peaks = peaks(law, length, duration);
            for (peak, limit) in peaks.into_iter().zip(limits) {
                prop_assert!(peak <= limit * (1.0 + 1e-9), "{peaks:?} {limits:?}");
            }
            prop_assert!((peaks[2] / limits[2] - 1.0).abs() < 1e-9);
            prop_assert!(law.ramp <= 0.5 && law.rounding <= 1.0 + 1e-12);
            // No slower than it has to be: at top speed, or half the way at top acceleration, or all of it at top jerk.
            let is_at_limit = |k: usize| (peaks[k] / limits[k] - 1.0).abs() < 1e-9;
            let is_steep = is_at_limit(1) || law.rounding > 1.0 - 1e-9;
            prop_assert!(is_steep && (law.ramp == 0.5 || is_at_limit(0)));
        }

        #[test]
        fn velocities_accelerations_and_jerks_are_those_of_the_closed_forms(
            ramp in 0.1..0.5_f64, rounding in 0.2..1.0_f64,
        ) {
            let law = SCurve { ramp, rounding };
            let [velocity, acceleration, jerk] = peaks(law, 1.0, 1.0);
            prop_assert!((law.progress(0.5).1 - velocity).abs() < 1e-12);
            let step = 1e-4;
            let change = |tau: f64| (law.progress(tau + step).1 - law.progress(tau - step).1) / (2.0 * step);
            prop_assert!((change(0.5 * ramp) / acceleration - 1.0).abs() < 1e-2);
            let rise = 0.25 * rounding * ramp;
            prop_assert!(((change(rise + step) - change(rise - step)) / (2.0 * step) / jerk - 1.0).abs() < 1e-5);
        }
    }

    #[test]
    fn shares_beyond_what_there_is_are_refused() {
        let objection = |name, share: f64| KIND.objection.unwrap()(&Parameters::new().with(name, share));
        assert!(objection("ramp", 0.51).is_some() && objection("rounding", 1.1).is_some());
        assert!(objection("ramp", 0.5).is_none() && objection("rounding", 1.0).is_none());
    }
}
