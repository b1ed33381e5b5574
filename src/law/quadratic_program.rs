use super::joint_ranges::JointRanges;
use super::{
    Conflict, Criterion, Infeasible, Instant, JointVelocity, Law, LawKind, LinearityKind, MakeLaw,
    Pseudoinverse, Resolution, SystemShape,
};
use crate::kind::Kind;
use crate::math::{Constraint, LeastDistance, LeastDistanceSolver, NoSolution};
use crate::task::TaskRows;

/// The joint velocity of least norm that meets all tasks and keeps all limits: a quadratic program,
/// minimise `1/2 |q' - c|^2` subject to `J q' = phi' - k e` and `lower <= q' <= upper`.
///
/// `c` is what the null-space criteria ask for. The bounds keep the limits of positions, velocities and accelerations, of the
/// velocity itself and of the sample that it leads to; all arms that are resolved together are one problem. While no limit is
/// active the answer is that of [`Pseudoinverse`], to the last bit; where one is, it is found by an active set method that
/// begins where the last sample ended (Goldfarb and Idnani 1983) and allocates nothing. Where the tasks can not be met within the
/// limits it says which rows are in conflict.
///
/// Near a singularity the tasks ask for what the damped inverse gives, so that the equalities can be met.
///
/// ```
/// use kinstep::law::QuadraticProgram;
/// use kinstep::planner::JointSystem;
///
/// let pair = JointSystem::of(["left", "right"]).with_law(QuadraticProgram::new());
/// # let _ = pair;
/// ```
#[derive(Default)]
pub struct QuadraticProgram {
    free: Pseudoinverse,
    workspace: Option<Workspace>,
}

struct Workspace {
    ranges: JointRanges,
    solver: LeastDistanceSolver,
    /// The stacked Jacobian, row after row, and what is asked of it.
    rows: Vec<f64>,
    values: Vec<f64>,
    /// What minimises the criterion where nothing else is asked for.
    target: Vec<f64>,
    feedforward: Vec<f64>,
    feedback: Vec<f64>,
    /// The tasks that rows belong to, and their places there.
    places: Vec<(usize, usize)>,
}

impl std::fmt::Debug for QuadraticProgram {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("QuadraticProgram").field("free", &self.free).finish_non_exhaustive()
    }
}

impl QuadraticProgram {
    /// The law without criteria.
    pub fn new() -> Self {
        Self::default()
    }

    /// The same with a criterion for what the tasks leave free; criteria add up.
    #[must_use]
    pub fn with_criterion(mut self, criterion: impl Criterion + 'static) -> Self {
        self.free = self.free.with_criterion(criterion);
        self
    }
}

impl Law for QuadraticProgram {
    fn prepare(&mut self, shape: &SystemShape) {
        self.free.prepare(shape);
        let (rows, joints) = (shape.rows(), shape.joints.len());
        let places = shape.tasks.iter().enumerate();
        self.workspace = Some(Workspace {
            ranges: JointRanges::with_capacity(joints),
            solver: LeastDistanceSolver::with_capacity(joints),
            rows: vec![0.0; rows * joints],
            values: vec![0.0; rows],
            target: vec![0.0; joints],
            feedforward: vec![0.0; joints],
            feedback: vec![0.0; joints],
            places: places.flat_map(|(task, shape)| (0..shape.rows()).map(move |row| (task, row))).collect(),
        });
    }

    fn resolve(
        &mut self,
        instant: &Instant<'_>,
        velocity: &mut JointVelocity<'_>,
    ) -> Result<Resolution, Infeasible> {
        let Some(workspace) = &mut self.workspace else { return Err(Infeasible::default()) };
        let (f, g) = (&mut workspace.feedforward, &mut workspace.feedback);
        let resolution =
            self.free.resolve(instant, &mut JointVelocity { feedforward: &mut *f, feedback: &mut *g })?;
        for (out, (f, g)) in velocity.feedforward.iter_mut().zip(f.iter().zip(&*g)) {
            *out = f + g;
        }
        velocity.feedback.fill(0.0);
        workspace.ranges.find(instant)?;
        if !workspace.ranges.contains(velocity.feedforward) {
            workspace.target.copy_from_slice(self.free.pull());
            workspace.limit(instant.tasks, velocity.feedforward)?;
        }
        Ok(resolution)
    }

    fn accept(&mut self, instant: &Instant<'_>) {
        self.free.accept(instant);
        if let Some(workspace) = &mut self.workspace {
            workspace.ranges.accept(instant);
        }
    }

    fn kind(&self) -> LinearityKind {
        LinearityKind::Total
    }

    fn needs_next_state(&self) -> bool {
        true
    }

    fn threshold(&self) -> f64 {
        self.free.threshold()
    }

    fn objection(&self, shape: &SystemShape) -> Option<String> {
        self.free.objection(shape)
    }

    fn criterion_rate(&self) -> Option<f64> {
        self.free.criterion_rate()
    }
}

impl Workspace {
    /// Puts in the place of what all tasks ask for the nearest velocity to the target that asks for the same within the ranges.
    fn limit(&mut self, tasks: &[TaskRows], velocity: &mut [f64]) -> Result<(), Infeasible> {
        self.stack(tasks, velocity);
        let problem = LeastDistance {
            target: &self.target,
            equalities: &self.rows,
            values: &self.values,
            lower: &self.ranges.lower,
            upper: &self.ranges.upper,
            inequalities: &[],
            bounds: &[],
        };
        match self.solver.solve(&problem, velocity) {
            Ok(_) => {
                let bounds = self.ranges.lower.iter().zip(&self.ranges.upper);
                for (velocity, (lower, upper)) in velocity.iter_mut().zip(bounds) {
                    *velocity = velocity.clamp(*lower, *upper);
                }
                Ok(())
            }
            Err(NoSolution::Infeasible) => Err(Infeasible {
                conflicts: self.solver.conflict().iter().map(|row| self.name(*row)).collect(),
            }),
            Err(NoSolution::NotFinite | NoSolution::TooManySteps) => Err(Infeasible::default()),
        }
    }

    /// Stacks the rows of all tasks, which ask for what this velocity does.
    fn stack(&mut self, tasks: &[TaskRows], velocity: &[f64]) {
        let mut rows = self.rows.chunks_exact_mut(velocity.len()).zip(&mut self.values);
        for task in tasks {
            for (row, (stacked, value)) in (0..task.rows()).zip(&mut rows) {
                *value = 0.0;
                for ((entry, own), velocity) in
                    stacked.iter_mut().zip(task.jacobian.row(row).iter()).zip(velocity)
                {
                    *entry = *own;
                    *value += own * velocity;
                }
            }
        }
    }

    fn name(&self, row: Constraint) -> Conflict {
        match row {
            Constraint::Equality(row) | Constraint::Inequality(row) => {
                let (task, row) = self.places[row];
                Conflict::Task { task, row }
            }
            Constraint::Lower(joint) => Conflict::Limit { joint, kind: self.ranges.kind(joint, false) },
            Constraint::Upper(joint) => Conflict::Limit { joint, kind: self.ranges.kind(joint, true) },
        }
    }
}

pub(super) const KIND: LawKind = Kind::new(
    "qp",
    "The joint velocity of least norm that meets all tasks within the limits of positions, velocities and accelerations: a quadratic program.",
    &[],
    MakeLaw::WithCriteria(|_, criteria| {
        Box::new(QuadraticProgram { free: Pseudoinverse::with_criteria(criteria), workspace: None })
    }),
);
