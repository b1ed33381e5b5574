//! Of all the joint positions with one pose of the tip, those near a configuration.

use super::descent::Descent;
use std::f64::consts::TAU;

/// Steps along the self-motion.
const SLIDES: usize = 60;
/// Halvings of a step that does not bring the joints nearer.
const HALVINGS: usize = 5;
/// Descents back onto the target after a step along its tangent.
const CORRECTIONS: usize = 20;
/// A step that brings the joints nearer by less than this fraction is the last.
const LEAST_GAIN: f64 = 1e-7;

/// The Euclidean distance between two configurations.
pub(super) fn distance(q: &[f64], other: &[f64]) -> f64 {
    q.iter().zip(other).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
}

/// Brings a solution `q` nearer to the configuration `near` without the tip leaving its target: whole turns first, then
/// along the self-motion of a redundant arm.
pub(super) fn draw(descent: &mut Descent<'_>, q: &mut Vec<f64>, near: &[f64]) {
    unwind(descent, q, near);
    let mut from = distance(q, near);
    for _ in 0..SLIDES {
        let Some((closer, to)) = slide(descent, q, near, from) else { return };
        *q = closer;
        let is_last = to > from * (1.0 - LEAST_GAIN);
        from = to;
        if is_last {
            return;
        }
    }
}

/// Takes whole turns off a joint where that brings it nearer and changes nothing for the tip.
fn unwind(descent: &mut Descent<'_>, q: &mut [f64], near: &[f64]) {
    for i in 0..q.len() {
        if !descent.chain.joints()[i].kind.is_rotation() {
            continue;
        }
        let wound = q[i];
        let limits = descent.limits[i];
        // As many turns as bring it within half a turn of `near`, or fewer where the limits allow no more.
        let mut turns = ((wound - near[i]) / TAU).round();
        while turns != 0.0 && !limits.contains(wound - turns * TAU) {
            turns -= turns.signum();
        }
        q[i] = wound - turns * TAU;
        // A joint that others follow by another ratio does not come back to the same pose.
        if turns != 0.0 && descent.descend(&mut q.to_vec(), 0) > descent.tolerance {
            q[i] = wound;
        }
    }
}

/// One step along the self-motion towards `near`: the new configuration, and its distance below `from`.
fn slide(descent: &mut Descent<'_>, q: &[f64], near: &[f64], from: f64) -> Option<(Vec<f64>, f64)> {
    let mut direction: Vec<f64> = near.iter().zip(q).map(|(near, q)| near - q).collect();
    descent.self_motion(q, &mut direction);
    let mut fraction = 1.0;
    for _ in 0..=HALVINGS {
        let ahead = q.iter().zip(&direction).zip(&descent.limits);
        let mut candidate: Vec<f64> =
            ahead.map(|((q, d), limits)| (q + fraction * d).clamp(limits.lower, limits.upper)).collect();
        let error = descent.descend(&mut candidate, CORRECTIONS);
        let to = distance(&candidate, near);
        if error <= descent.tolerance && to < from {
            return Some((candidate, to));
        }
        fraction *= 0.5;
    }
    None
}
