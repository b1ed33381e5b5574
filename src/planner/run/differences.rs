//! The accelerations and jerks that the samples of a run imply.

use super::plan::ArmPlan;
use crate::law::LimitKind;
use crate::planner::system::Violation;
use crate::robot::Limits;

/// The signs and sizes of the samples in a difference, the newest first.
const DIFFERENCES: [&[f64]; 3] = [&[1.0, -1.0], &[1.0, -2.0, 1.0], &[1.0, -3.0, 3.0, -1.0]];
/// Units in the last place that a sample may be off by: what the sums of a step can amount to.
const ROUNDING: f64 = 16.0;

/// The largest value that differences of samples prove, and when.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Peak {
    /// The acceleration [rad/s^2 or m/s^2] or jerk [rad/s^3 or m/s^3], with its sign.
    pub value: f64,
    /// By how much it is beyond doubt: its size less what rounding of the samples could make of it, at least zero.
    pub certain: f64,
    /// The middle of the samples that it was computed from \[s\].
    pub t: f64,
}

impl Peak {
    const NONE: Self = Self { value: 0.0, certain: 0.0, t: 0.0 };

    /// Returns the largest acceleration of a joint between samples `sigma` apart \[s\]: of `(v_n - v_(n-1)) / sigma` of its
    /// velocities and `(q_n - 2 q_(n-1) + q_(n-2)) / sigma^2` of its positions, the one that is larger beyond rounding.
    ///
    /// Each is a mean of the acceleration of whatever smooth motion passes through the samples, so that one beyond a limit
    /// proves that the motion is; an acceleration before the first sample is not known.
    ///
    /// ```
    /// use kinstep::planner::Peak;
    /// let t = || (0..5).map(|n| f64::from(n) * 0.5);
    /// let peak = Peak::of_acceleration(t().map(|t| t * t), t().map(|t| 2.0 * t), 0.5);
    /// assert_eq!(peak.value, 2.0);
    /// ```
    pub fn of_acceleration(
        positions: impl Iterator<Item = f64>,
        velocities: impl Iterator<Item = f64>,
        sigma: f64,
    ) -> Self {
        largest(velocities, 1, sigma).larger(largest(positions, 2, sigma))
    }

    /// Returns the largest jerk of a joint between samples `sigma` apart \[s\], as [`of_acceleration`](Self::of_acceleration),
    /// of second differences of its velocities and third ones of its positions.
    pub fn of_jerk(
        positions: impl Iterator<Item = f64>,
        velocities: impl Iterator<Item = f64>,
        sigma: f64,
    ) -> Self {
        largest(velocities, 2, sigma).larger(largest(positions, 3, sigma))
    }

    fn larger(self, other: Self) -> Self {
        if other.certain > self.certain { other } else { self }
    }
}

impl ArmPlan {
    /// The entries of one joint.
    pub(super) fn every<'a>(&self, entries: &'a [f64], joint: usize) -> impl Iterator<Item = f64> + 'a {
        entries.iter().skip(joint).step_by(self.joints.len()).copied()
    }

    /// The acceleration and jerk limits that the samples cross. Costs nothing where there are none.
    pub(super) fn crossed_by_differences<'a>(
        &'a self,
        limits: impl Iterator<Item = &'a Limits>,
        sigma: f64,
    ) -> Vec<Violation> {
        let mut violations = Vec::new();
        for (joint, limits) in limits.enumerate() {
            let every = |entries: &'a [f64]| self.every(entries, joint);
            let samples = || (every(&self.positions), every(&self.velocities));
            let mut check = |kind: LimitKind, limit: f64, peak: &dyn Fn() -> Peak| {
                let Some(Peak { value, t, .. }) =
                    limit.is_finite().then(peak).filter(|peak| peak.certain > limit)
                else {
                    return;
                };
                let joint = self.joints[joint].clone();
                violations.push(Violation { joint, kind, t, value, limit: limit.copysign(value) });
            };
            check(LimitKind::Acceleration, limits.acceleration, &|| {
                let (q, v) = samples();
                Peak::of_acceleration(q, v, sigma)
            });
            check(LimitKind::Jerk, limits.jerk, &|| {
                let (q, v) = samples();
                Peak::of_jerk(q, v, sigma)
            });
        }
        violations
    }
}

/// The largest difference of that order, divided by as many gaps. Samples that are not finite count for nothing.
fn largest(samples: impl Iterator<Item = f64>, order: usize, sigma: f64) -> Peak {
    let weights = DIFFERENCES[order - 1];
    let scale = sigma.powf(order as f64);
    let mut newest = [0.0_f64; 4];
    let mut most = Peak::NONE;
    for (n, sample) in samples.enumerate() {
        newest.rotate_right(1);
        newest[0] = sample;
        if n < order {
            continue;
        }
        let value = weights.iter().zip(&newest).map(|(weight, sample)| weight * sample).sum::<f64>() / scale;
        let doubt = weights.iter().zip(&newest).map(|(weight, sample)| (weight * sample).abs()).sum::<f64>();
        let certain = value.abs() - ROUNDING * f64::EPSILON * doubt / scale;
        if certain > most.certain && certain.is_finite() {
            most = Peak { value, certain, t: (n as f64 - order as f64 / 2.0) * sigma };
        }
    }
    most
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_of_polynomials_are_their_derivatives() {
        let cubic = |t: f64| 0.5 + 2.0 * t - t * t + 0.25 * t * t * t;
        let sigma = 1.0 / 64.0;
        let samples = || (0..=64).map(|n| cubic(f64::from(n) * sigma));
        let [acceleration, jerk] = [2, 3].map(|order| largest(samples(), order, sigma));
        // q'' = -2 + 1.5 t is largest at the start, seen in the middle of the first three samples.
        assert_eq!((acceleration.value, acceleration.t), (-2.0 + 1.5 * sigma, sigma));
        assert!((jerk.value - 1.5).abs() < 1e-8 && (jerk.certain - 1.5).abs() < 1e-6, "{jerk:?}");
    }

    #[test]
    fn rounding_of_samples_that_are_close_together_proves_nothing() {
        let still = (0..100).map(|n| if n % 2 == 0 { 1.0 } else { 1.0 + f64::EPSILON });
        let jerk = largest(still, 3, 1e-6);
        assert_eq!(jerk.certain, 0.0);
    }
}
