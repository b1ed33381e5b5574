//! The pictures of a plan: how the arms move, what their joints do, how far they are from their tasks.

mod conditioning;
mod distances;
mod errors;
mod joints;
mod limits;
mod links;
mod motion;
mod paths;
mod series;

use nalgebra::Vector6;

use crate::short;
use kinstep::formula::FormulaTable;
use kinstep::planner::{ClosestApproach, Plan};
use kinstep_files::trajectory::{ArmTrajectory, Recording, StagedArm};

use super::figure::Figure;

/// Kinematics are computed of at most so many samples of an arm: a drawing shows no more.
const MOST_POSES: usize = 2000;

/// Returns every picture of a recorded plan, from the motion of the arms to the distance from their limits.
///
/// With the plan position and orientation errors are drawn apart, and the desired paths beside those that were gone.
/// What is not known has no picture: without velocities there is none of them, without limits none of the distance to
/// them. Of long runs the drawings, and the numbers beside them, show as many points as can be told apart, with all
/// extremes.
pub fn plan_figures(recording: Recording<'_>, plan: Option<&Plan>) -> Vec<Figure> {
    PlanFigures::new(recording, plan).draw()
}

/// A choice of pictures of a recorded plan.
#[derive(Clone, Debug)]
pub struct PlanFigures<'a> {
    recording: Recording<'a>,
    /// The task errors of each arm of the trajectory, where they are known by component.
    errors: Vec<Option<&'a [Vector6<f64>]>>,
    kinds: Vec<String>,
    joints: Vec<String>,
    from: usize,
    to: usize,
    size: Option<(f64, f64)>,
    /// How near bodies came to each other, where that is known.
    distance: Option<&'a ClosestApproach>,
    /// How the run began: the starter's name and its number of steps.
    start: Option<(String, usize)>,
}

/// A kind of pictures: its name, what it shows, and how it is drawn.
struct Kind {
    name: &'static str,
    shows: &'static str,
    draw: fn(&PlanFigures<'_>) -> Vec<Figure>,
}

const KINDS: [Kind; 10] = [
    Kind {
        name: "motion",
        shows: "the arms at intervals, with the paths of their tips",
        draw: motion::figures,
    },
    Kind { name: "paths", shows: "the path of each tip beside the desired one", draw: paths::figures },
    Kind { name: "errors", shows: "task errors over time", draw: errors::figures },
    Kind { name: "joints", shows: "joint positions over time", draw: joints::positions },
    Kind { name: "velocities", shows: "joint velocities over time", draw: joints::velocities },
    Kind { name: "manipulability", shows: "manipulability over time", draw: conditioning::manipulability },
    Kind { name: "singular", shows: "the smallest singular value over time", draw: conditioning::smallest },
    Kind { name: "condition", shows: "the condition number over time", draw: conditioning::condition },
    Kind {
        name: "limits",
        shows: "the distance to the nearest joint limit over time",
        draw: limits::figures,
    },
    Kind {
        name: "distances",
        shows: "the least distance between bodies over time",
        draw: distances::figures,
    },
];

impl<'a> PlanFigures<'a> {
    /// Returns every kind of pictures of a recorded plan.
    pub fn new(recording: Recording<'a>, plan: Option<&'a Plan>) -> Self {
        let known = |arm: &ArmTrajectory| {
            let arm = plan?.arms.iter().find(|planned| planned.name == arm.name)?;
            Some(arm.errors.as_slice())
        };
        let trajectory = recording.trajectory;
        Self {
            recording,
            errors: trajectory.arms.iter().map(known).collect(),
            kinds: Vec::new(),
            joints: Vec::new(),
            from: 0,
            to: trajectory.samples(),
            size: None,
            distance: plan.and_then(|plan| plan.distance.as_ref()),
            start: start(recording, plan),
        }
    }

    /// The kinds of pictures and what they show, in the order in which they are drawn.
    pub fn kinds() -> impl Iterator<Item = (&'static str, &'static str)> {
        KINDS.iter().map(|kind| (kind.name, kind.shows))
    }

    /// Draws these kinds only; none for all.
    #[must_use]
    pub fn of_kinds(mut self, kinds: Vec<String>) -> Self {
        self.kinds = kinds;
        self
    }

    /// Draws these joints only, where joints are drawn; none for all.
    #[must_use]
    pub fn of_joints(mut self, joints: Vec<String>) -> Self {
        self.joints = joints;
        self
    }

    /// Draws what happened from one time to another \[s\].
    #[must_use]
    pub fn between(mut self, from: f64, to: f64) -> Self {
        let times = &self.recording.trajectory.times;
        self.from = times.partition_point(|time| *time < from);
        self.to = times.partition_point(|time| *time <= to);
        self
    }

    /// Draws pictures of this size \[px\].
    #[must_use]
    pub fn of_size(mut self, size: Option<(f64, f64)>) -> Self {
        self.size = size;
        self
    }

    /// Takes the task errors of the arms from here, in the order of the trajectory's arms.
    #[must_use]
    pub fn with_errors(mut self, errors: &'a [Vec<Vector6<f64>>]) -> Self {
        self.errors = self
            .recording
            .trajectory
            .arms
            .iter()
            .enumerate()
            .map(|(k, _)| errors.get(k).map(Vec::as_slice))
            .collect();
        self
    }

    /// Returns the pictures.
    pub fn draw(&self) -> Vec<Figure> {
        if self.from >= self.to {
            return Vec::new();
        }
        let is_asked =
            |kind: &&Kind| self.kinds.is_empty() || self.kinds.iter().any(|name| name == kind.name);
        let figures = KINDS.iter().filter(is_asked).flat_map(|kind| (kind.draw)(self));
        figures.map(|figure| Figure { size: self.size, ..figure }).collect()
    }

    /// Each arm with its chain, by its place in the trajectory.
    fn arms(&self) -> impl Iterator<Item = Subject<'a>> + '_ {
        let Recording { trajectory, stage } = self.recording;
        trajectory.arms.iter().enumerate().filter_map(move |(place, arm)| {
            let staged = stage.arm(&arm.name)?;
            (staged.chain.dof() == arm.joints.len()).then_some(Subject { place, arm, staged })
        })
    }

    /// The samples that are drawn.
    fn samples(&self) -> std::ops::Range<usize> {
        self.from..self.to
    }

    /// The samples whose kinematics are computed, the first and the last among them.
    fn posed_samples(&self) -> Vec<usize> {
        let stride = (self.to - self.from).div_ceil(MOST_POSES).max(1);
        let mut samples: Vec<usize> = self.samples().step_by(stride).collect();
        samples.extend(samples.last().filter(|last| **last + 1 < self.to).map(|_| self.to - 1));
        samples
    }

    fn time(&self, sample: usize) -> f64 {
        self.recording.trajectory.times[sample]
    }

    fn shows_joint(&self, name: &str) -> bool {
        self.joints.is_empty() || self.joints.iter().any(|joint| joint == name)
    }

    /// What made the plan, as a caption has it.
    fn made_by(&self) -> String {
        let Some(about) = &self.recording.trajectory.about else { return String::new() };
        let (sigma, h) = (kinstep::math::number_text(about.sigma), short(about.h));
        // Blanks that do not break keep quantities whole.
        format!(
            "Formula\u{a0}{}, \u{3c3}\u{a0}=\u{a0}{sigma}\u{a0}s, h\u{a0}=\u{a0}{h}, start\u{a0}{}.",
            about.formula, about.start
        )
    }

    /// The caption: what there is to say of one picture, and what made the plan.
    fn caption(&self, sentence: &str) -> String {
        format!("{sentence} {}", self.made_by()).trim().to_owned()
    }
}

/// An arm of the trajectory with its chain.
#[derive(Clone, Copy, Debug)]
struct Subject<'a> {
    place: usize,
    arm: &'a ArmTrajectory,
    staged: &'a StagedArm,
}

impl Subject<'_> {
    /// The stem of a file's name with the arm in it.
    fn stem(&self, kind: &str) -> String {
        let plain = |c: char| if c.is_alphanumeric() || "-_".contains(c) { c } else { '_' };
        format!("{kind}-{}", self.arm.name.chars().map(plain).collect::<String>())
    }
}

/// The starter and the number of its steps; nothing where the formula is not known here.
fn start(recording: Recording<'_>, plan: Option<&Plan>) -> Option<(String, usize)> {
    let about = recording.trajectory.about.as_ref();
    let formula = about.map(|about| &about.formula).or(plan.map(|plan| &plan.formula))?;
    let start = about.map(|about| about.start.as_str()).or(plan.map(|plan| plan.start))?;
    let steps = FormulaTable::builtin().get(formula).ok()?.steps();
    Some((start.to_owned(), steps.checked_sub(1).filter(|steps| *steps > 0)?))
}
