//! What runs are compared with: the solution at every sample of every rung, to more digits than they can have.

use super::ladder::{Ladder, Rung};
use kinstep::formula::Formula;
use kinstep::integrate::{
    Elementary, Equations, Field, IntegrateError, Method, Multistep, Scalar, Starter, Status,
};
use kinstep::math::DoubleDouble;
use num_traits::{One, Zero};

/// The most columns of an extrapolation; the order is twice as many.
const COLUMNS: usize = 12;
/// An interval is halved this many times at most: where the right-hand side jumps, down to the resolution of the numbers.
const HALVINGS: usize = 110;
/// The tolerance of the run that finds how large the solution is.
const ROUGHLY: f64 = 1e-10;
/// A step of the extrapolation that is smaller than this part of the finest gap shows that the right-hand side is not smooth there.
const ROUGH: f64 = 1e-4;
/// A solution that has grown by this factor has left every bound.
const BEYOND_BOUNDS: f64 = 1e9;
/// The small change of the start whose growth is followed, and the size at which it is made small again, both as parts of the solution.
const CHANGE: (f64, f64) = (1e-8, 1e-4);
/// The tolerance of the runs that follow it.
const FOLLOWED: f64 = 1e-13;
/// Evaluations of a right-hand side before a reference is given up.
const MOST_EVALUATIONS: usize = 50_000_000;

/// The solution of an initial value problem at every sample of a ladder, and how far it may be off.
#[derive(Clone, Debug)]
pub struct Reference {
    /// Entries of a state.
    pub(super) dimension: usize,
    /// How far it goes \[s\].
    duration: f64,
    /// The states of every rung, one sample after the other.
    pub(super) states: Vec<Vec<DoubleDouble>>,
    /// How far any entry may be off; infinite where there is no reference.
    pub uncertainty: f64,
    /// What stands in the way of a reference, if anything.
    pub trouble: Option<String>,
    /// The first time at which the right-hand side was seen not to be smooth on the scale of the finest gap \[s\].
    pub(super) rough: Option<f64>,
}

impl Reference {
    /// Nothing to compare with.
    fn none(dimension: usize, trouble: String) -> Self {
        Self {
            dimension,
            duration: 0.0,
            states: Vec::new(),
            uncertainty: f64::INFINITY,
            trouble: Some(trouble),
            rough: None,
        }
    }

    /// The same for a solution that may be off by so much more.
    #[must_use]
    pub(super) fn less_certain(mut self, by: f64) -> Self {
        self.uncertainty += by;
        self
    }

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
        Some(Self { dimension, duration: ladder.duration(), states, uncertainty, trouble, rough: None })
    }

    /// The solution by extrapolation of the modified midpoint rule (W. B. Gragg; R. Bulirsch and J. Stoer) with 32 digits, of an order
    /// up to 24 as the interval needs it.
    ///
    /// Errors are measured by the largest entry over the whole run, so that the state may pass through zero. It is computed
    /// once more with a looser tolerance; what the two differ by is the uncertainty.
    pub fn extended(equations: &Equations, ladder: &Ladder, tolerance: f64) -> Self {
        let dimension = equations.unknowns().len();
        let scale = match magnitude(equations, ladder) {
            Ok(scale) => scale,
            Err(trouble) => return Self::none(dimension, trouble),
        };
        let mut states: Vec<Vec<DoubleDouble>> =
            ladder.rungs().map(|rung| Vec::with_capacity((rung.steps + 1) * dimension)).collect();
        let mut integrator = Extrapolation::new(equations, tolerance, scale);
        integrator.finest = ladder.sigmas().last().copied().unwrap_or(0.0);
        for (t, rungs) in merged(ladder) {
            if let Err(trouble) = integrator.go_to(t) {
                return Self::none(dimension, trouble);
            }
            for rung in rungs {
                states[rung].extend_from_slice(&integrator.state);
            }
        }
        let (uncertainty, trouble) = match check(equations, ladder, (1e3 * tolerance, scale), &states[0]) {
            Ok(difference) => (difference, None),
            Err(trouble) => (f64::INFINITY, Some(trouble)),
        };
        Self { dimension, duration: ladder.duration(), states, uncertainty, trouble, rough: integrator.rough }
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
        let none = |trouble: &str| Self::none(dimension, trouble.to_owned());
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
        Ok(Self {
            dimension,
            duration: ladder.duration(),
            states: ladder.rungs().map(of_rung).collect(),
            uncertainty,
            trouble: None,
            rough: None,
        })
    }

    /// The solution at the end of the ladder, to the digits of a double; empty where there is no reference.
    pub fn end(&self) -> Vec<f64> {
        let last = self
            .states
            .first()
            .map_or(&[][..], |states| &states[states.len().saturating_sub(self.dimension)..]);
        last.iter().map(|entry| entry.to_f64()).collect()
    }

    /// The times and states of the finest rung.
    pub(super) fn finest(&self) -> impl Iterator<Item = (DoubleDouble, &[DoubleDouble])> {
        let states = self.states.last().map_or(&[][..], Vec::as_slice);
        let steps = (states.len() / self.dimension).saturating_sub(1);
        let duration = self.duration;
        states
            .chunks_exact(self.dimension)
            .enumerate()
            .map(move |(n, state)| (time(duration, n, steps), state))
    }

    /// That many states from the first to the last one, evenly spread, as far as the finest rung has so many.
    pub(super) fn sampled(&self, count: usize) -> Vec<Vec<f64>> {
        let all: Vec<&[DoubleDouble]> = self.finest().map(|(_, state)| state).collect();
        let count = count.min(all.len());
        let nearest = |k: usize| all[k * (all.len() - 1) / (count - 1).max(1)];
        (0..count).map(|k| nearest(k).iter().map(|entry| entry.to_f64()).collect()).collect()
    }

    /// The largest entry of the solution.
    pub(super) fn scale(&self) -> f64 {
        largest(&self.states)
    }
}

fn largest(states: &[Vec<DoubleDouble>]) -> f64 {
    states.iter().flatten().fold(0.0, |most, entry| most.max(entry.to_f64().abs()))
}

/// The largest entry of a state.
fn size(state: &[DoubleDouble]) -> f64 {
    state.iter().fold(0.0, |most, entry| most.max(entry.to_f64().abs()))
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
    let mut stepper = started(formula, starter, &field, sigma, &equations.initial())?;
    let mut states = stepper.state().to_vec();
    for _ in 0..steps {
        if stepper.step(&mut field) != Status::Running {
            break;
        }
        states.extend_from_slice(stepper.state());
    }
    Ok(states)
}

/// A stepper for a right-hand side of one part from t = 0. Of an implicit-explicit row only the explicit half has something to do.
pub(super) fn started<T: Scalar>(
    formula: &Formula,
    starter: &Starter<T>,
    field: &impl Field<T>,
    sigma: T,
    initial: &[T],
) -> Result<Multistep<T>, IntegrateError> {
    if formula.is_explicit() {
        return Multistep::new(formula, starter, field, T::zero(), sigma, initial);
    }
    Multistep::of_method(Method::of(formula), starter, field, T::zero(), sigma, initial)
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

/// The times of the coarsest rung.
fn coarsest(ladder: &Ladder) -> impl Iterator<Item = DoubleDouble> {
    let (duration, steps) = (ladder.duration(), ladder.rungs().next().map_or(1, |rung| rung.steps));
    (0..=steps).map(move |n| time(duration, n, steps))
}

/// The largest entry of the solution over the whole run.
fn magnitude(equations: &Equations, ladder: &Ladder) -> Result<f64, String> {
    let mut integrator = Extrapolation::new(equations, ROUGHLY, 0.0);
    let mut f = vec![DoubleDouble::zero(); integrator.state.len()];
    for t in coarsest(ladder) {
        // A state that rests at exactly zero has no size to judge its first step by: that of where it is about to go has.
        integrator.field.evaluate(t, &integrator.state, &mut f, &mut []);
        let reach = size(&f) * ladder.duration();
        if reach.is_finite() {
            integrator.floor = integrator.floor.max(reach);
        }
        integrator.go_to(t)?;
    }
    Ok(integrator.scale)
}

/// Where the right-hand side is first seen not to be smooth by a run whose steps end at other times than those of the runs: what
/// happens at their samples can not be seen from there.
pub(super) fn rough_between(equations: &Equations, ladder: &Ladder, tolerance: f64) -> Option<f64> {
    // The golden ratio: no fraction of a gap is further from simple ones.
    const SHIFT: f64 = 0.618_033_988_749_894_8;
    let mut integrator = Extrapolation::new(equations, tolerance, magnitude(equations, ladder).ok()?);
    integrator.finest = ladder.sigmas().last().copied()?;
    let gap = DoubleDouble::from(ladder.sigmas().first().copied()? * SHIFT);
    let end = DoubleDouble::from(ladder.duration());
    for t in coarsest(ladder).map(|t| t + gap).filter(|t| *t < end) {
        if integrator.rough.is_some() || integrator.go_to(t).is_err() {
            break;
        }
    }
    integrator.rough
}

/// How many times a small change of the start grows on the way, at most: of two solutions side by side, the second is brought back to
/// the first whenever they have drifted apart (G. Benettin, L. Galgani and J. M. Strelcyn, Phys. Rev. A 14, 1976). Nothing where the
/// solution can not be followed.
pub(super) fn growth(equations: &Equations, ladder: &Ladder) -> Option<f64> {
    let scale = magnitude(equations, ladder).ok()?;
    let [mut first, mut second] = [(); 2].map(|()| Extrapolation::new(equations, FOLLOWED, scale));
    let small = CHANGE.0 * scale;
    second.state.iter_mut().for_each(|entry| *entry += DoubleDouble::from(small));
    let (mut grown, mut most) = (1.0, 1.0_f64);
    for t in coarsest(ladder) {
        first.go_to(t).and_then(|()| second.go_to(t)).ok()?;
        let apart = distance(&first.state, &second.state) / small;
        most = most.max(grown * apart);
        if apart * CHANGE.0 > CHANGE.1 {
            grown *= apart;
            let back = DoubleDouble::from(1.0 / apart);
            for (near, &exact) in second.state.iter_mut().zip(&first.state) {
                *near = exact + (*near - exact) * back;
            }
        }
    }
    Some(most)
}

/// How far a looser run on the coarsest rung alone is from the states there.
fn check(
    equations: &Equations,
    ladder: &Ladder,
    (tolerance, scale): (f64, f64),
    states: &[DoubleDouble],
) -> Result<f64, String> {
    let mut integrator = Extrapolation::new(equations, tolerance, scale);
    let mut most = 0.0_f64;
    for (t, state) in coarsest(ladder).zip(states.chunks_exact(equations.unknowns().len())) {
        integrator.go_to(t)?;
        most = most.max(distance(&integrator.state, state));
    }
    Ok(most)
}

struct Extrapolation<F> {
    field: F,
    t: DoubleDouble,
    state: Vec<DoubleDouble>,
    tolerance: f64,
    /// The largest entry of the solution, as far as it is known.
    scale: f64,
    /// What errors are judged by at least.
    floor: f64,
    /// The largest entry at the start.
    initial: f64,
    /// The finest gap of the runs \[s\], and where the right-hand side was first seen to be rough on that scale.
    finest: f64,
    rough: Option<f64>,
    evaluations: usize,
    /// The row of the tableau that is being made, and the one before.
    rows: [Vec<Vec<DoubleDouble>>; 2],
}

impl Extrapolation<kinstep::integrate::EquationField<DoubleDouble>> {
    fn new(equations: &Equations, tolerance: f64, scale: f64) -> Self {
        let state: Vec<DoubleDouble> = equations.initial();
        let initial = size(&state);
        Self {
            field: equations.field(),
            t: DoubleDouble::zero(),
            state,
            tolerance,
            scale: scale.max(initial),
            floor: 0.0,
            initial,
            finest: 0.0,
            rough: None,
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
            let least = 4.0 * DoubleDouble::RESOLUTION * target.to_f64().abs();
            if let Some(state) = self.try_step(gap) {
                if self.rough.is_none() && gap.to_f64() < ROUGH * self.finest {
                    self.rough = Some(target.to_f64());
                }
                self.state = state;
                self.scale = self.scale.max(size(&self.state));
                self.t = target;
            } else if depth < HALVINGS && self.evaluations < MOST_EVALUATIONS && gap.to_f64() > least {
                stack.push((target, depth + 1));
                stack.push((self.t + gap * DoubleDouble::from(0.5), depth + 1));
            } else {
                return Err(self.end());
            }
        }
        Ok(())
    }

    /// Why the solution goes no further, as far as can be told from where it has come.
    fn end(&self) -> String {
        let (t, reached) = (self.t.to_f64(), size(&self.state));
        if reached > BEYOND_BOUNDS * self.initial.max(1.0) {
            return format!(
                "the solution leaves all bounds: it has grown to {reached:.1e} at t = {t:.6}, and does not exist beyond; choose a shorter duration"
            );
        }
        if self.evaluations >= MOST_EVALUATIONS {
            return format!(
                "the reference was given up at t = {t:.6} after {MOST_EVALUATIONS} evaluations: the problem is too stiff, or too long, for it"
            );
        }
        format!("the reference does not converge beyond t = {t:.6}: the solution may not exist there")
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
                let scale = self.scale.max(self.floor).max(size(&row[column]));
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
        self.evaluations += steps + 1;
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
        // Gragg's smoothing sees the end of the gap too: a kink in the last of the small steps would be overlooked.
        self.field.evaluate(self.t + gap, &new, &mut f, &mut []);
        let half = DoubleDouble::from(0.5);
        new.iter().zip(&old).zip(&f).map(|((&new, &old), &f)| half * (new + old + small * f)).collect()
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
        let trouble = found.trouble.unwrap();
        assert!(trouble.contains("leaves all bounds") && trouble.contains("at t = 1.000000"), "{trouble}");
        assert!(found.uncertainty.is_infinite());
    }

    #[test]
    fn a_state_that_passes_through_zero_is_followed() {
        let swing = equations(&["x' = cos(pi*t)"], &["x = 0"], &["x = sin(pi*t)/pi"]);
        let ladder = Ladder::half_octaves(2.0, 16, 6).unwrap();
        let (exact, found) =
            (Reference::exact(&swing, &ladder).unwrap(), Reference::extended(&swing, &ladder, 1e-30));
        assert!(found.trouble.is_none() && found.uncertainty < 1e-26 && found.rough.is_none());
        let pairs = exact.states.iter().flatten().zip(found.states.iter().flatten());
        assert!(pairs.into_iter().all(|(&a, &b)| (a - b).to_f64().abs() < 1e-28));
    }

    #[test]
    fn a_state_that_rests_at_zero_and_is_kicked_later_is_followed() {
        let kicked = equations(&["x' = max(sign(t - 1.01), 0)"], &["x = 0"], &["x = max(t - 1.01, 0)"]);
        let ladder = Ladder::halvings(2.0, 16, 3).unwrap();
        let (exact, found) =
            (Reference::exact(&kicked, &ladder).unwrap(), Reference::extended(&kicked, &ladder, 1e-26));
        assert!(found.trouble.is_none(), "{:?}", found.trouble);
        let pairs = exact.states.iter().flatten().zip(found.states.iter().flatten());
        assert!(pairs.into_iter().all(|(&a, &b)| (a - b).to_f64().abs() < 1e-22));
    }

    #[test]
    fn kinks_and_jumps_are_followed_and_seen() {
        let ladder = Ladder::halvings(2.0, 16, 3).unwrap();
        for (equation, solution, at) in [
            ("x' = abs(t - 0.7)", "x = 0.245 + (t - 0.7)*abs(t - 0.7)/2", 0.7),
            ("x' = sqrt((t - 0.7)^2)", "x = 0.245 + (t - 0.7)*abs(t - 0.7)/2", 0.7),
            ("x' = sign(t - 1/3)", "x = abs(t - 1/3) - 1/3", 1.0 / 3.0),
        ] {
            let kinked = equations(&[equation], &["x = 0"], &[solution]);
            let (exact, found) =
                (Reference::exact(&kinked, &ladder).unwrap(), Reference::extended(&kinked, &ladder, 1e-26));
            assert!(found.trouble.is_none(), "{equation}: {:?}", found.trouble);
            assert!((found.rough.unwrap() - at).abs() < 1e-4, "{equation}: {:?}", found.rough);
            let pairs = exact.states.iter().flatten().zip(found.states.iter().flatten());
            assert!(pairs.into_iter().all(|(&a, &b)| (a - b).to_f64().abs() < 1e-22), "{equation}");
        }
    }

    #[test]
    fn a_kink_at_a_sample_is_seen_between_samples() {
        let kinked = equations(&["x' = sqrt((t - 0.7)^2) - x"], &["x = 1"], &[]);
        let ladder = Ladder::halvings(3.0, 150, 7).unwrap();
        assert!(Reference::extended(&kinked, &ladder, 1e-26).rough.is_none());
        let at = rough_between(&kinked, &ladder, 1e-24);
        assert!(at.is_some_and(|at| (at - 0.7).abs() < 1e-7), "{at:?}");
    }

    #[test]
    fn the_growth_of_small_changes_is_that_of_the_equations() {
        let ladder = Ladder::halvings(20.0, 40, 2).unwrap();
        // Two solutions near zero part as exp(t), until they are pulled to +-1.
        let saddle = equations(&["x' = x", "y' = -y"], &["x = 0", "y = 1"], &[]);
        let found = growth(&saddle, &ladder).unwrap();
        assert!((found.ln() - 20.0).abs() < 0.1, "{found:e}");
        let calm = equations(&["x' = y", "y' = -x"], &["x = 0", "y = 1"], &[]);
        assert!(growth(&calm, &ladder).unwrap() < 2.0);
    }
}
