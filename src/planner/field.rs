use super::Arm;
use crate::integrate::{Field, Parts};
use crate::law::{Demand, Resolution};
use crate::robot::ChainScratch;
use nalgebra::Vector6;

/// An arm with its scratch memory and what the last evaluation found.
pub(super) struct ArmRuntime {
    pub(super) arm: Arm,
    scratch: ChainScratch,
    columns: Vec<Vector6<f64>>,
    pub(super) error: Vector6<f64>,
    pub(super) resolution: Resolution,
}

impl ArmRuntime {
    pub(super) fn new(mut arm: Arm) -> Self {
        let joints = arm.chain.dof();
        let reach = arm.chain.reach();
        arm.law.prepare(arm.task.rows(), joints, if reach.is_finite() { reach } else { 1.0 });
        Self {
            scratch: arm.chain.scratch(),
            columns: vec![Vector6::zeros(); joints],
            error: Vector6::zeros(),
            resolution: Resolution { smallest_singular_value: f64::INFINITY, damped: false },
            arm,
        }
    }

    /// Forward kinematics, task error and both parts of the joint velocity at time `t`.
    fn evaluate(&mut self, t: f64, gain: f64, q: &[f64], f: &mut [f64], g: &mut [f64]) {
        let posed = self.arm.chain.forward(q, &mut self.scratch);
        posed.geometric_jacobian(&mut self.columns);
        let reference = self.arm.motion.at(t);
        self.error = self.arm.task.error(&posed.pose(), &reference);
        let demand = Demand {
            rows: self.arm.task.rows(),
            jacobian: &self.columns,
            q,
            feedforward: &reference.twist,
            feedback: &(self.error * -gain),
        };
        self.resolution = self.arm.law.resolve(&demand, f, g);
    }
}

/// The right-hand side of all arms together: `f = J^+ phi'` (and the null-space part), `g = -k J^+ e`, block by block.
pub(super) struct SynchronousField {
    pub(super) arms: Vec<ArmRuntime>,
    pub(super) gain: f64,
    pub(super) dimension: usize,
}

impl Field<f64> for SynchronousField {
    fn dimension(&self) -> usize {
        self.dimension
    }

    fn parts(&self) -> Parts {
        Parts::Feedback
    }

    fn evaluate(&mut self, t: f64, x: &[f64], f: &mut [f64], g: &mut [f64]) {
        let mut from = 0;
        for runtime in &mut self.arms {
            let to = from + runtime.arm.chain.dof();
            runtime.evaluate(t, self.gain, &x[from..to], &mut f[from..to], &mut g[from..to]);
            from = to;
        }
    }
}
