//! Arguments of the commands about robots.

use std::path::PathBuf;

use clap::{Args, Subcommand};

#[derive(Debug, Subcommand)]
pub(crate) enum RobotCommand {
    /// List the robots that come with the program
    #[command(after_help = "Example:\n  kinstep robot list")]
    List,
    /// Show a robot: its tree, limits and chains; or draw it
    #[command(after_help = "\
Examples:
  kinstep robot show panda
  kinstep robot show my_robot.urdf --json
  kinstep robot show examples/dh/ur5e.toml
  kinstep robot show panda --plot panda.svg --q panda_joint4=-pi/2,panda_joint6=pi/2")]
    Show(RobotShow),
    /// Say everything that is wrong with a URDF file or a table; exit 3 if anything is an error
    #[command(after_help = "Example:\n  kinstep robot check my_robot.urdf")]
    Check(RobotFile),
    /// Pose of a tip in a base
    #[command(after_help = "Examples:\n  kinstep robot fk planar4 --base base --tip tip --q=-0.1,2,0,pi/4")]
    Fk(KinematicsArguments),
    /// Pose of a tip in a base, and the geometric Jacobian: twist (linear, angular) of the tip at its origin, in
    /// the base's axes, by joint
    #[command(
        after_help = "Example:\n  kinstep robot jacobian planar4 --base base --tip tip --q 0,pi/2,0,0 --json"
    )]
    Jacobian(KinematicsArguments),
    /// Joint positions that bring a tip to a pose, a position, or a position with a direction of its z axis, within the
    /// limits; exit 5, and the nearest place, if none are found
    #[command(after_help = "\
Examples:
  kinstep robot ik panda --base panda_link0 --tip panda_hand_tcp --position 0.5,0.1,0.3 --orientation pi,0,0
  kinstep robot ik ur5e --base base_link --tip tool0 --position 0.4,0.2,0.3 --axis 0,0,-1 --json
  kinstep robot ik planar4 --base base --tip tip --position 2,1 --q0 0.1,0.2,0.3,0.4
  kinstep robot ik my_5_axis.urdf --base base --tip tip --position 0.3,0,0.2 --orientation pi,0,0 --task axis

Without --q0 the answer nearest to the middle of the limits is taken. The same arguments always give the same answer.")]
    Ik(InverseArguments),
    /// Write a robot as URDF: a table, or a URDF with its calibration and its locked joints in it
    #[command(after_help = "\
Examples:
  kinstep robot export examples/dh/ur5e.toml > ur5e.urdf
  kinstep robot export panda --calibration mine.toml --lock panda_finger_joint1=0 --urdf mine.urdf")]
    Export(RobotExport),
}

#[derive(Debug, Args)]
pub(crate) struct RobotShow {
    #[command(flatten)]
    pub(crate) file: RobotFile,

    /// Draw the robot instead: into a folder, a file per view, or all on one page when the name ends in .svg; numbers go
    /// beside as CSV
    #[arg(long, value_name = "DIR|FILE")]
    pub(crate) plot: Option<PathBuf>,

    /// Joint positions of the drawing in rad or m: one for each joint that moves on its own, or some as NAME=VALUE; the
    /// others are 0
    #[arg(long, value_name = "Q,...", allow_hyphen_values = true, requires = "plot")]
    pub(crate) q: Option<String>,

    /// Replace drawings that are already there
    #[arg(long, requires = "plot")]
    pub(crate) force: bool,
}

#[derive(Debug, Args)]
pub(crate) struct RobotExport {
    #[command(flatten)]
    pub(crate) file: RobotFile,

    /// Write the URDF to this file; without it, or to -, it goes to standard output
    #[arg(long, value_name = "FILE", num_args = 0..=1, default_missing_value = "-")]
    pub(crate) urdf: Option<PathBuf>,

    /// Replace a file that is already there
    #[arg(long, requires = "urdf")]
    pub(crate) force: bool,
}

#[derive(Debug, Args)]
pub(crate) struct RobotFile {
    /// A URDF file, a Denavit-Hartenberg table in TOML, or the name of a robot that comes with the program
    #[arg(value_name = "FILE")]
    pub(crate) robot: String,

    /// Take joints without a limit element as unlimited instead of defective
    #[arg(long)]
    pub(crate) assume_unlimited: bool,

    /// Take every attribute that URDF does not know as an error
    #[arg(long)]
    pub(crate) strict: bool,

    /// A TOML file of corrections: tables [joint.NAME] with xyz, rpy, zero, reversed
    #[arg(long, value_name = "FILE")]
    pub(crate) calibration: Option<PathBuf>,

    /// A YAML file of joint limits that go over the robot's own (joint_limits, as in MoveIt's joint_limits.yaml)
    #[arg(long, value_name = "FILE")]
    pub(crate) limits: Option<PathBuf>,

    /// Hold a joint still, at a position in rad or m, or a floating, planar or spherical one at "x y z roll pitch yaw" or
    /// 0. May be given again
    #[arg(long, value_name = "JOINT=VALUE")]
    pub(crate) lock: Vec<String>,
}

#[derive(Debug, Args)]
pub(crate) struct ChainArguments {
    #[command(flatten)]
    pub(crate) file: RobotFile,

    /// Link at which the chain begins
    #[arg(long, value_name = "LINK")]
    pub(crate) base: String,

    /// Link at which the chain ends
    #[arg(long, value_name = "LINK")]
    pub(crate) tip: String,

    /// Pose of a tool in the tip, "x y z roll pitch yaw" in m and rad: the chain then ends there
    #[arg(long, value_name = "POSE", allow_hyphen_values = true)]
    pub(crate) tool: Option<String>,
}

#[derive(Debug, Args)]
pub(crate) struct KinematicsArguments {
    #[command(flatten)]
    pub(crate) chain: ChainArguments,

    /// Joint positions in path order in rad or m, separated by commas; expressions in pi are read
    #[arg(long, value_name = "Q,...", allow_hyphen_values = true)]
    pub(crate) q: Option<String>,
}

/// What of a pose counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub(crate) enum InverseTask {
    /// x and y
    PositionXy,
    /// The position
    Position,
    /// The position and where the tip's z axis points
    Axis,
    /// Position and orientation
    Pose,
}

#[derive(Debug, Args)]
pub(crate) struct InverseArguments {
    #[command(flatten)]
    pub(crate) chain: ChainArguments,

    /// Where the tip should be in the base's axes in m; of two numbers, x and y, z is free
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    pub(crate) position: String,

    /// How it should be turned: roll, pitch and yaw about the base's axes in rad as in URDF, or a unit quaternion x,y,z,w
    #[arg(long, value_name = "R,P,Y", allow_hyphen_values = true)]
    pub(crate) orientation: Option<String>,

    /// Where its z axis should point, in the base's axes; the turn about it is free
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, conflicts_with = "orientation")]
    pub(crate) axis: Option<String>,

    /// What of it counts; `position` of a pose leaves the orientation free, `axis` the turn about the tip's z. Default: all
    /// that is given
    #[arg(long, value_enum, value_name = "TASK")]
    pub(crate) task: Option<InverseTask>,

    /// Joint positions that the answer should be near, in path order in rad or m
    #[arg(long, value_name = "Q,...", allow_hyphen_values = true)]
    pub(crate) q0: Option<String>,

    /// Starting places to try at most
    #[arg(long, default_value_t = 100, allow_hyphen_values = true, value_parser = count)]
    pub(crate) starts: usize,

    /// Seed of the starting places
    #[arg(long, default_value_t = 0, allow_hyphen_values = true, value_parser = seed)]
    pub(crate) seed: u64,
}

/// Reads how many of something there should be: at least one.
fn count(text: &str) -> Result<usize, String> {
    text.parse().ok().filter(|&count| count > 0).ok_or_else(|| "give a whole number, at least 1".to_owned())
}

fn seed(text: &str) -> Result<u64, String> {
    text.parse().map_err(|_| format!("give a whole number between 0 and {}", u64::MAX))
}
