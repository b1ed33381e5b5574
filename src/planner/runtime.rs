use super::Arm;
use super::lost::Bounds;
use super::monitor::Monitor;
use super::noise::Disturbance;
use crate::law::{Demand, Resolution};
use crate::robot::ChainScratch;
use nalgebra::Vector6;

/// An arm with its scratch memory and what is known of it at the present sample.
pub(super) struct ArmRuntime {
    pub(super) arm: Arm,
    scratch: ChainScratch,
    pub(super) columns: Vec<Vector6<f64>>,
    /// Joint positions [rad or m].
    pub(super) positions: Vec<f64>,
    /// Feedforward joint velocities [rad/s or m/s].
    pub(super) velocities: Vec<f64>,
    /// Feedback joint velocities [rad/s or m/s].
    pub(super) feedback: Vec<f64>,
    pub(super) error: Vector6<f64>,
    pub(super) resolution: Resolution,
    /// What the loop sees in place of the truth; nothing but the truth without noise.
    pub(super) disturbance: Option<Disturbance>,
    /// Whether it shares joints with other arms.
    pub(super) is_shared: bool,
    /// The task error at which it is lost.
    pub(super) bounds: Bounds,
    /// Whether it has met a singularity that it has not recovered from, one sample ago.
    pub(super) was_singular: bool,
    pub(super) monitor: Monitor,
}

impl ArmRuntime {
    pub(super) fn new(mut arm: Arm, sigma: f64) -> Self {
        let (joints, rows) = (arm.chain.dof(), arm.task.rows());
        let reach = arm.chain.reach();
        // The chain's reach, or a metre where that is infinite.
        let length = if reach.is_finite() { reach } else { 1.0 };
        arm.law.prepare(rows, joints, length);
        Self {
            scratch: arm.chain.scratch(),
            columns: vec![Vector6::zeros(); joints],
            positions: arm.q0.clone(),
            velocities: vec![0.0; joints],
            feedback: vec![0.0; joints],
            error: Vector6::zeros(),
            resolution: Resolution { smallest_singular_value: f64::INFINITY, damped: false },
            disturbance: None,
            is_shared: false,
            bounds: Bounds { length, has_too_few_joints: joints < rows },
            was_singular: true,
            monitor: Monitor::new(&arm.chain, sigma),
            arm,
        }
    }

    /// Forward kinematics, task error and both parts of the joint velocity at the positions it has, at time `t`.
    pub(super) fn evaluate(&mut self, t: f64, gain: f64) {
        let twist = self.look(t);
        let (twist, error) = self.measured(twist);
        let demand = Demand {
            rows: self.arm.task.rows(),
            jacobian: &self.columns,
            q: &self.positions,
            feedforward: &twist,
            feedback: &(error * -gain),
        };
        self.resolution = self.arm.law.resolve(&demand, &mut self.velocities, &mut self.feedback);
    }

    /// The twist of the reference and the task error as the loop sees them.
    pub(super) fn measured(&self, twist: Vector6<f64>) -> (Vector6<f64>, Vector6<f64>) {
        match &self.disturbance {
            None => (twist, self.error),
            Some(noise) => (twist + noise.twist, self.error + noise.error),
        }
    }

    /// Forward kinematics, Jacobian and task error at the positions it has; returns the twist of the reference at time `t`.
    pub(super) fn look(&mut self, t: f64) -> Vector6<f64> {
        let posed = self.arm.chain.forward(&self.positions, &mut self.scratch);
        posed.geometric_jacobian(&mut self.columns);
        let reference = self.arm.motion.at(t);
        self.error = self.arm.task.error(&posed.pose(), &reference);
        reference.twist
    }

    /// Takes down errors, limits and conditioning of the present sample.
    pub(super) fn watch(&mut self, t: f64) {
        self.monitor.observe_error(&self.error);
        self.monitor.observe_joints(t, &self.positions, &self.velocities);
        self.monitor.observe_conditioning(&self.resolution, t);
    }
}
