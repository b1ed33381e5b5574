//! `kinstep export`: saved results in other formats.

use std::borrow::Cow;
use std::path::{Path, PathBuf};

use serde::Serialize;

use super::arguments::ExportArguments;
use super::failure::{Exit, Failure};
use super::folder::Folder;
use super::formats::{self, Exports};
use super::loaded::{Loaded, NamedRobot, Staged, load};
use super::output::{Output, Show};
use super::stopped::Stopped;
use kinstep::robot::Chain;
use kinstep::robot::names::printable;
use kinstep::task::TaskKind;
use kinstep_files::trajectory::{
    ArmTrajectory, KnownJoint, Machine, Recording, Stage, StagedArm, Trajectory, units,
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
    let robots = Robots::of(arguments)?;
    let Loaded { mut trajectory, mut notes, joints } =
        load(&arguments.trajectory, robots.joints(), &arguments.reading)?;
    let stage = robots.staged(&trajectory)?;
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

/// The robots that a trajectory is of, where they are known.
enum Robots {
    /// Those of a folder of results.
    Own(Box<Staged>),
    /// The one that the arguments name.
    Named(Box<NamedRobot>),
    Unknown,
}

impl Robots {
    fn of(arguments: &ExportArguments) -> Result<Self, Failure> {
        if arguments.trajectory.is_dir() {
            let staged = Staged::read(&arguments.trajectory.join("scenario.toml"))?;
            return Ok(Self::Own(Box::new(staged)));
        }
        let named = NamedRobot::of(&arguments.robot)?;
        Ok(named.map_or(Self::Unknown, |named| Self::Named(Box::new(named))))
    }

    /// The joints that may move in it.
    fn joints(&self) -> Vec<KnownJoint> {
        match self {
            Self::Own(staged) => staged.joints(),
            Self::Named(named) => named.joints(),
            Self::Unknown => Vec::new(),
        }
    }

    /// Returns them on their stage; a named robot takes the ends of its arm to be on one.
    fn staged(self, trajectory: &Trajectory) -> Result<Stage, Failure> {
        match self {
            Self::Own(staged) => Ok(staged.stage),
            Self::Named(named) => match named.chain.clone() {
                Some(chain) => lone_stage(trajectory, *named, chain),
                None => Ok(Stage::default()),
            },
            Self::Unknown => Ok(Stage::default()),
        }
    }
}

/// Returns the stage of a lone arm.
fn lone_stage(trajectory: &Trajectory, named: NamedRobot, chain: Chain) -> Result<Stage, Failure> {
    let [arm] = &trajectory.arms[..] else {
        let count = trajectory.arms.len();
        let message =
            format!("--robot is one robot, and {count} arms move here; give the folder of the results");
        return Err(Failure::usage(message));
    };
    named.check_chain(arm)?;
    let (urdf, folder) = (named.urdf(), named.folder());
    let machine = Machine {
        urdf,
        folder,
        ..Machine::new(&arm.name, named.robot, chain.base(), &IsometryMatrix3::identity())
    };
    let staged = StagedArm::new(&arm.name, (0, &machine.robot), chain, TaskKind::Pose).ok_or_else(|| {
        let message = "the chain moves a joint that the robot does not have";
        Failure::new(Exit::Robot, message).in_file(&named.reference)
    })?;
    Ok(Stage { machines: vec![machine], arms: vec![staged] })
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

/// Takes the joints of the chain of every arm, in its order.
fn in_order_of(trajectory: &mut Trajectory, stage: &Stage) {
    for arm in &mut trajectory.arms {
        if let Some(staged) = stage.arm(&arm.name) {
            let order: Vec<&str> = staged.chain.joints().iter().map(|joint| joint.name.as_str()).collect();
            if let Cow::Owned(ordered) = arm.with_joints(&order) {
                *arm = ordered;
            }
        }
    }
}
