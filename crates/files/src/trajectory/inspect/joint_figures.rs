//! What one joint does along a trajectory.

use rayon::prelude::*;

use super::continuity::{Disagreement, Jump, disagreements, jumps};
use super::crossing::{Beyond, Crossing};
use super::interpolant::{Interpolation, Knots};
use super::met::{Met, largest};
use super::resolution::{encoder, precision};
use super::rest::{Rest, rests};
use super::segment::Segment;
use crate::trajectory::ArmTrajectory;
use kinstep::planner::LimitKind;
use kinstep::robot::Limits;

/// How many times the rounding of the positions a derivative can carry, from the position itself to the jerk.
const ROUNDING: [f64; 4] = [1.0, 2.0, 12.0, 60.0];
/// How many times the step in which positions are rounded their differences can carry, of every order.
const ROUNDED: [f64; 4] = [0.5, 1.0, 2.0, 4.0];
/// What times may be rounded to \[s\]: messages count nanoseconds.
const TIME_ROUNDING: f64 = 2e-9;

/// What one joint does between all samples, by an [`Interpolation`].
#[derive(Clone, Debug, PartialEq)]
pub struct JointFigures {
    /// The joint.
    pub joint: String,
    /// Smallest and largest position [rad or m], between samples too.
    pub positions: [Met; 2],
    /// The fastest declared velocity [rad/s or m/s], where velocities are declared.
    pub declared_velocity: Option<Met>,
    /// The fastest velocity [rad/s or m/s], between samples too.
    pub velocity: Met,
    /// The fastest mean velocity [rad/s or m/s] between two samples.
    pub mean_velocity: Met,
    /// The largest acceleration [rad/s^2 or m/s^2]. Straight lines have none: then the least that any smooth motion through
    /// the samples needs somewhere, twice the second divided difference.
    pub acceleration: Met,
    /// The largest jerk [rad/s^3 or m/s^3] between samples. Of straight lines six times the third divided difference.
    pub jerk: Met,
    /// Steps that no arm can take.
    pub jumps: Vec<Jump>,
    /// Declared velocities that are not those of the positions, and accelerations that are not those of the velocities; `None`
    /// where that can not be told: none are declared, or the samples are more than 0.05 s apart.
    pub disagreements: Option<Vec<Disagreement>>,
    /// Whether the joint rests at the start, and at the end.
    pub rests: [Rest; 2],
    /// Limits crossed.
    pub crossings: Vec<Crossing>,
    /// Limits of which the interpolation can not decide whether they are crossed.
    pub undecided: Vec<LimitKind>,
}

impl JointFigures {
    /// The worst disagreement of declared velocities, or of declared accelerations.
    pub fn worst_disagreement(&self, kind: LimitKind) -> Option<&Disagreement> {
        self.disagreements.iter().flatten().find(|found| found.kind == kind)
    }
}

impl ArmTrajectory {
    /// Returns what every joint does at and between these times \[s\], two at least, held against `limits` in the order of the
    /// joints. Extremes are those of the interpolant's polynomials, not of samples.
    ///
    /// # Panics
    /// If there are fewer limits than joints, fewer samples than times, or an interpolation by what is not declared.
    pub fn inspect(
        &self,
        times: &[f64],
        limits: &[Limits],
        interpolation: Interpolation,
    ) -> Vec<JointFigures> {
        let joints = || (0..self.joints.len()).into_par_iter();
        let knots = |joint: usize| Knots::of(self, joint, times);
        // A joint that hardly moves does not show the step of its encoder; those beside it do.
        let steps: Vec<f64> = joints().map(|joint| encoder(&knots(joint).positions)).collect();
        let step = steps.into_iter().fold(0.0, f64::max);
        let figures = |joint: usize| {
            let knots = knots(joint).known_to(step);
            Inspection::of(&knots, interpolation, &limits[joint]).figures(&self.joints[joint])
        };
        joints().map(figures).collect()
    }
}

/// What is gathered while a joint's steps are gone through.
struct Inspection<'k> {
    knots: &'k Knots<'k>,
    interpolation: Interpolation,
    positions: [Met; 2],
    /// Velocity, acceleration and jerk.
    largest: [Met; 3],
    /// Limits from below and from above, of the position and its derivatives.
    beyond: [[Beyond; 2]; 4],
    /// What single or double precision makes of the positions.
    precision: f64,
}

impl<'k> Inspection<'k> {
    fn of(knots: &'k Knots<'k>, interpolation: Interpolation, limits: &Limits) -> Self {
        let first = Met { value: knots.positions[0], t: knots.times[0] };
        let either = |kind: LimitKind, size: f64| Beyond::both(kind, [-size, size]);
        let beyond = [
            Beyond::both(LimitKind::Position, [limits.lower, limits.upper]),
            either(LimitKind::Velocity, limits.velocity),
            either(LimitKind::Acceleration, limits.acceleration),
            either(LimitKind::Jerk, limits.jerk),
        ];
        let mut inspection = Self {
            knots,
            interpolation,
            positions: [first; 2],
            largest: [Met { value: 0.0, t: knots.times[0] }; 3],
            beyond,
            precision: precision(&knots.positions),
        };
        for n in 0..knots.steps() {
            inspection.take(n);
        }
        if interpolation == Interpolation::Linear {
            inspection.take_differences();
        }
        inspection
    }

    fn take(&mut self, n: usize) {
        let segments = self.knots.segments(self.interpolation, n);
        let slacks = self.slacks(n);
        for (order, segment) in segments.iter().enumerate().take(self.decided() + 1) {
            // Declared values stand at the ends as they are.
            let bounds = segment.bounds();
            let ends = match order {
                0 => self.precision,
                order if order <= self.declared() => 0.0,
                order => slacks[order],
            };
            self.beyond[order]
                .iter_mut()
                .for_each(|beyond| beyond.take(segment, bounds, [ends, slacks[order]]));
            match order.checked_sub(1) {
                None => extend(&mut self.positions, segment, bounds),
                Some(rate) => self.largest[rate].take(segment, bounds),
            }
        }
    }

    /// The highest derivative that samples declare.
    fn declared(&self) -> usize {
        match self.interpolation {
            Interpolation::Linear => 0,
            Interpolation::Cubic => 1,
            Interpolation::Quintic => 2,
        }
    }

    /// The highest derivative of which there is something to say between samples. That of a cubic's acceleration is but a part
    /// of its jerk, since the acceleration steps at the samples.
    fn decided(&self) -> usize {
        if self.interpolation == Interpolation::Linear { 1 } else { 3 }
    }

    /// What rounding makes of the derivatives over step `n`.
    fn slacks(&self, n: usize) -> [f64; 4] {
        let Knots { times, positions, .. } = self.knots;
        let h = self.knots.gap(n);
        let position = self.precision;
        let time = (TIME_ROUNDING + 8.0 * f64::EPSILON * times[n + 1].abs()) / h;
        let moved = position + time * (positions[n + 1] - positions[n]).abs();
        [position, ROUNDING[1] * moved / h, ROUNDING[2] * moved / (h * h), ROUNDING[3] * moved / (h * h * h)]
    }

    /// Divided differences of positions are derivatives of any smooth motion through them, somewhere between the samples.
    fn take_differences(&mut self) {
        let knots = self.knots;
        let mut values = knots.positions.clone();
        for (order, power) in (1..=3_usize).zip(1..) {
            values = knots.differences(&values, order);
            for (n, &value) in values.iter().enumerate().filter(|_| order > 1) {
                let (start, end) = (knots.times[n], knots.times[n + order]);
                let met = Met { value, t: f64::midpoint(start, end) };
                self.largest[order - 1].larger(value, met.t);
                let gap = (n..n + order).map(|n| knots.gap(n)).fold(f64::INFINITY, f64::min);
                let slack = self.slacks(n)[order] + ROUNDED[order] * knots.resolution() / gap.powi(power);
                self.beyond[order].iter_mut().for_each(|beyond| beyond.take_bound(met, start, slack));
            }
        }
    }

    fn figures(&self, joint: &str) -> JointFigures {
        let knots = self.knots;
        let at_samples = |values: &[f64]| {
            let met = values.iter().zip(knots.times).map(|(&value, &t)| Met { value, t });
            largest(met, knots.times[0])
        };
        let slopes = (0..knots.steps()).map(|n| Met { value: knots.slope(n), t: knots.times[n + 1] });
        let crossings: Vec<Crossing> =
            self.beyond.iter().flatten().filter_map(|beyond| beyond.crossing(joint)).collect();
        JointFigures {
            joint: joint.to_owned(),
            positions: self.positions,
            declared_velocity: (!knots.velocities.is_empty()).then(|| at_samples(&knots.velocities)),
            velocity: self.largest[0],
            mean_velocity: largest(slopes, knots.times[0]),
            acceleration: self.largest[1],
            jerk: self.largest[2],
            jumps: jumps(knots),
            disagreements: disagreements(knots),
            rests: rests(knots),
            undecided: self.undecided(&crossings),
            crossings,
        }
    }

    /// Limits that are known and not found to be crossed, of derivatives that step at the samples.
    fn undecided(&self, crossings: &[Crossing]) -> Vec<LimitKind> {
        let is_crossed = |kind: LimitKind| crossings.iter().any(|crossing| crossing.kind == kind);
        let stepping = self.beyond.iter().skip(self.declared() + 2);
        let limited = stepping.filter_map(|[_, above]| above.limited());
        limited.filter(|kind| !is_crossed(*kind)).collect()
    }
}

/// Widens a range by what is met over a step.
fn extend(range: &mut [Met; 2], segment: &Segment, [least, most]: [f64; 2]) {
    if least >= range[0].value && most <= range[1].value {
        return;
    }
    for s in segment.turning_points().into_iter().chain([0.0, 1.0]) {
        let met = Met { value: segment.value(s), t: segment.time(s) };
        if met.value < range[0].value {
            range[0] = met;
        }
        if met.value > range[1].value {
            range[1] = met;
        }
    }
}
