//! The samples of all arms on one clock.

use nalgebra::Vector6;

use super::About;
use crate::planner::{ArmPlan, Plan};

/// What the joints of one arm do.
#[derive(Clone, Debug, PartialEq)]
pub struct ArmTrajectory {
    /// The arm's name.
    pub name: String,
    /// Its joints, in the order of the entries of a sample.
    pub joints: Vec<String>,
    /// Joint positions [rad or m], sample after sample.
    pub positions: Vec<f64>,
    /// Joint velocities [rad/s or m/s], sample after sample: of a plan the feedforward `J^+ phi'`. Empty where unknown.
    pub velocities: Vec<f64>,
    /// The norm of the task error of every sample (m and rad together). Empty where unknown.
    pub errors: Vec<f64>,
}

impl ArmTrajectory {
    /// The joint positions [rad or m] of sample `n`.
    ///
    /// # Panics
    /// If there is no sample `n`.
    pub fn position(&self, n: usize) -> &[f64] {
        let joints = self.joints.len();
        &self.positions[n * joints..(n + 1) * joints]
    }

    /// The joint velocities [rad/s or m/s] of sample `n`, where they are known.
    pub fn velocity(&self, n: usize) -> Option<&[f64]> {
        let joints = self.joints.len();
        self.velocities.get(n * joints..(n + 1) * joints).filter(|velocity| !velocity.is_empty())
    }
}

impl From<&ArmPlan> for ArmTrajectory {
    fn from(arm: &ArmPlan) -> Self {
        Self {
            name: arm.name.clone(),
            joints: arm.joints.clone(),
            positions: arm.positions.clone(),
            velocities: arm.velocities.clone(),
            errors: arm.errors.iter().map(Vector6::norm).collect(),
        }
    }
}

/// Joint trajectories of all arms at common times.
#[derive(Clone, Debug, PartialEq)]
pub struct Trajectory {
    /// What made it, where that is known.
    pub about: Option<About>,
    /// The times of the samples \[s\].
    pub times: Vec<f64>,
    /// What each arm does; every arm has all samples.
    pub arms: Vec<ArmTrajectory>,
}

impl Trajectory {
    /// Returns the trajectory of a plan.
    pub fn of(plan: &Plan, about: Option<About>) -> Self {
        Self {
            about,
            times: (0..plan.samples()).map(|n| plan.time(n)).collect(),
            arms: plan.arms.iter().map(ArmTrajectory::from).collect(),
        }
    }

    /// Number of samples.
    pub fn samples(&self) -> usize {
        self.times.len()
    }
}
