//! `kinstep check`: a trajectory of whatever planner, held against a robot, itself and the path it should follow.

use std::fmt::Write;
use std::path::Path;

use nalgebra::Vector6;
use serde::Serialize;

use super::arguments::CheckArguments;
use super::export;
use super::failure::{Exit, Failure};
use super::output::{Output, Show};
use super::share_out::{Shares, share_out};
use super::stopped::Stopped;
use kinstep::planner::Arm;
use kinstep::robot::{Limits, Robot};
use kinstep_files::scenario::{ScenarioText, TaskSpec};
use kinstep_files::trajectory::{ArmTrajectory, JointFigures, Met, TimeFigures, Trajectory};
use kinstep_report::{Table, short};

#[derive(Serialize)]
struct Checked {
    ok: bool,
    samples: usize,
    duration: f64,
    time: Clock,
    arms: Vec<ArmChecked>,
    /// The arms of the scenario whose machines do not move here.
    absent: Vec<String>,
    /// The tasks over several tips, which are not checked.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    unchecked: Vec<String>,
    /// What failed, as sentences.
    failures: Vec<String>,
}

#[derive(Serialize)]
struct Clock {
    gap: f64,
    smallest_gap: f64,
    largest_gap: f64,
    even: bool,
    repeated_samples: usize,
}

#[derive(Serialize)]
struct ArmChecked {
    name: String,
    joints: Vec<JointChecked>,
    limits: LimitsChecked,
    continuous: bool,
    velocities_agree: Option<bool>,
    starts_at_rest: bool,
    ends_at_rest: bool,
    /// The worst norm of the task error, where there is a path to follow.
    max_error: Option<f64>,
    max_error_at: Option<f64>,
}

#[derive(Serialize)]
struct LimitsChecked {
    ok: bool,
    violations: Vec<Crossing>,
}

#[derive(Serialize)]
struct Crossing {
    joint: String,
    kind: &'static str,
    t: f64,
    value: f64,
    limit: f64,
}

#[derive(Serialize)]
struct JointChecked {
    joint: String,
    lowest: f64,
    highest: f64,
    velocity: Option<f64>,
    mean_velocity: f64,
    acceleration: f64,
    jerk: f64,
    velocity_disagreement: Option<f64>,
    jumps: usize,
}

impl From<&JointFigures> for JointChecked {
    fn from(figures: &JointFigures) -> Self {
        let size = |met: Met| met.value.abs();
        Self {
            joint: figures.joint.clone(),
            lowest: figures.positions[0],
            highest: figures.positions[1],
            velocity: figures.velocity.map(size),
            mean_velocity: size(figures.mean_velocity),
            acceleration: size(figures.acceleration),
            jerk: size(figures.jerk),
            velocity_disagreement: figures.disagreement.map(size),
            jumps: figures.jumps.len(),
        }
    }
}

/// What a trajectory is held against.
struct Against {
    trajectory: Trajectory,
    /// Limits in the order of each arm's joints.
    limits: Vec<Vec<Limits>>,
    /// The arm whose path each arm should follow.
    paths: Vec<Option<Arm>>,
    /// The arms of the scenario that are not in the trajectory.
    absent: Vec<String>,
    /// The tasks over several tips, which are not checked.
    unchecked: Vec<String>,
}

pub(super) fn run(arguments: &CheckArguments, output: &mut Output) -> Result<Exit, Failure> {
    if !(arguments.max_error > 0.0) {
        let got = arguments.max_error;
        return Err(Failure::usage(format!("--max-error: expected a length above 0, got {got}")));
    }
    let stopped = Stopped::check(&arguments.trajectory)?;
    let mut checked = Against::of(arguments)?.checked(arguments.max_error);
    if let Some(stopped) = stopped {
        checked.ok = false;
        checked.failures.insert(0, stopped.sentence);
    }
    output.show(&checked)?;
    Ok(if checked.ok { Exit::Done } else { Exit::CheckFailed })
}

impl Against {
    fn of(arguments: &CheckArguments) -> Result<Self, Failure> {
        let (mut trajectory, _) = export::load(&arguments.trajectory, &arguments.robot)?;
        let own = arguments.trajectory.join("scenario.toml");
        let folder = arguments.trajectory.is_dir().then_some(own.as_path());
        let (arms, unchecked) = match arguments.scenario.as_deref().or(folder) {
            Some(file) => scenario_arms(file)?,
            None => (Vec::new(), Vec::new()),
        };
        let robot = arguments.robot.robot.as_deref();
        let robot = robot.map(|name| Ok::<_, Failure>((name, export::robot(name)?))).transpose()?;
        let Shares { moved, absent } = share_out(&trajectory.arms, arms, robot.is_some())?;
        let paths: Vec<Option<Arm>>;
        (trajectory.arms, paths) = moved.into_iter().unzip();
        let mut limits = Vec::new();
        for (arm, path) in trajectory.arms.iter().zip(&paths) {
            limits.push(match (&robot, path) {
                (Some((name, robot)), _) => limits_of(arm, robot, name)?,
                (None, Some(path)) => path.chain().joints().iter().map(|joint| joint.limits).collect(),
                (None, None) => {
                    return Err(Failure::usage(
                        "name the robot that moves: --robot FILE, or --scenario FILE",
                    ));
                }
            });
        }
        Ok(Self { trajectory, limits, paths, absent, unchecked })
    }

    fn checked(&self, max_error: f64) -> Checked {
        let times = &self.trajectory.times;
        let clock = TimeFigures::of(&self.trajectory);
        let mut failures: Vec<String> = clock
            .repeated
            .map(|(count, t)| {
                format!("{count} samples repeat the one before in mid-motion, first at t = {} s", moment(t))
            })
            .into_iter()
            .collect();
        let mut arms = Vec::new();
        for ((arm, limits), path) in self.trajectory.arms.iter().zip(&self.limits).zip(&self.paths) {
            let figures = arm.inspect(times, limits);
            let error = path.as_ref().map(|path| worst_error(arm, path, times));
            failures.extend(failed(&arm.name, &figures, error, max_error));
            arms.push(ArmChecked::new(&arm.name, &figures, error));
        }
        Checked {
            ok: failures.is_empty(),
            samples: times.len(),
            duration: times[times.len() - 1] - times[0],
            time: Clock {
                gap: clock.gap,
                smallest_gap: clock.gaps[0].value,
                largest_gap: clock.gaps[1].value,
                even: clock.is_even,
                repeated_samples: clock.repeated.map_or(0, |(count, _)| count),
            },
            arms,
            absent: self.absent.clone(),
            unchecked: self.unchecked.clone(),
            failures,
        }
    }
}

/// The arms of a scenario, and its tasks over several tips.
fn scenario_arms(file: &Path) -> Result<(Vec<Arm>, Vec<String>), Failure> {
    let text = ScenarioText::read(file)?;
    let scenario = text.scenario()?;
    let name = |task: &TaskSpec| format!("{} of {}", task.kind, task.arms.join(", "));
    let tasks = scenario.task.iter().map(name).collect();
    Ok((scenario.arms(text.folder()).map_err(|e| text.placed(e))?, tasks))
}

/// The limits of a robot's joints by their names.
fn limits_of(arm: &ArmTrajectory, robot: &Robot, name: &str) -> Result<Vec<Limits>, Failure> {
    let known: Vec<&str> = robot.movable_joints().map(|joint| joint.name.as_str()).collect();
    arm.joints
        .iter()
        .map(|joint| {
            export::check_joint(joint, &known, name)?;
            Ok(robot.joint(joint).map_or(Limits::UNLIMITED, |joint| joint.limits))
        })
        .collect()
}

fn worst_error(arm: &ArmTrajectory, path: &Arm, times: &[f64]) -> Met {
    let errors = arm.task_errors(path, times);
    // The way to the path is not the path; of an arm that never comes there all counts.
    let first = Some(path.on_path_from(times, &errors)).filter(|&first| first < times.len()).unwrap_or(0);
    let mut worst = Met { value: 0.0, t: times[first] };
    for (error, &t) in errors.iter().map(Vector6::norm).zip(times).skip(first) {
        if !(error <= worst.value) {
            worst = Met { value: error, t };
        }
    }
    worst
}

/// A time without the digits that a sum of gaps leaves behind.
fn moment(t: f64) -> String {
    format!("{t:.6}").trim_end_matches('0').trim_end_matches('.').to_owned()
}

/// What failed of an arm, as sentences.
fn failed(arm: &str, figures: &[JointFigures], error: Option<Met>, max_error: f64) -> Vec<String> {
    let mut failures = Vec::new();
    for figures in figures {
        let joint = &figures.joint;
        for crossed in &figures.violations {
            let (kind, value, limit) = (crossed.kind.name(), short(crossed.value), short(crossed.limit));
            failures.push(format!(
                "{arm}.{joint}: {kind} {value} crosses its limit {limit} at t = {} s",
                moment(crossed.t)
            ));
        }
        for jump in &figures.jumps {
            failures.push(format!(
                "{arm}.{joint}: jumps by {} at t = {} s",
                short(jump.value),
                moment(jump.t)
            ));
        }
        if let Some(apart) = figures.disagreement.filter(|_| !figures.agrees()) {
            failures.push(format!(
                "{arm}.{joint}: the declared velocity differs by {} from that of the positions at t = {} s",
                short(apart.value),
                moment(apart.t)
            ));
        }
    }
    for (end, word) in ["starts", "ends"].iter().enumerate() {
        let moving = figures.iter().filter(|figures| !figures.rests()[end]);
        let fastest = moving.max_by(|a, b| a.ends[end].abs().total_cmp(&b.ends[end].abs()));
        if let Some(fastest) = fastest {
            let velocity = short(fastest.ends[end]);
            failures.push(format!("{arm}: {word} in motion, {} at {velocity}", fastest.joint));
        }
    }
    if let Some(error) = error.filter(|error| !(error.value <= max_error)) {
        let (value, bound) = (short(error.value), short(max_error));
        failures.push(format!(
            "{arm}: a task error of {value} at t = {} s, above --max-error {bound}",
            moment(error.t)
        ));
    }
    failures
}

impl ArmChecked {
    fn new(name: &str, figures: &[JointFigures], error: Option<Met>) -> Self {
        let violations: Vec<Crossing> = figures
            .iter()
            .flat_map(|figures| &figures.violations)
            .map(|found| Crossing {
                joint: found.joint.clone(),
                kind: found.kind.name(),
                t: found.t,
                value: found.value,
                limit: found.limit,
            })
            .collect();
        let declares = figures.iter().any(|figures| figures.velocity.is_some());
        Self {
            name: name.to_owned(),
            joints: figures.iter().map(JointChecked::from).collect(),
            limits: LimitsChecked { ok: violations.is_empty(), violations },
            continuous: figures.iter().all(|figures| figures.jumps.is_empty()),
            velocities_agree: declares.then(|| figures.iter().all(JointFigures::agrees)),
            starts_at_rest: figures.iter().all(|figures| figures.rests()[0]),
            ends_at_rest: figures.iter().all(|figures| figures.rests()[1]),
            max_error: error.map(|error| error.value),
            max_error_at: error.map(|error| error.t),
        }
    }
}

impl Show for Checked {
    fn text(&self) -> String {
        let Clock { gap, smallest_gap, largest_gap, even, .. } = &self.time;
        let evenness = if *even {
            format!("even time, {} s apart", short(*gap))
        } else {
            format!("uneven time, {} to {} s apart", short(*smallest_gap), short(*largest_gap))
        };
        let mut text = format!("{} samples over {} s, {evenness}\n\n", self.samples, short(self.duration));
        let mut table = Table::new(["joint", "from", "to", "velocity", "by steps", "acceleration", "jerk"]);
        for arm in &self.arms {
            for joint in &arm.joints {
                let declared = joint.velocity.map_or_else(|| "-".to_owned(), short);
                table.row([
                    format!("{}.{}", arm.name, joint.joint),
                    short(joint.lowest),
                    short(joint.highest),
                    declared,
                    short(joint.mean_velocity),
                    short(joint.acceleration),
                    short(joint.jerk),
                ]);
            }
        }
        text.push_str(&table.to_string());
        // Writing to a String can not fail.
        for arm in &self.arms {
            if let (Some(error), Some(t)) = (arm.max_error, arm.max_error_at) {
                let _ =
                    writeln!(text, "{}: worst task error {} at t = {} s", arm.name, short(error), moment(t));
            }
        }
        for arm in &self.absent {
            let _ = writeln!(text, "{arm}: nothing of it moves here");
        }
        for task in &self.unchecked {
            let _ = writeln!(text, "task {task}: not checked, tasks over several tips are not yet");
        }
        match self.failures.as_slice() {
            [] if self.unchecked.is_empty() => text.push_str("\nevery check holds\n"),
            [] => text.push_str("\nevery check that was made holds\n"),
            failures => {
                text.push('\n');
                for failure in failures {
                    let _ = writeln!(text, "FAILED  {failure}");
                }
            }
        }
        text
    }
}
