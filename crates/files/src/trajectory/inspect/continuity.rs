//! Samples that do not belong to one motion: jumps, and velocities that the positions do not have.
//!
//! What is far apart may be anything: a goal of two points is as sound as a recording. So a verdict needs samples that are
//! close, or an acceleration that no arm has.

use super::interpolant::Knots;
use super::resolution::resolution;
use super::rest::REST;

/// Samples that are as close as this \[s\] tell a velocity: arms do not stop and go twenty times in a second.
pub(super) const CLOSE: f64 = 0.05 * (1.0 + 1e-6);
/// An acceleration [rad/s^2 or m/s^2] that no arm has.
const BEYOND_ARMS: f64 = 100.0;
/// How much faster than its neighbours a step is that is a jump.
const JUMP_RATIO: f64 = 10.0;
/// The smallest jump [rad or m].
const SMALLEST_JUMP: f64 = 1e-3;
/// The fraction of the fastest velocity by which a declared velocity may differ from that of the positions.
const DISAGREEMENT: f64 = 0.05;
/// How many times the usual noise of declared velocities is allowed.
const NOISE: f64 = 4.0;
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

/// A declared velocity that the positions around it do not have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Disagreement {
    /// When it is declared \[s\].
    pub t: f64,
    /// The declared velocity [rad/s or m/s].
    pub declared: f64,
    /// The velocity of the parabola through three positions.
    pub of_positions: f64,
}

impl Disagreement {
    /// By how much the two differ.
    pub fn size(&self) -> f64 {
        (self.declared - self.of_positions).abs()
    }
}

/// Steps that are much faster than those before and after, in the time that they take.
pub(super) fn jumps(knots: &Knots<'_>) -> Vec<Jump> {
    let slopes: Vec<f64> = (0..knots.steps()).map(|n| knots.slope(n)).collect();
    let rounding = resolution(&knots.positions);
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

/// Returns declared velocities that the positions do not have, the worst first: those that differ from the slope of the
/// parabola through the positions around by more than its own error, the noise of the velocities and 5 % of the fastest
/// velocity. `None` where none of the samples is close enough to others to tell.
pub(super) fn disagreements(knots: &Knots<'_>) -> Option<Vec<Disagreement>> {
    let last = knots.steps();
    let is_close = |n: usize| knots.gap(n) <= CLOSE;
    let may_tell = |n: &usize| (n - 2..n + 2).all(is_close);
    let places: Vec<usize> = (2..last.saturating_sub(1)).filter(may_tell).collect();
    if knots.velocities.is_empty() || places.is_empty() {
        return None;
    }
    let slopes: Vec<f64> = (0..last).map(|n| knots.slope(n)).collect();
    let largest = |values: &mut dyn Iterator<Item = f64>| values.map(f64::abs).fold(0.0, f64::max);
    let fastest =
        largest(&mut knots.velocities.iter().copied()).max(largest(&mut parabolas(knots, &slopes, &places)));
    let allowed = DISAGREEMENT * fastest + NOISE * noise(&knots.velocities) + REST;
    let rounding = 4.0 * resolution(&knots.positions);
    let found = places.iter().zip(parabolas(knots, &slopes, &places)).filter_map(|(&n, of_positions)| {
        let bend = |n: usize| (slopes[n + 1] - 2.0 * slopes[n] + slopes[n - 1]).abs();
        let error = bend(n - 1).max(bend(n)) + rounding / knots.gap(n).min(knots.gap(n - 1));
        let found = Disagreement { t: knots.times[n], declared: knots.velocities[n], of_positions };
        (found.size() > allowed + error).then_some(found)
    });
    let mut found: Vec<Disagreement> = found.collect();
    found.sort_by(|a, b| b.size().total_cmp(&a.size()));
    found.truncate(MOST);
    Some(found)
}

/// The slope at each of these samples of the parabola through it and its two neighbours.
fn parabolas<'k>(
    knots: &'k Knots<'_>,
    slopes: &'k [f64],
    places: &'k [usize],
) -> impl Iterator<Item = f64> + 'k {
    places.iter().map(|&n| {
        let (before, after) = (knots.gap(n - 1), knots.gap(n));
        (slopes[n - 1] * after + slopes[n] * before) / (before + after)
    })
}

/// The usual second difference of velocities: nothing of a smooth motion that is sampled closely, the noise of one that was
/// measured.
fn noise(velocities: &[f64]) -> f64 {
    let mut bends: Vec<f64> = velocities.windows(3).map(|v| (v[2] - 2.0 * v[1] + v[0]).abs()).collect();
    let middle = bends.len() / 2;
    if bends.is_empty() { 0.0 } else { *bends.select_nth_unstable_by(middle, f64::total_cmp).1 }
}
