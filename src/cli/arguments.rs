//! What can be asked on the command line.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};

/// Synchronous motion of robot arms from exact difference formulas.
#[derive(Debug, Parser)]
#[command(
    name = "kinstep",
    version,
    max_term_width = 110,
    after_help = "\
Examples:
  kinstep plan                              two real arms, a built-in scenario
  kinstep plan mine.toml --out results      your scenario, with its trajectory as a file
  kinstep formula show la6-wang-guo         what a formula can do, decided exactly
  kinstep reproduce                         the paper's experiments beside its bounds

Exit codes: 0 done; 1 done, but a check failed; 2 usage or scenario; 3 robot; 4 formula; 5 the run stopped; 6 files."
)]
pub(super) struct Arguments {
    #[command(subcommand)]
    pub(super) command: Command,

    /// Print one JSON document on standard output, for failures too
    #[arg(long, global = true)]
    pub(super) json: bool,

    /// A file with formula rows of your own, beside the built-in ones
    #[arg(long, global = true, value_name = "FILE")]
    pub(super) formulas: Option<PathBuf>,
}

#[derive(Debug, Subcommand)]
pub(super) enum Command {
    /// Look at robots: list, show, check, pose and Jacobian
    #[command(subcommand)]
    Robot(RobotCommand),
    /// Print the JSON Schema of a kind of file
    Schema(SchemaArguments),
}

#[derive(Debug, Subcommand)]
pub(super) enum RobotCommand {
    /// List the robots that come with the program
    List,
    /// Show a robot's links, joints and limits
    #[command(
        after_help = "Examples:\n  kinstep robot show panda\n  kinstep robot show my_robot.urdf --json"
    )]
    Show(RobotFile),
    /// Say everything that is wrong with a URDF file; exit 3 if anything is an error
    #[command(after_help = "Example:\n  kinstep robot check my_robot.urdf")]
    Check(RobotFile),
    /// Pose of a tip in a base
    #[command(after_help = "Examples:\n  kinstep robot fk planar4 --base base --tip tip --q=-0.1,2,0,pi/4")]
    Fk(ChainArguments),
    /// Pose of a tip in a base, and the geometric Jacobian: twist (linear, angular) of the tip at its origin, in
    /// the base's axes, by joint
    #[command(
        after_help = "Example:\n  kinstep robot jacobian planar4 --base base --tip tip --q 0,pi/2,0,0 --json"
    )]
    Jacobian(ChainArguments),
}

#[derive(Debug, Args)]
pub(super) struct RobotFile {
    /// A URDF file, or the name of a robot that comes with the program
    #[arg(value_name = "FILE")]
    pub(super) robot: String,

    /// Take joints without a <limit> as unlimited instead of defective
    #[arg(long)]
    pub(super) assume_unlimited: bool,

    /// Take every attribute that URDF does not know as an error
    #[arg(long)]
    pub(super) strict: bool,
}

#[derive(Debug, Args)]
pub(super) struct ChainArguments {
    #[command(flatten)]
    pub(super) file: RobotFile,

    /// Link at which the chain begins
    #[arg(long, value_name = "LINK")]
    pub(super) base: String,

    /// Link at which the chain ends
    #[arg(long, value_name = "LINK")]
    pub(super) tip: String,

    /// Joint positions in path order [rad or m], separated by commas; expressions in pi are read
    #[arg(long, value_name = "Q,...", allow_hyphen_values = true)]
    pub(super) q: String,
}

#[derive(Clone, Copy, Debug, Args)]
pub(super) struct SchemaArguments {
    /// Kind of file
    pub(super) kind: SchemaKind,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(super) enum SchemaKind {
    /// Scenario files of `kinstep plan`
    Scenario,
    /// Files of formula rows
    Formula,
}
