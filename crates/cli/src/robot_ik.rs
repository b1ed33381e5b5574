//! `kinstep robot ik`: joint positions for a pose.

use std::fmt::Write;

use nalgebra::{IsometryMatrix3, Quaternion, Rotation3, Translation3, Unit, UnitQuaternion, Vector3};
use serde::Serialize;

use super::arguments::{ChainArguments, InverseArguments, InverseTask};
use super::failure::{Exit, Failure};
use super::output::{Output, Show};
use super::robot::{believable, joint_positions, numbers, robot_words, tooled_chain};
use super::shell::option;
use kinstep::inverse::{Search, Solution, Target};
use kinstep::robot::{Chain, degrees_suspected};
use kinstep_report::{Table, short};

/// Below this a position counts as zero in the text [rad or m]: no double that stands beside a 1 has a place for it.
const NOTHING: f64 = 1e-16;

pub(super) fn run(arguments: &InverseArguments, output: &mut Output) -> Result<Exit, Failure> {
    let (chain, _) = tooled_chain(&arguments.chain, output)?;
    let (target, conditions) = target(arguments)?;
    question_units(arguments, output);
    let mut search = Search::new().starts(arguments.starts).seed(arguments.seed);
    if let Some(q0) = &arguments.q0 {
        search = search.near(&joint_positions("--q0", Some(q0), &chain)?);
    }
    let solution = search.solve(&chain, &target).map_err(|e| Failure::usage(e.to_string()))?;
    output.show(&Answer::new(arguments, &chain, &solution, conditions))?;
    Ok(if solution.is_found() { Exit::Done } else { Exit::Stopped })
}

/// The target, and how many conditions it is.
fn target(arguments: &InverseArguments) -> Result<(Target, usize), Failure> {
    let position = sizes("--position", &arguments.position)?;
    let is_turned = arguments.orientation.is_some() || arguments.axis.is_some();
    let task = arguments.task;
    let place = match position[..] {
        [x, y] if !is_turned && task.is_none_or(|task| task == InverseTask::PositionXy) => {
            return Ok((Target::position_xy(x, y), 2));
        }
        [x, y, _] if task == Some(InverseTask::PositionXy) => return Ok((Target::position_xy(x, y), 2)),
        [x, y, z] => Vector3::new(x, y, z),
        _ => {
            return Err(expected(
                "--position",
                "three numbers, or x and y without an orientation",
                &position,
            ));
        }
    };
    let axis = arguments.axis.as_deref().map(direction).transpose()?;
    let turn = arguments.orientation.as_deref().map(rotation).transpose()?;
    match (task, axis, turn) {
        (Some(InverseTask::Position), ..) | (None, None, None) => Ok((Target::position(place), 3)),
        (Some(InverseTask::Axis) | None, Some(axis), _) => Ok((Target::axis(place, axis), 5)),
        (Some(InverseTask::Axis), None, Some(turn)) => {
            Ok((Target::axis(place, Unit::new_normalize(turn * Vector3::z())), 5))
        }
        (Some(InverseTask::Pose) | None, _, Some(turn)) => {
            Ok((Target::pose(&IsometryMatrix3::from_parts(Translation3::from(place), turn)), 6))
        }
        (Some(_), ..) => {
            Err(Failure::usage("--task: it needs an --orientation (or, for `axis`, an --axis)".to_owned()))
        }
    }
}

/// Says that an orientation looks like degrees.
fn question_units(arguments: &InverseArguments, output: &Output) {
    let Some(text) = &arguments.orientation else { return };
    let angles = numbers("--orientation", text).unwrap_or_default();
    if let Some(doubt) = degrees_suspected(&angles).filter(|_| angles.len() == 3) {
        output.remark(&format!("warning: --orientation {text}: {doubt}"));
    }
}

fn direction(text: &str) -> Result<Unit<Vector3<f64>>, Failure> {
    let axis = sizes("--axis", text)?;
    let &[x, y, z] = &axis[..] else { return Err(expected("--axis", "three numbers", &axis)) };
    Unit::try_new(Vector3::new(x, y, z), f64::MIN_POSITIVE).ok_or_else(|| {
        Failure::usage(format!("--axis {text}: it points nowhere; give a direction such as 0,0,-1"))
    })
}

fn rotation(text: &str) -> Result<Rotation3<f64>, Failure> {
    let given = sizes("--orientation", text)?;
    match given[..] {
        [roll, pitch, yaw] => Ok(Rotation3::from_euler_angles(roll, pitch, yaw)),
        [x, y, z, w] => {
            let quaternion = Quaternion::new(w, x, y, z);
            let length = quaternion.norm();
            if (length - 1.0).abs() > 1e-3 {
                let problem = "its length is not 1; give a unit quaternion x,y,z,w";
                return Err(Failure::usage(format!(
                    "--orientation {text}: {problem} (this has {})",
                    short(length)
                )));
            }
            Ok(UnitQuaternion::new_normalize(quaternion).to_rotation_matrix())
        }
        _ => {
            let wanted = "three numbers (roll, pitch, yaw) or four (a quaternion x,y,z,w)";
            Err(expected("--orientation", wanted, &given))
        }
    }
}

fn expected(option: &str, wanted: &str, got: &[f64]) -> Failure {
    Failure::usage(format!("{option}: expected {wanted}, got {}", got.len()))
}

/// Reads lengths or angles that an arm may have.
fn sizes(option: &str, text: &str) -> Result<Vec<f64>, Failure> {
    believable(option, numbers(option, text)?)
}

/// Where the search ended; a limit that is not known is null.
#[derive(Serialize)]
struct Answer {
    found: bool,
    joints: Vec<String>,
    q: Vec<f64>,
    distance: f64,
    position_error: f64,
    orientation_error: f64,
    position: [f64; 3],
    rotation: [[f64; 3]; 3],
    starts: usize,
    conditions: usize,
    #[serde(skip)]
    orientation_counts: bool,
    #[serde(skip)]
    limits: Vec<[f64; 2]>,
    #[serde(skip)]
    again: String,
}

impl Answer {
    fn new(arguments: &InverseArguments, chain: &Chain, solution: &Solution, conditions: usize) -> Self {
        let rotation = solution.tip.rotation.matrix();
        let q: Vec<String> = solution.q.iter().map(|&q| or_zero(q).to_string()).collect();
        Self {
            found: solution.is_found(),
            joints: chain.joints().iter().map(|joint| joint.name.clone()).collect(),
            q: solution.q.clone(),
            distance: solution.distance(),
            position_error: solution.position_error(),
            orientation_error: solution.orientation_error(),
            position: solution.tip.translation.vector.into(),
            rotation: std::array::from_fn(|row| std::array::from_fn(|column| rotation[(row, column)])),
            starts: solution.starts,
            conditions,
            orientation_counts: conditions > 3,
            limits: chain.position_limits().map(|(lower, upper)| [lower, upper]).collect(),
            again: again(&arguments.chain, &q.join(",")),
        }
    }
}

/// The number, or the zero that a person expects where rounding left something smaller than any angle or length.
fn or_zero(number: f64) -> f64 {
    if number.abs() < NOTHING { 0.0 } else { number }
}

/// The command that gives the pose at the joint positions `q` of the same chain.
fn again(chain: &ChainArguments, q: &str) -> String {
    let ChainArguments { file, base, tip, tool } = chain;
    let mut command = format!("kinstep robot fk {}", robot_words(file));
    command += &(option("--base", base) + &option("--tip", tip));
    if let Some(tool) = tool {
        command += &option("--tool", tool);
    }
    command + &format!(" --q={q}")
}

impl Answer {
    /// The tasks with fewer conditions.
    fn masks(&self) -> String {
        let axis = "--task axis leaves the turn about the tip's z free (5 conditions)";
        let position = "--task position the whole orientation (3)";
        match self.conditions {
            6 => format!("{axis}, {position}"),
            5 => position.to_owned(),
            _ => "--task position-xy leaves z free (2)".to_owned(),
        }
    }
}

impl Show for Answer {
    fn text(&self) -> String {
        let mut text = String::new();
        let mut away = format!("{} m away", short(self.position_error));
        if self.orientation_counts {
            away = format!("{} m and {} rad away", short(self.position_error), short(self.orientation_error));
        }
        let _ = if self.found {
            writeln!(text, "Found; the tip is {away}. Starting places tried: {}.", self.starts)
        } else {
            let place = self.position.map(|entry| format!("{entry:.4}")).join(", ");
            writeln!(
                text,
                "Not reached within the limits: the nearest of {} tries is {away}, with the tip at ({place}) m.",
                self.starts
            )
        };
        let joints = self.joints.len();
        if !self.found && joints < self.conditions {
            let _ = writeln!(
                text,
                "{joints} joints can not meet {} conditions in general; ask for less: {}.",
                self.conditions,
                self.masks()
            );
        }
        let mut table = Table::new(["joint", "position", "lower", "upper"]);
        let limit = |value: f64| if value.is_finite() { short(value) } else { "-".to_owned() };
        for ((joint, q), [lower, upper]) in self.joints.iter().zip(&self.q).zip(&self.limits) {
            table.row([joint.clone(), format!("{:.9}", or_zero(*q)), limit(*lower), limit(*upper)]);
        }
        let _ = write!(text, "\n{table}\nPositions in rad or m. To check:\n  {}\n", self.again);
        text
    }
}
