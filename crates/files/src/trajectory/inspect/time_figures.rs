//! What the clock of a trajectory does.

use super::Met;
use super::continuity::CLOSE;
use super::interpolant::Knots;
use super::noise::noise;
use super::rest::REST;
use crate::trajectory::{ArmTrajectory, Trajectory};

/// The fraction of the usual gap by which gaps may differ in even time.
const UNEVEN: f64 = 1e-6;
/// The fraction of the fastest declared velocity that is more than the noise of an arm at rest.
const MOVING: f64 = 0.05;
/// How many times the hardest acceleration elsewhere it takes to stand still for a step that was not meant.
const STALL: f64 = 10.0;

/// What the clock does.
#[derive(Clone, Debug, PartialEq)]
pub struct TimeFigures {
    /// The usual gap between samples \[s\]: the median.
    pub gap: f64,
    /// The smallest and the largest gap, and when they end \[s\].
    pub gaps: [Met; 2],
    /// Whether all gaps are equal but for rounding.
    pub is_even: bool,
    /// Samples that repeat the one before while an arm moves through both: how often, and when first \[s\].
    pub repeated: Option<(usize, f64)>,
}

impl TimeFigures {
    /// Returns the figures of a trajectory with two samples at least.
    pub fn of(trajectory: &Trajectory) -> Self {
        let times = &trajectory.times;
        let gap = |n: usize| Met { value: times[n] - times[n - 1], t: times[n] };
        let mut gaps: Vec<Met> = (1..times.len()).map(gap).collect();
        let order = |a: &Met, b: &Met| a.value.total_cmp(&b.value);
        let (first, last) = (gaps.iter().copied().min_by(order), gaps.iter().copied().max_by(order));
        let [first, last] = [first, last].map(Option::unwrap_or_default);
        let middle = gaps.len() / 2;
        let usual = if gaps.is_empty() { first } else { *gaps.select_nth_unstable_by(middle, order).1 };
        // Times carry the rounding of the last of them, and files may have rounded to nanoseconds.
        let rounding = 4.0 * f64::EPSILON * times.last().copied().unwrap_or(0.0).abs() + 2e-9;
        let is_even = last.value - first.value <= UNEVEN * usual.value + rounding;
        Self { gap: usual.value, gaps: [first, last], is_even, repeated: repeated(trajectory) }
    }
}

/// Samples close together that all joints of all arms repeat although one of them moves through.
fn repeated(trajectory: &Trajectory) -> Option<(usize, f64)> {
    let times = &trajectory.times;
    let same = |n: usize| trajectory.arms.iter().all(|arm| arm.position(n) == arm.position(n - 1));
    let still = |n: &usize| times[*n] - times[*n - 1] <= CLOSE && same(*n);
    let still: Vec<usize> = (1..times.len()).filter(still).collect();
    let runs: Vec<&[usize]> = still.chunk_by(|a, b| a + 1 == *b).collect();
    if runs.is_empty() {
        return None;
    }
    let joints: Vec<Passing<'_>> = trajectory.arms.iter().flat_map(|arm| passing(arm, times)).collect();
    let is_stall = |run: &&&[usize]| joints.iter().any(|joint| joint.passes(run[0], run[run.len() - 1]));
    let mut found = runs.iter().filter(is_stall);
    let first = found.next()?;
    Some((first.len() + found.map(|run| run.len()).sum::<usize>(), times[first[0]]))
}

/// What tells whether a joint moves through a sample that repeats the one before.
struct Passing<'t> {
    knots: Knots<'t>,
    /// The least declared velocity that is a motion.
    least: f64,
    /// The hardest acceleration elsewhere, where no velocities are declared.
    hardest: f64,
    /// The shortest step that is more than rounding.
    rounding: f64,
}

fn passing<'t>(arm: &ArmTrajectory, times: &'t [f64]) -> Vec<Passing<'t>> {
    let joint = |joint: usize| {
        let knots = Knots::of(arm, joint, times);
        let fastest = knots.velocities.iter().map(|velocity| velocity.abs()).fold(0.0, f64::max);
        let rounding = 4.0 * knots.resolution();
        let least = REST + noise(&knots.velocities).max(MOVING * fastest);
        Passing { least, hardest: hardest(&knots), rounding, knots }
    };
    (0..arm.joints.len()).map(joint).collect()
}

impl Passing<'_> {
    /// Whether the joint passes through the samples from `first` to `last`, which repeat the one before `first`: it moves on as
    /// before, and the velocities that it declares meanwhile do not rest, or else it would have to stop and start harder than it
    /// does anything else.
    fn passes(&self, first: usize, last: usize) -> bool {
        if first < 2 || last >= self.knots.steps() {
            return false;
        }
        let (before, after) = (self.knots.slope(first - 2), self.knots.slope(last));
        let (slower, gap) = (before.abs().min(after.abs()), self.knots.gap(first - 1));
        if !(before * after > 0.0 && slower * gap > self.rounding) {
            return false;
        }
        match self.knots.velocities.get(first - 1..=last) {
            Some(declared) => declared.iter().all(|velocity| velocity * before.signum() > self.least),
            None => slower / gap > STALL * self.hardest,
        }
    }
}

/// The hardest acceleration of a joint, with steps left out that repeat a position.
fn hardest(knots: &Knots<'_>) -> f64 {
    let (mut times, mut positions) = (Vec::new(), Vec::new());
    for (&position, &time) in knots.positions.iter().zip(knots.times) {
        if positions.last() != Some(&position) {
            positions.push(position);
            times.push(time);
        }
    }
    Knots::through(&times, positions).hardest()
}
