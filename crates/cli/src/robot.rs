//! `kinstep robot`: what a URDF says, what is wrong with it, and the kinematics of its chains.

use std::path::Path;

use std::fmt::Write;

use nalgebra::{IsometryMatrix3, Rotation3, Translation3, Vector6};
use serde::Serialize;

use super::arguments::{ChainArguments, KinematicsArguments, RobotCommand, RobotFile, RobotShow};
use super::failure::{Exit, Failure};
use super::output::{Output, Show};
use super::robot_show::RobotCard;
use super::shell::{option, quoted};
use super::{formula_plot, robot_export, robot_ik};
use kinstep::robot::names::{printable, quote};
use kinstep::robot::{
    Chain, ChainError, Diagnostic, ReadError, Robot, Severity, UrdfOptions, embedded, unbelievable,
};
use kinstep_files::scenario::{RobotSource, calibrated, evaluate, limited, suggestion, tool_name};
use kinstep_report::Table;
use kinstep_report::figure::robot_figures;

pub(super) fn run(command: &RobotCommand, output: &mut Output) -> Result<Exit, Failure> {
    match command {
        RobotCommand::List => output.show(&RobotList::new()?).map(|()| Exit::Done),
        RobotCommand::Show(arguments) => show(arguments, output),
        RobotCommand::Check(file) => check(file, output),
        RobotCommand::Fk(arguments) => kinematics(arguments, false, output),
        RobotCommand::Jacobian(arguments) => kinematics(arguments, true, output),
        RobotCommand::Export(arguments) => robot_export::run(arguments, output),
        RobotCommand::Ik(arguments) => robot_ik::run(arguments, output),
    }
}

fn options(file: &RobotFile) -> UrdfOptions {
    UrdfOptions { assume_unlimited: file.assume_unlimited, strict: file.strict, ..UrdfOptions::default() }
}

/// Returns the robot and what was asked to be done to it, as words of a command.
pub(super) fn robot_words(file: &RobotFile) -> String {
    let mut words = quoted(&file.robot);
    if file.assume_unlimited {
        words += " --assume-unlimited";
    }
    if file.strict {
        words += " --strict";
    }
    if let Some(calibration) = &file.calibration {
        words += &option("--calibration", &calibration.display().to_string());
    }
    if let Some(limits) = &file.limits {
        words += &option("--limits", &limits.display().to_string());
    }
    file.lock.iter().for_each(|lock| words += &option("--lock", lock));
    words
}

/// Reads a robot, calibrates it and holds its locked joints; with `--verbose`, what was found in the file is said.
pub(super) fn read(file: &RobotFile, output: &Output) -> Result<Robot, Failure> {
    let source = RobotSource::find(&file.robot, None)?;
    let robot = source.read(&options(file)).map_err(|e| source.refusal(&e))?;
    if output.is_verbose() {
        robot
            .diagnostics()
            .iter()
            .for_each(|found| output.remark(&format!("{}:{found}", printable(&source.label()))));
    }
    edited(robot, file, output)
}

/// Returns the robot with the limits of a file over its own, and says what has to be said of them.
pub(super) fn limited_by(robot: &Robot, file: &Path, output: &Output) -> Result<Robot, Failure> {
    let (robot, notes) = limited(robot, file)?;
    let label = file.display().to_string();
    for note in notes {
        output.aside(&printable(&format!("{label}:{note}")));
    }
    Ok(robot)
}

/// Returns the robot with the calibration, the limits and the locks that were asked for.
fn edited(robot: Robot, file: &RobotFile, output: &Output) -> Result<Robot, Failure> {
    let mut robot = robot;
    if let Some(calibration) = &file.calibration {
        robot = calibrated(&robot, calibration)?;
    }
    if let Some(limits) = &file.limits {
        robot = limited_by(&robot, limits, output)?;
    }
    for lock in &file.lock {
        let (joint, values) = lock.split_once('=').ok_or_else(|| {
            Failure::usage(format!("--lock {lock}: write JOINT=VALUE, for example --lock elbow=pi/2"))
        })?;
        let values = pose_numbers("--lock", lock, values)?;
        let refuse =
            |e: kinstep::robot::LockError| Failure::new(Exit::Robot, e.to_string()).in_file(&file.robot);
        let joint = joint.trim();
        let locked = robot.with_locked(joint, &values).map_err(refuse)?;
        if let Some(left) = robot.joint_followed_by(joint) {
            let (joint, left) = (quote(joint), quote(&left.name));
            output.aside(&format!(
                "note: joint {joint} is locked and follows {left} no longer; {left} moves without it"
            ));
        }
        robot = locked;
    }
    Ok(robot)
}

/// Reads numbers or expressions in pi, separated by commas or blanks.
fn pose_numbers(option: &str, given: &str, text: &str) -> Result<Vec<f64>, Failure> {
    let parts = text.split([',', ' ', '\t']).filter(|part| !part.is_empty());
    let values: Result<Vec<f64>, _> = parts.map(evaluate).collect();
    values.map_err(|e| Failure::usage(format!("{option} {given}: {e}")))
}

fn show(arguments: &RobotShow, output: &mut Output) -> Result<Exit, Failure> {
    let robot = read(&arguments.file, output)?;
    let positions = all_positions(arguments.q.as_deref(), &robot)?;
    let Some(path) = &arguments.plot else {
        return output.show(&RobotCard::new(&robot, robot_words(&arguments.file))).map(|()| Exit::Done);
    };
    let figures = robot_figures(&robot, &positions);
    let written = formula_plot::draw(path, arguments.force, robot.name(), &figures)?;
    if output.wants_json() {
        output.json(&serde_json::json!({ "written": written }))?;
    } else {
        output.report(&format!("wrote {}\n", written.join(", ")))?;
    }
    Ok(Exit::Done)
}

/// Reads positions of the whole robot: one for each joint that moves on its own, in the order of `robot show`, or some of
/// them by name; the others are 0.
fn all_positions(text: Option<&str>, robot: &Robot) -> Result<Vec<f64>, Failure> {
    let mut positions = vec![0.0; robot.joints().len()];
    let Some(text) = text.filter(|text| !text.trim().is_empty()) else { return Ok(positions) };
    let moving: Vec<&str> = robot.movable_joints().map(|joint| joint.name.as_str()).collect();
    let place = |name: &str| robot.joints().iter().position(|joint| joint.name == name);
    let parts: Vec<&str> = text.split(',').map(str::trim).collect();
    let is_named = parts.iter().all(|part| part.contains('='));
    if !is_named && parts.len() != moving.len() {
        let (count, got) = (moving.len(), parts.len());
        let names = moving.join(", ");
        let message = format!("--q: expected {count} ({names}), or some of them as NAME=VALUE, got {got}");
        return Err(Failure::usage(message));
    }
    let mut given: Vec<&str> = Vec::new();
    for (part, name) in parts.iter().zip(moving.iter().copied().chain(std::iter::repeat(""))) {
        let (name, value) = part.split_once('=').map_or((name, *part), |(name, value)| (name.trim(), value));
        if !moving.contains(&name) {
            let hint = suggestion(name, moving.iter().copied());
            return Err(Failure::usage(format!("--q: no joint \"{name}\" moves on its own; {hint}")));
        }
        if given.contains(&name) {
            return Err(Failure::usage(format!("--q {text}: joint {} is given twice", quote(name))));
        }
        given.push(name);
        let value = evaluate(value).map_err(|e| Failure::usage(format!("--q {text}: {e}")))?;
        if let Some(index) = place(name) {
            positions[index] = value;
        }
    }
    Ok(positions)
}

fn kinematics(arguments: &KinematicsArguments, jacobian: bool, output: &mut Output) -> Result<Exit, Failure> {
    let result = Kinematics::new(arguments, jacobian, output)?;
    output.show(&result).map(|()| Exit::Done)
}

#[derive(Serialize)]
struct RobotList {
    robots: Vec<RobotLine>,
}

#[derive(Serialize)]
struct RobotLine {
    name: &'static str,
    movable_joints: usize,
    links: usize,
    tips: Vec<String>,
}

impl RobotList {
    fn new() -> Result<Self, Failure> {
        let line = |name: &'static str| {
            let robot = embedded::get(name).map_err(|e| Failure::new(Exit::Robot, e.to_string()))?;
            Ok(RobotLine {
                name,
                movable_joints: robot.movable_joints().count(),
                links: robot.links().len(),
                tips: robot.leaves().map(|link| link.name.clone()).collect(),
            })
        };
        Ok(Self { robots: embedded::names().into_iter().map(line).collect::<Result<_, Failure>>()? })
    }
}

impl Show for RobotList {
    fn text(&self) -> String {
        let mut table = Table::new(["robot", "joints", "links", "tips"]);
        for robot in &self.robots {
            let tips = robot.tips.join(", ");
            table.row([
                robot.name.to_owned(),
                robot.movable_joints.to_string(),
                robot.links.to_string(),
                tips,
            ]);
        }
        format!(
            "{table}\n`kinstep robot show NAME` shows joints and limits; any .urdf file will do in place of a name.\n"
        )
    }
}

#[derive(Serialize)]
pub(super) struct Problem {
    pub(super) severity: &'static str,
    line: usize,
    column: usize,
    message: String,
}

impl From<&Diagnostic> for Problem {
    fn from(found: &Diagnostic) -> Self {
        let Diagnostic { severity, line, column, message, .. } = found;
        Self { severity: severity.as_str(), line: *line, column: *column, message: message.clone() }
    }
}

#[derive(Serialize)]
struct CheckResult {
    ok: bool,
    problems: Vec<Problem>,
    joints: Vec<String>,
    links: usize,
    #[serde(skip)]
    label: String,
}

fn check(file: &RobotFile, output: &mut Output) -> Result<Exit, Failure> {
    let source = RobotSource::find(&file.robot, None)?;
    let (found, joints, links) = match source.read(&options(file)) {
        Ok(robot) => {
            edited(robot.clone(), file, output)?;
            let joints = robot.joints().iter().map(|joint| joint.name.clone()).collect();
            (robot.diagnostics().to_vec(), joints, robot.links().len())
        }
        Err(error @ ReadError::File { .. }) => return Err(source.refusal(&error).into()),
        Err(error) => (found_in(&error), Vec::new(), 0),
    };
    let ok = found.iter().all(|problem| problem.severity != Severity::Error);
    let problems = found.iter().map(Problem::from).collect();
    if output.is_quiet() {
        let important = found.iter().filter(|problem| problem.severity != Severity::Note);
        important.for_each(|problem| output.remark(&format!("{}:{problem}", printable(&source.label()))));
    }
    output.show(&CheckResult { ok, problems, joints, links, label: source.label() })?;
    Ok(if ok { Exit::Done } else { Exit::Robot })
}

/// What was found in a file that makes no robot; there is always something.
fn found_in(error: &ReadError) -> Vec<Diagnostic> {
    let found = error.diagnostics().to_vec();
    if found.is_empty() { vec![Diagnostic::error(1, 1, error.to_string())] } else { found }
}

impl Show for CheckResult {
    fn text(&self) -> String {
        let mut text = String::new();
        let label = printable(&self.label);
        for Problem { severity, line, column, message } in &self.problems {
            let _ = writeln!(text, "{label}:{line}:{column}: {severity}: {message}");
        }
        let count = |severity| self.problems.iter().filter(|problem| problem.severity == severity).count();
        let verdict = if self.ok { "usable" } else { "defective" };
        let (errors, warnings, notes) = (count("error"), count("warning"), count("note"));
        let _ = writeln!(
            text,
            "{label}: {verdict}; {} links, {} joints; {errors} errors, {warnings} warnings, {notes} notes",
            self.links,
            self.joints.len()
        );
        text
    }
}

/// Pose and Jacobian of a chain.
#[derive(Serialize)]
struct Kinematics {
    joints: Vec<String>,
    position: [f64; 3],
    rotation: [[f64; 3]; 3],
    jacobian: [Vec<f64>; 6],
    #[serde(skip)]
    shows_jacobian: bool,
    #[serde(skip)]
    ends: [String; 2],
}

impl Kinematics {
    fn new(arguments: &KinematicsArguments, shows_jacobian: bool, output: &Output) -> Result<Self, Failure> {
        let ChainArguments { file, base, .. } = &arguments.chain;
        let (chain, tip) = tooled_chain(&arguments.chain, output)?;
        let q = joint_positions("--q", arguments.q.as_deref(), &chain)?;
        let mut scratch = chain.scratch();
        let posed = chain.forward(&q, &mut scratch);
        let pose = posed.pose();
        let mut columns = vec![Vector6::zeros(); chain.dof()];
        posed.geometric_jacobian(&mut columns);
        let rotation = pose.rotation.matrix();
        let numbers = pose.translation.vector.iter().chain(rotation).chain(columns.iter().flatten());
        if !numbers.copied().all(f64::is_finite) {
            let message =
                format!("the pose of {} at these positions is too large to be computed", quote(&tip));
            return Err(Failure::new(Exit::Robot, message).in_file(&file.robot));
        }
        Ok(Self {
            joints: chain.joints().iter().map(|joint| joint.name.clone()).collect(),
            position: pose.translation.vector.into(),
            rotation: std::array::from_fn(|row| std::array::from_fn(|column| rotation[(row, column)])),
            jacobian: std::array::from_fn(|row| columns.iter().map(|column| column[row]).collect()),
            shows_jacobian,
            ends: [base.clone(), tip],
        })
    }
}

/// Returns the chain between two links of a robot, with a tool on the tip, and the link at which it then ends.
pub(super) fn tooled_chain(arguments: &ChainArguments, output: &Output) -> Result<(Chain, String), Failure> {
    let ChainArguments { file, base, tip, tool } = arguments;
    let (robot, tip) = tooled(read(file, output)?, tip, tool.as_deref())?;
    let chain = robot.chain(base, &tip).map_err(|e| {
        let is_free = matches!(e, ChainError::UnsupportedJoint { .. });
        let remedy = if is_free { ", or hold the joint still with --lock JOINT=0" } else { "" };
        Failure::new(Exit::Robot, format!("{e}{remedy}")).in_file(&file.robot)
    })?;
    Ok((chain, tip))
}

/// Returns the robot with a tool on `tip`, and the link at which the chain then ends.
fn tooled(robot: Robot, tip: &str, tool: Option<&str>) -> Result<(Robot, String), Failure> {
    let Some(text) = tool.filter(|_| robot.link(tip).is_some()) else { return Ok((robot, tip.to_owned())) };
    let numbers = believable("--tool", pose_numbers("--tool", text, text)?)?;
    let [x, y, z, roll, pitch, yaw] = numbers[..] else {
        let got = numbers.len();
        return Err(Failure::usage(format!("--tool: expected 6 numbers x y z roll pitch yaw, got {got}")));
    };
    let turn = Rotation3::from_euler_angles(roll, pitch, yaw);
    let pose = IsometryMatrix3::from_parts(Translation3::new(x, y, z), turn);
    let name = tool_name(&robot, tip);
    let robot = robot.with_tool(tip, &name, &pose).map_err(|e| Failure::new(Exit::Robot, e.to_string()))?;
    Ok((robot, name))
}

/// Reads one position per joint of the chain; a chain without joints needs none.
pub(super) fn joint_positions(option: &str, text: Option<&str>, chain: &Chain) -> Result<Vec<f64>, Failure> {
    let text = text.unwrap_or_default();
    let values = if text.trim().is_empty() { Vec::new() } else { numbers(option, text)? };
    chain.check_positions(&values).map_err(|e| Failure::usage(format!("{option}: {e}")))?;
    Ok(values)
}

/// Refuses lengths and angles that no arm has.
pub(super) fn believable(option: &str, values: Vec<f64>) -> Result<Vec<f64>, Failure> {
    match values.iter().find_map(|&value| unbelievable(value)) {
        Some(problem) => Err(Failure::usage(format!("{option}: {problem}"))),
        None => Ok(values),
    }
}

/// Reads numbers or expressions in pi, separated by commas.
pub(super) fn numbers(option: &str, text: &str) -> Result<Vec<f64>, Failure> {
    let values: Result<Vec<f64>, _> = text.split(',').map(str::trim).map(evaluate).collect();
    values.map_err(|e| Failure::usage(format!("{option} {text}: {e}")))
}

impl Show for Kinematics {
    fn text(&self) -> String {
        let [base, tip] = &self.ends;
        let number = |value: &f64| format!("{value:.9}").replace("-0.000000000", "0.000000000");
        let mut pose = Table::new([format!("{tip} in {base}"), "position [m]".into(), "rotation".into()]);
        for (axis, (position, row)) in ["x", "y", "z"].iter().zip(self.position.iter().zip(&self.rotation)) {
            pose.row([(*axis).to_owned(), number(position)].into_iter().chain(row.iter().map(number)));
        }
        if !self.shows_jacobian {
            return pose.to_string();
        }
        let heading = std::iter::once("per joint".to_owned()).chain(self.joints.iter().cloned());
        let mut jacobian = Table::new(heading);
        for (name, row) in ["vx", "vy", "vz", "wx", "wy", "wz"].iter().zip(&self.jacobian) {
            jacobian.row(std::iter::once((*name).to_owned()).chain(row.iter().map(number)));
        }
        format!("{pose}\n{jacobian}")
    }
}
