//! `kinstep robot`: what a URDF says, what is wrong with it, and the kinematics of its chains.

use std::fmt::Write;

use nalgebra::Vector6;
use serde::Serialize;

use super::arguments::{ChainArguments, RobotCommand, RobotFile};
use super::failure::{Exit, Failure};
use super::output::{Output, Show};
use crate::report::{Table, short};
use crate::robot::{Chain, Diagnostic, ReadError, Robot, Severity, UrdfOptions, embedded};
use crate::scenario::{RobotSource, evaluate};

pub(super) fn run(command: &RobotCommand, output: &mut Output) -> Result<Exit, Failure> {
    match command {
        RobotCommand::List => output.show(&RobotList::new()?).map(|()| Exit::Done),
        RobotCommand::Show(file) => output.show(&RobotCard::new(&read(file)?)).map(|()| Exit::Done),
        RobotCommand::Check(file) => check(file, output),
        RobotCommand::Fk(arguments) => output.show(&Kinematics::new(arguments, false)?).map(|()| Exit::Done),
        RobotCommand::Jacobian(arguments) => {
            output.show(&Kinematics::new(arguments, true)?).map(|()| Exit::Done)
        }
    }
}

fn options(file: &RobotFile) -> UrdfOptions {
    UrdfOptions { assume_unlimited: file.assume_unlimited, strict: file.strict, ..UrdfOptions::default() }
}

fn read(file: &RobotFile) -> Result<Robot, Failure> {
    let source = RobotSource::find(&file.robot, None)?;
    source.read(&options(file)).map_err(|e| source.refusal(&e).into())
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
                movable_joints: movable(&robot).count(),
                links: robot.links().len(),
                tips: robot.leaves().map(|link| link.name.clone()).collect(),
            })
        };
        Ok(Self { robots: embedded::names().into_iter().map(line).collect::<Result<_, Failure>>()? })
    }
}

fn movable(robot: &Robot) -> impl Iterator<Item = &crate::robot::Joint> {
    robot.joints().iter().filter(|joint| joint.kind.is_movable() && joint.mimic.is_none())
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
struct RobotCard {
    name: String,
    links: Vec<String>,
    roots: Vec<String>,
    tips: Vec<String>,
    joints: Vec<JointLine>,
    problems: Vec<Problem>,
}

/// One joint of a robot; a limit that is not known is null.
#[derive(Serialize)]
struct JointLine {
    name: String,
    kind: &'static str,
    parent: String,
    child: String,
    lower: Option<f64>,
    upper: Option<f64>,
    velocity: Option<f64>,
    mimics: Option<String>,
}

impl RobotCard {
    fn new(robot: &Robot) -> Self {
        let finite = |value: f64| Some(value).filter(|value| value.is_finite());
        let link = |index: usize| robot.links()[index].name.clone();
        let line = |joint: &crate::robot::Joint| JointLine {
            name: joint.name.clone(),
            kind: joint.kind.as_str(),
            parent: link(joint.parent),
            child: link(joint.child),
            lower: finite(joint.limits.lower),
            upper: finite(joint.limits.upper),
            velocity: finite(joint.limits.velocity),
            mimics: joint.mimic.map(|mimic| robot.joints()[mimic.driver].name.clone()),
        };
        Self {
            name: robot.name().to_owned(),
            links: robot.links().iter().map(|link| link.name.clone()).collect(),
            roots: robot.roots().map(|link| link.name.clone()).collect(),
            tips: robot.leaves().map(|link| link.name.clone()).collect(),
            joints: robot.joints().iter().map(line).collect(),
            problems: robot.diagnostics().iter().map(Problem::from).collect(),
        }
    }
}

impl Show for RobotCard {
    fn text(&self) -> String {
        let mut table = Table::new(["joint", "type", "from", "to", "lower", "upper", "velocity"]);
        let limit = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), short);
        let rotates = |joint: &&JointLine| joint.kind != "fixed";
        for joint in self.joints.iter().filter(rotates) {
            let kind = joint
                .mimics
                .as_ref()
                .map_or_else(|| joint.kind.to_owned(), |driver| format!("mimics {driver}"));
            let limits = [limit(joint.lower), limit(joint.upper), limit(joint.velocity)];
            table.row(
                [joint.name.clone(), kind, joint.parent.clone(), joint.child.clone()]
                    .into_iter()
                    .chain(limits),
            );
        }
        let fixed = self.joints.len() - self.joints.iter().filter(rotates).count();
        let mut text = format!(
            "{}: {} links, {} joints ({fixed} fixed, not shown); root {}; tips {}\n\n{table}\n\
             Limits in rad, rad/s (revolute) or m, m/s (prismatic); - where the file gives none.\n",
            self.name,
            self.links.len(),
            self.joints.len(),
            self.roots.join(", "),
            self.tips.join(", ")
        );
        let loud = self.problems.iter().filter(|problem| problem.severity != "note").count();
        if loud > 0 {
            let _ = writeln!(text, "{loud} problems in the file: see `kinstep robot check`.");
        }
        text
    }
}

#[derive(Serialize)]
struct Problem {
    severity: &'static str,
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
            let joints = robot.joints().iter().map(|joint| joint.name.clone()).collect();
            (robot.diagnostics().to_vec(), joints, robot.links().len())
        }
        Err(ReadError::Urdf { error, .. }) => (error.diagnostics().to_vec(), Vec::new(), 0),
        Err(error) => return Err(source.refusal(&error).into()),
    };
    let ok = found.iter().all(|problem| problem.severity != Severity::Error);
    let problems = found.iter().map(Problem::from).collect();
    output.show(&CheckResult { ok, problems, joints, links, label: source.label() })?;
    Ok(if ok { Exit::Done } else { Exit::Robot })
}

impl Show for CheckResult {
    fn text(&self) -> String {
        let mut text = String::new();
        for Problem { severity, line, column, message } in &self.problems {
            let _ = writeln!(text, "{}:{line}:{column}: {severity}: {message}", self.label);
        }
        let count = |severity| self.problems.iter().filter(|problem| problem.severity == severity).count();
        let verdict = if self.ok { "usable" } else { "defective" };
        let (errors, warnings, notes) = (count("error"), count("warning"), count("note"));
        let _ = writeln!(
            text,
            "{}: {verdict}; {} links, {} joints; {errors} errors, {warnings} warnings, {notes} notes",
            self.label,
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
    fn new(arguments: &ChainArguments, shows_jacobian: bool) -> Result<Self, Failure> {
        let ChainArguments { file, base, tip, q } = arguments;
        let robot = read(file)?;
        let chain = robot
            .chain(base, tip)
            .map_err(|e| Failure::new(Exit::Robot, e.to_string()).in_file(&file.robot))?;
        let q = joint_positions("--q", q.as_deref(), &chain)?;
        let mut scratch = chain.scratch();
        let posed = chain.forward(&q, &mut scratch);
        let pose = posed.pose();
        let mut columns = vec![Vector6::zeros(); chain.dof()];
        posed.geometric_jacobian(&mut columns);
        let rotation = pose.rotation.matrix();
        let numbers = pose.translation.vector.iter().chain(rotation).chain(columns.iter().flatten());
        if !numbers.copied().all(f64::is_finite) {
            let message = format!("the pose of `{tip}` at these positions is too large to be computed");
            return Err(Failure::new(Exit::Robot, message).in_file(&file.robot));
        }
        Ok(Self {
            joints: chain.joints().iter().map(|joint| joint.name.clone()).collect(),
            position: pose.translation.vector.into(),
            rotation: std::array::from_fn(|row| std::array::from_fn(|column| rotation[(row, column)])),
            jacobian: std::array::from_fn(|row| columns.iter().map(|column| column[row]).collect()),
            shows_jacobian,
            ends: [base.clone(), tip.clone()],
        })
    }
}

/// Reads one position per joint of the chain; a chain without joints needs none.
pub(super) fn joint_positions(option: &str, text: Option<&str>, chain: &Chain) -> Result<Vec<f64>, Failure> {
    let text = text.unwrap_or_default();
    let values = if text.trim().is_empty() { Vec::new() } else { numbers(option, text)? };
    if values.len() == chain.dof() {
        return Ok(values);
    }
    let names: Vec<&str> = chain.joints().iter().map(|joint| joint.name.as_str()).collect();
    let message = format!("{option}: expected {} ({}), got {}", chain.dof(), names.join(", "), values.len());
    Err(Failure::usage(message))
}

/// Reads numbers or expressions in pi, separated by commas.
pub(super) fn numbers(option: &str, text: &str) -> Result<Vec<f64>, Failure> {
    let values: Result<Vec<f64>, _> = text.split(',').map(str::trim).map(evaluate).collect();
    values.map_err(|e| Failure::usage(format!("{option} {text}: {e}")))
}

impl Show for Kinematics {
    fn text(&self) -> String {
        let [base, tip] = &self.ends;
        let number = |value: &f64| format!("{value:.9}");
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
