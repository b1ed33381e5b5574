//! Trajectories that are read, and the joints that may move in them.

use std::path::{Path, PathBuf};

use super::arguments::{ReadingArguments, TrajectoryRobot};
use super::failure::{Exit, Failure};
use super::formats;
use kinstep::robot::{Chain, Robot, UrdfOptions};
use kinstep_files::scenario::{RobotSource, Scenario, ScenarioText, suggestion};
use kinstep_files::trajectory::{ArmTrajectory, KnownJoint, ReadOptions, Reading, Stage, Trajectory};

/// A trajectory that was read.
pub(super) struct Loaded {
    pub(super) trajectory: Trajectory,
    /// What was recognised and assumed.
    pub(super) notes: Vec<String>,
    /// The joints that may move in it; none where that is not known.
    pub(super) joints: Vec<KnownJoint>,
}

/// Reads a trajectory in which these joints may move, or the one in a folder of results.
pub(super) fn load(
    path: &Path,
    joints: Vec<KnownJoint>,
    reading: &ReadingArguments,
) -> Result<Loaded, Failure> {
    if path.is_dir() {
        return load_own(path, joints, reading);
    }
    let options = reading.options(joints);
    let Reading { mut trajectory, notes } = formats::read(path, &options)?;
    if let Some(hint) = options.hint(&trajectory) {
        return Err(Failure::new(Exit::Robot, hint).in_file(&path.display().to_string()));
    }
    if let Some(name) = &reading.arm {
        rename(&mut trajectory, name)?;
    }
    Ok(Loaded { trajectory, notes, joints: options.joints })
}

/// Reads the trajectory in a folder of results: what there is to say of it stands there.
fn load_own(folder: &Path, joints: Vec<KnownJoint>, reading: &ReadingArguments) -> Result<Loaded, Failure> {
    if let Some(option) = reading.given() {
        let folder = folder.display();
        let message = format!("{option}: this is about files of others, and {folder} is a folder of results");
        return Err(Failure::usage(message));
    }
    let Reading { trajectory, notes } =
        formats::read(&folder.join("trajectory.csv"), &ReadOptions::default())?;
    Ok(Loaded { trajectory, notes, joints })
}

/// Calls the lone arm of a trajectory by another name.
fn rename(trajectory: &mut Trajectory, name: &str) -> Result<(), Failure> {
    let [arm] = &mut trajectory.arms[..] else {
        let names: Vec<&str> = trajectory.arms.iter().map(|arm| arm.name.as_str()).collect();
        let message = format!("--arm {name}: this names a lone arm, and here move {}", names.join(", "));
        return Err(Failure::usage(message));
    };
    name.clone_into(&mut arm.name);
    Ok(())
}

/// A scenario that was read, with its robots on their stage.
pub(super) struct Staged {
    pub(super) text: ScenarioText,
    pub(super) scenario: Scenario,
    pub(super) stage: Stage,
}

impl Staged {
    pub(super) fn read(file: &Path) -> Result<Self, Failure> {
        let text = ScenarioText::read(file)?;
        let scenario = text.scenario()?;
        let stage = scenario.stage(text.folder()).map_err(|e| text.placed(e))?;
        Ok(Self { text, scenario, stage })
    }

    /// The joints of its robots that move, those of the arms first and in their order.
    pub(super) fn joints(&self) -> Vec<KnownJoint> {
        let Stage { machines, arms } = &self.stage;
        let mut joints: Vec<KnownJoint> = Vec::new();
        for joint in machines.iter().flat_map(|machine| KnownJoint::of(&machine.robot)) {
            if joints.iter().all(|known| known.name != joint.name) {
                joints.push(joint);
            }
        }
        arms.iter().rev().for_each(|arm| chain_first(&mut joints, &arm.chain));
        joints
    }
}

/// Puts the joints of a chain first, in its order.
fn chain_first(joints: &mut [KnownJoint], chain: &Chain) {
    let place = |joint: &KnownJoint| {
        chain.joints().iter().position(|own| own.name == joint.name).unwrap_or(usize::MAX)
    };
    joints.sort_by_key(place);
}

/// The robot that the arguments name, as its file has it.
pub(super) struct NamedRobot {
    /// What it was called.
    pub(super) reference: String,
    source: RobotSource,
    pub(super) robot: Robot,
    /// The chain between the links that were named too.
    pub(super) chain: Option<Chain>,
}

impl NamedRobot {
    pub(super) fn of(named: &TrajectoryRobot) -> Result<Option<Self>, Failure> {
        named.robot.as_deref().map(|reference| Self::read(reference, named)).transpose()
    }

    fn read(reference: &str, named: &TrajectoryRobot) -> Result<Self, Failure> {
        let source = RobotSource::find(reference, None)?;
        let robot = source.read(&UrdfOptions::default()).map_err(|e| source.refusal(&e))?;
        let ends = named.base.as_ref().zip(named.tip.as_ref());
        let chain = ends.map(|(base, tip)| robot.chain(base, tip)).transpose();
        let chain = chain.map_err(|e| Failure::new(Exit::Robot, e.to_string()).in_file(reference))?;
        Ok(Self { reference: reference.to_owned(), source, robot, chain })
    }

    /// Its joints that move, those of the chain first and in their order.
    pub(super) fn joints(&self) -> Vec<KnownJoint> {
        let mut joints = KnownJoint::of(&self.robot);
        if let Some(chain) = &self.chain {
            chain_first(&mut joints, chain);
        }
        joints
    }

    /// The URDF that it was read from, if it was.
    pub(super) fn urdf(&self) -> Option<String> {
        self.source.urdf()
    }

    /// The folder of its file, if it is one.
    pub(super) fn folder(&self) -> Option<PathBuf> {
        self.source.folder()
    }

    /// Refuses joints that it does not have.
    pub(super) fn check_joints(&self, arm: &ArmTrajectory) -> Result<(), Failure> {
        let movable = self.robot.joints().iter().filter(|joint| joint.kind.is_movable());
        let known: Vec<&str> = movable.map(|joint| joint.name.as_str()).collect();
        match arm.joints.iter().find(|joint| !known.contains(&joint.as_str())) {
            Some(joint) => {
                let whose = format!("{} that it could", self.reference);
                Err(unknown_joint(joint, &known, &whose).in_file(&self.reference))
            }
            None => Ok(()),
        }
    }

    /// Refuses a trajectory that lacks a joint of the chain: what it calls by a name that the robot does not have may be meant.
    pub(super) fn check_chain(&self, arm: &ArmTrajectory) -> Result<(), Failure> {
        let mut own = self.chain.iter().flat_map(Chain::joints);
        let Some(missing) = own.find(|joint| !arm.joints.contains(&joint.name)) else { return Ok(()) };
        self.check_joints(arm)?;
        let message = format!("the trajectory does not have joint `{}` of the chain", missing.name);
        Err(Failure::new(Exit::Robot, message).in_file(&self.reference))
    }
}

/// The refusal of a joint that is not among those that are known, with the nearest of them.
pub(super) fn unknown_joint(joint: &str, known: &[&str], whose: &str) -> Failure {
    let hint = suggestion(joint, known.iter().copied());
    Failure::new(Exit::Robot, format!("the trajectory moves `{joint}`, which is no joint of {whose}; {hint}"))
}
