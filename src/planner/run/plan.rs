use super::closest_approach::ClosestApproach;
use super::convergence::Convergence;
use super::noise::Noise;
use crate::planner::system::Violation;
use crate::task::Component;
use nalgebra::Vector6;

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlanStatus {
    /// It reached the end of its duration.
    Completed,
    /// The task error left every bound although the arm was well conditioned: the loop is not stable.
    Diverged,
    /// The arm lost a direction that the task needs.
    Singular,
    /// The path leaves what the arm can reach.
    Unreachable,
    /// A limit stopped it.
    Limit,
    /// A joint position became infinite or NaN.
    NonFinite,
}

impl PlanStatus {
    /// The word used in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Completed => "completed",
            Self::Diverged => "diverged",
            Self::Singular => "singular",
            Self::Unreachable => "unreachable",
            Self::Limit => "limit",
            Self::NonFinite => "non_finite",
        }
    }
}

/// Why and where a run stopped early.
#[derive(Clone, Debug, PartialEq)]
pub struct Stop {
    /// The kind of stop.
    pub status: PlanStatus,
    /// The reason as a sentence.
    pub reason: String,
}

/// What became of a task beside those of the arms.
#[derive(Clone, Debug, PartialEq)]
pub struct TaskPlan {
    /// What it was called.
    pub name: String,
    /// The kind of task.
    pub kind: String,
    /// The arms whose tips it is about.
    pub arms: Vec<String>,
    /// How many rows it has.
    pub rows: usize,
    /// What each of them measures.
    pub components: Vec<Component>,
    /// The error of every row [m or rad], sample after sample.
    pub errors: Vec<f64>,
}

impl TaskPlan {
    /// The errors of all rows [m or rad] at sample `n`.
    pub fn error(&self, n: usize) -> &[f64] {
        &self.errors[n * self.rows..(n + 1) * self.rows]
    }

    /// The largest norm of the error over the run.
    pub fn max_error(&self) -> f64 {
        self.largest(|_| true)
    }

    /// The largest norm of the rows that are lengths \[m\].
    pub fn max_position_error(&self) -> f64 {
        self.largest(|component| !component.is_angular())
    }

    /// The largest norm of the rows that are angles \[rad\].
    pub fn max_orientation_error(&self) -> f64 {
        self.largest(Component::is_angular)
    }

    fn largest(&self, is_meant: impl Fn(Component) -> bool) -> f64 {
        let norm = |errors: &[f64]| {
            let rows = errors.iter().zip(&self.components).filter(|(_, component)| is_meant(**component));
            rows.map(|(error, _)| error * error).sum::<f64>().sqrt()
        };
        self.errors.chunks_exact(self.rows).map(norm).fold(0.0, f64::max)
    }
}

/// A direction of its task that an arm could move in too slowly to be asked for in full: its singular value lay below the law's
/// threshold, where inverses are damped.
#[derive(Clone, Debug, PartialEq)]
pub struct LostDirection {
    /// From when \[s\].
    pub from: f64,
    /// Until when \[s\]: the last sample at which it was lost.
    pub to: f64,
    /// The unit vector (linear; angular) in the axes of the task, where it was worst; its sign means nothing.
    pub direction: Vector6<f64>,
    /// The smallest singular value then.
    pub smallest_singular_value: f64,
}

/// What one arm did.
#[derive(Clone, Debug, Default)]
pub struct ArmPlan {
    /// The arm's name.
    pub name: String,
    /// Its joints, in the order of the entries of a sample.
    pub joints: Vec<String>,
    /// Joint positions [rad or m], sample after sample.
    pub positions: Vec<f64>,
    /// Feedforward joint velocities `J^+ phi'` [rad/s or m/s], sample after sample; the slopes of the positions while an arm
    /// converges to its path.
    pub velocities: Vec<f64>,
    /// The task error of every sample (linear \[m\]; angular \[rad\]), zero in the components the task does not ask for.
    pub errors: Vec<Vector6<f64>>,
    /// The largest norm of the task error over the run.
    pub max_error: f64,
    /// The largest absolute component of the task error over the run.
    pub max_error_component: f64,
    /// The largest norm of the task error over the second half of the run, where the start is forgotten.
    pub max_error_steady: f64,
    /// The root mean square of the norm of the task error over the second half of the run.
    pub rms_error_steady: f64,
    /// The largest position error \[m\].
    pub max_position_error: f64,
    /// The largest orientation error \[rad\].
    pub max_orientation_error: f64,
    /// A lower bound of the smallest singular value of the task Jacobian met, at most a factor `sqrt(rows)` below it, and the
    /// time \[s\] of the sample where that bound was least. Of arms that are resolved together it is that of all of them.
    pub smallest_singular_value: (f64, f64),
    /// The smallest singular value of the task Jacobian at that sample, a bound from above of the smallest one met; `None` where the run stopped there, or where arms are resolved together.
    pub worst_singular_value: Option<f64>,
    /// On how many samples the law damped its answer.
    pub damped_samples: usize,
    /// The directions that it lost near singularities, where and how long; nothing is known of arms that are resolved together.
    pub lost_directions: Vec<LostDirection>,
    /// Joint limits crossed, each where it was worst.
    pub violations: Vec<Violation>,
    /// By what factor the duration of the motion along the path would have to change for the joints to come just to their limits
    /// of velocity, acceleration and jerk; above one where they are crossed. `None` where no such limit is known.
    pub time_scale: Option<f64>,
    /// How the feedback brought the arm in, where it was allowed to start off its path.
    pub convergence: Option<Convergence>,
    /// Where the initial joint positions were solved for: the distance [m, rad] of the tip from where it was asked to be.
    pub start_distance: Option<f64>,
}

impl ArmPlan {
    /// The joint positions [rad or m] of sample `n`.
    pub fn position(&self, n: usize) -> &[f64] {
        let joints = self.joints.len();
        &self.positions[n * joints..(n + 1) * joints]
    }

    /// By how much the joint that comes back least is away from its start [rad or m] at the last sample:
    /// `max |q(T) - q(0)|`.
    pub fn drift(&self) -> f64 {
        let samples = self.positions.len() / self.joints.len().max(1);
        if samples == 0 {
            return 0.0;
        }
        let pairs = self.position(0).iter().zip(self.position(samples - 1));
        pairs.map(|(first, last)| (last - first).abs()).fold(0.0, f64::max)
    }

    /// The joint velocities [rad/s or m/s] of sample `n`.
    pub fn velocity(&self, n: usize) -> &[f64] {
        let joints = self.joints.len();
        &self.velocities[n * joints..(n + 1) * joints]
    }
}

/// Arms that move joints in common.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SharedJoints {
    /// Their names.
    pub arms: Vec<String>,
    /// The joints that move two of them or more.
    pub joints: Vec<String>,
}

/// How much of a stack of tasks of different priorities could be met.
#[derive(Clone, Debug, PartialEq)]
pub struct StackRank {
    /// The arms that it is of.
    pub arms: Vec<String>,
    /// How many rows all tasks have.
    pub rows: usize,
    /// How many of them could be met beside those before them, where that was least.
    pub rank: usize,
    /// When that was \[s\].
    pub t: f64,
}

/// The outcome of a run: joint trajectories of all arms on one time grid, whether it ended well, and what it met.
#[derive(Clone, Debug)]
pub struct Plan {
    /// How the run ended.
    pub status: PlanStatus,
    /// Why it ended early, as a sentence.
    pub reason: Option<String>,
    /// The formula's id.
    pub formula: String,
    /// The sampling gap used \[s\].
    pub sigma: f64,
    /// The feedback step used.
    pub h: f64,
    /// The starter's name.
    pub start: &'static str,
    /// Steps of the whole plan; a run that stopped has fewer.
    pub steps: usize,
    /// How many of them lead arms to their paths before the run.
    pub lead: usize,
    /// How many derivatives of the motions are continuous, if not all: errors fall like `sigma` to one power more at best.
    pub smoothness: Option<usize>,
    /// The noise that was injected into the loop, if there was any.
    pub noise: Option<Noise>,
    /// What each arm did.
    pub arms: Vec<ArmPlan>,
    /// What became of the tasks beside those of the arms.
    pub tasks: Vec<TaskPlan>,
    /// The ranks of stacks of tasks of different priorities.
    pub stacks: Vec<StackRank>,
    /// Which arms shared joints, and were resolved as one system.
    pub shared: Vec<SharedJoints>,
    /// How near bodies came to each other, where something [stands around](crate::planner::Surroundings) the arms.
    pub distance: Option<ClosestApproach>,
    /// What the user should know.
    pub warnings: Vec<String>,
}

impl Plan {
    /// Number of samples recorded: `steps + 1` for a completed run.
    pub fn samples(&self) -> usize {
        self.arms.first().map_or(0, |arm| arm.errors.len())
    }

    /// The time of sample `n` \[s\].
    pub fn time(&self, n: usize) -> f64 {
        n as f64 * self.sigma
    }

    /// Whether the run reached its end.
    pub fn is_completed(&self) -> bool {
        self.status == PlanStatus::Completed
    }

    /// Whether every arm that was allowed to start off its path came onto it.
    pub fn has_converged(&self) -> bool {
        let mut convergence = self.arms.iter().filter_map(|arm| arm.convergence.as_ref());
        convergence.all(|convergence| convergence.reached.is_some())
    }

    /// Whether every joint stayed within its limits.
    pub fn is_within_limits(&self) -> bool {
        self.arms.iter().all(|arm| arm.violations.is_empty())
    }

    /// Whether no two bodies came nearer to each other than they may.
    pub fn keeps_distances(&self) -> bool {
        self.distance.as_ref().is_none_or(ClosestApproach::is_kept)
    }
}
