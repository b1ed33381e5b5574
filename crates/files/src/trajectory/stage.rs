//! The robots of a plan, as they stand and move.

use std::path::PathBuf;

use nalgebra::IsometryMatrix3;

use super::about::fingerprint;
use kinstep::robot::{Chain, Robot};
use kinstep::task::TaskKind;

/// A robot that one arm or several arms of the plan are parts of.
#[derive(Clone, Debug)]
pub struct Machine {
    /// The name of the first of its arms.
    pub name: String,
    /// The robot, calibrated, with its locked joints held and its tools put on.
    pub robot: Robot,
    /// The URDF that it was read from, if it was: it may say what the links look like.
    pub urdf: Option<String>,
    /// Where that file is, if it is one: meshes are named relative to it.
    pub folder: Option<PathBuf>,
    /// The pose of the robot's root in the world.
    pub world_from_root: IsometryMatrix3<f64>,
    /// The positions of its joints [rad or m] at rest, in the order of [`Robot::joints`]: zero, or the nearest that the
    /// limits allow.
    pub rest: Vec<f64>,
}

impl Machine {
    /// Returns a robot whose link `base` stands at `world_from_base` while the joints are at rest.
    pub fn new(
        name: impl Into<String>,
        robot: Robot,
        base: &str,
        world_from_base: &IsometryMatrix3<f64>,
    ) -> Self {
        let rest: Vec<f64> = robot
            .joints()
            .iter()
            .map(|joint| 0.0_f64.min(joint.limits.upper).max(joint.limits.lower))
            .map(|position| if position.is_finite() { position } else { 0.0 })
            .collect();
        let base = robot.links().iter().position(|link| link.name == base);
        let root_from_base = base.map_or_else(IsometryMatrix3::identity, |b| robot.link_poses(&rest)[b]);
        let world_from_root = world_from_base * root_from_base.inverse();
        Self { name: name.into(), robot, urdf: None, folder: None, world_from_root, rest }
    }

    /// Returns the poses of all links in the world, in the order of [`Robot::links`], with the joints at `positions`, in
    /// the order of [`Robot::joints`].
    pub fn link_poses(&self, positions: &[f64]) -> Vec<IsometryMatrix3<f64>> {
        let poses = self.robot.link_poses(positions);
        poses.into_iter().map(|pose| self.world_from_root * pose).collect()
    }

    /// Returns the SHA-256 of the robot, written as URDF, in hexadecimal digits.
    pub fn fingerprint(&self) -> String {
        // What can not be written as URDF is told apart by its name at least.
        fingerprint(&self.robot.to_urdf().unwrap_or_else(|_| self.robot.name().to_owned()))
    }
}

/// One arm of the plan: a chain of a machine.
#[derive(Clone, Debug)]
pub struct StagedArm {
    /// The arm's name.
    pub name: String,
    /// Its machine, an index into [`Stage::machines`].
    pub machine: usize,
    /// The chain, mounted in the world.
    pub chain: Chain,
    /// What of the tip follows the path: the plain task that its own is a part of.
    pub task: TaskKind,
    /// The place in [`Robot::joints`] of every joint of the chain.
    joints: Vec<usize>,
}

impl StagedArm {
    /// Returns an arm of that machine; `None` where its chain moves a joint that the machine does not have.
    pub fn new(
        name: impl Into<String>,
        (machine, robot): (usize, &Robot),
        chain: Chain,
        task: TaskKind,
    ) -> Option<Self> {
        let place = |name: &str| robot.joints().iter().position(|joint| joint.name == name);
        let joints = chain.joints().iter().map(|joint| place(&joint.name)).collect::<Option<_>>()?;
        Some(Self { name: name.into(), machine, chain, task, joints })
    }

    /// Whether these are the joints of its chain, in their order.
    pub fn moves(&self, joints: &[String]) -> bool {
        self.chain.joints().iter().map(|joint| &joint.name).eq(joints)
    }
}

/// The robots of a plan, and which of their chains its arms are.
#[derive(Clone, Debug, Default)]
pub struct Stage {
    /// The robots.
    pub machines: Vec<Machine>,
    /// The arms, in the order of the plan.
    pub arms: Vec<StagedArm>,
}

impl Stage {
    /// Returns the positions of all joints of a machine, in the order of [`Robot::joints`], where each arm has its joints at
    /// what `positions` says of it (by its index in [`Stage::arms`]); other joints rest.
    ///
    /// # Panics
    /// If there is no such machine.
    pub fn machine_positions<'q>(&self, machine: usize, positions: impl Fn(usize) -> &'q [f64]) -> Vec<f64> {
        let mut all = self.machines[machine].rest.clone();
        for (index, arm) in self.arms.iter().enumerate().filter(|(_, arm)| arm.machine == machine) {
            for (&joint, &position) in arm.joints.iter().zip(positions(index)) {
                all[joint] = position;
            }
        }
        all
    }

    /// Returns the arm of that name.
    pub fn arm(&self, name: &str) -> Option<&StagedArm> {
        self.arms.iter().find(|arm| arm.name == name)
    }
}

#[cfg(test)]
pub(crate) mod tests {
    use super::*;
    use kinstep::robot::embedded;
    use nalgebra::{Matrix4, Vector3};

    /// Asserts, for a stage of one machine, that the links at the arms' tips are where their chains say, with joint `i` of
    /// every chain at `position(i)`.
    pub(crate) fn assert_tips_stand_where_the_chains_have_them(
        stage: &Stage,
        position: impl Fn(usize) -> f64,
    ) {
        let positions = |arm: &StagedArm| -> Vec<f64> { (0..arm.chain.dof()).map(&position).collect() };
        let q: Vec<Vec<f64>> = stage.arms.iter().map(positions).collect();
        let machine = &stage.machines[0];
        let poses = machine.link_poses(&stage.machine_positions(0, |arm| &q[arm]));
        for (arm, q) in stage.arms.iter().zip(&q) {
            let link = machine.robot.links().iter().position(|link| link.name == arm.chain.tip()).unwrap();
            let tip = arm.chain.forward(q, &mut arm.chain.scratch()).pose();
            let apart = poses[link].inverse() * tip;
            assert!((apart.to_matrix() - Matrix4::identity()).norm() < 1e-12);
        }
    }

    #[test]
    fn links_of_a_stage_stand_where_the_chains_have_their_tips() {
        let robot = embedded::get("baxter").unwrap();
        let mount = IsometryMatrix3::new(Vector3::new(1.0, -2.0, 0.5), Vector3::new(0.1, 0.2, 0.3));
        let machine = Machine::new("left", robot, "left_arm_mount", &mount);
        let tips = ["left_gripper", "right_gripper"];
        let arms: Vec<StagedArm> = tips
            .iter()
            .map(|tip| {
                let chain = machine.robot.chain("left_arm_mount", tip).unwrap().mounted(&mount);
                StagedArm::new(*tip, (0, &machine.robot), chain, TaskKind::Pose).unwrap()
            })
            .collect();
        let stage = Stage { machines: vec![machine], arms };
        assert_tips_stand_where_the_chains_have_them(&stage, |i| 0.3 - 0.1 * i as f64);
    }
}
