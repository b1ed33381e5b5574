use super::limited::{Limited, RangeMethod};
use super::{LawKind, MakeLaw, SystemShape};
use crate::formula::{Formula, FormulaTable};
use crate::integrate::{Field, Multistep, Starter, Status};
use crate::kind::{Form, Kind, Parameter, Parameters};
use crate::math::{Constraint, LeastDistance, NoSolution, RowRotations, dot};
use num_traits::ToPrimitive;
use std::cell::OnceCell;

/// What a network that has settled may miss of what the tasks ask for, as a fraction of it, unless given.
const TOLERANCE: f64 = 1e-12;
/// How many steps it may take to settle at one sample, unless given.
const MOST_STEPS: usize = 100_000;
/// Singular values below this fraction of the largest are rounding.
const ROUNDING: f64 = 1e-12;

/// The problem of [`QuadraticProgram`](super::QuadraticProgram) solved by a recurrent neural network: an ordinary differential
/// equation whose rest is the solution, integrated by the same stepper and any explicit row ([`Limited`] has the problem).
///
/// ```
/// use kinstep::law::Network;
/// use kinstep::planner::JointSystem;
///
/// let pair = JointSystem::of(["left", "right"]).with_law(Network::new());
/// # let _ = pair;
/// ```
pub type Network = Limited<RecurrentNetwork>;

/// How the error of a network is fed back.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum NetworkKind {
    /// By all joints, `y' = gamma (A A^T)^-1 (b - A x)`: the simplified dual neural network (Liu and Wang 2006), preconditioned.
    /// Joints at the ends of their ranges slow it down; it settles wherever there is an answer.
    #[default]
    Projection,
    /// By the joints that are free, `y' = gamma (A D A^T)^-1 (b - A x)` with `D` one for these and zero for the others, so that `e' =
    /// -gamma e` while the same are active: the zeroing neural network (Zhang, Jiang and Wang 2002). It settles in a few steps, or,
    /// where joints come to the ends of their ranges and leave them in turn, not at all.
    Zeroing,
}

/// A recurrent neural network for the dual of the problem: the joint velocities are `x = P(c + A^T y)`, where `P` clamps each to its
/// range, `A x = b` are the tasks and `c` is what the criteria ask for, and `y` moves by the error `e = b - A x` ([`NetworkKind`] says
/// how).
///
/// Its rest is the optimum: the tasks hold, and `x - c` is a sum of their rows but for what the ranges push. Where the error falls as
/// `e' = -gamma e`, with `gamma` chosen so that `h = gamma beta(1)` is the row's optimum, it falls by the row's own factor `r(h)` a
/// step. The state lives on from sample to sample, which is a warm start.
pub struct RecurrentNetwork {
    formula: Result<Formula, String>,
    rate: OnceCell<Result<f64, String>>,
    kind: NetworkKind,
    tolerance: f64,
    most_steps: usize,
    running: Option<Running>,
}

/// The network of a system.
struct Running {
    stepper: Multistep<f64>,
    /// `gamma`, with steps of unit length.
    rate: f64,
    rotations: RowRotations,
    /// The joints by which the rotations were found.
    counted: Vec<bool>,
    residual: Vec<f64>,
}

/// The right-hand side at the problem of one sample.
struct Equation<'a> {
    problem: &'a LeastDistance<'a>,
    kind: NetworkKind,
    rotations: &'a mut RowRotations,
    counted: &'a mut [bool],
    residual: &'a mut [f64],
    x: &'a mut [f64],
    rate: f64,
    /// The largest entry of the residual, and the largest sum of what it is the difference of.
    largest: f64,
    size: f64,
}

impl Default for RecurrentNetwork {
    /// With the row of the 2020 paper.
    fn default() -> Self {
        Self::of_row("la6-wang-guo")
    }
}

impl RecurrentNetwork {
    /// The network integrated by a row of the built-in table; one that is not there is an objection of the law.
    fn of_row(id: &str) -> Self {
        let formula = FormulaTable::builtin().get(id).cloned().map_err(|unknown| unknown.to_string());
        Self {
            formula,
            rate: OnceCell::new(),
            kind: NetworkKind::default(),
            tolerance: TOLERANCE,
            most_steps: MOST_STEPS,
            running: None,
        }
    }

    /// The network integrated by this row.
    pub fn by(formula: &Formula) -> Self {
        Self { formula: Ok(formula.clone()), ..Self::default() }
    }

    /// The same with its error fed back in another way.
    #[must_use]
    pub fn of_kind(mut self, kind: NetworkKind) -> Self {
        self.kind = kind;
        self
    }

    /// The stepper of so many unknowns and its rate, or why the row can not run it.
    fn stepper(&self, unknowns: usize) -> Result<(Multistep<f64>, f64), String> {
        let formula = self.formula.as_ref().map_err(Clone::clone)?;
        // The optimum takes a search, and is asked for by the objection and by the preparation.
        let rate = self.rate.get_or_init(|| rate(formula)).clone()?;
        let idle = crate::integrate::Ode::new(unknowns, |_: f64, _: &[f64], derivative: &mut [f64]| {
            derivative.fill(0.0);
        });
        let zeros = vec![0.0; unknowns];
        let stepper = Multistep::new(formula, &Starter::Rk4, &idle, 0.0, 1.0, &zeros);
        stepper.map(|stepper| (stepper, rate)).map_err(|refusal| refusal.to_string())
    }
}

/// `gamma` with steps of unit length, so that `h = gamma beta(1)` is the row's optimum; or why the row can not run a network.
fn rate(formula: &Formula) -> Result<f64, String> {
    formula.runnable().map_err(|refusal| refusal.to_string())?;
    let pair = formula.without_split();
    let h = pair.optimum().ok_or_else(|| format!("the row `{}` settles no error", formula.id()))?.h;
    Ok(h / pair.gamma_sum().to_f64().unwrap_or(f64::NAN))
}

impl Network {
    /// The law with its network integrated by this row.
    #[must_use]
    pub fn integrated_by(mut self, formula: &Formula) -> Self {
        self.set_method(RecurrentNetwork::by(formula));
        self
    }
}

impl RangeMethod for RecurrentNetwork {
    fn objection(&self, shape: &SystemShape) -> Option<String> {
        self.stepper(shape.rows()).err().map(|problem| format!("can not run its network: {problem}"))
    }

    fn prepare(&mut self, shape: &SystemShape) {
        let (rows, joints) = (shape.rows(), shape.joints.len());
        self.running = self.stepper(rows).ok().map(|(stepper, rate)| Running {
            stepper,
            rate,
            rotations: RowRotations::with_capacity(rows, joints),
            counted: vec![true; joints],
            residual: vec![0.0; rows],
        });
    }

    fn solve(&mut self, problem: &LeastDistance<'_>, x: &mut [f64]) -> Result<(), NoSolution> {
        let Some(running) = self.running.as_mut().filter(|_| problem.is_sound()) else {
            return Err(NoSolution::NotFinite);
        };
        let mut equation = Equation {
            problem,
            kind: self.kind,
            rotations: &mut running.rotations,
            counted: &mut running.counted,
            residual: &mut running.residual,
            x,
            rate: running.rate,
            largest: f64::INFINITY,
            size: 0.0,
        };
        equation.counted.fill(true);
        equation.decompose();
        for _ in 0..self.most_steps {
            // The first step of a sample still goes by what the last one evaluated.
            if running.stepper.step(&mut equation) != Status::Running {
                return Err(NoSolution::NotFinite);
            }
            running.stepper.evaluate(&mut equation);
            if equation.largest <= self.tolerance * equation.size {
                return Ok(());
            }
        }
        Err(NoSolution::TooManySteps)
    }

    fn conflict(&self) -> &[Constraint] {
        &[]
    }
}

impl Field<f64> for Equation<'_> {
    fn dimension(&self) -> usize {
        self.residual.len()
    }

    fn evaluate(&mut self, _t: f64, y: &[f64], f: &mut [f64], _g: &mut [f64]) {
        let joints = self.x.len();
        self.x.copy_from_slice(self.problem.target);
        for (row, y) in self.problem.equalities.chunks_exact(joints).zip(y) {
            for (x, entry) in self.x.iter_mut().zip(row) {
                *x += entry * y;
            }
        }
        let ranges = self.problem.lower.iter().zip(self.problem.upper);
        for (x, (lower, upper)) in self.x.iter_mut().zip(ranges) {
            *x = x.max(*lower).min(*upper);
        }
        (self.largest, self.size) = (0.0, 0.0);
        let rows = self.problem.equalities.chunks_exact(joints).zip(self.problem.values);
        for (residual, (row, value)) in self.residual.iter_mut().zip(rows) {
            *residual = value - dot(row, self.x);
            self.largest = self.largest.max(residual.abs());
            let terms = row.iter().zip(&*self.x).map(|(entry, x)| (entry * x).abs());
            self.size = self.size.max(value.abs() + terms.sum::<f64>());
        }
        if self.kind == NetworkKind::Zeroing && self.recount() {
            self.decompose();
        }
        self.feed_back(f);
    }
}

impl Equation<'_> {
    /// Finds out which joints are free, and whether those are others than before.
    fn recount(&mut self) -> bool {
        let mut has_changed = false;
        let ranges = self.problem.lower.iter().zip(self.problem.upper);
        for (counted, (x, (lower, upper))) in self.counted.iter_mut().zip(self.x.iter().zip(ranges)) {
            let is_free = lower < x && x < upper;
            has_changed |= *counted != is_free;
            *counted = is_free;
        }
        has_changed
    }

    /// Decomposes the rows of the joints that count.
    fn decompose(&mut self) {
        let (joints, counted, rows) = (self.x.len(), &self.counted, self.problem.equalities);
        self.rotations
            .compute(joints, |row, joint| if counted[joint] { rows[row * joints + joint] } else { 0.0 });
    }

    /// Writes `gamma (A D A^T)^-1 e`, without the directions that the joints can not move.
    fn feed_back(&self, f: &mut [f64]) {
        f.fill(0.0);
        let largest = self.rotations.values().iter().fold(0.0_f64, |most, value| most.max(*value));
        let is_moved = |value: f64| value > ROUNDING * largest;
        for (value, left, _) in self.rotations.directions().filter(|(value, ..)| is_moved(*value)) {
            let along = self.rate * dot(left, self.residual) / (value * value);
            for (f, entry) in f.iter_mut().zip(left) {
                *f += along * entry;
            }
        }
    }
}

pub(super) const KIND: LawKind = Kind::new(
    "network",
    "The quadratic program of the law qp solved by a recurrent neural network, which a formula row integrates.",
    &[
        Parameter::optional(
            "formula",
            Form::Text,
            "",
            "Id of the built-in row that integrates the network. Default: la6-wang-guo.",
        ),
        Parameter::optional(
            "network",
            Form::OneOf(&["projection", "zeroing"]),
            "",
            "How its error is fed back: by all joints, or by those that are free, which is faster where it settles. Default: projection.",
        ),
        Parameter::optional(
            "tolerance",
            Form::Positive { noun: "tolerance" },
            "",
            "What the network may miss of what the tasks ask for when it counts as settled, as a fraction of it. Default: 1e-12.",
        ),
        Parameter::optional(
            "most_steps",
            Form::Positive { noun: "number of steps" },
            "",
            "How many steps the network may take to settle at one sample. Default: 100000.",
        ),
    ],
    MakeLaw::WithCriteria(|given, criteria| Box::new(Limited::by(network(given), criteria))),
);

fn network(given: &Parameters) -> RecurrentNetwork {
    let network = given.text("formula").map_or_else(RecurrentNetwork::default, RecurrentNetwork::of_row);
    let kind = match given.text("network") {
        Some("zeroing") => NetworkKind::Zeroing,
        _ => NetworkKind::Projection,
    };
    RecurrentNetwork {
        kind,
        tolerance: given.number("tolerance").unwrap_or(network.tolerance),
        most_steps: given.number("most_steps").map_or(network.most_steps, |most| most.ceil() as usize),
        ..network
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::LeastDistanceSolver;
    use proptest::prelude::*;

    /// Rows of several kinds: of the paper, of one step, of few and of many steps, and a split one.
    const ROWS: [&str; 5] = ["la6-wang-guo", "la2-euler", "la4-ssp32", "split-ab4", "la8-24"];

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(32))]

        #[test]
        fn it_settles_at_the_solution_of_the_quadratic_program_whatever_row_integrates_it(
            entries in prop::collection::vec(-0.3..0.3_f64, 21), inside in prop::collection::vec(-0.8..0.8_f64, 7),
            target in prop::collection::vec(-1.5..1.5_f64, 7), row in prop::sample::select(&ROWS[..]),
        ) {
            // Far from singular, with whatever is active: how fast it settles is another question.
            let mut equalities = entries;
            equalities.iter_mut().step_by(8).for_each(|entry| *entry += 1.0);
            let values: Vec<f64> = equalities.chunks(7).map(|row| dot(row, &inside)).collect();
            let problem = LeastDistance {
                target: &target,
                equalities: &equalities,
                values: &values,
                lower: &[-1.0; 7],
                upper: &[1.0; 7],
                inequalities: &[],
                bounds: &[],
            };
            let mut exact = [0.0; 7];
            LeastDistanceSolver::with_capacity(7).solve(&problem, &mut exact).expect("there is a point inside");
            prop_assume!(exact[..3].iter().all(|x| x.abs() < 1.0));
            let mut network = RecurrentNetwork::of_row(row);
            network.prepare(&SystemShape::of_one_task(3, 7, 1.0));
            let mut x = [0.0; 7];
            let settled = network.solve(&problem, &mut x);
            prop_assert_eq!(settled, Ok(()), "{}", row);
            let apart = x.iter().zip(&exact).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            prop_assert!(apart < 1e-8, "{row}: {apart:.2e}");
        }
    }

    #[test]
    fn a_row_that_is_not_there_or_settles_nothing_is_an_objection() {
        let shape = SystemShape::of_one_task(3, 7, 1.0);
        let unknown = RecurrentNetwork::of_row("la7").objection(&shape).expect("there is no such row");
        assert!(unknown.contains("la7"), "{unknown}");
        let implicit = RecurrentNetwork::of_row("bdf2").objection(&shape).expect("it is implicit");
        assert!(implicit.contains("bdf2") && implicit.contains("implicit"), "{implicit}");
    }

    #[test]
    fn what_can_not_be_met_does_not_settle() {
        let problem = LeastDistance {
            target: &[0.0],
            equalities: &[1.0],
            values: &[2.0],
            lower: &[-1.0],
            upper: &[1.0],
            inequalities: &[],
            bounds: &[],
        };
        let mut network = RecurrentNetwork { most_steps: 100, ..RecurrentNetwork::default() };
        network.prepare(&SystemShape::of_one_task(1, 1, 1.0));
        assert_eq!(network.solve(&problem, &mut [0.0]), Err(NoSolution::TooManySteps));
    }
}
