//! A plan as one JSON document.

use std::io::{self, Write};

use serde::Serialize;

use super::PlanFormat;
use kinstep::planner::{self, ArmPlan, Plan, TaskPlan};

/// The summary of a plan as JSON: how it ended, errors and limits by arm. The samples are not in it.
#[derive(Clone, Copy, Debug, Default)]
pub struct PlanJson;

impl PlanFormat for PlanJson {
    fn write(&self, plan: &Plan, out: &mut dyn Write) -> io::Result<()> {
        serde_json::to_writer_pretty(&mut *out, &Document::of(plan)).map_err(io::Error::from)?;
        writeln!(out)
    }
}

#[derive(Serialize)]
struct Document<'a> {
    status: &'static str,
    reason: Option<&'a str>,
    formula: &'a str,
    sigma: f64,
    h: f64,
    start: &'static str,
    steps: usize,
    samples: usize,
    duration: f64,
    /// As of the arms, of all of them together.
    feasible_duration: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    lead: Option<usize>,
    noise: Option<Noise>,
    arms: Vec<Arm<'a>>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    relations: Vec<Relation<'a>>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    stacks: Vec<Stack<'a>>,
    shared: Vec<Shared<'a>>,
    distance: Option<Distance<'a>>,
    warnings: &'a [String],
}

/// The standard deviations of the noise that the loop suffered.
#[derive(Serialize)]
struct Noise {
    seed: u64,
    position: f64,
    orientation: f64,
    linear_velocity: f64,
    angular_velocity: f64,
    joints: f64,
}

/// A task over the tips of several arms, beside their own.
#[derive(Serialize)]
struct Relation<'a> {
    name: &'a str,
    kind: &'a str,
    arms: &'a [String],
    rows: usize,
    max_error: f64,
    max_position_error: f64,
    max_orientation_error: f64,
}

/// Arms that were resolved as one system because they move joints in common.
#[derive(Serialize)]
struct Shared<'a> {
    arms: &'a [String],
    joints: &'a [String],
}

/// How near two bodies came to each other.
#[derive(Serialize)]
struct Distance<'a> {
    minimum: f64,
    pair: &'a [String; 2],
    t: f64,
    margin: f64,
    ok: bool,
}

#[derive(Serialize)]
struct Arm<'a> {
    name: &'a str,
    joints: &'a [String],
    max_error: f64,
    max_error_component: f64,
    max_error_steady: f64,
    rms_error_steady: f64,
    max_position_error: f64,
    max_orientation_error: f64,
    /// By how much the joint that comes back least is away from its start at the end.
    drift: f64,
    /// No sample on the path is below this.
    smallest_singular_value_at_least: f64,
    /// What it is at the sample where that bound was least; null where that is not known.
    smallest_singular_value_at_most: Option<f64>,
    damped_samples: usize,
    /// The directions that the arm lost near singularities; nothing is known of arms that are resolved together.
    lost_directions: Vec<Lost>,
    limits: Limits<'a>,
    start_pose: Option<StartPose<'a>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    convergence: Option<Convergence>,
}

/// A direction of its task that an arm lost: from when until when [s], its unit vector (linear; angular) and the smallest singular
/// value where it was worst.
#[derive(Serialize)]
struct Lost {
    from: f64,
    to: f64,
    direction: [f64; 6],
    smallest_singular_value: f64,
}

impl Lost {
    fn of(lost: &planner::LostDirection) -> Self {
        Self {
            from: lost.from,
            to: lost.to,
            direction: lost.direction.into(),
            smallest_singular_value: lost.smallest_singular_value,
        }
    }
}

/// How much of a stack of tasks of different priorities could be met, where that was least.
#[derive(Serialize)]
struct Stack<'a> {
    arms: &'a [String],
    rows: usize,
    rank: usize,
    t: f64,
}

/// How the feedback brought an arm in that started off its path; what never happens is null.
#[derive(Serialize)]
struct Convergence {
    initial_error: f64,
    tolerance: f64,
    reached: Option<f64>,
    factor: f64,
    predicted: Option<f64>,
}

/// The initial joint positions, where they were solved for, and how far they leave the tip from where it was asked to be.
#[derive(Serialize)]
struct StartPose<'a> {
    q0: &'a [f64],
    distance: f64,
}

#[derive(Serialize)]
struct Limits<'a> {
    ok: bool,
    /// The duration at which the arm would come just to its limits of velocity, acceleration and jerk; null where none is
    /// known.
    feasible_duration: Option<f64>,
    violations: Vec<Violation<'a>>,
}

#[derive(Serialize)]
struct Violation<'a> {
    joint: &'a str,
    kind: &'static str,
    t: f64,
    value: f64,
    limit: f64,
}

impl<'a> Document<'a> {
    fn of(plan: &'a Plan) -> Self {
        Self {
            status: plan.status.name(),
            reason: plan.reason.as_deref(),
            formula: &plan.formula,
            sigma: plan.sigma,
            h: plan.h,
            start: plan.start,
            steps: plan.steps,
            samples: plan.samples(),
            duration: plan.duration(),
            feasible_duration: plan.feasible_duration(),
            lead: Some(plan.lead).filter(|&lead| lead > 0),
            noise: plan.noise.as_ref().map(Noise::of),
            arms: plan.arms.iter().map(|arm| Arm::of(plan, arm)).collect(),
            relations: plan.tasks.iter().map(Relation::of).collect(),
            stacks: plan.stacks.iter().map(Stack::of).collect(),
            shared: plan.shared.iter().map(|s| Shared { arms: &s.arms, joints: &s.joints }).collect(),
            distance: plan.distance.as_ref().map(Distance::of),
            warnings: &plan.warnings,
        }
    }
}

impl Noise {
    fn of(noise: &planner::Noise) -> Self {
        let planner::Noise { seed, position, orientation, linear_velocity, angular_velocity, joints } =
            *noise;
        Self { seed, position, orientation, linear_velocity, angular_velocity, joints }
    }
}

impl<'a> Distance<'a> {
    fn of(closest: &'a planner::ClosestApproach) -> Self {
        let planner::ClosestApproach { minimum, ref pair, t, margin, .. } = *closest;
        Self { minimum, pair, t, margin, ok: closest.is_kept() }
    }
}

impl<'a> Relation<'a> {
    fn of(task: &'a TaskPlan) -> Self {
        Self {
            name: &task.name,
            kind: &task.kind,
            arms: &task.arms,
            rows: task.rows,
            max_error: task.max_error(),
            max_position_error: task.max_position_error(),
            max_orientation_error: task.max_orientation_error(),
        }
    }
}

impl<'a> Stack<'a> {
    fn of(stack: &'a planner::StackRank) -> Self {
        Self { arms: &stack.arms, rows: stack.rows, rank: stack.rank, t: stack.t }
    }
}

impl<'a> Arm<'a> {
    fn of(plan: &Plan, arm: &'a ArmPlan) -> Self {
        let violations = arm.violations.iter().map(|v| Violation {
            joint: &v.joint,
            kind: v.kind.name(),
            t: v.t,
            value: v.value,
            limit: v.limit,
        });
        Self {
            name: &arm.name,
            joints: &arm.joints,
            max_error: arm.max_error,
            max_error_component: arm.max_error_component,
            max_error_steady: arm.max_error_steady,
            rms_error_steady: arm.rms_error_steady,
            max_position_error: arm.max_position_error,
            max_orientation_error: arm.max_orientation_error,
            drift: arm.drift(),
            smallest_singular_value_at_least: arm.smallest_singular_value.0,
            smallest_singular_value_at_most: arm.worst_singular_value,
            damped_samples: arm.damped_samples,
            lost_directions: arm.lost_directions.iter().map(Lost::of).collect(),
            limits: Limits {
                ok: arm.violations.is_empty(),
                feasible_duration: arm
                    .time_scale
                    .filter(|_| plan.is_completed())
                    .map(|scale| scale * plan.duration()),
                violations: violations.collect(),
            },
            convergence: arm.convergence.as_ref().map(|convergence| Convergence {
                initial_error: convergence.initial_error,
                tolerance: convergence.tolerance,
                reached: convergence.reached,
                factor: convergence.factor,
                predicted: Some(convergence.predicted).filter(|t| t.is_finite()),
            }),
            start_pose: arm.start_distance.map(|distance| StartPose { q0: arm.position(0), distance }),
        }
    }
}
