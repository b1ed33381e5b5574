//! White noise in what a loop measures and in what it is told.

use super::field::SynchronousField;
use crate::integrate::Multistep;
use crate::math::{mix, normal};
use crate::planner::PlannerError;
use crate::planner::system::Disturbance;
use nalgebra::Vector6;

/// White noise, normally distributed, drawn anew at every sample from the second on. Every number is the standard deviation
/// of one component; the draws depend on the seed alone.
///
/// The three inputs are those of [`NoiseGain`](crate::formula::NoiseGain), which says how much of each a formula lets
/// through to the task error. The error that a plan states is the true one, of the positions sent to the robot.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Noise {
    /// What the draws depend on.
    pub seed: u64,
    /// Of the measured position error \[m\].
    pub position: f64,
    /// Of the measured orientation error \[rad\].
    pub orientation: f64,
    /// Of the linear velocity of the reference, as it is streamed to the loop \[m/s\].
    pub linear_velocity: f64,
    /// Of its angular velocity \[rad/s\].
    pub angular_velocity: f64,
    /// Of the measured joint positions, of which the formula makes the next ones [rad or m].
    pub joints: f64,
}

impl Noise {
    /// The standard deviations by name, with what they are of and their unit.
    pub fn deviations(&self) -> [(&'static str, &'static str, &'static str, f64); 5] {
        [
            ("position", "the measured position", "m", self.position),
            ("orientation", "the measured orientation", "rad", self.orientation),
            ("linear_velocity", "the linear velocity of the reference", "m/s", self.linear_velocity),
            ("angular_velocity", "the angular velocity of the reference", "rad/s", self.angular_velocity),
            ("joints", "the measured joint positions", "rad or m", self.joints),
        ]
    }

    /// Whether there is none.
    pub fn is_silent(&self) -> bool {
        self.deviations().iter().all(|deviation| deviation.3 == 0.0)
    }

    /// Refuses what is no standard deviation.
    pub(in crate::planner) fn check(&self) -> Result<(), PlannerError> {
        let is_wrong = |value: f64| !(value >= 0.0 && value.is_finite());
        let mut wrong = self.deviations().into_iter().filter(|deviation| is_wrong(deviation.3));
        wrong.next().map_or(Ok(()), |(what, _, _, value)| Err(PlannerError::Noise { what, value }))
    }
}

/// The noise of a run, and what the robot was sent.
#[derive(Debug)]
pub(in crate::planner) struct NoisyLoop {
    noise: Noise,
    commanded: Vec<f64>,
}

impl NoisyLoop {
    pub(in crate::planner) fn new(noise: Noise, initial: Vec<f64>) -> Self {
        Self { noise, commanded: initial }
    }

    pub(in crate::planner) fn noise(&self) -> &Noise {
        &self.noise
    }

    /// Evaluates the present sample as it is measured; the task errors found are the true ones.
    pub(in crate::planner) fn evaluate(
        &mut self,
        stepper: &mut Multistep<f64>,
        field: &mut SynchronousField,
    ) {
        let draws = Draws::of(&self.noise, stepper.index());
        for (arm, runtime) in field.arms.iter_mut().enumerate() {
            runtime.disturbance = Some(draws.disturbance(arm));
        }
        self.commanded.copy_from_slice(stepper.state());
        if self.noise.joints == 0.0 {
            field.evaluate_sample(stepper);
            return;
        }
        let joints = stepper.state_mut().iter_mut().zip(field.joints()).filter(|(_, joint)| joint.is_some());
        for (joint, (position, _)) in joints.enumerate() {
            *position += draws.joint(joint);
        }
        field.evaluate_sample(stepper);
        self.look(stepper, field);
    }

    /// Brings the arms, evaluated as they are measured, to where they were sent.
    pub(in crate::planner) fn look(&self, stepper: &Multistep<f64>, field: &mut SynchronousField) {
        field.look(stepper.time(), &self.commanded);
    }
}

/// The draws of one sample.
struct Draws<'a> {
    noise: &'a Noise,
    sample: u64,
}

impl<'a> Draws<'a> {
    fn of(noise: &'a Noise, sample: usize) -> Self {
        Self { noise, sample: mix(mix(noise.seed).wrapping_add(sample as u64)) }
    }

    fn draw(&self, deviation: f64, number: usize) -> f64 {
        if deviation == 0.0 { 0.0 } else { deviation * normal(mix(self.sample.wrapping_add(number as u64))) }
    }

    /// Even numbers are the joints', odd ones the arms'.
    fn joint(&self, joint: usize) -> f64 {
        self.draw(self.noise.joints, 2 * joint)
    }

    fn disturbance(&self, arm: usize) -> Disturbance {
        let number = |component: usize| 2 * (12 * arm + component) + 1;
        let twist = |linear: f64, angular: f64, first: usize| {
            Vector6::from_fn(|i, _| self.draw(if i < 3 { linear } else { angular }, number(first + i)))
        };
        Disturbance {
            error: twist(self.noise.position, self.noise.orientation, 0),
            twist: twist(self.noise.linear_velocity, self.noise.angular_velocity, 6),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn draws_are_white_and_those_of_different_places_have_nothing_in_common() {
        let noise = Noise { seed: 7, position: 2.0, linear_velocity: 1.0, joints: 0.5, ..Noise::default() };
        let samples = 20_000;
        let rows: Vec<[f64; 5]> = (1..=samples)
            .map(|n| {
                let draws = Draws::of(&noise, n);
                let (one, other) = (draws.disturbance(0), draws.disturbance(1));
                [one.error.x / 2.0, one.error.y / 2.0, one.twist.x, other.error.x / 2.0, draws.joint(0) / 0.5]
            })
            .collect();
        let mean = |of: &dyn Fn(usize) -> f64| (0..samples - 1).map(of).sum::<f64>() / samples as f64;
        // Five standard deviations of a mean.
        let tolerance = 5.0 / (samples as f64).sqrt();
        for i in 0..5 {
            assert!(mean(&|n| rows[n][i]).abs() < tolerance);
            assert!(mean(&|n| rows[n][i] * rows[n + 1][i]).abs() < tolerance, "{i} is not white");
            for j in 0..5 {
                let expected = if i == j { 1.0 } else { 0.0 };
                assert!((mean(&|n| rows[n][i] * rows[n][j]) - expected).abs() < 1.5 * tolerance, "{i} {j}");
            }
        }
        let silent = Draws::of(&noise, 1).disturbance(0);
        assert_eq!(silent.error.fixed_rows::<3>(3).norm() + silent.twist.fixed_rows::<3>(3).norm(), 0.0);
    }
}
