//! `kinstep export`: saved results in other formats.

use std::path::{Path, PathBuf};

use serde::Serialize;

use super::arguments::{ExportArguments, TrajectoryRobot};
use super::failure::{Exit, Failure};
use super::folder::Folder;
use super::formats::{self, Exports};
use super::output::{Output, Show};
use super::stopped::Stopped;
use kinstep::robot::names::printable;
use kinstep::robot::{Robot, UrdfOptions};
use kinstep::task::TaskKind;
use kinstep_files::scenario::{RobotSource, ScenarioText, suggestion};
use kinstep_files::trajectory::{ArmTrajectory, Machine, Recording, Stage, StagedArm, Trajectory};
use nalgebra::IsometryMatrix3;

#[derive(Serialize)]
struct Written {
    written: Vec<String>,
}

impl Show for Written {
    fn text(&self) -> String {
        format!("wrote {}\n", self.written.join(", "))
    }
}

pub(super) fn run(arguments: &ExportArguments, output: &mut Output) -> Result<Exit, Failure> {
    let chosen = formats::formats(&arguments.format, &[])?;
    if let Some(stopped) = Stopped::check(&arguments.trajectory)? {
        output.aside(&printable(&stopped.sentence));
    }
    let (mut trajectory, stage) = load(&arguments.trajectory, &arguments.robot)?;
    in_order_of(&mut trajectory, &stage);
    let recording = Recording { trajectory: &trajectory, stage: &stage };
    let exports = Exports::new(&chosen, &recording.machines(), arguments.append_stop)?;
    let out = arguments.out.clone().unwrap_or_else(|| beside(&arguments.trajectory));
    let names: Vec<&str> = exports.names().collect();
    let folder = Folder::open(&out, arguments.force, &names)?.interruptible(formats::interruption());
    exports.write(&folder, recording)?;
    let written = names.iter().map(|name| out.join(name).display().to_string()).collect();
    output.show(&Written { written })?;
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

/// Returns a trajectory with the robots that it is of: of the folder of results, or those that the arguments name.
pub(super) fn load(path: &Path, robot: &TrajectoryRobot) -> Result<(Trajectory, Stage), Failure> {
    if path.is_dir() {
        let trajectory = formats::read(&path.join("trajectory.csv"))?;
        let text = ScenarioText::read(&path.join("scenario.toml"))?;
        let stage = text.scenario()?.stage(text.folder()).map_err(|e| text.placed(e))?;
        return Ok((trajectory, stage));
    }
    let trajectory = formats::read(path)?;
    let stage = staged(&trajectory, robot)?;
    Ok((trajectory, stage))
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
    let names: Vec<&str> = chain.joints().iter().map(|joint| joint.name.as_str()).collect();
    check_joints(arm, &names, reference)?;
    let machine = Machine {
        urdf: source.urdf(),
        folder: source.folder(),
        ..Machine::new(&arm.name, read, base, &IsometryMatrix3::identity())
    };
    let staged = StagedArm::new(&arm.name, (0, &machine.robot), chain, TaskKind::Pose)
        .ok_or_else(|| refuse("the chain moves a joint that the robot does not have".to_owned()))?;
    Ok(Stage { machines: vec![machine], arms: vec![staged] })
}

/// Refuses a trajectory that moves other joints than a chain has.
fn check_joints(arm: &ArmTrajectory, chain: &[&str], robot: &str) -> Result<(), Failure> {
    arm.joints.iter().try_for_each(|joint| check_joint(joint, chain, robot))?;
    match chain.iter().find(|name| !arm.joints.iter().any(|own| own == *name)) {
        Some(missing) => {
            let message = format!("the trajectory does not have joint `{missing}` of the chain");
            Err(Failure::new(Exit::Robot, message).in_file(robot))
        }
        None => Ok(()),
    }
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

/// Puts the joints of every arm into the order of its chain.
pub(super) fn in_order_of(trajectory: &mut Trajectory, stage: &Stage) {
    for arm in &mut trajectory.arms {
        if let Some(staged) = stage.arm(&arm.name) {
            let order: Vec<&str> = staged.chain.joints().iter().map(|joint| joint.name.as_str()).collect();
            *arm = arm.in_order(&order);
        }
    }
}

/// Reads the robot that is named.
pub(super) fn robot(reference: &str) -> Result<Robot, Failure> {
    let source = RobotSource::find(reference, None)?;
    Ok(source.read(&UrdfOptions::default()).map_err(|e| source.refusal(&e))?)
}
