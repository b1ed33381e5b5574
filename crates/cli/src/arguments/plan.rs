//! Arguments of the commands that make, draw, hand on and check trajectories.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::OutArguments;
use kinstep_files::scenario::suggestion;
use kinstep_files::trajectory::{ColumnMap, Interpolation, KnownJoint, ReadOptions, TimeUnit};

#[derive(Debug, Args)]
#[expect(clippy::struct_excessive_bools, reason = "they are switches of a command")]
pub(crate) struct PlanArguments {
    /// The scenario, a TOML file (`kinstep schema scenario` has its keys)
    pub(crate) scenario: Option<PathBuf>,

    #[command(flatten)]
    pub(crate) written: OutArguments,

    /// Further formats of the trajectory, beside csv: npz, parquet, ros2, mcap, moveit, or all
    #[arg(long, value_name = "FORMAT,...", value_delimiter = ',', requires = "out")]
    pub(crate) format: Vec<String>,

    /// Add a deceleration to rest where a trajectory for controllers ends in motion
    #[arg(long, requires = "out")]
    pub(crate) append_stop: bool,

    /// Leave out report.html, the page with the replay and the figures
    #[arg(long, requires = "out")]
    pub(crate) no_report: bool,

    /// Draw the plan too, into the folder figures of --out: a picture a file, its numbers beside it as CSV
    #[arg(long, requires = "out")]
    pub(crate) figures: bool,

    /// Take the least duration that keeps the joints' limits of velocity, acceleration and jerk, in place of the scenario's
    #[arg(long)]
    pub(crate) fastest: bool,

    /// Lay a value over the scenario; arms by name. May be given again
    #[arg(long, value_name = "KEY.PATH=VALUE")]
    pub(crate) set: Vec<String>,
}

#[derive(Debug, Args)]
pub(crate) struct PlotArguments {
    /// The folder of kinstep plan --out or kinstep order --out, or the table of kinstep sweep --out
    #[arg(value_name = "SAVED")]
    pub(crate) saved: PathBuf,

    /// Which figures of a plan, separated by commas; all unless given
    #[arg(long, value_name = "NAME,...", value_delimiter = ',')]
    pub(crate) figure: Vec<String>,

    /// Only this arm. May be given again
    #[arg(long, value_name = "NAME")]
    pub(crate) arm: Vec<String>,

    /// Only this joint, where joints are drawn. May be given again
    #[arg(long, value_name = "NAME")]
    pub(crate) joint: Vec<String>,

    /// Begin at this time in s
    #[arg(long, value_name = "T", allow_hyphen_values = true, value_parser = time)]
    pub(crate) from: Option<f64>,

    /// End at this time in s
    #[arg(long, value_name = "T", allow_hyphen_values = true, value_parser = time)]
    pub(crate) to: Option<f64>,

    /// How wide and high each drawing is in pixels; as large as it needs to be unless given
    #[arg(long, value_name = "WxH", value_parser = size)]
    pub(crate) size: Option<(f64, f64)>,

    /// Formats, separated by commas
    #[arg(long, value_delimiter = ',', default_value = "svg")]
    pub(crate) format: Vec<PictureFormat>,

    /// Folder for the figures; the folder figures beside what was saved unless given
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,

    /// Replace files that are already there
    #[arg(long)]
    pub(crate) force: bool,
}

/// Formats of pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum PictureFormat {
    /// Scalable drawings
    Svg,
    /// Pixels, two for each of the drawing's own
    Png,
    /// A page
    Pdf,
}

impl PictureFormat {
    /// The end of its files' names.
    pub(crate) fn ending(self) -> &'static str {
        match self {
            Self::Svg => "svg",
            Self::Png => "png",
            Self::Pdf => "pdf",
        }
    }
}

fn interpolation(text: &str) -> Result<Interpolation, String> {
    let known = Interpolation::ALL.into_iter();
    known.clone().find(|known| known.name() == text).ok_or_else(|| {
        format!("there is no interpolation \"{text}\"; {}", suggestion(text, known.map(Interpolation::name)))
    })
}

fn time(text: &str) -> Result<f64, String> {
    let time = kinstep::math::evaluate(text).ok().filter(|time| time.is_finite());
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
pub(crate) struct ExportArguments {
    /// The folder that `plan --out` wrote, or a trajectory: a table, npz, MCAP, or messages as YAML or JSON
    #[arg(value_name = "DIR|TRAJECTORY")]
    pub(crate) trajectory: PathBuf,

    #[command(flatten)]
    pub(crate) robot: TrajectoryRobot,

    #[command(flatten)]
    pub(crate) reading: ReadingArguments,

    /// The formats: csv, npz, parquet, ros2, mcap, moveit, or all
    #[arg(long, value_name = "FORMAT,...", value_delimiter = ',', required = true)]
    pub(crate) format: Vec<String>,

    /// Folder for the files; without it they go beside the trajectory
    #[arg(long, value_name = "DIR")]
    pub(crate) out: Option<PathBuf>,

    /// Add a deceleration to rest where a trajectory for controllers ends in motion
    #[arg(long)]
    pub(crate) append_stop: bool,

    /// Replace files that are already there
    #[arg(long)]
    pub(crate) force: bool,
}

#[derive(Debug, Args)]
pub(crate) struct TrajectoryRobot {
    /// The robot of a lone trajectory: a file, or the name of one that comes with the program
    #[arg(long, value_name = "FILE")]
    pub(crate) robot: Option<String>,

    /// Link at which the arm begins
    #[arg(long, value_name = "LINK", requires = "robot", requires = "tip")]
    pub(crate) base: Option<String>,

    /// Link at which the arm ends
    #[arg(long, value_name = "LINK", requires = "robot", requires = "base")]
    pub(crate) tip: Option<String>,
}

/// How a file of others is read.
#[derive(Debug, Args)]
#[command(next_help_heading = "Files of others")]
pub(crate) struct ReadingArguments {
    /// Take these columns of a table and leave out all others: COLUMN=JOINT, COLUMN=JOINT.velocity, COLUMN=t, or a pattern with
    /// one * that stands for the joints' names or counts them in the robot's order, as in 'actual_q_*' or
    /// 'actual_qd_*=velocity'. May be given again
    #[arg(long, value_name = "COLUMNS[=TARGET]", allow_hyphen_values = true)]
    pub(crate) map: Vec<ColumnMap>,

    /// What the names of joints begin with in the file and not in the robot
    #[arg(long, value_name = "TEXT", allow_hyphen_values = true)]
    pub(crate) prefix: Option<String>,

    /// What the arm is called, where only one moves: the arm of a scenario that it is, or the name that is written
    #[arg(long, value_name = "NAME")]
    pub(crate) arm: Option<String>,

    /// The unit of the times: s, ms, us or ns; seconds, unless they are dates that can not be
    #[arg(long, value_name = "UNIT")]
    pub(crate) time_unit: Option<TimeUnit>,

    /// Angles are in degrees; convert them, and their rates
    #[arg(long)]
    pub(crate) degrees: bool,

    /// Undo turns of 2 pi of continuous joints whose angles were wrapped
    #[arg(long)]
    pub(crate) unwrap: bool,
}

impl ReadingArguments {
    /// The first of them that is given.
    pub(crate) fn given(&self) -> Option<&'static str> {
        let given = [
            ("--map", !self.map.is_empty()),
            ("--prefix", self.prefix.is_some()),
            ("--arm", self.arm.is_some()),
            ("--time-unit", self.time_unit.is_some()),
            ("--degrees", self.degrees),
            ("--unwrap", self.unwrap),
        ];
        given.into_iter().find_map(|(option, is_given)| is_given.then_some(option))
    }

    /// What they say, of a file in which these joints may move.
    pub(crate) fn options(&self, joints: Vec<KnownJoint>) -> ReadOptions {
        ReadOptions {
            map: self.map.clone(),
            prefix: self.prefix.clone(),
            time_unit: self.time_unit,
            degrees: self.degrees,
            unwrap: self.unwrap,
            joints,
        }
    }
}

#[derive(Debug, Args)]
pub(crate) struct CheckArguments {
    /// A trajectory: a table, npz, MCAP, or messages as YAML or JSON; or the folder that `plan --out` wrote
    #[arg(value_name = "TRAJECTORY|DIR")]
    pub(crate) trajectory: PathBuf,

    #[command(flatten)]
    pub(crate) robot: TrajectoryRobot,

    #[command(flatten)]
    pub(crate) reading: ReadingArguments,

    /// A scenario whose paths the tips should follow, arm by arm of the same name; its robots are taken unless --robot is given
    #[arg(long, value_name = "FILE")]
    pub(crate) scenario: Option<PathBuf>,

    /// A YAML file of joint limits that go over those of --robot (joint_limits, as in MoveIt's joint_limits.yaml)
    #[arg(long, value_name = "FILE", requires = "robot")]
    pub(crate) limits: Option<PathBuf>,

    /// How a controller moves between samples; unless given what they declare decides: quintic with velocities and
    /// accelerations, cubic with velocities, linear else
    #[arg(long, value_name = "linear|cubic|quintic", value_parser = interpolation)]
    pub(crate) interpolation: Option<Interpolation>,

    /// The largest task error that is allowed, in m and rad
    #[arg(long, value_name = "E", default_value_t = 1e-3)]
    pub(crate) max_error: f64,
}
