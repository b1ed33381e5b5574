//! What a trajectory is held against: the robots that move, their limits, and the paths that they should follow.

use std::borrow::Cow;

use super::super::arguments::CheckArguments;
use super::super::failure::Failure;
use super::super::loaded::{Loaded, NamedRobot, Staged, load};
use super::super::output::Output;
use super::super::robot::limited_by;
use super::super::share_out::{Shares, Taker, share_out};
use super::sentences;
use super::verdict::{ArmChecked, Checked, Clock, PathChecked};
use kinstep::planner::Arm;
use kinstep::robot::{Joint, Limits, Robot};
use kinstep_files::scenario::RelationSpec;
use kinstep_files::trajectory::{
    ArmTrajectory, Course, Interpolation, JointFigures, Met, Stage, Straying, TimeFigures, Trajectory, units,
};

pub(super) struct Against {
    /// What moves, with the joints that follow.
    trajectory: Trajectory,
    /// What is known of its arms, in their order.
    moved: Vec<Moved>,
    /// How long the paths take \[s\].
    duration: Option<f64>,
    /// The arms of the scenario that are not in the trajectory.
    absent: Vec<String>,
    /// The tasks over several tips, which are not checked.
    unchecked: Vec<String>,
    /// What was recognised and assumed of the file.
    notes: Vec<String>,
    /// What is questionable about it.
    warnings: Vec<String>,
}

/// One arm that moves.
struct Moved {
    /// The limits of its joints, in their order.
    limits: Vec<Limits>,
    straying: Vec<Straying>,
    interpolation: Interpolation,
    /// The arm whose path it should follow.
    path: Option<Arm>,
}

/// What a scenario asks for.
struct Asked {
    takers: Vec<Taker>,
    stage: Stage,
    duration: Option<f64>,
    tasks: Vec<String>,
}

impl Asked {
    fn nothing() -> Self {
        Self { takers: Vec::new(), stage: Stage::default(), duration: None, tasks: Vec::new() }
    }

    fn of(Staged { text, scenario, stage }: Staged) -> Result<Self, Failure> {
        let taker = |arm: Arm| {
            let followers =
                robot_of(&stage, arm.name()).map_or_else(Vec::new, |robot| followers(&arm, robot));
            Taker { arm, followers }
        };
        let arms = scenario.arms(text.folder()).map_err(|e| text.placed(e))?;
        let takers = arms.into_iter().map(taker).collect();
        let name = |relation: &RelationSpec| format!("{} of {}", relation.called(), relation.arms.join(", "));
        let tasks = scenario.relation.iter().map(name).collect();
        Ok(Self { takers, stage, duration: Some(scenario.duration.value()), tasks })
    }
}

/// The robot that is named, with the limits of the file that is named over its own.
fn limited(
    mut named: NamedRobot,
    arguments: &CheckArguments,
    output: &Output,
) -> Result<NamedRobot, Failure> {
    if let Some(file) = &arguments.limits {
        named.robot = limited_by(&named.robot, file, output)?;
    }
    Ok(named)
}

/// The robot that an arm is part of.
fn robot_of<'s>(stage: &'s Stage, arm: &str) -> Option<&'s Robot> {
    Some(&stage.machines[stage.arm(arm)?.machine].robot)
}

/// The joints of a robot that follow those of an arm.
fn followers(arm: &Arm, robot: &Robot) -> Vec<String> {
    let is_own = |index: usize| {
        let name = &robot.joints()[index].name;
        arm.chain().joints().iter().any(|joint| joint.name == *name)
    };
    let follows = |joint: &&Joint| joint.mimic.is_some_and(|mimic| is_own(mimic.driver));
    robot.joints().iter().filter(follows).map(|joint| joint.name.clone()).collect()
}

impl Against {
    pub(super) fn of(arguments: &CheckArguments, output: &Output) -> Result<Self, Failure> {
        let own = arguments.trajectory.join("scenario.toml");
        let folder = arguments.trajectory.is_dir().then_some(own.as_path());
        let scenario = arguments.scenario.as_deref().or(folder);
        let staged = scenario.map(Staged::read).transpose()?;
        let named = NamedRobot::of(&arguments.robot)?;
        let of_scenario = || staged.as_ref().map_or_else(Vec::new, Staged::joints);
        let joints = named.as_ref().map_or_else(of_scenario, NamedRobot::joints);
        let Loaded { mut trajectory, notes, joints } =
            load(&arguments.trajectory, joints, &arguments.reading)?;
        let warnings = units::questions(&trajectory, &joints);
        let Asked { takers, stage, duration, tasks } =
            staged.map_or_else(|| Ok(Asked::nothing()), Asked::of)?;
        let robot = named.map(|named| limited(named, arguments, output)).transpose()?;
        let Shares { moved, absent } = share_out(&trajectory.arms, takers, robot.is_some())?;
        let (mut arms, mut all) = (Vec::new(), Vec::new());
        for (arm, path) in moved {
            let own = path.as_ref().and_then(|path| robot_of(&stage, path.name()));
            let robot = match (&robot, own) {
                (Some(named), _) => {
                    named.check_chain(&arm)?;
                    named.check_joints(&arm)?;
                    &named.robot
                }
                (None, Some(robot)) => robot,
                (None, None) => {
                    let message = "name the robot that moves: --robot FILE, or --scenario FILE";
                    return Err(Failure::usage(message));
                }
            };
            let interpolation = interpolation(&arm, arguments.interpolation)?;
            let (arm, straying) = arm.with_followers(robot, &trajectory.times, interpolation);
            let limits = |joint: &String| robot.joint(joint).map_or(Limits::UNLIMITED, |joint| joint.limits);
            let limits = arm.joints.iter().map(limits).collect();
            arms.push(arm);
            all.push(Moved { limits, straying, interpolation, path });
        }
        trajectory.arms = arms;
        Ok(Self { trajectory, moved: all, duration, absent, unchecked: tasks, notes, warnings })
    }

    pub(super) fn checked(&self, max_error: f64) -> Checked {
        let times = &self.trajectory.times;
        let clock = TimeFigures::of(&self.trajectory);
        let course = self.course();
        let mut failures = sentences::of_clock(&clock);
        failures.extend(course.iter().flat_map(|course| sentences::of_course(*course)));
        let mut arms = Vec::new();
        let (figures, errors) = self.inspected(course);
        let all = self.trajectory.arms.iter().zip(&self.moved).zip(figures).zip(errors);
        for (((arm, moved), figures), error) in all {
            failures.extend(sentences::of_arm(&arm.name, &figures, times));
            failures
                .extend(moved.straying.iter().map(|straying| sentences::of_follower(&arm.name, straying)));
            failures.extend(error.and_then(|error| sentences::of_error(&arm.name, error, max_error)));
            arms.push(ArmChecked::new(&arm.name, &figures, &moved.straying, moved.interpolation, error));
        }
        Checked {
            ok: failures.is_empty(),
            samples: times.len(),
            duration: times[times.len() - 1] - times[0],
            time: Clock::of(&clock),
            path: course.map(|course| PathChecked::of(&course)),
            arms,
            absent: self.absent.clone(),
            unchecked: self.unchecked.clone(),
            notes: self.notes.clone(),
            warnings: self.warnings.clone(),
            failures,
        }
    }

    /// What the joints of every arm do, and the worst error of its task: the one while the other.
    fn inspected(&self, course: Option<Course>) -> (Vec<Vec<JointFigures>>, Vec<Option<Met>>) {
        let Trajectory { times, arms, .. } = &self.trajectory;
        let mut figures = vec![Vec::new(); arms.len()];
        let errors = rayon::in_place_scope(|scope| {
            for ((arm, moved), figures) in arms.iter().zip(&self.moved).zip(&mut figures) {
                let (limits, interpolation) = (&moved.limits, moved.interpolation);
                scope.spawn(move |_| *figures = arm.inspect(times, limits, interpolation));
            }
            let error = |(arm, moved): (&ArmTrajectory, &Moved)| moved.worst_error(course?, arm, times);
            arms.iter().zip(&self.moved).map(error).collect()
        });
        (figures, errors)
    }

    /// The part of the paths that is done, where there are paths.
    fn course(&self) -> Option<Course> {
        let arms = self.trajectory.arms.iter().zip(&self.moved);
        let paths: Vec<(Cow<'_, ArmTrajectory>, &Arm)> = arms
            .filter_map(|(arm, moved)| moved.own_path().map(|path| (own_joints(arm, path), path)))
            .collect();
        let duration = self.duration.filter(|_| !paths.is_empty())?;
        Some(Course::of(&self.trajectory.times, &paths, duration))
    }
}

impl Moved {
    /// The arm whose path it should follow, if that has one of its own.
    fn own_path(&self) -> Option<&Arm> {
        self.path.as_ref().filter(|arm| arm.has_own_task())
    }

    fn worst_error(&self, course: Course, arm: &ArmTrajectory, times: &[f64]) -> Option<Met> {
        let path = self.own_path()?;
        Some(course.worst_error(&own_joints(arm, path), path, times, self.interpolation))
    }
}

/// An arm's own joints, in the order of its chain.
fn own_joints<'a>(arm: &'a ArmTrajectory, path: &Arm) -> Cow<'a, ArmTrajectory> {
    let joints: Vec<&str> = path.chain().joints().iter().map(|joint| joint.name.as_str()).collect();
    arm.with_joints(&joints)
}

/// The interpolation that is asked for, or that the samples imply.
fn interpolation(arm: &ArmTrajectory, asked: Option<Interpolation>) -> Result<Interpolation, Failure> {
    let implied = Interpolation::of(arm);
    match asked {
        Some(asked) if asked > implied => {
            let (name, implied, asked) = (&arm.name, implied.name(), asked.name());
            let lacking = if arm.velocities.is_empty() { "velocities" } else { "accelerations" };
            Err(Failure::usage(format!(
                "--interpolation {asked}: the samples of `{name}` declare no {lacking}; what they allow is {implied}"
            )))
        }
        _ => Ok(asked.unwrap_or(implied)),
    }
}
