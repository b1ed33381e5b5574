use super::arm::{Arm, pose};
use super::arm_state::ArmState;
use super::bounds::{Bounds, Deviation, StopCriteria};
use super::disturbance::Disturbance;
use super::monitor::Monitor;
use crate::law::Resolution;
use crate::robot::ChainScratch;
use crate::task::Tip;
use nalgebra::Vector6;

/// Why arms are resolved together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in crate::planner) enum Coupling {
    /// They are not.
    None,
    /// They share joints.
    Joints,
    /// They were tied, by a task for instance.
    Tasks,
}

/// An arm with its scratch memory and what is known of it at the present sample.
pub(in crate::planner) struct ArmRuntime {
    pub(in crate::planner) arm: Arm,
    scratch: ChainScratch,
    /// Joint positions [rad or m].
    pub(in crate::planner) positions: Vec<f64>,
    /// Feedforward joint velocities [rad/s or m/s].
    pub(in crate::planner) velocities: Vec<f64>,
    /// The true task error.
    pub(in crate::planner) error: Vector6<f64>,
    pub(in crate::planner) resolution: Resolution,
    /// What the loop sees in place of the truth; nothing but the truth without noise.
    pub(in crate::planner) disturbance: Option<Disturbance>,
    /// Why other arms are resolved together with it.
    pub(in crate::planner) coupling: Coupling,
    /// The task error at which it is lost.
    pub(in crate::planner) bounds: Bounds,
    /// The singular value below which its law calls a configuration singular.
    pub(in crate::planner) threshold: f64,
    /// Whether it has met a singularity that it has not recovered from, one sample ago.
    pub(in crate::planner) was_singular: bool,
    pub(in crate::planner) monitor: Monitor,
}

impl ArmRuntime {
    pub(in crate::planner) fn new(arm: Arm, sigma: f64) -> Self {
        let joints = arm.chain.dof();
        Self {
            scratch: arm.chain.scratch(),
            positions: arm.q0.clone(),
            velocities: vec![0.0; joints],
            error: Vector6::zeros(),
            resolution: Resolution::default(),
            disturbance: None,
            coupling: Coupling::None,
            bounds: Bounds { length: arm.length(), has_too_few_joints: joints < arm.task.rows() },
            threshold: 0.0,
            was_singular: true,
            monitor: Monitor::new(&arm.chain, &arm.q0, sigma),
            arm,
        }
    }

    /// Forward kinematics and Jacobian at the positions it has.
    pub(in crate::planner) fn pose(&mut self, tip: &mut Tip) {
        pose(tip, self.arm.chain.forward(&self.positions, &mut self.scratch));
    }

    /// What tells that a sample of it needs no closer look.
    pub(in crate::planner) fn stop_criteria(&self) -> StopCriteria {
        StopCriteria::new(&self.bounds, self.threshold)
    }

    /// Whether the task error lies within this fraction of the bounds at which a run is stopped; false for NaN.
    pub(in crate::planner) fn is_within(&self, fraction: f64) -> bool {
        Deviation::of(&self.error).is_within(&self.bounds.largest(fraction))
    }

    /// Whether the smallest singular value lies below the law's threshold.
    pub(in crate::planner) fn is_singular(&self) -> bool {
        self.resolution.smallest_singular_value < self.threshold
    }

    /// Takes down errors, limits and conditioning of the present sample.
    pub(in crate::planner) fn observe(&mut self, t: f64) {
        self.monitor.observe_error(&self.error);
        self.monitor.observe_joints(t, &self.positions, &self.velocities);
        self.monitor.observe_conditioning(&self.resolution, t);
    }

    /// The arm at the sample that was evaluated last.
    pub(in crate::planner) fn state(&self) -> ArmState<'_> {
        ArmState {
            positions: &self.positions,
            velocities: &self.velocities,
            error: self.error,
            damped: self.resolution.damped,
        }
    }
}
