//! The motion between samples.

use std::cell::OnceCell;

use super::resolution::{resolution, written};
use super::segment::Segment;
use crate::trajectory::ArmTrajectory;

/// How a controller moves a joint between two samples, `h` \[s\] apart.
///
/// | | between two samples | continuous |
/// |---|---|---|
/// | linear | `q_0 + s (q_1 - q_0)` with `s = (t - t_0) / h` | positions |
/// | cubic | the polynomial of degree 3 with the positions and velocities of both | velocities |
/// | quintic | that of degree 5 with the accelerations too | accelerations |
///
/// These are the three of the joint trajectory controller of `ros2_control`, which chooses by what the points declare.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Interpolation {
    /// Straight lines through the positions.
    Linear,
    /// Cubics through positions and velocities.
    Cubic,
    /// Quintics through positions, velocities and accelerations.
    Quintic,
}

impl Interpolation {
    /// Every interpolation, the roughest first.
    pub const ALL: [Self; 3] = [Self::Linear, Self::Cubic, Self::Quintic];

    /// Returns the one that the samples of an arm imply: quintic where they declare velocities and accelerations, cubic where
    /// they declare velocities, linear else.
    pub fn of(arm: &ArmTrajectory) -> Self {
        match (arm.velocities.is_empty(), arm.accelerations.is_empty()) {
            (false, false) => Self::Quintic,
            (false, true) => Self::Cubic,
            (true, _) => Self::Linear,
        }
    }

    /// The word for it.
    pub fn name(self) -> &'static str {
        match self {
            Self::Linear => "linear",
            Self::Cubic => "cubic",
            Self::Quintic => "quintic",
        }
    }
}

/// The samples of one joint.
#[derive(Clone, Debug)]
pub(super) struct Knots<'t> {
    pub(super) times: &'t [f64],
    pub(super) positions: Vec<f64>,
    /// Empty where none are declared.
    pub(super) velocities: Vec<f64>,
    /// Empty where none are declared.
    pub(super) accelerations: Vec<f64>,
    resolution: OnceCell<f64>,
}

impl<'t> Knots<'t> {
    pub(super) fn of(arm: &ArmTrajectory, joint: usize, times: &'t [f64]) -> Self {
        let of_joint =
            |values: &[f64]| values.iter().skip(joint).step_by(arm.joints.len()).copied().collect();
        Self {
            times,
            positions: of_joint(&arm.positions),
            velocities: of_joint(&arm.velocities),
            accelerations: of_joint(&arm.accelerations),
            resolution: OnceCell::new(),
        }
    }

    /// Positions alone.
    pub(super) fn through(times: &'t [f64], positions: Vec<f64>) -> Self {
        Self {
            times,
            positions,
            velocities: Vec::new(),
            accelerations: Vec::new(),
            resolution: OnceCell::new(),
        }
    }

    /// The same, with positions that are known no better than to this step: that of its own encoder, or of a coarser one like it.
    pub(super) fn known_to(self, step: f64) -> Self {
        let resolution = OnceCell::from(written(&self.positions).max(step));
        Self { resolution, ..self }
    }

    /// How finely the positions are known.
    pub(super) fn resolution(&self) -> f64 {
        *self.resolution.get_or_init(|| resolution(&self.positions))
    }

    /// Returns what these are more than `multiplier` times others and `offset`.
    pub(super) fn less(&self, others: &Self, multiplier: f64, offset: f64) -> Self {
        let apart = |own: &[f64], others: &[f64], offset: f64| -> Vec<f64> {
            own.iter().zip(others).map(|(own, other)| own - (multiplier * other + offset)).collect()
        };
        Self {
            velocities: apart(&self.velocities, &others.velocities, 0.0),
            accelerations: apart(&self.accelerations, &others.accelerations, 0.0),
            ..Self::through(self.times, apart(&self.positions, &others.positions, offset))
        }
    }

    /// Number of steps between samples.
    pub(super) fn steps(&self) -> usize {
        self.times.len() - 1
    }

    /// How long step `n` takes \[s\].
    pub(super) fn gap(&self, n: usize) -> f64 {
        self.times[n + 1] - self.times[n]
    }

    /// The mean velocity over step `n`.
    pub(super) fn slope(&self, n: usize) -> f64 {
        (self.positions[n + 1] - self.positions[n]) / self.gap(n)
    }

    /// Returns the derivatives of order `order` that any smooth motion through the positions has, each somewhere between
    /// `order + 1` neighbouring samples, from those of the order below: divided differences times the factorial of the order.
    pub(super) fn differences(&self, below: &[f64], order: usize) -> Vec<f64> {
        let span = |n: usize| self.times[n + order] - self.times[n];
        let pairs = below.windows(2).enumerate();
        pairs.map(|(n, pair)| order as f64 * (pair[1] - pair[0]) / span(n)).collect()
    }

    /// The least acceleration that any smooth motion through the positions has where it is largest: zero with two samples.
    pub(super) fn hardest(&self) -> f64 {
        let slopes = self.differences(&self.positions, 1);
        let accelerations = self.differences(&slopes, 2);
        accelerations.iter().map(|acceleration| acceleration.abs()).fold(0.0, f64::max)
    }

    /// The position over step `n`, and its three derivatives. Ends that the samples declare are those to the last bit.
    pub(super) fn segments(&self, interpolation: Interpolation, n: usize) -> [Segment; 4] {
        let h = self.gap(n);
        let both = |values: &[f64]| [values[n], values[n + 1]];
        let [q, end] = both(&self.positions);
        let distance = end - q;
        let mut c = [q, 0.0, 0.0, 0.0, 0.0, 0.0];
        match interpolation {
            Interpolation::Linear => c[1] = distance,
            Interpolation::Cubic => {
                let [from, to] = both(&self.velocities).map(|velocity| h * velocity);
                c[1..4].copy_from_slice(&[
                    from,
                    3.0 * distance - 2.0 * from - to,
                    from + to - 2.0 * distance,
                ]);
            }
            Interpolation::Quintic => {
                let [from, to] = both(&self.velocities).map(|velocity| h * velocity);
                let [a, b] = both(&self.accelerations).map(|acceleration| h * h / 2.0 * acceleration);
                c[1..].copy_from_slice(&[
                    from,
                    a,
                    10.0 * distance - 6.0 * from - 4.0 * to - 3.0 * a + b,
                    8.0 * from + 7.0 * to - 15.0 * distance + 3.0 * a - 2.0 * b,
                    6.0 * distance - 3.0 * (from + to) - a + b,
                ]);
            }
        }
        let position = Segment::new([self.times[n], h], c).ending(end);
        let mut velocity = position.derivative();
        if interpolation >= Interpolation::Cubic {
            velocity = velocity.between(both(&self.velocities));
        }
        let mut acceleration = velocity.derivative();
        if interpolation == Interpolation::Quintic {
            acceleration = acceleration.between(both(&self.accelerations));
        }
        [position, velocity, acceleration, acceleration.derivative()]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::array::uniform6;
    use proptest::prelude::*;

    proptest! {
        /// A polynomial of the degree is its own interpolant.
        #[test]
        fn polynomials_of_the_degree_come_back(c in uniform6(-2.0..2.0_f64), t in 0.0..3.0_f64, gap in 0.1..2.0_f64) {
            for (interpolation, degree) in Interpolation::ALL.into_iter().zip([1, 3, 5]) {
                let derived = |order: usize, t: f64| -> f64 {
                    let factor = |power: usize| (0..order).map(|k| (power - k) as f64).product::<f64>();
                    (order..=degree).map(|power| c[power] * factor(power) * t.powf((power - order) as f64)).sum()
                };
                let times = [t, t + gap];
                let at = |order: usize| times.map(|t| derived(order, t)).to_vec();
                let knots =
                    Knots { velocities: at(1), accelerations: at(2), ..Knots::through(&times, at(0)) };
                for (order, segment) in knots.segments(interpolation, 0).iter().enumerate() {
                    for s in [0.0, 0.3, 1.0] {
                        let (found, wanted) = (segment.value(s), derived(order, segment.time(s)));
                        let scale = (0..=5).map(|k| derived(k, t + gap).abs()).sum::<f64>().max(1.0);
                        prop_assert!(
                            (found - wanted).abs() < 1e-8 * scale / gap.powi(3),
                            "{interpolation:?} {order}: {found} {wanted}"
                        );
                    }
                }
            }
        }
    }
}
