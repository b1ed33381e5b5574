//! How much slower or faster a motion could be for what limits the joints' motion.

use super::differences::Peak;
use super::plan::{ArmPlan, Plan};
use crate::robot::Limits;

impl ArmPlan {
    /// By what factor the duration would have to change for the joints to come just to their limits; nothing where none
    /// of velocity, acceleration and jerk is known.
    ///
    /// Along one path velocities go with the first, accelerations with the second, jerks with the third power of the inverse
    /// duration. What is compared is what makes a [`Violation`](crate::planner::Violation).
    pub(super) fn scale_of_limits<'a>(
        &self,
        limits: impl Iterator<Item = &'a Limits>,
        sigma: f64,
    ) -> Option<f64> {
        let of_joint = |(joint, limits): (usize, &Limits)| {
            let (q, v) = (|| self.every(&self.positions, joint), || self.every(&self.velocities, joint));
            let means = || q().zip(q().skip(1)).map(|(from, to)| (to - from) / sigma);
            let velocity = || v().chain(means()).fold(0.0, |most: f64, v| most.max(v.abs()));
            let shares: [(f64, f64, &dyn Fn() -> f64); 3] = [
                (limits.velocity, 1.0, &velocity),
                (limits.acceleration, 0.5, &|| Peak::of_acceleration(q(), v(), sigma).certain),
                (limits.jerk, 1.0 / 3.0, &|| Peak::of_jerk(q(), v(), sigma).certain),
            ];
            let known = shares.into_iter().filter(|(limit, ..)| limit.is_finite());
            known.map(|(limit, power, peak)| (peak() / limit).powf(power)).reduce(f64::max)
        };
        limits.enumerate().filter_map(of_joint).reduce(f64::max)
    }
}

impl Plan {
    /// How long the motion along the paths takes \[s\], without the way to them.
    pub fn duration(&self) -> f64 {
        (self.steps - self.lead) as f64 * self.sigma
    }

    /// The duration \[s\] at which the motion along the paths would come just to the limits of velocity, acceleration and
    /// jerk, as far as it follows from this run; nothing where no such limit is known, or the run stopped.
    ///
    /// Feedback and start do not become faster or slower with the motion, so that it is not exact; run it to see.
    pub fn feasible_duration(&self) -> Option<f64> {
        let scales = self.arms.iter().filter_map(|arm| arm.time_scale);
        scales.reduce(f64::max).filter(|_| self.is_completed()).map(|scale| scale * self.duration())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `q = sin(w t)` over a period, in steps of `sigma`.
    fn swing(rate: f64, sigma: f64) -> ArmPlan {
        let times: Vec<f64> =
            (0..=(std::f64::consts::TAU / rate / sigma) as usize).map(|n| n as f64 * sigma).collect();
        ArmPlan {
            joints: vec!["joint".to_owned()],
            positions: times.iter().map(|t| (rate * t).sin()).collect(),
            velocities: times.iter().map(|t| rate * (rate * t).cos()).collect(),
            ..ArmPlan::default()
        }
    }

    #[test]
    fn each_limit_goes_with_its_power_of_the_duration() {
        let (swing, sigma) = (swing(2.0, 1e-3), 1e-3);
        let scale = |limits: Limits| swing.scale_of_limits(std::iter::once(&limits), sigma);
        assert_eq!(scale(Limits::UNLIMITED), None);
        for (limits, expected) in [
            (Limits { velocity: 4.0, ..Limits::UNLIMITED }, 0.5),
            (Limits { acceleration: 1.0, ..Limits::UNLIMITED }, 2.0),
            (Limits { jerk: 1.0, ..Limits::UNLIMITED }, 2.0),
            (Limits { velocity: 1.0, acceleration: 400.0, jerk: 64.0, ..Limits::UNLIMITED }, 2.0),
        ] {
            assert!((scale(limits).unwrap() - expected).abs() < 1e-5, "{limits:?}");
        }
    }
}
