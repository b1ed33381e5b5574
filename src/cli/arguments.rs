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

    /// Say nothing but warnings and failures; the exit code tells the rest. Documents and JSON are written as ever
    #[arg(long, global = true, conflicts_with = "verbose")]
    pub(super) quiet: bool,

    /// Say more: what was ignored in a robot's file, what a plan asks of every joint, how long each stage took
    #[arg(short, long, global = true)]
    pub(super) verbose: bool,

    /// Colours: on a terminal unless NO_COLOR is set, always, or never
    #[arg(long, global = true, value_name = "WHEN", default_value = "auto", hide_possible_values = true)]
    pub(super) color: ColourChoice,

    /// A file with formula rows of your own, beside the built-in ones
    #[arg(long, global = true, value_name = "FILE")]
    pub(super) formulas: Option<PathBuf>,
}

/// When text is coloured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum ColourChoice {
    /// On a terminal, unless NO_COLOR is set
    Auto,
    /// Always
    Always,
    /// Never
    Never,
}

#[derive(Debug, Subcommand)]
pub(super) enum Command {
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
pub(super) struct OutArguments {
    /// Folder for what is written; made if it is not there
    #[arg(long, value_name = "DIR")]
    pub(super) out: Option<PathBuf>,

    /// Replace files that are already there
    #[arg(long)]
    pub(super) force: bool,
}

#[derive(Debug, Args)]
pub(super) struct PlanArguments {
    /// The scenario, a TOML file (`kinstep schema scenario` has its keys)
    pub(super) scenario: Option<PathBuf>,

    #[command(flatten)]
    pub(super) written: OutArguments,

    /// Further formats of the trajectory, beside csv: npz, parquet, ros2, mcap, moveit, or all
    #[arg(long, value_name = "FORMAT,...", value_delimiter = ',', requires = "out")]
    pub(super) format: Vec<String>,

    /// Add a deceleration to rest where a trajectory for controllers ends in motion
    #[arg(long, requires = "out")]
    pub(super) append_stop: bool,

    /// Leave out report.html, the page with the replay and the figures
    #[arg(long, requires = "out")]
    pub(super) no_report: bool,

    /// Draw the plan too, into the folder figures of --out: a picture a file, its numbers beside it as CSV
    #[arg(long, requires = "out")]
    pub(super) figures: bool,

    /// Lay a value over the scenario; arms by name. May be given again
    #[arg(long, value_name = "KEY.PATH=VALUE")]
    pub(super) set: Vec<String>,
}

#[derive(Debug, Args)]
pub(super) struct PlotArguments {
    /// The folder of kinstep plan --out or kinstep order --out, or the table of kinstep sweep --out
    #[arg(value_name = "SAVED")]
    pub(super) saved: PathBuf,

    /// Which figures of a plan, separated by commas; all unless given
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    pub(super) figure: Vec<String>,

    /// Only this arm. May be given again
    #[arg(long, value_name = "NAME")]
    pub(super) arm: Vec<String>,

    /// Only this joint, where joints are drawn. May be given again
    #[arg(long, value_name = "NAME")]
    pub(super) joint: Vec<String>,

    /// Begin at this time in s
    #[arg(long, value_name = "T", allow_hyphen_values = true, value_parser = time)]
    pub(super) from: Option<f64>,

    /// End at this time in s
    #[arg(long, value_name = "T", allow_hyphen_values = true, value_parser = time)]
    pub(super) to: Option<f64>,

    /// How wide and high each drawing is in pixels; as large as it needs to be unless given
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub(super) size: Option<(f64, f64)>,

    /// Formats, separated by commas
    #[arg(long, value_delimiter = ',', default_value = "svg")]
    pub(super) format: Vec<PictureFormat>,

    /// Folder for the figures; the folder figures beside what was saved unless given
    #[arg(long, value_name = "DIR")]
    pub(super) out: Option<PathBuf>,

    /// Replace files that are already there
    #[arg(long)]
    pub(super) force: bool,
}

/// Formats of pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum PictureFormat {
    /// Scalable drawings
    Svg,
    /// Pixels, two for each of the drawing's own
    Png,
    /// A page
    Pdf,
}

impl PictureFormat {
    /// The end of its files' names.
    pub(super) fn ending(self) -> &'static str {
        match self {
            Self::Svg => "svg",
            Self::Png => "png",
            Self::Pdf => "pdf",
        }
    }
}

fn time(text: &str) -> Result<f64, String> {
    let time = crate::math::evaluate(text).ok().filter(|time| time.is_finite());
    time.ok_or_else(|| format!("\"{text}\" is no time in s"))
}

/// Reads `800x600`.
fn size(text: &str) -> Result<(f64, f64), String> {
    const SIDES: std::ops::RangeInclusive<u32> = 160..=8000;
    let sides =
        text.split_once(['x', 'X']).and_then(|(w, h)| Some((w.trim().parse().ok()?, h.trim().parse().ok()?)));
    match sides {
        Some((width, height)) if SIDES.contains(&width) && SIDES.contains(&height) => {
            Ok((width.into(), height.into()))
        }
        Some(_) => Err(format!("both sides have to be from {} to {} pixels", SIDES.start(), SIDES.end())),
        None => Err(format!("\"{text}\" is no size; write width and height in pixels, as in 800x600")),
    }
}

#[derive(Debug, Args)]
pub(super) struct ExportArguments {
    /// The folder that `plan --out` wrote, or a trajectory: CSV, npz, MCAP, or a message as YAML
    #[arg(value_name = "DIR|TRAJECTORY")]
    pub(super) trajectory: PathBuf,

    #[command(flatten)]
    pub(super) robot: TrajectoryRobot,

    /// The formats: csv, npz, parquet, ros2, mcap, moveit, or all
    #[arg(long, value_name = "FORMAT,...", value_delimiter = ',', required = true)]
    pub(super) format: Vec<String>,

    /// Folder for the files; without it they go beside the trajectory
    #[arg(long, value_name = "DIR")]
    pub(super) out: Option<PathBuf>,

    /// Add a deceleration to rest where a trajectory for controllers ends in motion
    #[arg(long)]
    pub(super) append_stop: bool,

    /// Replace files that are already there
    #[arg(long)]
    pub(super) force: bool,
}

#[derive(Debug, Args)]
pub(super) struct TrajectoryRobot {
    /// The robot of a lone trajectory: a file, or the name of one that comes with the program
    #[arg(long, value_name = "FILE")]
    pub(super) robot: Option<String>,

    /// Link at which the arm begins
    #[arg(long, value_name = "LINK", requires = "robot", requires = "tip")]
    pub(super) base: Option<String>,

    /// Link at which the arm ends
    #[arg(long, value_name = "LINK", requires = "robot", requires = "base")]
    pub(super) tip: Option<String>,
}

#[derive(Debug, Args)]
pub(super) struct CheckArguments {
    /// A trajectory: CSV, npz, MCAP, or a message as YAML; or the folder that `plan --out` wrote
    #[arg(value_name = "TRAJECTORY|DIR")]
    pub(super) trajectory: PathBuf,

    #[command(flatten)]
    pub(super) robot: TrajectoryRobot,

    /// A scenario whose paths the tips should follow, arm by arm of the same name; its robots are taken unless --robot is given
    #[arg(long, value_name = "FILE")]
    pub(super) scenario: Option<PathBuf>,

    /// The largest task error that is allowed, in m and rad
    #[arg(long, value_name = "E", default_value_t = 1e-3)]
    pub(super) max_error: f64,
}

#[derive(Debug, Args)]
pub(super) struct OrderArguments {
    /// Scenario files, or names of built-in problems; without any, the built-in problems are listed
    #[arg(value_name = "SCENARIO")]
    pub(super) scenarios: Vec<String>,

    /// A row to study in place of those that the scenario names. May be given again
    #[arg(long, value_name = "ID")]
    pub(super) formula: Vec<String>,

    /// Lay a value over every scenario. May be given again
    #[arg(long, value_name = "KEY.PATH=VALUE")]
    pub(super) set: Vec<String>,

    #[command(flatten)]
    pub(super) written: OutArguments,
}

#[derive(Debug, Args)]
pub(super) struct SweepArguments {
    /// Scenario files; each is swept
    #[arg(value_name = "SCENARIO", required = true)]
    pub(super) scenarios: Vec<PathBuf>,

    /// A key of the scenario and its values. May be given again: all combinations are run
    #[arg(long, value_name = "KEY.PATH=VALUES", allow_hyphen_values = true)]
    pub(super) vary: Vec<String>,

    /// The table: .csv or .json
    #[arg(long, value_name = "FILE")]
    pub(super) out: PathBuf,

    /// How often distributions are drawn for every combination of the lists
    #[arg(long, default_value_t = 100)]
    pub(super) samples: usize,

    /// What the draws depend on
    #[arg(long, default_value_t = 1)]
    pub(super) seed: u64,

    /// Lay a value over every scenario. May be given again
    #[arg(long, value_name = "KEY.PATH=VALUE")]
    pub(super) set: Vec<String>,

    /// Number of threads; all processors unless given. The table does not depend on it
    #[arg(long)]
    pub(super) threads: Option<usize>,

    /// Draw the table too, into this folder: a map, lines or histograms as SVG, their numbers beside them as CSV
    #[arg(long, value_name = "DIR")]
    pub(super) plot: Option<PathBuf>,

    /// Replace a table that is already there, and begin afresh
    #[arg(long)]
    pub(super) force: bool,
}

#[derive(Debug, Args)]
pub(super) struct ReproduceArguments {
    #[command(flatten)]
    pub(super) written: OutArguments,

    /// Leave out the pages
    #[arg(long, requires = "out")]
    pub(super) no_report: bool,

    /// Write the page about the paper, in Markdown, with every order measured anew
    #[arg(long, value_name = "FILE", conflicts_with = "out")]
    pub(super) page: Option<PathBuf>,
}

#[derive(Debug, Subcommand)]
pub(super) enum FormulaCommand {
    /// List the formulas: built-in ones and those of --formulas
    #[command(after_help = "\
Examples:
  kinstep formula list
  kinstep formula list --order 3 --steps 4-6 --zero-stable --sort decay
  kinstep formula list --recommended
  kinstep formula list --derivative-rules
  kinstep formula list --formulas mine.toml")]
    List(FormulaList),
    /// Show formulas in full, by id or typed at the prompt
    #[command(after_help = "\
Examples:
  kinstep formula show la6-wang-guo split-ab6
  kinstep formula show --difference 24,-5,-12,-6,-4,3 --denominator 48
  kinstep formula show --alpha 1,-1,0 --beta 0,3/2,-1/2 --gamma 0,1,0
  kinstep formula show la6-wang-guo --plot pictures     five figures as SVG, their numbers as CSV
  kinstep formula show la6-wang-guo --plot card.svg     all figures on one page
  kinstep formula show split-ab6 --rust > split_ab6.rs

Newest sample first: the first coefficient belongs to x_n+1.")]
    Show(FormulaShow),
    /// Check the rows of a file: what they declare against what their coefficients say
    #[command(after_help = "\
Examples:
  kinstep formula check mine.toml
  kinstep formula check draft.toml --draft      computes what is not declared and prints finished rows")]
    Check(FormulaCheck),
    /// Derive all formulas of a stencil and an order, exactly; with parameters, one of them as a row
    #[command(after_help = "\
Examples:
  kinstep formula derive --samples 1,0,-1,-2,-3,-4 --order 3
  kinstep formula derive --samples 1,0,-1,-2,-3,-4 --order 3 --parameters -1/12,1/16
  kinstep formula derive --samples 1,0 --derivatives 0,-1,-2,-3 --order 4       Adams-Bashforth
  kinstep formula derive --samples 1,0,-1,-3 --derivatives 1,0 --order 4        with a gap, implicit

Offsets count samples from t_n: 1 is the new one, 0 the present one, -1 the one before.")]
    Derive(FormulaDerive),
    /// Search for formulas of given steps and order that are best at something
    #[command(after_help = "\
Examples:
  kinstep formula search --steps 5 --order 3 --objective range
  kinstep formula search --steps 7 --order 4 --objective decay --denominator 480 --seconds 30
  kinstep formula search --steps 8 --order 5 --beat la9-240 --out found
  kinstep formula search --steps 5 --order 4 --family corrected --objective noise

The same arguments and seed find the same rows, whatever the number of threads, unless --seconds cuts the search short.
Written are rows.toml, front.csv and the figure front.svg.")]
    Search(FormulaSearch),
    /// Compare formulas side by side
    #[command(after_help = "\
Examples:
  kinstep formula compare la6-wang-guo la6-twenty-four split-ab4
  kinstep formula compare la6-wang-guo la6-fast --plot both.svg     with figures, and their numbers as CSV")]
    Compare(FormulaCompare),
    /// Say which orders look-ahead formulas can have, and why no higher ones
    #[command(after_help = "Example:\n  kinstep formula barrier --steps 12")]
    Barrier(FormulaBarrier),
    /// Write the page about all formulas, in Markdown, with its pictures
    #[command(after_help = "Example:\n  kinstep formula docs --out docs/formulas.md --force")]
    Docs(FormulaDocs),
}

#[derive(Debug, Args)]
pub(super) struct FormulaDerive {
    /// Offsets of the states, newest first
    #[arg(long, value_name = "O,...", allow_hyphen_values = true, value_delimiter = ',', required = true)]
    pub(super) samples: Vec<i64>,

    /// Offsets of the derivatives
    #[arg(
        long,
        value_name = "O,...",
        allow_hyphen_values = true,
        value_delimiter = ',',
        default_value = "0"
    )]
    pub(super) derivatives: Vec<i64>,

    /// The order that every formula is to have at least
    #[arg(long)]
    pub(super) order: usize,

    /// A value for each free parameter: integers, fractions or decimals
    #[arg(long, value_name = "P,...", allow_hyphen_values = true)]
    pub(super) parameters: Option<String>,
}

#[derive(Debug, Args)]
pub(super) struct FormulaSearch {
    /// Number of steps s
    #[arg(long)]
    pub(super) steps: usize,

    /// Order p
    #[arg(long)]
    pub(super) order: usize,

    /// What to be best at: range, decay, error-constant, per-step, noise, steady, economy, or weights such as
    /// range=2,decay=1
    #[arg(long, default_value = "range")]
    pub(super) objective: String,

    /// Look for rows at least as good as this one in range, error and decay, and better in one of them
    #[arg(long, value_name = "ID", conflicts_with = "objective")]
    pub(super) beat: Option<String>,

    /// The kind of rows: look-ahead, general, split or corrected
    #[arg(long, default_value = "look-ahead")]
    pub(super) family: String,

    /// The largest denominator of the free coefficients
    #[arg(long, default_value_t = 480)]
    pub(super) denominator: u32,

    /// Only rows whose feedback range reaches at least this far
    #[arg(long, value_name = "H", default_value_t = 0.0)]
    pub(super) least_range: f64,

    /// Seed of the random starting points
    #[arg(long, default_value_t = 1)]
    pub(super) seed: u64,

    /// Number of starting points; the budget of the search
    #[arg(long, default_value_t = 64)]
    pub(super) starts: usize,

    /// Stop after so many seconds with what is there
    #[arg(long, default_value_t = 60.0)]
    pub(super) seconds: f64,

    /// Number of threads; all processors unless given
    #[arg(long)]
    pub(super) threads: Option<usize>,

    /// How many rows to print
    #[arg(long, default_value_t = 3)]
    pub(super) rows: usize,

    #[command(flatten)]
    pub(super) written: OutArguments,
}

#[derive(Debug, Args)]
pub(super) struct FormulaBarrier {
    /// Up to this number of steps, 18 at most
    #[arg(long, value_name = "S", default_value_t = 16, value_parser = clap::value_parser!(u64).range(1..=18))]
    pub(super) steps: u64,
}

#[derive(Debug, Args)]
pub(super) struct FormulaCompare {
    /// Ids of two or more formulas
    #[arg(value_name = "ID", required = true, num_args = 2..)]
    pub(super) ids: Vec<String>,

    /// Draw the formulas over one another: into a folder, a file per figure, or all on one page when the name ends in .svg; numbers
    /// go beside as CSV
    #[arg(long, value_name = "DIR|FILE")]
    pub(super) plot: Option<PathBuf>,

    /// Replace figures that are already there
    #[arg(long, requires = "plot")]
    pub(super) force: bool,
}

#[derive(Debug, Args)]
pub(super) struct FormulaList {
    /// Only formulas of this family. May be given again
    #[arg(long, value_name = "NAME")]
    pub(super) family: Vec<String>,

    /// Only this number of steps, or a range such as 4-6
    #[arg(long, value_name = "N", value_parser = span)]
    pub(super) steps: Option<(usize, usize)>,

    /// Only this order, or a range such as 3-5
    #[arg(long, value_name = "N", value_parser = span)]
    pub(super) order: Option<(usize, usize)>,

    /// Only formulas that are zero-stable
    #[arg(long)]
    pub(super) zero_stable: bool,

    /// Best first by this column; formulas without it come last
    #[arg(long, value_name = "KEY")]
    pub(super) sort: Option<SortKey>,

    /// The formula to use for each number of steps and order, and why
    #[arg(long, conflicts_with_all = ["sort", "derivative_rules"])]
    pub(super) recommended: bool,

    /// The rules for the derivative of a reference that is known by its samples
    #[arg(long, conflicts_with_all = ["family", "steps", "zero_stable", "sort"])]
    pub(super) derivative_rules: bool,
}

/// Reads `5` or `4-6`.
fn span(text: &str) -> Result<(usize, usize), String> {
    let number = |part: &str| {
        part.trim()
            .parse::<usize>()
            .map_err(|_| format!("\"{part}\" is no number; give one, or a range such as 4-6"))
    };
    let (low, high) = text.split_once('-').unwrap_or((text, text));
    let (low, high) = (number(low)?, number(high)?);
    if low > high { Err(format!("the range {low}-{high} is empty")) } else { Ok((low, high)) }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum SortKey {
    /// Highest order first
    Order,
    /// Widest feedback range first
    Range,
    /// Least error constant c first
    ErrorConstant,
    /// Least r_opt first
    Decay,
    /// Least gain from feedforward noise at h_opt first
    Noise,
    /// By name
    Id,
}

#[derive(Debug, Args)]
pub(super) struct FormulaDocs {
    /// The page; its pictures go into the folder `pictures` beside it
    #[arg(long, value_name = "FILE")]
    pub(super) out: PathBuf,

    /// Replace files that are already there
    #[arg(long)]
    pub(super) force: bool,
}

#[derive(Debug, Args)]
#[expect(clippy::struct_excessive_bools, reason = "they are switches of a command")]
pub(super) struct FormulaShow {
    /// Ids of formulas
    #[arg(value_name = "ID")]
    pub(super) ids: Vec<String>,

    /// Numerators of a difference formula, newest sample first
    #[arg(long, value_name = "A,...", allow_hyphen_values = true, conflicts_with_all = ["alpha", "beta", "gamma"])]
    pub(super) difference: Option<String>,

    /// Denominator of --difference; 1 unless given
    #[arg(long, value_name = "D", allow_hyphen_values = true, requires = "difference")]
    pub(super) denominator: Option<String>,

    /// Weights of the states, newest sample first
    #[arg(long, value_name = "A,...", allow_hyphen_values = true, requires = "beta")]
    pub(super) alpha: Option<String>,

    /// Weights of the right-hand side f
    #[arg(long, value_name = "B,...", allow_hyphen_values = true, requires = "alpha")]
    pub(super) beta: Option<String>,

    /// Weights of the feedback g; those of f unless given
    #[arg(long, value_name = "G,...", allow_hyphen_values = true, requires = "alpha")]
    pub(super) gamma: Option<String>,

    /// Draw the formulas: into a folder, a file per figure, or all on one page when the name ends in .svg; numbers
    /// go beside as CSV
    #[arg(long, value_name = "DIR|FILE")]
    pub(super) plot: Option<PathBuf>,

    /// Replace figures that are already there
    #[arg(long, requires = "plot")]
    pub(super) force: bool,

    /// Print the recursion in LaTeX instead of the card
    #[arg(long)]
    pub(super) latex: bool,

    /// Print the weights and the recursion as Rust code instead of the card
    #[arg(long)]
    pub(super) rust: bool,

    /// Print the weights and the recursion as Python code instead of the card
    #[arg(long)]
    pub(super) python: bool,

    /// Print the source as a BibTeX entry instead of the card
    #[arg(long)]
    pub(super) bibtex: bool,
}

#[derive(Debug, Args)]
pub(super) struct FormulaCheck {
    /// A TOML file of rows (`kinstep schema formula` has its keys)
    pub(super) file: PathBuf,

    /// Compute the facts that rows do not declare, and print the finished rows
    #[arg(long)]
    pub(super) draft: bool,
}

#[derive(Debug, Subcommand)]
pub(super) enum RobotCommand {
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
    Fk(ChainArguments),
    /// Pose of a tip in a base, and the geometric Jacobian: twist (linear, angular) of the tip at its origin, in
    /// the base's axes, by joint
    #[command(
        after_help = "Example:\n  kinstep robot jacobian planar4 --base base --tip tip --q 0,pi/2,0,0 --json"
    )]
    Jacobian(ChainArguments),
    /// Joint positions that bring a tip to a pose, a position, or a position with a direction of its z axis, within the
    /// limits; exit 5, and the nearest place, if none are found
    #[command(after_help = "\
Examples:
  kinstep robot ik panda --base panda_link0 --tip panda_hand_tcp --position 0.5,0.1,0.3 --orientation pi,0,0
  kinstep robot ik ur5e --base base_link --tip tool0 --position 0.4,0.2,0.3 --axis 0,0,-1 --json
  kinstep robot ik planar4 --base base --tip tip --position 2,1 --q0 0.1,0.2,0.3,0.4

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
pub(super) struct RobotShow {
    #[command(flatten)]
    pub(super) file: RobotFile,

    /// Draw the robot instead: into a folder, a file per view, or all on one page when the name ends in .svg; numbers go
    /// beside as CSV
    #[arg(long, value_name = "DIR|FILE")]
    pub(super) plot: Option<PathBuf>,

    /// Joint positions of the drawing in rad or m: one for each joint that moves on its own, or some as NAME=VALUE; the
    /// others are 0
    #[arg(long, value_name = "Q,...", allow_hyphen_values = true, requires = "plot")]
    pub(super) q: Option<String>,

    /// Replace drawings that are already there
    #[arg(long, requires = "plot")]
    pub(super) force: bool,
}

#[derive(Debug, Args)]
pub(super) struct RobotExport {
    #[command(flatten)]
    pub(super) file: RobotFile,

    /// Write the URDF to this file; without it, or to -, it goes to standard output
    #[arg(long, value_name = "FILE", num_args = 0..=1, default_missing_value = "-")]
    pub(super) urdf: Option<PathBuf>,

    /// Replace a file that is already there
    #[arg(long, requires = "urdf")]
    pub(super) force: bool,
}

#[derive(Debug, Args)]
pub(super) struct RobotFile {
    /// A URDF file, a Denavit-Hartenberg table in TOML, or the name of a robot that comes with the program
    #[arg(value_name = "FILE")]
    pub(super) robot: String,

    /// Take joints without a limit element as unlimited instead of defective
    #[arg(long)]
    pub(super) assume_unlimited: bool,

    /// Take every attribute that URDF does not know as an error
    #[arg(long)]
    pub(super) strict: bool,

    /// A TOML file of corrections: tables [joint.NAME] with xyz, rpy, zero, reversed
    #[arg(long, value_name = "FILE")]
    pub(super) calibration: Option<PathBuf>,

    /// Hold a joint still, at a position in rad or m, or a floating, planar or spherical one at "x y z roll pitch yaw" or
    /// 0. May be given again
    #[arg(long, value_name = "JOINT=VALUE")]
    pub(super) lock: Vec<String>,
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

    /// Joint positions in path order in rad or m, separated by commas; expressions in pi are read
    #[arg(long, value_name = "Q,...", allow_hyphen_values = true)]
    pub(super) q: Option<String>,

    /// Pose of a tool in the tip, "x y z roll pitch yaw" in m and rad: the chain then ends there
    #[arg(long, value_name = "POSE", allow_hyphen_values = true)]
    pub(super) tool: Option<String>,
}

#[derive(Debug, Args)]
pub(super) struct InverseArguments {
    #[command(flatten)]
    pub(super) file: RobotFile,

    /// Link at which the chain begins
    #[arg(long, value_name = "LINK")]
    pub(super) base: String,

    /// Link at which the chain ends
    #[arg(long, value_name = "LINK")]
    pub(super) tip: String,

    /// Where the tip should be in the base's axes in m; of two numbers, x and y, z is free
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true)]
    pub(super) position: String,

    /// How it should be turned: roll, pitch and yaw about the base's axes in rad as in URDF, or a unit quaternion x,y,z,w
    #[arg(long, value_name = "R,P,Y", allow_hyphen_values = true)]
    pub(super) orientation: Option<String>,

    /// Where its z axis should point, in the base's axes; the turn about it is free
    #[arg(long, value_name = "X,Y,Z", allow_hyphen_values = true, conflicts_with = "orientation")]
    pub(super) axis: Option<String>,

    /// Joint positions that the answer should be near, in path order in rad or m
    #[arg(long, value_name = "Q,...", allow_hyphen_values = true)]
    pub(super) q0: Option<String>,

    /// Pose of a tool in the tip, "x y z roll pitch yaw" in m and rad: the chain then ends there
    #[arg(long, value_name = "POSE", allow_hyphen_values = true)]
    pub(super) tool: Option<String>,

    /// Starting places to try at most
    #[arg(long, default_value_t = 100)]
    pub(super) starts: usize,

    /// Seed of the starting places
    #[arg(long, default_value_t = 0)]
    pub(super) seed: u64,
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
