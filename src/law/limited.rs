use super::distance_rows::DistanceRows;
use super::joint_ranges::JointRanges;
use super::task_stack::TaskStack;
use super::{
    Conflict, Criteria, Criterion, Infeasible, Instant, JointVelocity, Law, Pseudoinverse, Resolution,
    SystemShape,
};
use crate::math::{Constraint, LeastDistance, NoSolution};

/// How often the rows that keep bodies apart are made anew for the step that came of them.
const ROUNDS: usize = 4;

/// A way to find the joint velocity nearest to what the criteria ask for that meets the tasks within the ranges of the joints.
///
/// It is asked only where the velocity that is best without ranges leaves them.
pub trait RangeMethod: Send {
    /// Why this method can not serve systems of a shape, as the end of a sentence that begins with "this law"; `None` if it can.
    fn objection(&self, _shape: &SystemShape) -> Option<String> {
        None
    }

    /// Allocates what systems of this shape need; called once, before the first [`solve`](RangeMethod::solve).
    fn prepare(&mut self, shape: &SystemShape);

    /// Replaces `x`, the answer without ranges, by one within them.
    ///
    /// # Errors
    /// [`NoSolution`] where it finds none; the rows in [`conflict`](RangeMethod::conflict) are named then.
    fn solve(&mut self, problem: &LeastDistance<'_>, x: &mut [f64]) -> Result<(), NoSolution>;

    /// Whether it keeps inequalities over several joints too: the rows that keep bodies apart.
    fn takes_rows(&self) -> bool {
        false
    }

    /// The rows that can not all be met, after [`NoSolution::Infeasible`].
    fn conflict(&self) -> &[Constraint];
}

/// A law that keeps the limits of all joints: the least-norm velocity while it lies within them, and what a [`RangeMethod`]
/// finds where it does not.
///
/// It decides about minimise `1/2 |q' - c|^2` subject to `J q' = phi' - k e` and `lower <= q' <= upper`, where `c` is what the
/// null-space criteria ask for. The bounds keep the limits of positions, velocities and accelerations, of the velocity itself
/// and of the sample that it leads to; all arms that are resolved together are one problem. While no limit is active the answer
/// is that of [`Pseudoinverse`], to the last bit; where one is, the feedback part stays what it is there, `-k J^+ e`, so that the
/// task error falls by the row's `gamma` at all times, and the feedforward part makes room for the limits. Near a singularity the
/// tasks ask for what the damped inverse gives. Where the tasks can not be met within the limits, the run stops and says which rows
/// are in conflict. A joint that is beyond a limit comes back. By a method that [takes rows](RangeMethod::takes_rows) bodies are kept apart too, where something stands around
/// the arms ([`Avoidance`](super::Avoidance)).
#[derive(Default)]
pub struct Limited<M> {
    free: Pseudoinverse,
    method: M,
    workspace: Workspace,
}

#[derive(Default)]
struct Workspace {
    ranges: JointRanges,
    distances: DistanceRows,
    stack: TaskStack,
    /// What the tasks ask for: what the answer without ranges does.
    values: Vec<f64>,
    /// Both parts of the answer together.
    x: Vec<f64>,
    /// The feedforward part of the answer.
    feedforward: Vec<f64>,
}

impl<M> std::fmt::Debug for Limited<M> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Limited").field("free", &self.free).finish_non_exhaustive()
    }
}

impl<M: RangeMethod + Default> Limited<M> {
    /// The law without criteria.
    pub fn new() -> Self {
        Self::default()
    }
}

impl<M: RangeMethod> Limited<M> {
    /// The law by a method, with these criteria.
    pub(super) fn by(method: M, criteria: Criteria) -> Self {
        Self { free: Pseudoinverse::with_criteria(criteria), method, workspace: Workspace::default() }
    }

    pub(super) fn set_method(&mut self, method: M) {
        self.method = method;
    }

    /// The same with a criterion for what the tasks leave free; criteria add up.
    #[must_use]
    pub fn with_criterion(mut self, criterion: impl Criterion + 'static) -> Self {
        self.free = self.free.with_criterion(criterion);
        self
    }
}

impl<M: RangeMethod> Law for Limited<M> {
    fn prepare(&mut self, shape: &SystemShape) {
        self.free.prepare(shape);
        self.method.prepare(shape);
        let joints = shape.joints.len();
        self.workspace = Workspace {
            ranges: JointRanges::with_capacity(joints),
            distances: DistanceRows::new(shape),
            stack: TaskStack::new(shape),
            values: vec![0.0; shape.rows()],
            x: vec![0.0; joints],
            feedforward: vec![0.0; joints],
        };
    }

    fn resolve(
        &mut self,
        instant: &Instant<'_>,
        velocity: &mut JointVelocity<'_>,
    ) -> Result<Resolution, Infeasible> {
        let workspace = &mut self.workspace;
        let resolution = self.free.resolve(instant, velocity)?;
        let (f, g) = (&mut *velocity.feedforward, &*velocity.feedback);
        workspace.ranges.find(instant, g)?;
        for (x, (f, g)) in workspace.x.iter_mut().zip(f.iter().zip(g)) {
            *x = f + g;
        }
        if self.method.takes_rows() {
            workspace.distances.find(instant, g, &workspace.x);
        }
        if !(workspace.ranges.contains(&workspace.x) && workspace.distances.contain(&workspace.x)) {
            workspace.prepare_problem(instant);
            for _ in 0..ROUNDS {
                let mut x = std::mem::take(&mut workspace.x);
                let solved = self.method.solve(&workspace.problem(self.free.criteria_sum()), &mut x);
                workspace.x = x;
                solved.map_err(|failure| workspace.infeasible(failure, self.method.conflict()))?;
                workspace.ranges.clamp(&mut workspace.x);
                if !workspace.distances.tighten(&workspace.x) || workspace.distances.contain(&workspace.x) {
                    break;
                }
            }
            for (f, (x, g)) in f.iter_mut().zip(workspace.x.iter().zip(g)) {
                *f = x - g;
            }
        }
        workspace.feedforward.copy_from_slice(f);
        Ok(resolution)
    }

    fn accept(&mut self, instant: &Instant<'_>) {
        self.free.accept(instant);
        self.workspace.ranges.accept(instant, &self.workspace.feedforward);
    }

    fn keeps_limits(&self) -> bool {
        true
    }

    fn needs_next_state(&self) -> bool {
        true
    }

    fn threshold(&self) -> f64 {
        self.free.threshold()
    }

    fn objection(&self, shape: &SystemShape) -> Option<String> {
        self.free.objection(shape).or_else(|| self.method.objection(shape))
    }

    fn keeps_distances(&self) -> bool {
        self.method.takes_rows() || self.free.keeps_distances()
    }

    fn criterion_rate(&self) -> Option<f64> {
        self.free.criterion_rate()
    }
}

impl Workspace {
    /// Stacks the tasks, which ask for what the answer without ranges does.
    fn prepare_problem(&mut self, instant: &Instant<'_>) {
        self.stack.collect(instant.tasks);
        self.stack.image(&self.x, &mut self.values);
    }

    fn problem<'a>(&'a self, target: &'a [f64]) -> LeastDistance<'a> {
        LeastDistance {
            target,
            equalities: &self.stack.jacobian,
            values: &self.values,
            lower: &self.ranges.lower,
            upper: &self.ranges.upper,
            inequalities: self.distances.rows(),
            bounds: self.distances.bounds(),
        }
    }

    fn infeasible(&self, failure: NoSolution, conflict: &[Constraint]) -> Infeasible {
        let conflicts = match failure {
            NoSolution::Infeasible => conflict.iter().map(|row| self.name(*row)).collect(),
            NoSolution::NotFinite | NoSolution::TooManySteps => Vec::new(),
        };
        Infeasible { conflicts }
    }

    fn name(&self, row: Constraint) -> Conflict {
        match row {
            Constraint::Equality(row) => {
                let (task, row) = self.stack.place(row);
                Conflict::Task { task, row }
            }
            Constraint::Inequality(row) => {
                Conflict::Distance { pair: self.distances.pair(row).unwrap_or_default() }
            }
            Constraint::Lower(joint) => Conflict::Limit { joint, kind: self.ranges.kind(joint, false) },
            Constraint::Upper(joint) => Conflict::Limit { joint, kind: self.ranges.kind(joint, true) },
        }
    }
}
