//! The samples of all arms on one clock.

use std::borrow::Cow;

use nalgebra::Vector6;

use super::About;
use super::quantity::Quantity;
use kinstep::planner::{Arm, ArmPlan, Plan};

/// What the joints of one arm do.
#[derive(Clone, Debug, PartialEq)]
pub struct ArmTrajectory {
    /// The arm's name.
    pub name: String,
    /// Its joints, in the order of the entries of a sample.
    pub joints: Vec<String>,
    /// Joint positions [rad or m], sample after sample.
    pub positions: Vec<f64>,
    /// Joint velocities [rad/s or m/s], sample after sample: of a plan the feedforward `J^+ phi'`,
    /// and the slope of the positions while an arm converges to its path. Empty where unknown.
    pub velocities: Vec<f64>,
    /// Joint accelerations [rad/s^2 or m/s^2], sample after sample. Empty where unknown, as of a plan.
    pub accelerations: Vec<f64>,
    /// The norm of the task error of every sample (m and rad together). Empty where unknown.
    pub errors: Vec<f64>,
}

impl ArmTrajectory {
    /// An arm without joints and samples.
    pub(super) fn empty(name: &str) -> Self {
        Self {
            name: name.to_owned(),
            joints: Vec::new(),
            positions: Vec::new(),
            velocities: Vec::new(),
            accelerations: Vec::new(),
            errors: Vec::new(),
        }
    }

    /// The joint positions [rad or m] of sample `n`.
    ///
    /// # Panics
    /// If there is no sample `n`.
    pub fn position(&self, n: usize) -> &[f64] {
        let joints = self.joints.len();
        &self.positions[n * joints..(n + 1) * joints]
    }

    /// Returns the same with those of its joints that are named, in the order of the names.
    #[must_use]
    pub fn with_joints(&self, joints: &[&str]) -> Cow<'_, Self> {
        let place = |name: &&str| self.joints.iter().position(|own| own == name);
        let places: Vec<usize> = joints.iter().filter_map(place).collect();
        if places.iter().copied().eq(0..self.joints.len()) {
            return Cow::Borrowed(self);
        }
        let taken = |values: &[f64]| -> Vec<f64> {
            let rows = values.chunks_exact(self.joints.len().max(1));
            rows.flat_map(|row| places.iter().map(|&place| row[place])).collect()
        };
        Cow::Owned(Self {
            name: self.name.clone(),
            joints: places.iter().map(|&place| self.joints[place].clone()).collect(),
            positions: taken(&self.positions),
            velocities: taken(&self.velocities),
            accelerations: taken(&self.accelerations),
            errors: self.errors.clone(),
        })
    }

    /// The joint velocities [rad/s or m/s] of sample `n`, where they are known.
    pub fn velocity(&self, n: usize) -> Option<&[f64]> {
        let joints = self.joints.len();
        self.velocities.get(n * joints..(n + 1) * joints).filter(|velocity| !velocity.is_empty())
    }

    /// The joint accelerations [rad/s^2 or m/s^2] of sample `n`, where they are known.
    pub fn acceleration(&self, n: usize) -> Option<&[f64]> {
        let joints = self.joints.len();
        self.accelerations.get(n * joints..(n + 1) * joints).filter(|acceleration| !acceleration.is_empty())
    }

    /// What is known of all joints: sample after sample, with the quantity that it is of.
    pub(super) fn known(&self) -> impl Iterator<Item = (Quantity, &[f64])> {
        let all = Quantity::ALL.into_iter().map(|quantity| (quantity, self.of(quantity)));
        all.filter(|(quantity, values)| *quantity == Quantity::Position || !values.is_empty())
    }

    pub(super) fn of(&self, quantity: Quantity) -> &[f64] {
        match quantity {
            Quantity::Position => &self.positions,
            Quantity::Velocity => &self.velocities,
            Quantity::Acceleration => &self.accelerations,
        }
    }

    pub(super) fn of_mut(&mut self, quantity: Quantity) -> &mut Vec<f64> {
        match quantity {
            Quantity::Position => &mut self.positions,
            Quantity::Velocity => &mut self.velocities,
            Quantity::Acceleration => &mut self.accelerations,
        }
    }

    /// The [task errors](Arm::task_error) (linear \[m\]; angular \[rad\]) of the samples, at `times` \[s\], of an arm with the
    /// same joints.
    ///
    /// # Panics
    /// If there are fewer samples than times, or another number of joints.
    pub fn task_errors(&self, arm: &Arm, times: &[f64]) -> Vec<Vector6<f64>> {
        let mut scratch = arm.chain().scratch();
        let at = |(n, t): (usize, &f64)| arm.task_error(*t, self.position(n), &mut scratch);
        times.iter().enumerate().map(at).collect()
    }
}

impl From<&ArmPlan> for ArmTrajectory {
    fn from(arm: &ArmPlan) -> Self {
        Self {
            name: arm.name.clone(),
            joints: arm.joints.clone(),
            positions: arm.positions.clone(),
            velocities: arm.velocities.clone(),
            accelerations: Vec::new(),
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

    /// The names of the columns of a table of the samples: `t`, then of each arm `ARM.JOINT` joint by joint,
    /// `ARM.JOINT.velocity`, `ARM.JOINT.acceleration`, and `ARM.error`; what is not known has no columns.
    pub fn columns(&self) -> Vec<String> {
        let mut names = vec!["t".to_owned()];
        for arm in &self.arms {
            for (quantity, _) in arm.known() {
                let suffix = quantity.suffix();
                names.extend(arm.joints.iter().map(|joint| format!("{}.{joint}{suffix}", arm.name)));
            }
            if !arm.errors.is_empty() {
                names.push(format!("{}.error", arm.name));
            }
        }
        names
    }

    /// The entries of sample `n` in the order of [`Trajectory::columns`], without the time.
    ///
    /// # Panics
    /// If there is no sample `n`.
    pub fn values(&self, n: usize) -> impl Iterator<Item = f64> + '_ {
        self.arms.iter().flat_map(move |arm| {
            let velocities = arm.velocity(n).unwrap_or_default();
            let accelerations = arm.acceleration(n).unwrap_or_default();
            let joints = arm.position(n).iter().chain(velocities).chain(accelerations);
            joints.chain(arm.errors.get(n)).copied()
        })
    }
}
