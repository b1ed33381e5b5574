//! Samples that do not belong to one motion: jumps, and velocities that the positions do not have.
//!
//! What is far apart may be anything: a goal of two points is as sound as a recording. So a verdict needs samples that are
//! close, or an acceleration that no arm has.

use super::interpolant::Knots;
use super::noise::noise;
use super::resolution::resolution;
use super::rest::REST;
use kinstep::planner::LimitKind;

/// Samples that are as close as this \[s\] tell a velocity: arms do not stop and go twenty times in a second.
pub(super) const CLOSE: f64 = 0.05 * (1.0 + 1e-6);
/// An acceleration [rad/s^2 or m/s^2] that no arm has.
const BEYOND_ARMS: f64 = 100.0;
/// How much faster than its neighbours a step is that is a jump.
const JUMP_RATIO: f64 = 10.0;
/// The smallest jump [rad or m]: more than one count of a coarse encoder, `2 pi / 4096`.
const SMALLEST_JUMP: f64 = 2e-3;
/// The fraction of the fastest by which a declared velocity or acceleration may differ from that of the values.
const DISAGREEMENT: f64 = 0.05;
/// The most findings of one kind that are kept for a joint.
const MOST: usize = 5;

/// A step that no arm can take.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Jump {
    /// When it ends \[s\].
    pub t: f64,
    /// How far it goes [rad or m].
    pub distance: f64,
    /// How long it takes \[s\].
    pub duration: f64,
    /// The least acceleration [rad/s^2 or m/s^2] that any smooth motion through the samples around it needs: twice their second
    /// divided difference.
    pub acceleration: f64,
}

/// A declared velocity that the positions around it do not have, or a declared acceleration that the velocities do not have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disagreement {
    /// Which of the two.
    pub kind: LimitKind,
    /// When it is declared \[s\].
    pub t: f64,
    /// What is declared [rad/s or m/s, rad/s^2 or m/s^2].
    pub declared: f64,
    /// The slope of the parabola through three positions, or velocities.
    pub of_values: f64,
}

impl Disagreement {
    /// By how much the two differ.
    pub fn size(&self) -> f64 {
        (self.declared - self.of_values).abs()
    }
}

/// Steps that are much faster than those before and after, in the time that they take.
pub(super) fn jumps(knots: &Knots<'_>) -> Vec<Jump> {
    let slopes: Vec<f64> = (0..knots.steps()).map(|n| knots.slope(n)).collect();
    let rounding = knots.resolution();
    let jump = |n: usize| {
        let neighbours = n.checked_sub(1).into_iter().chain((n + 1 < slopes.len()).then_some(n + 1));
        let mut acceleration = f64::INFINITY;
        for other in neighbours {
            let is_slower = slopes[n].abs() > JUMP_RATIO * slopes[other].abs();
            let mean = f64::midpoint(knots.gap(n), knots.gap(other));
            let needed = (slopes[n] - slopes[other]).abs() / mean - 4.0 * rounding / (mean * mean);
            acceleration = if is_slower { acceleration.min(needed) } else { 0.0_f64.min(acceleration) };
        }
        let (distance, duration) = (knots.positions[n + 1] - knots.positions[n], knots.gap(n));
        let is_jump =
            distance.abs() > SMALLEST_JUMP && acceleration.is_finite() && acceleration > BEYOND_ARMS;
        is_jump.then(|| Jump { t: knots.times[n + 1], distance, duration, acceleration })
    };
    (0..slopes.len()).filter_map(jump).take(MOST).collect()
}

/// Returns declared velocities that the positions do not have, and declared accelerations that the velocities do not have, of each
/// kind the worst first: those that differ from the slope of the parabola around by more than its own error, the noise of both, and 5 % of
/// the fastest. `None` where none of the samples is close enough to others to tell.
pub(super) fn disagreements(knots: &Knots<'_>) -> Option<Vec<Disagreement>> {
    let is_close = |n: usize| knots.gap(n) <= CLOSE;
    let may_tell = |n: &usize| (n - 2..n + 2).all(is_close);
    let places: Vec<usize> = (2..knots.steps().saturating_sub(1)).filter(may_tell).collect();
    if knots.velocities.is_empty() || places.is_empty() {
        return None;
    }
    let mut found =
        Compared::new(LimitKind::Velocity, knots.resolution(), knots, [&knots.positions, &knots.velocities])
            .disagreements(&places);
    if !knots.accelerations.is_empty() {
        let values = [&knots.velocities, &knots.accelerations].map(Vec::as_slice);
        let step = resolution(&knots.velocities);
        found.extend(Compared::new(LimitKind::Acceleration, step, knots, values).disagreements(&places));
    }
    Some(found)
}

/// Values, their declared derivative, and the derivative that they have.
struct Compared<'k> {
    kind: LimitKind,
    resolution: f64,
    knots: &'k Knots<'k>,
    declared: &'k [f64],
    slopes: Vec<f64>,
}

impl<'k> Compared<'k> {
    fn new(
        kind: LimitKind,
        resolution: f64,
        knots: &'k Knots<'_>,
        [values, declared]: [&'k [f64]; 2],
    ) -> Self {
        Self { kind, resolution, knots, declared, slopes: knots.differences(values, 1) }
    }

    fn disagreements(&self, places: &[usize]) -> Vec<Disagreement> {
        let largest = |values: &mut dyn Iterator<Item = f64>| values.map(f64::abs).fold(0.0, f64::max);
        let fastest = largest(&mut self.declared.iter().copied());
        let fastest = fastest.max(largest(&mut places.iter().map(|&n| self.parabola(n))));
        let allowed = DISAGREEMENT * fastest
            + noise(self.declared)
            + noise(&self.slopes)
            + resolution(self.declared)
            + REST;
        // Steps of the declared derivative bound what a smooth motion can bend.
        let most = 2.0 * largest(&mut self.declared.windows(2).map(|pair| pair[1] - pair[0]));
        let bend = |n: usize| (self.slopes[n + 1] - 2.0 * self.slopes[n] + self.slopes[n - 1]).abs();
        let disagreement = |&n: &usize| {
            let gap = self.knots.gap(n).min(self.knots.gap(n - 1));
            let error = bend(n - 1).max(bend(n)).min(most) + 4.0 * self.resolution / gap;
            let (declared, of_values) = (self.declared[n], self.parabola(n));
            let found = Disagreement { kind: self.kind, t: self.knots.times[n], declared, of_values };
            (found.size() > allowed + error).then_some(found)
        };
        let mut found: Vec<Disagreement> = places.iter().filter_map(disagreement).collect();
        found.sort_by(|a, b| b.size().total_cmp(&a.size()));
        found.truncate(MOST);
        found
    }

    /// The slope at a sample of the parabola through it and its two neighbours.
    fn parabola(&self, n: usize) -> f64 {
        let (before, after) = (self.knots.gap(n - 1), self.knots.gap(n));
        (self.slopes[n - 1] * after + self.slopes[n] * before) / (before + after)
    }
}
