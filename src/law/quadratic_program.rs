use super::limited::{Limited, RangeMethod};
use super::{LawKind, MakeLaw, SystemShape};
use crate::kind::{Form, Kind, Parameter, Parameters};
use crate::math::{Constraint, LeastDistance, LeastDistanceSolver, NoSolution};

/// How much a joint velocity off the criteria counts beside a task that is missed, unless given.
const REGULARIZATION: f64 = 1e-8;

/// The joint velocity nearest to what the criteria ask for that meets all tasks within all limits: a quadratic program, solved
/// exactly by an active set method that begins where the last sample ended and allocates nothing ([`Limited`] has the problem).
///
/// ```
/// use kinstep::law::QuadraticProgram;
/// use kinstep::planner::JointSystem;
///
/// let pair = JointSystem::of(["left", "right"]).with_law(QuadraticProgram::new());
/// # let _ = pair;
/// ```
pub type QuadraticProgram = Limited<ActiveSetMethod>;

/// The dual active set method of Goldfarb and Idnani (Mathematical Programming 27, 1983) as a way to keep ranges:
/// [`LeastDistanceSolver`] has it.
///
/// With tasks in least squares it minimises `rho |q' - c|^2 + sum w_i |J_i q' - v_i|^2` within the ranges, so that there always
/// is an answer: with slacks `s`, `J_i q' + sqrt(rho / w_i) s_i = v_i`, it is the same problem with more unknowns.
#[derive(Default)]
pub struct ActiveSetMethod {
    regularization: Option<f64>,
    solver: Option<LeastDistanceSolver>,
    slacks: Slacks,
}

/// The problem with slacks.
#[derive(Default)]
struct Slacks {
    weights: Vec<f64>,
    target: Vec<f64>,
    equalities: Vec<f64>,
    lower: Vec<f64>,
    upper: Vec<f64>,
    inequalities: Vec<f64>,
    x: Vec<f64>,
}

impl Slacks {
    fn new(shape: &SystemShape) -> Self {
        let (rows, joints) = (shape.rows(), shape.joints.len());
        let weights = shape.tasks.iter().flat_map(|task| std::iter::repeat_n(task.weight, task.rows()));
        let unknowns = joints + rows;
        Self {
            weights: weights.collect(),
            target: vec![0.0; unknowns],
            equalities: vec![0.0; rows * unknowns],
            lower: vec![f64::NEG_INFINITY; unknowns],
            upper: vec![f64::INFINITY; unknowns],
            inequalities: Vec::with_capacity(shape.contacts * unknowns),
            x: vec![0.0; unknowns],
        }
    }

    fn solve(
        &mut self,
        solver: &mut LeastDistanceSolver,
        problem: &LeastDistance<'_>,
        rho: f64,
        x: &mut [f64],
    ) -> Result<(), NoSolution> {
        let (joints, unknowns) = (x.len(), self.x.len());
        self.target[..joints].copy_from_slice(problem.target);
        self.lower[..joints].copy_from_slice(problem.lower);
        self.upper[..joints].copy_from_slice(problem.upper);
        let rows = problem.equalities.chunks_exact(joints).zip(self.equalities.chunks_exact_mut(unknowns));
        for (row, ((own, extended), weight)) in rows.zip(&self.weights).enumerate() {
            extended[..joints].copy_from_slice(own);
            extended[joints + row] = (rho / weight).sqrt();
        }
        self.inequalities.clear();
        for row in problem.inequalities.chunks_exact(joints) {
            self.inequalities.extend_from_slice(row);
            self.inequalities.resize(self.inequalities.len() + unknowns - joints, 0.0);
        }
        let extended = LeastDistance {
            target: &self.target,
            equalities: &self.equalities,
            lower: &self.lower,
            upper: &self.upper,
            inequalities: &self.inequalities,
            ..*problem
        };
        solver.solve(&extended, &mut self.x)?;
        x.copy_from_slice(&self.x[..joints]);
        Ok(())
    }
}

impl QuadraticProgram {
    /// The law with tasks in least squares, by their weights, instead of exactly: what limits do not allow is missed by as
    /// little as possible, and `rho` is how much a joint velocity off the criteria counts beside that.
    #[must_use]
    pub fn in_least_squares(mut self, rho: f64) -> Self {
        self.set_method(ActiveSetMethod { regularization: Some(rho), ..ActiveSetMethod::default() });
        self
    }
}

impl RangeMethod for ActiveSetMethod {
    fn prepare(&mut self, shape: &SystemShape) {
        let mut unknowns = shape.joints.len();
        if self.regularization.is_some() {
            self.slacks = Slacks::new(shape);
            unknowns += shape.rows();
        }
        self.solver = Some(LeastDistanceSolver::with_capacity(unknowns));
    }

    fn solve(&mut self, problem: &LeastDistance<'_>, x: &mut [f64]) -> Result<(), NoSolution> {
        let Some(solver) = &mut self.solver else { return Err(NoSolution::NotFinite) };
        match self.regularization {
            None => solver.solve(problem, x).map(drop),
            Some(rho) => self.slacks.solve(solver, problem, rho, x),
        }
    }

    fn takes_rows(&self) -> bool {
        true
    }

    fn conflict(&self) -> &[Constraint] {
        self.solver.as_ref().map_or(&[], LeastDistanceSolver::conflict)
    }
}

pub(super) const KIND: LawKind = Kind::new(
    "qp",
    "The joint velocity of least norm that meets all tasks within the limits of positions, velocities and accelerations: a quadratic program.",
    &[
        Parameter::optional(
            "tasks",
            Form::OneOf(&["equality", "least-squares"]),
            "",
            "Whether tasks are met exactly, or, while limits are active, as nearly as these allow. Default: equality.",
        ),
        Parameter::optional(
            "regularization",
            Form::Positive { noun: "weight of joint velocities" },
            "",
            "How much a joint velocity counts beside a task that is missed, with tasks in least squares. Default: 1e-8.",
        ),
    ],
    MakeLaw::WithCriteria(|given, criteria| Box::new(Limited::by(method(given), criteria))),
)
.with_objection(|given| {
    let is_idle = given.get("regularization").is_some() && given.text("tasks") != Some("least-squares");
    is_idle.then(|| "`regularization` acts with tasks = \"least-squares\" only".to_owned())
});

fn method(given: &Parameters) -> ActiveSetMethod {
    let in_least_squares = given.text("tasks") == Some("least-squares");
    let rho = given.number("regularization").unwrap_or(REGULARIZATION);
    ActiveSetMethod { regularization: in_least_squares.then_some(rho), ..ActiveSetMethod::default() }
}
