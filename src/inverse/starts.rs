//! The places a search starts from: spread evenly over the joints' ranges, the same ones every time.

use crate::robot::{ChainJoint, Limits};
use std::f64::consts::PI;

/// The range \[rad or m\] that starting positions of a joint are taken from; where a limit is not known, half a turn or
/// `length` \[m\] to that side of where the joint would rest.
pub(super) fn range(joint: &ChainJoint, limits: &Limits, length: f64) -> (f64, f64) {
    let margin = if joint.kind.is_rotation() { PI } else { length };
    match (limits.lower.is_finite(), limits.upper.is_finite()) {
        (true, true) => (limits.lower, limits.upper),
        (true, false) => (limits.lower, limits.lower + 2.0 * margin),
        (false, true) => (limits.upper - 2.0 * margin, limits.upper),
        (false, false) => (-margin, margin),
    }
}

/// Points of the unit cube that fill it evenly: the additive recurrence `frac(shift_i + k phi^-(i+1))` with the positive
/// root `phi` of `x^(d+1) = x + 1`, which is the golden ratio for `d = 1` (M. Roberts 2018). The shift comes from the seed.
pub(super) struct EvenPoints {
    shift: Vec<f64>,
    step: Vec<f64>,
}

impl EvenPoints {
    pub(super) fn new(dimension: usize, seed: u64) -> Self {
        let phi = (0..64).fold(1.5_f64, |x, _| (1.0 + x).powf(1.0 / (dimension as f64 + 1.0)));
        let step = (1..=dimension).map(|i| phi.powf(-(i as f64))).collect();
        Self { shift: (0..dimension as u64).map(|i| fraction(seed, i)).collect(), step }
    }

    /// Component `i` of point `k`, in [0, 1).
    pub(super) fn component(&self, k: usize, i: usize) -> f64 {
        (self.shift[i] + k as f64 * self.step[i]).fract()
    }
}

/// A number in [0, 1) that looks random but follows from the seed and the index (Steele, Lea and Flood's SplitMix64).
fn fraction(seed: u64, index: u64) -> f64 {
    let mut z = seed.wrapping_add(1 + index).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_are_spread_more_evenly_than_chance_would() {
        for dimension in [1, 2, 7, 14] {
            let points = EvenPoints::new(dimension, 7);
            for i in 0..dimension {
                let mut counts = [0; 8];
                (0..800).for_each(|k| counts[(points.component(k, i) * 8.0) as usize] += 1);
                // Chance would leave some of the eighths 25 away from 100.
                assert!(counts.iter().all(|count| (85..=115).contains(count)), "{dimension} {i}: {counts:?}");
            }
        }
    }

    #[test]
    fn another_seed_gives_other_points() {
        let [one, other] = [1, 2].map(|seed| EvenPoints::new(3, seed).component(5, 1));
        assert_ne!(one, other);
        assert_eq!(one, EvenPoints::new(3, 1).component(5, 1));
    }
}
