//! What runs are compared with: the solution at every sample of every rung, to more digits than they can have.

use super::ladder::{Ladder, Rung};
use kinstep::formula::Formula;
use kinstep::integrate::{Elementary, Equations, Field, IntegrateError, Multistep, Scalar, Starter, Status};
use kinstep::math::DoubleDouble;
use num_traits::{One, Zero};

/// The most columns of an extrapolation; the order is twice as many.
const COLUMNS: usize = 12;
/// An interval is halved this many times at most.
const HALVINGS: usize = 24;
/// Evaluations of a right-hand side before a reference is given up.
const MOST_EVALUATIONS: usize = 50_000_000;

/// The solution of an initial value problem at every sample of a ladder, and how far it may be off.
#[derive(Clone, Debug)]
pub struct Reference {
    /// Entries of a state.
    pub(super) dimension: usize,
    /// The states of every rung, one sample after the other.
    pub(super) states: Vec<Vec<DoubleDouble>>,
    /// How far any entry may be off; infinite where there is no reference.
    pub uncertainty: f64,
    /// What stands in the way of a reference, if anything.
    pub trouble: Option<String>,
}

impl Reference {
    /// The exact solution that the problem states, evaluated with 32 digits; `None` where it states none.
    pub fn exact(equations: &Equations, ladder: &Ladder) -> Option<Self> {
        let mut solution = equations.solution::<DoubleDouble>()?;
        let mut of_rung = |rung: Rung| -> Vec<DoubleDouble> {
            (0..=rung.steps).flat_map(|n| solution(time(ladder.duration(), n, rung.steps))).collect()
        };
        let states: Vec<Vec<DoubleDouble>> = ladder.rungs().map(&mut of_rung).collect();
        let finite = states.iter().flatten().all(|entry| entry.is_finite());
        let trouble = (!finite).then(|| "the exact solution is not a number somewhere on the way".to_owned());
        let dimension = equations.unknowns().len();
        let uncertainty =
            if finite { 1e3 * DoubleDouble::RESOLUTION * largest(&states) } else { f64::INFINITY };
        Some(Self { dimension, states, uncertainty, trouble })
    }

    /// The solution by extrapolation of the modified midpoint rule (W. B. Gragg; R. Bulirsch and J. Stoer) with 32 digits, of an order
    /// up to 24 as the interval needs it.
    ///
    /// It is computed once more with a looser tolerance; what the two differ by is the uncertainty.
    pub fn extended(equations: &Equations, ladder: &Ladder, tolerance: f64) -> Self {
        let dimension = equations.unknowns().len();
        let mut states: Vec<Vec<DoubleDouble>> =
            ladder.rungs().map(|rung| Vec::with_capacity((rung.steps + 1) * dimension)).collect();
        let mut integrator = Extrapolation::new(equations, tolerance);
        for (t, rungs) in merged(ladder) {
            if let Err(trouble) = integrator.go_to(t) {
                return Self { dimension, states, uncertainty: f64::INFINITY, trouble: Some(trouble) };
            }
            for rung in rungs {
                states[rung].extend_from_slice(&integrator.state);
            }
        }
        let (uncertainty, trouble) = match check(equations, ladder, 1e3 * tolerance, &states[0]) {
            Ok(difference) => (difference, None),
            Err(trouble) => (f64::INFINITY, Some(trouble)),
        };
        Self { dimension, states, uncertainty, trouble }
    }

    /// The solution by a formula on the coarsest grid that all rungs share, and once more with half the gap, which is used; what the
    /// two differ by is the uncertainty.
    ///
    /// # Errors
    /// [`IntegrateError`] for a formula that may not run.
    pub fn by_formula<T: Elementary>(
        formula: &Formula,
        equations: &Equations,
        ladder: &Ladder,
    ) -> Result<Self, IntegrateError> {
        let dimension = equations.unknowns().len();
        let none = |trouble: &str| Self {
            dimension,
            states: Vec::new(),
            uncertainty: f64::INFINITY,
            trouble: Some(trouble.to_owned()),
        };
        let most = ladder.rungs().map(|rung| rung.steps).max().unwrap_or(1).saturating_mul(64);
        let Some(common) = ladder.common().filter(|common| common.steps <= most) else {
            return Ok(none("the gaps have no common grid of moderate size; choose gaps in simple ratios"));
        };
        let run = |steps| -> Result<Vec<T>, IntegrateError> {
            let starter = Starter::sufficient_for(formula.order());
            trajectory(formula, &starter, equations, ladder.duration(), steps)
        };
        let (coarse, fine) = (run(common.steps)?, run(2 * common.steps)?);
        if fine.len() != (2 * common.steps + 1) * dimension || coarse.len() != (common.steps + 1) * dimension
        {
            return Ok(none("the reference run stopped on the way"));
        }
        let sample = |states: &[T], n: usize| -> Vec<DoubleDouble> {
            states[n * dimension..(n + 1) * dimension].iter().map(|x| x.to_extended()).collect()
        };
        let uncertainty = (0..=common.steps)
            .map(|n| distance(&sample(&coarse, n), &sample(&fine, 2 * n)))
            .fold(0.0, f64::max);
        let of_rung = |rung: Rung| {
            let stride = 2 * common.steps / rung.steps;
            (0..=rung.steps).flat_map(|n| sample(&fine, n * stride)).collect()
        };
        Ok(Self { dimension, states: ladder.rungs().map(of_rung).collect(), uncertainty, trouble: None })
    }

    /// The solution at the end of the ladder, to the digits of a double; empty where there is no reference.
    pub fn end(&self) -> Vec<f64> {
        let last = self
            .states
            .first()
            .map_or(&[][..], |states| &states[states.len().saturating_sub(self.dimension)..]);
        last.iter().map(|entry| entry.to_f64()).collect()
    }

    /// The largest entry of the solution.
    pub(super) fn scale(&self) -> f64 {
        largest(&self.states)
    }
}

fn largest(states: &[Vec<DoubleDouble>]) -> f64 {
    states.iter().flatten().fold(0.0, |most, entry| most.max(entry.to_f64().abs()))
}

fn distance(a: &[DoubleDouble], b: &[DoubleDouble]) -> f64 {
    a.iter().zip(b).map(|(&a, &b)| (a - b).to_f64().abs()).fold(0.0, f64::max)
}

fn time(duration: f64, n: usize, steps: usize) -> DoubleDouble {
    DoubleDouble::from(duration) * DoubleDouble::from_index(n) / DoubleDouble::from_index(steps)
}

/// The states of a run of a formula, the initial one included; fewer where it stops.
pub(super) fn trajectory<T: Elementary>(
    formula: &Formula,
    starter: &Starter<T>,
    equations: &Equations,
    duration: f64,
    steps: usize,
) -> Result<Vec<T>, IntegrateError> {
    let mut field = equations.field::<T>();
    let sigma = T::from_extended(time(duration, 1, steps));
    let mut stepper = Multistep::new(formula, starter, &field, T::zero(), sigma, &equations.initial::<T>())?;
    let mut states = stepper.state().to_vec();
    for _ in 0..steps {
        if stepper.step(&mut field) != Status::Running {
            break;
        }
        states.extend_from_slice(stepper.state());
    }
    Ok(states)
}

/// All times at which some rung has a sample, in order, with those rungs.
fn merged(ladder: &Ladder) -> Vec<(DoubleDouble, Vec<usize>)> {
    let mut samples: Vec<(u64, u64, usize)> = ladder
        .rungs()
        .enumerate()
        .flat_map(|(rung, Rung { steps, .. })| (0..=steps).map(move |n| (n as u64, steps as u64, rung)))
        .collect();
    let compare = |a: &(u64, u64, usize), b: &(u64, u64, usize)| {
        (u128::from(a.0) * u128::from(b.1)).cmp(&(u128::from(b.0) * u128::from(a.1)))
    };
    samples.sort_by(|a, b| compare(a, b).then(a.2.cmp(&b.2)));
    samples
        .chunk_by(|a, b| compare(a, b).is_eq())
        .map(|same| {
            let (n, steps, _) = same[0];
            (time(ladder.duration(), n as usize, steps as usize), same.iter().map(|s| s.2).collect())
        })
        .collect()
}

/// How far a looser run on the coarsest rung alone is from the states there.
fn check(
    equations: &Equations,
    ladder: &Ladder,
    tolerance: f64,
    states: &[DoubleDouble],
) -> Result<f64, String> {
    let mut integrator = Extrapolation::new(equations, tolerance);
    let steps = ladder.rungs().next().map_or(1, |rung| rung.steps);
    let mut most = 0.0_f64;
    for (n, state) in states.chunks_exact(integrator.state.len()).enumerate() {
        integrator.go_to(time(ladder.duration(), n, steps))?;
        most = most.max(distance(&integrator.state, state));
    }
    Ok(most)
}

struct Extrapolation<F> {
    field: F,
    t: DoubleDouble,
    state: Vec<DoubleDouble>,
    tolerance: f64,
    evaluations: usize,
    /// The row of the tableau that is being made, and the one before.
    rows: [Vec<Vec<DoubleDouble>>; 2],
}

impl Extrapolation<kinstep::integrate::EquationField<DoubleDouble>> {
    fn new(equations: &Equations, tolerance: f64) -> Self {
        Self {
            field: equations.field(),
            t: DoubleDouble::zero(),
            state: equations.initial(),
            tolerance,
            evaluations: 0,
            rows: [Vec::new(), Vec::new()],
        }
    }

    /// Goes on to the time `t`.
    fn go_to(&mut self, t: DoubleDouble) -> Result<(), String> {
        let mut stack = vec![(t, 0)];
        while let Some((target, depth)) = stack.pop() {
            let gap = target - self.t;
            if gap.is_zero() {
                continue;
            }
            if let Some(state) = self.try_step(gap) {
                self.state = state;
                self.t = target;
            } else if depth < HALVINGS && self.evaluations < MOST_EVALUATIONS {
                stack.push((target, depth + 1));
                stack.push((self.t + gap * DoubleDouble::from(0.5), depth + 1));
            } else {
                return Err(format!(
                    "the reference does not converge beyond t = {:.6}: the solution may not exist there",
                    self.t.to_f64()
                ));
            }
        }
        Ok(())
    }

    /// The state a gap later, where the columns of the extrapolation settle.
    fn try_step(&mut self, gap: DoubleDouble) -> Option<Vec<DoubleDouble>> {
        self.rows.iter_mut().for_each(Vec::clear);
        let mut before = f64::INFINITY;
        for column in 0..COLUMNS {
            let first = self.midpoint(gap, 2 * (column + 1));
            if !first.iter().all(|entry| entry.is_finite()) {
                return None;
            }
            self.rows.swap(0, 1);
            let [row, last] = &mut self.rows;
            row.clear();
            row.push(first);
            for k in 0..column {
                let ratio = DoubleDouble::from_index(column + 1) / DoubleDouble::from_index(column - k);
                let divisor = ratio * ratio - DoubleDouble::one();
                let next =
                    row[k].iter().zip(&last[k]).map(|(&new, &old)| new + (new - old) / divisor).collect();
                row.push(next);
            }
            if column > 0 {
                let error = distance(&row[column], &row[column - 1]);
                let scale = row[column].iter().fold(0.0_f64, |most, x| most.max(x.to_f64().abs()));
                if error <= self.tolerance * scale.max(f64::MIN_POSITIVE) {
                    return row.pop();
                }
                // Columns that no longer help will not help later.
                if column > 5 && error > before {
                    return None;
                }
                before = error;
            }
        }
        None
    }

    /// The modified midpoint rule with `steps` steps, an even number: its errors have even powers only.
    fn midpoint(&mut self, gap: DoubleDouble, steps: usize) -> Vec<DoubleDouble> {
        self.evaluations += steps;
        let small = gap / DoubleDouble::from_index(steps);
        let twice = small + small;
        let mut f = vec![DoubleDouble::zero(); self.state.len()];
        self.field.evaluate(self.t, &self.state, &mut f, &mut []);
        let mut old = self.state.clone();
        let mut new: Vec<DoubleDouble> = old.iter().zip(&f).map(|(&x, &f)| x + small * f).collect();
        for n in 1..steps {
            self.field.evaluate(self.t + DoubleDouble::from_index(n) * small, &new, &mut f, &mut []);
            for ((old, new), &f) in old.iter_mut().zip(&mut new).zip(&f) {
                let next = *old + twice * f;
                *old = *new;
                *new = next;
            }
        }
        new
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kinstep::integrate::EquationText;

    fn equations(equations: &[&str], initial: &[&str], exact: &[&str]) -> Equations {
        let lines = |lines: &[&str]| lines.iter().map(|&line| line.to_owned()).collect();
        let text = EquationText {
            equations: lines(equations),
            initial: lines(initial),
            exact: lines(exact),
            ..EquationText::default()
        };
        Equations::parse(&text).unwrap()
    }

    #[test]
    fn extrapolation_agrees_with_the_exact_solution_to_28_digits() {
        let swing = equations(&["x' = x*cos(t)"], &["x = 1"], &["x = exp(sin(t))"]);
        let ladder = Ladder::half_octaves(6.0, 16, 4).unwrap();
        let exact = Reference::exact(&swing, &ladder).unwrap();
        let found = Reference::extended(&swing, &ladder, 1e-30);
        assert!(found.trouble.is_none() && found.uncertainty < 1e-26, "{}", found.uncertainty);
        for (exact, found) in exact.states.iter().zip(&found.states) {
            assert_eq!(exact.len(), found.len());
            let most = exact.iter().zip(found).map(|(&a, &b)| (a - b).to_f64().abs()).fold(0.0, f64::max);
            assert!(most < 1e-27, "{most:e}");
        }
    }

    #[test]
    fn a_solution_that_does_not_exist_is_no_reference() {
        // x = 1/(1 - t) leaves every bound at t = 1.
        let blows_up = equations(&["x' = x^2"], &["x = 1"], &[]);
        let found = Reference::extended(&blows_up, &Ladder::halvings(2.0, 8, 3).unwrap(), 1e-28);
        assert!(found.trouble.unwrap().contains("does not converge beyond t = "));
        assert!(found.uncertainty.is_infinite());
    }
}
