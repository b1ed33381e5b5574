//! A trajectory held against what its joints allow, and against itself.

use super::{ArmTrajectory, Trajectory};
use kinstep::planner::{LimitKind, Violation};
use kinstep::robot::Limits;

/// The fastest velocity [rad/s or m/s] that is rest, where velocities are declared.
const REST: f64 = 1e-6;
/// The fraction of the fastest velocity that is rest, where velocities are estimated from positions.
const REST_FRACTION: f64 = 0.01;
/// How much faster than its neighbours a step is that is a jump.
const JUMP_RATIO: f64 = 10.0;
/// The smallest jump [rad or m].
const SMALLEST_JUMP: f64 = 1e-3;
/// The fraction of the fastest velocity by which declared velocities and steps may disagree, beside what the velocity
/// changes over the step.
const DISAGREEMENT: f64 = 0.05;
/// The fraction of the usual gap by which gaps may differ in even time.
const UNEVEN: f64 = 1e-6;
/// The most findings of one kind that are kept for a joint.
const MOST: usize = 5;

/// A value, and when it was met \[s\].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Met {
    /// The value.
    pub value: f64,
    /// The time \[s\].
    pub t: f64,
}

impl Met {
    fn larger(&mut self, value: f64, t: f64) {
        if value.abs() > self.value.abs() {
            *self = Self { value, t };
        }
    }
}

/// What one joint does.
#[derive(Clone, Debug, PartialEq)]
pub struct JointFigures {
    /// The joint.
    pub joint: String,
    /// Smallest and largest position [rad or m].
    pub positions: [f64; 2],
    /// The fastest declared velocity [rad/s or m/s], where velocities are declared.
    pub velocity: Option<Met>,
    /// The fastest mean velocity [rad/s or m/s] between two samples.
    pub mean_velocity: Met,
    /// The largest acceleration [rad/s^2 or m/s^2], by differences of velocities.
    pub acceleration: Met,
    /// The largest jerk [rad/s^3 or m/s^3], by differences of accelerations.
    pub jerk: Met,
    /// By how much the declared velocity and the mean velocity disagree most, beyond what the velocity changes over a step.
    pub disagreement: Option<Met>,
    /// The velocities at the start and at the end: declared, or estimated from three samples.
    pub ends: [f64; 2],
    /// Jumps: steps that are much faster than those before and after; by how much, and when.
    pub jumps: Vec<Met>,
    /// Limits crossed, each where it was worst.
    pub violations: Vec<Violation>,
}

impl JointFigures {
    /// The fastest velocity of all, declared or not.
    fn fastest(&self) -> f64 {
        self.velocity.map_or(0.0, |met| met.value.abs()).max(self.mean_velocity.value.abs())
    }

    /// Whether the joint is at rest at the start, and at the end.
    pub fn rests(&self) -> [bool; 2] {
        let bound = if self.velocity.is_some() { REST } else { REST.max(REST_FRACTION * self.fastest()) };
        self.ends.map(|velocity| velocity.abs() <= bound)
    }

    /// Whether declared velocities are those that the positions have.
    pub fn agrees(&self) -> bool {
        self.disagreement.is_none_or(|met| met.value <= DISAGREEMENT * self.fastest() + REST)
    }
}

/// What the clock does.
#[derive(Clone, Debug, PartialEq)]
pub struct TimeFigures {
    /// The usual gap between samples \[s\]: the median.
    pub gap: f64,
    /// The smallest and the largest gap, and when they end \[s\].
    pub gaps: [Met; 2],
    /// Whether all gaps are equal but for rounding.
    pub is_even: bool,
    /// Samples that repeat the one before while the arm moves on both sides: how often, and when first \[s\].
    pub repeated: Option<(usize, f64)>,
}

impl TimeFigures {
    /// Returns the figures of a trajectory with two samples at least.
    pub fn of(trajectory: &Trajectory) -> Self {
        let times = &trajectory.times;
        let gap = |n: usize| Met { value: times[n] - times[n - 1], t: times[n] };
        let mut gaps: Vec<Met> = (1..times.len()).map(gap).collect();
        gaps.sort_by(|a, b| a.value.total_cmp(&b.value));
        let nothing = Met::default();
        let at = |index: usize| gaps.get(index).copied().unwrap_or(nothing);
        let (first, usual, last) = (at(0), at(gaps.len() / 2), at(gaps.len().saturating_sub(1)));
        // Times carry the rounding of the last of them, and files may have rounded to nanoseconds.
        let rounding = 4.0 * f64::EPSILON * times.last().copied().unwrap_or(0.0).abs() + 2e-9;
        let is_even = last.value - first.value <= UNEVEN * usual.value + rounding;
        Self { gap: usual.value, gaps: [first, last], is_even, repeated: repeated(trajectory) }
    }
}

/// A sample that all joints of all arms repeat although they moved before and move after.
fn repeated(trajectory: &Trajectory) -> Option<(usize, f64)> {
    let same = |n: usize| trajectory.arms.iter().all(|arm| arm.position(n) == arm.position(n - 1));
    let still: Vec<bool> = (1..trajectory.samples()).map(same).collect();
    let alone = |n: &usize| still[*n] && *n > 0 && !still[*n - 1] && still.get(*n + 1) == Some(&false);
    let mut found = (0..still.len()).filter(alone);
    let first = found.next()?;
    Some((1 + found.count(), trajectory.times[first + 1]))
}

impl ArmTrajectory {
    /// Returns what every joint does at these times \[s\], two at least, held against `limits` in the order of the joints.
    ///
    /// # Panics
    /// If there are fewer limits than joints, or fewer samples than times.
    pub fn inspect(&self, times: &[f64], limits: &[Limits]) -> Vec<JointFigures> {
        (0..self.joints.len()).map(|joint| self.inspect_joint(joint, times, &limits[joint])).collect()
    }

    fn inspect_joint(&self, joint: usize, times: &[f64], limits: &Limits) -> JointFigures {
        let joints = self.joints.len();
        let q: Vec<f64> = self.positions.iter().skip(joint).step_by(joints).copied().collect();
        let v: Vec<f64> = self.velocities.iter().skip(joint).step_by(joints).copied().collect();
        let mean: Vec<f64> = quotients(&q, times);
        let middle: Vec<f64> = times.windows(2).map(|pair| f64::midpoint(pair[0], pair[1])).collect();
        let is_declared = !v.is_empty();
        // Differences of what is declared, or else of mean velocities, which hold in the middle of their steps.
        let (rates, at) = if is_declared { (&v, times) } else { (&mean, middle.as_slice()) };
        let acceleration = quotients(rates, at);
        let acceleration_at: Vec<f64> = at.windows(2).map(|pair| f64::midpoint(pair[0], pair[1])).collect();
        let jerk = quotients(&acceleration, &acceleration_at);
        let velocity = is_declared.then(|| largest(&v, times));
        let (low, high) =
            q.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &q| (low.min(q), high.max(q)));
        JointFigures {
            joint: self.joints[joint].clone(),
            positions: [low, high],
            velocity,
            mean_velocity: largest(&mean, &times[1..]),
            acceleration: largest(&acceleration, &at[1..]),
            jerk: largest(&jerk, &at[2.min(at.len())..]),
            disagreement: is_declared.then(|| disagreement(&v, &mean, times)),
            ends: if is_declared { [v[0], v[v.len() - 1]] } else { estimated_ends(&mean, &middle, times) },
            jumps: jumps(&q, &mean, times),
            violations: violations(&self.joints[joint], limits, [&q, &v, &mean], times),
        }
    }
}

/// Divided differences of neighbours.
fn quotients(values: &[f64], times: &[f64]) -> Vec<f64> {
    let steps = values.windows(2).zip(times.windows(2));
    steps.map(|(value, time)| (value[1] - value[0]) / (time[1] - time[0])).collect()
}

fn largest(values: &[f64], times: &[f64]) -> Met {
    let mut met = Met { value: 0.0, t: times.first().copied().unwrap_or(0.0) };
    values.iter().zip(times).for_each(|(&value, &t)| met.larger(value, t));
    met
}

/// The mean of a smooth velocity over a step lies within what the velocity is at its ends, or near it.
fn disagreement(v: &[f64], mean: &[f64], times: &[f64]) -> Met {
    let mut worst = Met { value: 0.0, t: times[0] };
    for (n, mean) in mean.iter().enumerate() {
        let allowed = (v[n + 1] - v[n]).abs();
        let apart = (mean - f64::midpoint(v[n], v[n + 1])).abs() - allowed;
        worst.larger(apart.max(0.0), times[n + 1]);
    }
    worst
}

/// The velocity at both ends, by a straight line through the two mean velocities nearest to it.
fn estimated_ends(mean: &[f64], middle: &[f64], times: &[f64]) -> [f64; 2] {
    let line = |from: usize, to: usize, t: f64| {
        let slope = (mean[to] - mean[from]) / (middle[to] - middle[from]);
        mean[from] + slope * (t - middle[from])
    };
    match mean.len() {
        0 => [0.0; 2],
        1 => [mean[0]; 2],
        n => [line(0, 1, times[0]), line(n - 1, n - 2, times[times.len() - 1])],
    }
}

fn jumps(q: &[f64], mean: &[f64], times: &[f64]) -> Vec<Met> {
    let is_jump = |n: &usize| {
        let before = n.checked_sub(1).and_then(|before| mean.get(before));
        let around = before.into_iter().chain(mean.get(n + 1)).map(|mean| mean.abs()).fold(0.0, f64::max);
        (q[n + 1] - q[*n]).abs() > SMALLEST_JUMP && mean.len() > 1 && mean[*n].abs() > JUMP_RATIO * around
    };
    let found = (0..mean.len()).filter(is_jump);
    found.map(|n| Met { value: q[n + 1] - q[n], t: times[n + 1] }).take(MOST).collect()
}

fn violations(joint: &str, limits: &Limits, [q, v, mean]: [&[f64]; 3], times: &[f64]) -> Vec<Violation> {
    let positions = q.iter().zip(times).map(|(&value, &t)| (value, t));
    let velocities = v.iter().zip(times).chain(mean.iter().zip(&times[1..])).map(|(&value, &t)| (value, t));
    let bound = limits.velocity;
    [
        worst(joint, LimitKind::Position, positions, [limits.lower, limits.upper]),
        worst(joint, LimitKind::Velocity, velocities, [-bound, bound]),
    ]
    .into_iter()
    .flatten()
    .collect()
}

fn worst(
    joint: &str,
    kind: LimitKind,
    values: impl Iterator<Item = (f64, f64)>,
    [lower, upper]: [f64; 2],
) -> Option<Violation> {
    let excess = |value: f64| if value > upper { value - upper } else { lower - value };
    let (value, t) = values.max_by(|a, b| excess(a.0).total_cmp(&excess(b.0)))?;
    let limit = if value > upper { upper } else { lower };
    (excess(value) > 0.0).then(|| Violation { joint: joint.to_owned(), kind, t, value, limit })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `q = sin^2` over a second, with its velocity, 101 samples.
    fn smooth() -> (ArmTrajectory, Vec<f64>) {
        let times: Vec<f64> = (0..=100).map(|n| f64::from(n) / 100.0).collect();
        let q = |t: &f64| (t * std::f64::consts::PI).sin().powi(2);
        let v = |t: &f64| std::f64::consts::PI * (2.0 * t * std::f64::consts::PI).sin();
        let arm = ArmTrajectory {
            joints: vec!["a".to_owned()],
            positions: times.iter().map(q).collect(),
            velocities: times.iter().map(v).collect(),
            ..ArmTrajectory::empty("arm")
        };
        (arm, times)
    }

    fn figures(arm: &ArmTrajectory, times: &[f64]) -> JointFigures {
        arm.inspect(times, &[Limits { lower: -0.1, upper: 2.0, velocity: 4.0, ..Limits::UNLIMITED }])
            .remove(0)
    }

    #[test]
    fn a_smooth_motion_passes_with_its_figures() {
        let (mut arm, times) = smooth();
        for declared in [true, false] {
            let found = figures(&arm, &times);
            assert!(found.violations.is_empty() && found.jumps.is_empty() && found.agrees(), "{found:?}");
            assert_eq!(found.rests(), [true; 2], "{declared}: {found:?}");
            let pi = std::f64::consts::PI;
            assert!((found.acceleration.value.abs() / (2.0 * pi * pi) - 1.0).abs() < 0.01, "{found:?}");
            assert!((found.jerk.value.abs() / (4.0 * pi.powi(3)) - 1.0).abs() < 0.01, "{found:?}");
            assert!((found.mean_velocity.value.abs() / pi - 1.0).abs() < 0.01);
            arm.velocities.clear();
        }
    }

    #[test]
    fn a_jump_is_found_and_crosses_the_velocity_limit() {
        let (mut arm, times) = smooth();
        arm.positions[51..].iter_mut().for_each(|q| *q += 0.5);
        let found = figures(&arm, &times);
        assert_eq!(found.jumps.len(), 1);
        assert_eq!(found.jumps[0].t, 0.51);
        let velocity = &found.violations[0];
        assert_eq!((velocity.kind, velocity.t, velocity.limit), (LimitKind::Velocity, 0.51, 4.0));
        assert!(!found.agrees());
    }

    #[test]
    fn wrong_velocities_an_end_in_motion_and_a_stalled_clock_are_found() {
        let (mut arm, times) = smooth();
        arm.velocities.iter_mut().for_each(|v| *v *= 2.0);
        assert!(!figures(&arm, &times).agrees());
        let (mut arm, times) = smooth();
        arm.positions.truncate(26);
        arm.velocities.truncate(26);
        assert_eq!(figures(&arm, &times[..26]).rests(), [true, false]);
        arm.velocities.clear();
        assert_eq!(figures(&arm, &times[..26]).rests(), [true, false]);

        let (mut arm, mut times) = smooth();
        arm.positions[30] = arm.positions[29];
        times[60] += 0.001;
        let clock = TimeFigures::of(&Trajectory { about: None, times, arms: vec![arm] });
        assert_eq!(clock.repeated, Some((1, 0.3)));
        assert!(!clock.is_even && (clock.gap - 0.01).abs() < 1e-12, "{clock:?}");
    }
}
