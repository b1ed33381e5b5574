//! What can be asked on the command line.

mod formula;
mod ode;
mod plan;
mod robot;
mod study;

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};

pub(super) use formula::*;
pub(super) use ode::*;
pub(super) use plan::*;
pub(super) use robot::*;
pub(super) use study::*;

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
pub(crate) struct Arguments {
    #[command(subcommand)]
    pub(crate) command: Command,

    /// Print one JSON document on standard output, for failures too
    #[arg(long, global = true)]
    pub(crate) json: bool,

    /// Say nothing but warnings and failures; the exit code tells the rest. Documents and JSON are written as ever
    #[arg(long, global = true, conflicts_with = "verbose")]
    pub(crate) quiet: bool,

    /// Say more: what was ignored in a robot's file, what a plan asks of every joint, how long each stage took
    #[arg(short, long, global = true)]
    pub(crate) verbose: bool,

    /// Colours: on a terminal unless NO_COLOR is set, always, or never
    #[arg(long, global = true, value_name = "WHEN", default_value = "auto", hide_possible_values = true)]
    pub(crate) color: ColourChoice,

    /// A file with formula rows of your own, beside the built-in ones
    #[arg(long, global = true, value_name = "FILE")]
    pub(crate) formulas: Option<PathBuf>,
}

/// When text is coloured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum ColourChoice {
    /// On a terminal, unless NO_COLOR is set
    Auto,
    /// Always
    Always,
    /// Never
    Never,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Plan the motion of a scenario; without a file, of two real arms in a built-in one
    #[command(after_help = "\
Examples:
  kinstep plan
  kinstep plan mine.toml --out results --force
  kinstep plan mine.toml --out results --figures
  kinstep plan mine.toml --out results --format npz,ros2,mcap
  kinstep plan mine.toml --set sigma=0.005 --set law.h=0.3
  kinstep plan mine.toml --set formula=split-ab6 --set law.h=1 --json
  kinstep plan mine.toml --set noise.position=1e-4 --set noise.joints=1e-5     white noise in what is measured
  kinstep plan mine.toml --set 'arm.left.q0=[0.1, 0.2, \"pi/2\", 0]'

Setting one of law.h and law.gain takes the other away. Written are trajectory.csv, plan.json, scenario.toml and report.html, the page to look at.")]
    Plan(PlanArguments),
    /// Draw what was saved by plan --out, order --out or sweep --out: figures as SVG, PNG or PDF, their numbers as CSV
    #[command(after_help = "\
Examples:
  kinstep plot results                                       every figure of a plan, into results/figures
  kinstep plot results --figure motion,errors --format png,pdf
  kinstep plot results --figure joints --arm left --joint panda_joint4 --from 1 --to 3
  kinstep plot results --size 480x360 --out small
  kinstep plot study                                         errors against the gap, of kinstep order --out study
  kinstep plot grid.csv                                      a map, lines or histograms, of kinstep sweep --out grid.csv

Figures of a plan: motion, paths, errors, joints, velocities, manipulability, singular, condition, limits.")]
    Plot(PlotArguments),
    /// Run the paper's experiments beside the bounds that it states; exit 1 if one is missed
    #[command(after_help = "\
Examples:
  kinstep reproduce
  kinstep reproduce --out paper --json          the trajectories, a page of each, and reproduce.json")]
    Reproduce(ReproduceArguments),
    /// Solve an initial value problem: varying steps and order, events, output times; or any row of the table in equal steps
    #[command(after_help = "\
Examples:
  kinstep ode                                                the built-in problems and the families
  kinstep ode kepler --rtol 1e-10 --at 1,2,3
  kinstep ode van_der_pol --set problem.parameters.m=1000 --until 2000 --out solution
  kinstep ode kepler --method la6-wang-guo --sigma 0.001
  kinstep ode kepler --predictor ab4 --corrector am3 --json
  kinstep ode mine.toml --family bdf --until 1e11

Without a method it begins with the Adams family (orders 1 to 12) and changes to backward differentiation (bdf, orders 1 to 5) where 25 steps in a row
are bounded by stability and not by their error, and back where the Jacobian says that Adams would do.
A problem file has a table [problem] with equations, initial values and, if you like, events: docs/ode.md. A run that stops exits with 5.")]
    Ode(OdeArguments),
    /// Study which order runs really show: of scenarios, of textbook problems, of your own row
    #[command(after_help = "\
Examples:
  kinstep order examples/dual_panda.toml
  kinstep order examples/dual_panda.toml --formula la6-wang-guo --formula split-ab4 --out study
  kinstep order kepler arenstorf --formula ab4
  kinstep order swing --formulas mine.toml --formula my-formula
  kinstep order kepler --formula ab8 --set study.precision=extended

Written are the figure and the numbers of every study. A row that does not reach the order it is held to exits with 1, a finest
run that stops with 5.")]
    Order(OrderArguments),
    /// Plan a scenario many times, with values from lists and distributions, into one table
    #[command(after_help = "\
Examples:
  kinstep sweep mine.toml --vary law.h=0.1,0.2,0.4 --vary sigma=0.02,0.01 --out grid.csv
  kinstep sweep mine.toml --vary law.h=0.1,0.2,0.4 --vary sigma=0.02,0.01 --out grid.csv --plot pictures
  kinstep sweep mine.toml --vary formula=la6-wang-guo,split-ab4 --vary 'law.h=linspace(0.1, 0.6, 11)' --out rows.csv
  kinstep sweep a.toml b.toml --vary 'arm.left.q0[2]=normal(0.3, 0.05)' --samples 1000 --out scatter.json
  kinstep sweep mine.toml --vary noise.position=1e-5,1e-4 --vary 'noise.seed=linspace(1, 20, 20)' --out noise.csv

Values: a,b,c  linspace(from, to, count)  logspace(from, to, count)  uniform(from, to)  loguniform(from, to)
normal(mean, deviation). A sweep that was interrupted goes on where it stopped when the same command is given again.")]
    Sweep(SweepArguments),
    /// Write a saved trajectory in other formats
    #[command(after_help = "\
Examples:
  kinstep export results --format all
  kinstep export results --format mcap --out bags
  kinstep export theirs.csv --robot panda --base panda_link0 --tip panda_hand_tcp --format mcap

Formats: csv, npz (NumPy), parquet (with the feature of that name), ros2 (trajectory_msgs as YAML), mcap (Foxglove, RViz), moveit (DisplayTrajectory as YAML), all.")]
    Export(ExportArguments),
    /// Check a trajectory of any planner against a robot: limits, continuity, rest, the path; exit 1 if a check fails
    #[command(after_help = "\
Examples:
  kinstep check results
  kinstep check theirs.yaml --robot panda
  kinstep check bag.mcap --robot panda --scenario mine.toml --max-error 1e-4 --json")]
    Check(CheckArguments),
    /// Look at difference formulas and make new ones: list, show, check, derive, search, compare
    #[command(
        subcommand,
        after_help = "Example:\n  kinstep formula show --difference 24,-5,-12,-6,-4,3 --denominator 48"
    )]
    Formula(FormulaCommand),
    /// Look at robots: list, show, draw, check, pose and Jacobian, inverse kinematics, write as URDF
    #[command(subcommand, after_help = "Example:\n  kinstep robot show panda")]
    Robot(RobotCommand),
    /// Print the JSON Schema of a kind of file
    #[command(after_help = "Example:\n  kinstep schema scenario > scenario.schema.json")]
    Schema(SchemaArguments),
}

/// Where the files of a command go.
#[derive(Debug, Args)]
pub(crate) struct OutArguments {
    /// Folder for what is written; made if it is not there
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,

    /// Replace files that are already there
    #[arg(long)]
    pub(crate) force: bool,
}

#[derive(Clone, Copy, Debug, Args)]
pub(crate) struct SchemaArguments {
    /// Kind of file
    pub(crate) kind: SchemaKind,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum SchemaKind {
    /// Scenario files of `kinstep plan`
    Scenario,
    /// Files of formula rows
    Formula,
}
