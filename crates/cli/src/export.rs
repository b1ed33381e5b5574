//! `kinstep export`: saved results in other formats.

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use serde::Serialize;

use super::arguments::{ExportArguments, ReadingArguments, TrajectoryRobot};
use super::failure::{Exit, Failure};
use super::folder::Folder;
use super::formats::{self, Exports};
use super::output::{Output, Show};
use super::stopped::Stopped;
use kinstep::robot::names::printable;
use kinstep::robot::{Chain, Robot, UrdfOptions};
use kinstep::task::TaskKind;
use kinstep_files::scenario::{RobotSource, ScenarioText, suggestion};
use kinstep_files::trajectory::{
    ArmTrajectory, KnownJoint, Machine, ReadOptions, Reading, Recording, Stage, StagedArm, Trajectory, units,
};
use nalgebra::IsometryMatrix3;

#[derive(Serialize)]
struct Exported {
    written: Vec<String>,
    /// What was recognised and assumed of the file.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    notes: Vec<String>,
    /// What is questionable about it.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    warnings: Vec<String>,
}

impl Show for Exported {
    fn text(&self) -> String {
        format!("wrote {}\n", self.written.join(", "))
    }
}

pub(super) fn run(arguments: &ExportArguments, output: &mut Output) -> Result<Exit, Failure> {
    let chosen = formats::formats(&arguments.format, &[])?;
    if let Some(stopped) = Stopped::check(&arguments.trajectory)? {
        output.aside(&printable(&stopped.sentence));
    }
    let Loaded { mut trajectory, stage, mut notes, joints } =
        load(&arguments.trajectory, &arguments.robot, None, &arguments.reading)?;
    notes.extend(left_out(&trajectory, &stage));
    let warnings = units::questions(&trajectory, &joints);
    output.remarks(&notes, &warnings);
    in_order_of(&mut trajectory, &stage);
    let recording = Recording { trajectory: &trajectory, stage: &stage };
    let exports = Exports::new(&chosen, &recording.machines(), arguments.append_stop)?;
    let out = arguments.out.clone().unwrap_or_else(|| beside(&arguments.trajectory));
    let names: Vec<&str> = exports.names().collect();
    let folder = Folder::open(&out, arguments.force, &names)?.interruptible(formats::interruption());
    exports.write(&folder, recording)?;
    let written = names.iter().map(|name| out.join(name).display().to_string()).collect();
    output.show(&Exported { written, notes, warnings })?;
    Ok(Exit::Done)
}

/// The folder of results itself, or the one that a file is in.
fn beside(path: &Path) -> PathBuf {
    if path.is_dir() {
        return path.to_owned();
    }
    let parent = path.parent().filter(|parent| !parent.as_os_str().is_empty());
    parent.unwrap_or(Path::new(".")).to_owned()
}

/// A trajectory that was read.
pub(super) struct Loaded {
    pub(super) trajectory: Trajectory,
    /// The robots that it is of, where they are known: those of the folder of results, or the one that the arguments name with the
    /// ends of its arm.
    pub(super) stage: Stage,
    /// What was recognised and assumed.
    pub(super) notes: Vec<String>,
    /// The joints that may move in it; none where that is not known.
    pub(super) joints: Vec<KnownJoint>,
}

/// Reads a trajectory, or the one in a folder of results.
pub(super) fn load(
    path: &Path,
    robot: &TrajectoryRobot,
    scenario: Option<&Path>,
    reading: &ReadingArguments,
) -> Result<Loaded, Failure> {
    if path.is_dir() {
        let read = formats::read(&path.join("trajectory.csv"), &ReadOptions::default())?;
        let stage = stage_of(&path.join("scenario.toml"))?;
        let joints = staged_joints(&stage);
        return Ok(Loaded { trajectory: read.trajectory, stage, notes: read.notes, joints });
    }
    let joints = known_joints(robot, scenario)?;
    let options = reading.options(joints);
    let Reading { trajectory, notes } = formats::read(path, &options)?;
    if let Some(hint) = options.hint(&trajectory) {
        return Err(Failure::new(Exit::Robot, hint).in_file(&path.display().to_string()));
    }
    let stage = staged(&trajectory, robot)?;
    Ok(Loaded { trajectory, stage, notes, joints: options.joints })
}

fn stage_of(scenario: &Path) -> Result<Stage, Failure> {
    let text = ScenarioText::read(scenario)?;
    Ok(text.scenario()?.stage(text.folder()).map_err(|e| text.placed(e))?)
}

/// The joints of the robot that is named, or else of those of the scenario, those of the arms first and in their order.
fn known_joints(robot: &TrajectoryRobot, scenario: Option<&Path>) -> Result<Vec<KnownJoint>, Failure> {
    let Some(reference) = &robot.robot else {
        return scenario.map_or_else(|| Ok(Vec::new()), |file| Ok(staged_joints(&stage_of(file)?)));
    };
    let read = self::robot(reference)?;
    let mut joints = KnownJoint::of(&read);
    if let (Some(base), Some(tip)) = (&robot.base, &robot.tip)
        && let Ok(chain) = read.chain(base, tip)
    {
        chain_first(&mut joints, &chain);
    }
    Ok(joints)
}

fn staged_joints(stage: &Stage) -> Vec<KnownJoint> {
    let mut joints: Vec<KnownJoint> = Vec::new();
    for joint in stage.machines.iter().flat_map(|machine| KnownJoint::of(&machine.robot)) {
        if joints.iter().all(|known| known.name != joint.name) {
            joints.push(joint);
        }
    }
    stage.arms.iter().rev().for_each(|arm| chain_first(&mut joints, &arm.chain));
    joints
}

/// Puts the joints of a chain first, in its order.
fn chain_first(joints: &mut [KnownJoint], chain: &Chain) {
    let place = |joint: &KnownJoint| {
        chain.joints().iter().position(|own| own.name == joint.name).unwrap_or(usize::MAX)
    };
    joints.sort_by_key(place);
}

/// Returns the stage of a lone arm; without a robot there is none.
fn staged(trajectory: &Trajectory, robot: &TrajectoryRobot) -> Result<Stage, Failure> {
    let (Some(reference), Some(base), Some(tip)) = (&robot.robot, &robot.base, &robot.tip) else {
        return Ok(Stage::default());
    };
    let [arm] = &trajectory.arms[..] else {
        let count = trajectory.arms.len();
        let message =
            format!("--robot is one robot, and {count} arms move here; give the folder of the results");
        return Err(Failure::usage(message));
    };
    let source = RobotSource::find(reference, None)?;
    let read = source.read(&UrdfOptions::default()).map_err(|e| source.refusal(&e))?;
    let refuse = |message: String| Failure::new(Exit::Robot, message).in_file(reference);
    let chain = read.chain(base, tip).map_err(|e| refuse(e.to_string()))?;
    check_joints(arm, &chain, &read, reference)?;
    let machine = Machine {
        urdf: source.urdf(),
        folder: source.folder(),
        ..Machine::new(&arm.name, read, base, &IsometryMatrix3::identity())
    };
    let staged = StagedArm::new(&arm.name, (0, &machine.robot), chain, TaskKind::Pose)
        .ok_or_else(|| refuse("the chain moves a joint that the robot does not have".to_owned()))?;
    Ok(Stage { machines: vec![machine], arms: vec![staged] })
}

/// Refuses a trajectory that moves joints that a robot does not have, or lacks one of a chain.
fn check_joints(arm: &ArmTrajectory, chain: &Chain, robot: &Robot, reference: &str) -> Result<(), Failure> {
    let movable = robot.joints().iter().filter(|joint| joint.kind.is_movable());
    let known: Vec<&str> = movable.map(|joint| joint.name.as_str()).collect();
    arm.joints.iter().try_for_each(|joint| check_joint(joint, &known, reference))?;
    match chain.joints().iter().find(|joint| !arm.joints.contains(&joint.name)) {
        Some(missing) => {
            let message = format!("the trajectory does not have joint `{}` of the chain", missing.name);
            Err(Failure::new(Exit::Robot, message).in_file(reference))
        }
        None => Ok(()),
    }
}

/// What is said of the joints that move in a trajectory and are none of its arm's, such as those of a gripper.
fn left_out(trajectory: &Trajectory, stage: &Stage) -> Vec<String> {
    let of_arm = |arm: &ArmTrajectory| {
        let chain = &stage.arm(&arm.name)?.chain;
        let is_other = |joint: &&String| chain.joints().iter().all(|own| own.name != **joint);
        let others: Vec<String> =
            arm.joints.iter().filter(is_other).map(|joint| format!("`{joint}`")).collect();
        let sentence = || format!("left out, because no joint of the arm: {}", others.join(", "));
        (!others.is_empty()).then(sentence)
    };
    trajectory.arms.iter().filter_map(of_arm).collect()
}

/// Refuses a joint that is not among the known ones, with the nearest of them.
pub(super) fn check_joint(joint: &str, known: &[&str], robot: &str) -> Result<(), Failure> {
    if known.contains(&joint) {
        return Ok(());
    }
    Err(unknown_joint(joint, known, &format!("{robot} that it could")).in_file(robot))
}

/// The refusal of a joint that is not among those that are known, with the nearest of them.
pub(super) fn unknown_joint(joint: &str, known: &[&str], whose: &str) -> Failure {
    let hint = suggestion(joint, known.iter().copied());
    Failure::new(Exit::Robot, format!("the trajectory moves `{joint}`, which is no joint of {whose}; {hint}"))
}

/// Takes the joints of the chain of every arm, in its order.
pub(super) fn in_order_of(trajectory: &mut Trajectory, stage: &Stage) {
    for arm in &mut trajectory.arms {
        if let Some(staged) = stage.arm(&arm.name) {
            let order: Vec<&str> = staged.chain.joints().iter().map(|joint| joint.name.as_str()).collect();
            if let Cow::Owned(ordered) = arm.with_joints(&order) {
                *arm = ordered;
            }
        }
    }
}

/// Reads the robot that is named.
pub(super) fn robot(reference: &str) -> Result<Robot, Failure> {
    let source = RobotSource::find(reference, None)?;
    Ok(source.read(&UrdfOptions::default()).map_err(|e| source.refusal(&e))?)
}
