//! Methods that are not explicit, and steps that vary, on fields of one's own: orders, stability, errors that are told, failures.
#![allow(clippy::unwrap_used, reason = "a test that can not go on stops")]

use kinstep::formula::{Formula, FormulaTable};
use kinstep::integrate::{
    Affine, Attempt, Coefficients, Decision, Elementary, Field, FixedStep, IntegrateError, Method, Mode,
    Multistep, Ode, Parts, RatioCoefficients, RatioRow, RowKind, Scalar, Solved, Starter, StarterKind,
    Status, StepController,
};
use kinstep::math::{DoubleDouble, Rational};
use std::num::NonZeroUsize;
use std::sync::Arc;

fn row(id: &str) -> &'static Formula {
    FormulaTable::builtin().get(id).unwrap()
}

fn slope(errors: &[f64]) -> f64 {
    let [.., coarse, fine] = errors else { panic!("a slope needs two errors") };
    (coarse / fine).log2()
}

/// The states of the exact solution that a method of so many steps starts with.
fn exact_start<T: Scalar>(steps: usize, sigma: T, exact: impl Fn(T) -> T) -> Starter<T> {
    Starter::Given((1..steps).map(|n| vec![exact(T::from_index(n) * sigma)]).collect())
}

/// The largest error along a run of `count` steps.
fn largest_error<T: Elementary>(
    stepper: &mut Multistep<T>,
    field: &mut impl Field<T>,
    count: usize,
    exact: impl Fn(T) -> T,
) -> f64 {
    let mut most = 0.0_f64;
    for _ in 0..count {
        assert_eq!(stepper.step(field), Status::Running, "at {:?}", stepper.time());
        let error = (stepper.state()[0] - exact(stepper.time())).to_extended().to_f64().abs();
        most = most.max(if error.is_nan() { f64::INFINITY } else { error });
    }
    most
}

/// `x' = x cos t`, whose solution is `exp(sin t)`.
struct Swing {
    evaluations: usize,
}

fn swing<T: Elementary>(t: T) -> T {
    t.sin_cos().0.exp()
}

impl<T: Elementary> Field<T> for Swing {
    fn dimension(&self) -> usize {
        1
    }

    fn evaluate(&mut self, t: T, x: &[T], f: &mut [T], _g: &mut [T]) {
        self.evaluations += 1;
        f[0] = x[0] * t.sin_cos().1;
    }

    fn solve(&mut self, t: T, next: Affine<'_, T>, x: &mut [T]) -> Solved {
        x[0] = next.known[0] / (T::one() - next.first * t.sin_cos().1);
        Solved::Converged
    }
}

/// `x' = -rate (x - cos t) - sin t`, whose solution is `cos t` however large the rate (Prothero and Robinson 1974).
struct Stiff {
    rate: f64,
}

impl Field<f64> for Stiff {
    fn dimension(&self) -> usize {
        1
    }

    fn evaluate(&mut self, t: f64, x: &[f64], f: &mut [f64], _g: &mut [f64]) {
        f[0] = -self.rate * (x[0] - t.cos()) - t.sin();
    }

    fn solve(&mut self, t: f64, next: Affine<'_, f64>, x: &mut [f64]) -> Solved {
        let rest = self.rate * t.cos() - t.sin();
        x[0] = (next.known[0] + next.first * rest) / (1.0 + next.first * self.rate);
        Solved::Converged
    }
}

/// `x' = -rate (x^3 - c^3) - sin t` with `c = 2 + cos t`, its solution; solved by Newton's iteration.
struct StiffCubic {
    rate: f64,
}

fn cubic(t: f64) -> f64 {
    2.0 + t.cos()
}

impl Field<f64> for StiffCubic {
    fn dimension(&self) -> usize {
        1
    }

    fn evaluate(&mut self, t: f64, x: &[f64], f: &mut [f64], _g: &mut [f64]) {
        f[0] = -self.rate * (x[0].powi(3) - cubic(t).powi(3)) - t.sin();
    }

    fn solve(&mut self, t: f64, next: Affine<'_, f64>, x: &mut [f64]) -> Solved {
        for _ in 0..30 {
            let mut f = [0.0];
            self.evaluate(t, x, &mut f, &mut []);
            let residual = x[0] - next.known[0] - next.first * f[0];
            let change = residual / (1.0 + next.first * 3.0 * self.rate * x[0] * x[0]);
            x[0] -= change;
            if change.abs() < 1e-15 * x[0].abs().max(1.0) {
                return Solved::Converged;
            }
        }
        Solved::NotConverged
    }
}

/// The implicit rows of the built-in table that may run.
fn implicit_rows() -> Vec<&'static Formula> {
    let may_run = |row: &&Formula| RowKind::of(row) == RowKind::Implicit && row.is_zero_stable();
    FormulaTable::builtin().iter().filter(may_run).collect()
}

fn swing_error<T: Elementary>(formula: &Formula, steps: usize) -> f64 {
    let sigma = T::from_index(2) / T::from_index(steps);
    let mut field = Swing { evaluations: 0 };
    let start = exact_start(formula.steps(), sigma, swing);
    let mut stepper =
        Multistep::of_method(Method::of(formula), &start, &field, T::zero(), sigma, &[T::one()]).unwrap();
    largest_error(&mut stepper, &mut field, steps, swing)
}

#[test]
fn every_implicit_row_shows_its_order() {
    assert!(implicit_rows().len() >= 15);
    for formula in implicit_rows() {
        let error = if formula.order() > 4 { swing_error::<DoubleDouble> } else { swing_error::<f64> };
        let errors = [64, 128, 256].map(|steps| error(formula, steps));
        let (seen, order) = (slope(&errors), formula.order() as f64);
        assert!((seen - order).abs() < 0.15, "{}: slope {seen}, {errors:?}", formula.id());
    }
}

#[test]
fn an_implicit_row_agrees_with_its_formula_written_by_hand() {
    // Adams-Moulton of two steps: x_{n+1} = x_n + sigma (5/12 f_{n+1} + 2/3 f_n - 1/12 f_{n-1}).
    let (sigma, f) = (0.1_f64, |t: f64, x: f64| x * t.cos());
    let mut field = Swing { evaluations: 0 };
    let start = exact_start(2, sigma, swing);
    let mut stepper =
        Multistep::of_method(Method::of(row("am2")), &start, &field, 0.0, sigma, &[1.0]).unwrap();
    let (mut older, mut newer) = (1.0, swing(sigma));
    for n in 1..20 {
        let t = n as f64 * sigma;
        let known = newer + sigma * (2.0 / 3.0 * f(t, newer) - f(t - sigma, older) / 12.0);
        (older, newer) = (newer, known / (1.0 - sigma * 5.0 / 12.0 * (t + sigma).cos()));
        while stepper.index() <= n {
            stepper.step(&mut field);
        }
        assert!((stepper.state()[0] - newer).abs() < 1e-13, "step {n}");
    }
}

fn stiff_errors(id: &str, start: &Starter<f64>, steps: [usize; 3]) -> Vec<f64> {
    let run = |steps: usize| {
        let sigma = 2.0 / steps as f64;
        let start = match start {
            Starter::Sufficient => &exact_start(row(id).steps(), sigma, f64::cos),
            start => start,
        };
        let mut field = Stiff { rate: 1e4 };
        let mut stepper =
            Multistep::of_method(Method::of(row(id)), start, &field, 0.0, sigma, &[1.0]).unwrap();
        largest_error(&mut stepper, &mut field, steps, f64::cos)
    };
    steps.map(run).to_vec()
}

#[test]
fn backward_differentiation_follows_a_stiff_solution_where_explicit_rows_blow_up() {
    for (id, order) in [("bdf1", 1.0), ("bdf2", 2.0), ("bdf3", 3.0), ("bdf4", 4.0)] {
        let errors = stiff_errors(id, &Starter::Sufficient, [20, 40, 80]);
        assert!(errors[0] < 1e-5, "{id}: {errors:?}");
        assert!((slope(&errors) - order).abs() < 0.2, "{id}: {errors:?}");
    }
    for id in ["ab1", "ab2", "ab4", "sbdf2"] {
        let mut field = Stiff { rate: 1e4 };
        let start = exact_start(row(id).steps(), 0.025, f64::cos);
        let mut stepper =
            Multistep::of_method(Method::of(row(id)), &start, &field, 0.0, 0.025, &[1.0]).unwrap();
        while stepper.index() < 1000 && stepper.step(&mut field) == Status::Running {}
        assert_eq!(stepper.status(), Status::NonFinite, "{id}");
        assert!(stepper.index() < 400 && stepper.state()[0].is_finite(), "{id}");
    }
}

#[test]
fn a_stiff_nonlinear_problem_is_solved_by_the_fields_own_newton_iteration() {
    for (id, order) in [("bdf1", 1.0), ("bdf2", 2.0), ("bdf3", 3.0), ("am1", 2.0)] {
        let run = |steps: usize| {
            let sigma = 2.0 / steps as f64;
            let mut field = StiffCubic { rate: 1e3 };
            let start = exact_start(row(id).steps(), sigma, cubic);
            let method = Method::of(row(id));
            let mut stepper = Multistep::of_method(method, &start, &field, 0.0, sigma, &[3.0]).unwrap();
            largest_error(&mut stepper, &mut field, steps, cubic)
        };
        let errors = [40, 80, 160].map(run);
        assert!(errors[0] < 1e-4, "{id}: {errors:?}");
        assert!((slope(&errors) - order).abs() < 0.25, "{id}: {errors:?}");
    }
}

#[test]
fn a_start_by_lower_implicit_rows_is_stable_where_runge_kutta_is_not() {
    let ladder = ["bdf1", "bdf2"].map(|id| row(id).clone()).to_vec();
    let worst = |start: &Starter<f64>| {
        let mut field = Stiff { rate: 1e4 };
        let method = Method::of(row("bdf3"));
        // Away from the solution, to which all others are drawn at once.
        let mut stepper = Multistep::of_method(method, start, &field, 0.0, 0.05, &[2.0]).unwrap();
        let mut worst = 0.0_f64;
        for _ in 0..40 {
            stepper.step(&mut field);
            worst = worst.max((stepper.state()[0] - stepper.time().cos()).abs());
        }
        (worst, (stepper.state()[0] - stepper.time().cos()).abs())
    };
    let (during, after) = worst(&Starter::Rows(ladder));
    assert!(during < 0.3 && after < 1e-4, "{during} {after}");
    assert!(worst(&Starter::Rk4).0 > 1e6);
}

#[test]
fn without_a_solver_of_its_own_a_field_is_solved_by_iteration_or_by_newtons_method() {
    let mut swinging = Ode::new(1, |t: f64, x: &[f64], f: &mut [f64]| f[0] = x[0] * t.cos());
    let start = exact_start(2, 0.01, swing);
    let method = || Method::of(row("bdf2"));
    let mut stepper = Multistep::of_method(method(), &start, &swinging, 0.0, 0.01, &[1.0]).unwrap();
    let mut exactly = Swing { evaluations: 0 };
    let mut solved = Multistep::of_method(method(), &start, &exactly, 0.0, 0.01, &[1.0]).unwrap();
    for _ in 0..200 {
        stepper.step(&mut swinging);
        solved.step(&mut exactly);
        assert!((stepper.state()[0] - solved.state()[0]).abs() < 1e-13);
    }
    // Where putting in does not converge, Newton's method does.
    let mut stiff = Ode::new(1, |t: f64, x: &[f64], f: &mut [f64]| f[0] = -1e4 * (x[0] - t.cos()) - t.sin());
    let start = exact_start(2, 0.01, f64::cos);
    let mut stepper = Multistep::of_method(method(), &start, &stiff, 0.0, 0.01, &[1.0]).unwrap();
    for _ in 0..200 {
        assert_eq!(stepper.step(&mut stiff), Status::Running);
    }
    assert!((stepper.state()[0] - stepper.time().cos()).abs() < 1e-8);
    // Where there is no solution, the run ends and says so.
    let mut bound = Ode::new(1, |_t, x: &[f64], f: &mut [f64]| f[0] = 1e4 * (1.0 + x[0] * x[0]));
    let start = exact_start(2, 0.01, |_| 0.0);
    let mut stepper = Multistep::of_method(method(), &start, &bound, 0.0, 0.01, &[0.0]).unwrap();
    assert_eq!(stepper.step(&mut bound), Status::Running, "the start is given");
    assert_eq!(stepper.step(&mut bound), Status::NotSolved);
    assert_eq!((stepper.index(), stepper.state()), (1, &[0.0] as &[_]));
}

/// `x' = f + g` with `f = rate cos t - sin t` and `g = -rate x`, whose solution is `cos t`.
struct Splitting {
    rate: f64,
}

impl Field<f64> for Splitting {
    fn dimension(&self) -> usize {
        1
    }

    fn parts(&self) -> Parts {
        Parts::Additive
    }

    fn evaluate(&mut self, t: f64, x: &[f64], f: &mut [f64], g: &mut [f64]) {
        f[0] = self.rate * t.cos() - t.sin();
        g[0] = -self.rate * x[0];
    }

    fn solve(&mut self, t: f64, next: Affine<'_, f64>, x: &mut [f64]) -> Solved {
        let rest = self.rate * t.cos() - t.sin();
        x[0] = (next.known[0] + next.first * rest) / (1.0 + next.second * self.rate);
        Solved::Converged
    }
}

/// Implicit-explicit rows (Ascher, Ruuth and Wetton 1995): extrapolated backward differentiation, Crank-Nicolson with Adams-Bashforth.
const IMEX: &str = r#"
    [[formula]]
    id = "imex-bdf2"
    alpha = ["1", "-4/3", "1/3"]
    beta = ["0", "4/3", "-2/3"]
    gamma = ["2/3", "0", "0"]
    order = 2
    error_constant = "2/3"
    zero_stable = true
    source = "ascher1995"

    [[formula]]
    id = "imex-bdf3"
    alpha = ["1", "-18/11", "9/11", "-2/11"]
    beta = ["0", "18/11", "-18/11", "6/11"]
    gamma = ["6/11", "0", "0", "0"]
    order = 3
    error_constant = "3/4"
    zero_stable = true
    source = "ascher1995"

    [[formula]]
    id = "cnab"
    alpha = ["1", "-1", "0"]
    beta = ["0", "3/2", "-1/2"]
    gamma = ["1/2", "1/2", "0"]
    order = 2
    error_constant = "5/12"
    zero_stable = true
    source = "ascher1995"
"#;

#[test]
fn implicit_explicit_rows_solve_for_the_stiff_part_alone() {
    let table = FormulaTable::from_toml(IMEX).unwrap();
    for formula in &table {
        let run = |steps: usize| {
            let sigma = 2.0 / steps as f64;
            let mut field = Splitting { rate: 1e3 };
            let start = exact_start(formula.steps(), sigma, f64::cos);
            let method = Method::of(formula);
            assert!(matches!(method, Method::Imex(_)));
            let mut stepper = Multistep::of_method(method, &start, &field, 0.0, sigma, &[1.0]).unwrap();
            largest_error(&mut stepper, &mut field, steps, f64::cos)
        };
        let errors = [40, 80, 160].map(run);
        assert!(errors[0] < 1e-2, "{}: {errors:?}", formula.id());
        let (seen, order) = (slope(&errors), formula.order() as f64);
        assert!((seen - order).abs() < 0.2, "{}: slope {seen}, {errors:?}", formula.id());
    }
    // The same extrapolation with an explicit stiff part blows up.
    let mut field = Splitting { rate: 1e3 };
    let start = exact_start(2, 0.05, f64::cos);
    let mut stepper = Multistep::new(row("sbdf2"), &start, &field, 0.0, 0.05, &[1.0]).unwrap();
    while stepper.index() < 1000 && stepper.step(&mut field) == Status::Running {}
    assert_eq!(stepper.status(), Status::NonFinite);
}

#[test]
fn an_implicit_explicit_row_needs_a_field_of_two_parts() {
    let table = FormulaTable::from_toml(IMEX).unwrap();
    let field = Swing { evaluations: 0 };
    let method = Method::of(table.get("cnab").unwrap());
    let refused = Multistep::of_method(method, &Starter::Rk4, &field, 0.0, 0.1, &[1.0]).unwrap_err();
    assert_eq!(refused, IntegrateError::OnePart { id: "cnab".to_owned() });
}

const PAIRS: [(&str, &str); 4] =
    [("ab2", "am1"), ("ab3", "am2"), ("ab4", "am3"), ("milne-predictor", "milne-simpson2")];

fn modes() -> [(Mode, usize); 4] {
    let two = NonZeroUsize::new(2).unwrap();
    [(Mode::Pec, 1), (Mode::Pece, 2), (Mode::Repeated(two), 3), (Mode::Solved, 1)]
}

#[test]
fn predictor_corrector_pairs_show_their_order_in_every_mode() {
    for (predictor, corrector) in PAIRS {
        for (mode, per_step) in modes() {
            let run = |steps: usize| {
                let sigma = 2.0 / steps as f64;
                let mut field = Swing { evaluations: 0 };
                let method = Method::pair(row(predictor), row(corrector), mode);
                let started = method.steps() - 1;
                let start = exact_start(method.steps(), sigma, swing);
                let mut stepper = Multistep::of_method(method, &start, &field, 0.0, sigma, &[1.0]).unwrap();
                let error = largest_error(&mut stepper, &mut field, steps, swing);
                // PEC evaluates nothing but predictions, the first of which is made when the start is over.
                let first = if mode == Mode::Pec { started + 1 } else { started };
                let expected = first + per_step * (steps - started);
                assert_eq!(field.evaluations, expected, "{predictor} {corrector} {mode:?}");
                error
            };
            let errors = [80, 160, 320].map(run);
            let order = row(corrector).order() as f64;
            let seen = slope(&errors);
            assert!((seen - order).abs() < 0.2, "{predictor} {corrector} {mode:?}: slope {seen}, {errors:?}");
        }
    }
}

#[test]
fn what_a_pair_remembers_is_the_prediction_in_pec_and_the_state_in_pece() {
    let f = |t: f64, x: f64| x * t.cos();
    let sigma = 0.1;
    for mode in [Mode::Pec, Mode::Pece] {
        let mut field = Swing { evaluations: 0 };
        let method = Method::pair(row("ab2"), row("am1"), mode);
        let mut stepper =
            Multistep::of_method(method, &exact_start(2, sigma, swing), &field, 0.0, sigma, &[1.0]).unwrap();
        stepper.step(&mut field);
        let (mut x, mut older, mut newer) = (swing(sigma), f(0.0, 1.0), f(sigma, swing(sigma)));
        for n in 1..30 {
            let t = f64::from(n + 1) * sigma;
            let predicted = x + sigma * (1.5 * newer - 0.5 * older);
            let of_prediction = f(t, predicted);
            x += sigma * 0.5 * (of_prediction + newer);
            (older, newer) = (newer, if mode == Mode::Pec { of_prediction } else { f(t, x) });
            stepper.step(&mut field);
            assert!((stepper.state()[0] - x).abs() < 1e-13, "{mode:?} step {n}");
        }
    }
}

#[test]
fn the_difference_of_predictor_and_corrector_tells_the_error_of_a_step() {
    for (predictor, corrector) in PAIRS {
        let (t0, sigma) = (1.0, 0.01);
        let mut field = Swing { evaluations: 0 };
        let method = Method::pair(row(predictor), row(corrector), Mode::Pece);
        let start = exact_start(method.steps(), sigma, |t: f64| swing(t0 + t));
        let mut stepper = Multistep::of_method(method, &start, &field, t0, sigma, &[swing(t0)]).unwrap();
        while !stepper.is_started() {
            assert_eq!(stepper.error_estimate(), None);
            stepper.step(&mut field);
        }
        // All of the past is exact, so this step's error is the only one.
        stepper.step(&mut field);
        let error = swing(stepper.time()) - stepper.state()[0];
        let estimate = stepper.error_estimate().unwrap()[0];
        assert!((estimate / error - 1.0).abs() < 0.1, "{predictor} {corrector}: {estimate:e} for {error:e}");
    }
}

#[test]
fn a_predictor_need_not_be_stable_but_a_corrector_must() {
    let pair = |predictor, corrector| Method::pair(row(predictor), row(corrector), Mode::Pece);
    let run = |steps: usize| {
        let sigma = 2.0 / steps as f64;
        let mut field = Swing { evaluations: 0 };
        let method = pair("bad-la5-fullorder", "am3");
        let start = exact_start(method.steps(), sigma, swing);
        let mut stepper = Multistep::of_method(method, &start, &field, 0.0, sigma, &[1.0]).unwrap();
        largest_error(&mut stepper, &mut field, steps, swing)
    };
    let errors = [80, 160, 320].map(run);
    assert!((slope(&errors) - 4.0).abs() < 0.2, "{errors:?}");
    let field = Swing { evaluations: 0 };
    let unstable = Multistep::of_method(pair("ab4", "bad-bdf7"), &Starter::Rk8, &field, 0.0, 0.1, &[1.0]);
    assert!(unstable.unwrap_err().to_string().contains("bad-bdf7"));
}

#[test]
fn rows_in_places_that_do_not_fit_are_refused_with_a_sentence() {
    let field = Swing { evaluations: 0 };
    let refused = |method: Method<f64>| {
        let made = Multistep::of_method(method, &Starter::Sufficient, &field, 0.0, 0.1, &[1.0]);
        made.unwrap_err().to_string()
    };
    let implicit_predictor = refused(Method::pair(row("am2"), row("am3"), Mode::Pece));
    assert_eq!(
        implicit_predictor,
        "formula `am2` is implicit and can not be a predictor; choose one that is explicit"
    );
    assert!(refused(Method::pair(row("ab2"), row("ab4"), Mode::Pec)).contains("can not be a corrector"));
    assert!(refused(Method::Implicit(row("ab4").into())).contains("can not be solved"));
    let as_explicit = refused(Method::Explicit(row("bdf2").into()));
    assert_eq!(
        as_explicit,
        Multistep::new(row("bdf2"), &Starter::Rk4, &field, 0.0, 0.1, &[1.0]).unwrap_err().to_string()
    );
    let mixed = Method::pair(Coefficients::from(Arc::new(VaryingAb2)), row("am1"), Mode::Pece);
    assert!(refused(mixed).contains("can not be a pair"));
    assert!(refused(Method::of(Arc::new(Stepless))).contains("no step"));
}

/// The Adams-Bashforth formula of two steps for varying steps.
#[derive(Debug)]
struct VaryingAb2;

impl<T: Scalar> RatioCoefficients<T> for VaryingAb2 {
    fn id(&self) -> &'static str {
        "ab2-varying"
    }

    fn steps(&self) -> usize {
        2
    }

    fn order(&self) -> usize {
        2
    }

    fn write(&self, ratios: &[T], row: RatioRow<'_, T>) {
        let half = ratios[0] / T::from_index(2);
        row.alpha[..2].copy_from_slice(&[T::one(), -T::one()]);
        row.beta[1..].copy_from_slice(&[T::one() + half, -half]);
    }

    fn per_step_constant(&self, ratios: &[T]) -> T {
        T::one() / T::from_index(6) + T::one() / (T::from_index(4) * ratios[0])
    }
}

/// The same with the coefficients for equal steps: on varying ones it has order one.
#[derive(Debug)]
struct UnawareAb2;

impl RatioCoefficients<f64> for UnawareAb2 {
    fn id(&self) -> &'static str {
        "ab2-unaware"
    }

    fn steps(&self) -> usize {
        2
    }

    fn order(&self) -> usize {
        2
    }

    fn write(&self, _ratios: &[f64], row: RatioRow<'_, f64>) {
        VaryingAb2.write(&[1.0], row);
    }

    fn per_step_constant(&self, _ratios: &[f64]) -> f64 {
        5.0 / 12.0
    }
}

/// The trapezoidal rule, which does not look at ratios; as a row of two steps to go with [`VaryingAb2`].
#[derive(Debug)]
struct VaryingTrapezoid;

impl RatioCoefficients<f64> for VaryingTrapezoid {
    fn id(&self) -> &'static str {
        "am1-varying"
    }

    fn steps(&self) -> usize {
        1
    }

    fn order(&self) -> usize {
        2
    }

    fn kind(&self) -> RowKind {
        RowKind::Implicit
    }

    fn write(&self, ratios: &[f64], row: RatioRow<'_, f64>) {
        assert!(ratios.is_empty());
        row.alpha.copy_from_slice(&[1.0, -1.0]);
        row.beta.copy_from_slice(&[0.5, 0.5]);
    }

    fn per_step_constant(&self, _ratios: &[f64]) -> f64 {
        -1.0 / 12.0
    }
}

/// The backward differentiation formula of two steps for varying steps (Hairer, Norsett and Wanner, section III.5), not normalised.
#[derive(Debug)]
struct VaryingBdf2;

impl RatioCoefficients<f64> for VaryingBdf2 {
    fn id(&self) -> &'static str {
        "bdf2-varying"
    }

    fn steps(&self) -> usize {
        2
    }

    fn order(&self) -> usize {
        2
    }

    fn kind(&self) -> RowKind {
        RowKind::Implicit
    }

    fn write(&self, ratios: &[f64], row: RatioRow<'_, f64>) {
        let w = ratios[0];
        row.alpha.copy_from_slice(&[1.0 + 2.0 * w, -(1.0 + w) * (1.0 + w), w * w]);
        row.beta[0] = 1.0 + w;
    }

    fn per_step_constant(&self, ratios: &[f64]) -> f64 {
        let w = ratios[0];
        -(1.0 + w) * (1.0 + w) / (6.0 * w * (1.0 + 2.0 * w))
    }
}

/// A row that needs no past.
#[derive(Debug)]
struct Stepless;

impl RatioCoefficients<f64> for Stepless {
    fn id(&self) -> &'static str {
        "stepless"
    }

    fn steps(&self) -> usize {
        0
    }

    fn order(&self) -> usize {
        0
    }

    fn write(&self, _ratios: &[f64], _row: RatioRow<'_, f64>) {}

    fn per_step_constant(&self, _ratios: &[f64]) -> f64 {
        0.0
    }
}

/// Accepts everything, with steps that go up and down about a mean.
struct Bumpy {
    mean: f64,
    step: usize,
}

impl StepController<f64> for Bumpy {
    fn judge(&mut self, _attempt: &Attempt<'_, f64>) -> Decision<f64> {
        self.step += 1;
        let pattern = [1.0, 1.5, 0.75, 1.25, 0.5];
        Decision::Accept { next: self.mean * pattern[self.step % pattern.len()] }
    }
}

fn bumpy_errors(row: &Coefficients<f64>, mut field: impl Field<f64>, exact: fn(f64) -> f64) -> Vec<f64> {
    let run = |steps: usize| {
        let mean = 2.0 / steps as f64;
        let start = Starter::Given(vec![vec![exact(mean)]]);
        let mut stepper =
            Multistep::of_method(Method::of(row.clone()), &start, &field, 0.0, mean, &[exact(0.0)]).unwrap();
        let mut controller = Bumpy { mean, step: 0 };
        let mut most = 0.0_f64;
        for _ in 0..steps {
            assert_eq!(stepper.step_under(&mut field, &mut controller), Status::Running);
            most = most.max((stepper.state()[0] - exact(stepper.time())).abs());
        }
        most
    };
    [80, 160, 320, 640].map(run).to_vec()
}

#[test]
fn coefficients_that_follow_the_steps_keep_the_order_on_a_bumpy_grid() {
    let swinging = || Swing { evaluations: 0 };
    let aware = bumpy_errors(&Arc::new(VaryingAb2).into(), swinging(), swing);
    assert!((slope(&aware) - 2.0).abs() < 0.1, "{aware:?}");
    let unaware = bumpy_errors(&Arc::new(UnawareAb2).into(), swinging(), swing);
    assert!((slope(&unaware) - 1.0).abs() < 0.1, "{unaware:?}");
    let stiff = bumpy_errors(&Arc::new(VaryingBdf2).into(), Stiff { rate: 1e4 }, f64::cos);
    assert!(stiff[0] < 1e-6 && (slope(&stiff) - 2.0).abs() < 0.1, "{stiff:?}");
}

#[test]
fn at_equal_steps_varying_coefficients_are_those_of_the_table() {
    let run = |row: Coefficients<f64>| {
        let mut field = Swing { evaluations: 0 };
        let start = exact_start(2, 0.01, swing);
        let mut stepper = Multistep::of_method(Method::of(row), &start, &field, 0.0, 0.01, &[1.0]).unwrap();
        for _ in 0..300 {
            stepper.step(&mut field);
        }
        stepper.state()[0]
    };
    for (id, varying) in [("ab2", Arc::new(VaryingAb2).into()), ("bdf2", Arc::new(VaryingBdf2).into())] {
        assert!((run(row(id).into()) - run(varying)).abs() < 1e-12, "{id}");
    }
}

/// Rejects the attempt of one index, with half the step, and accepts all others.
struct RejectOnce {
    at: usize,
    attempts: usize,
}

impl StepController<f64> for RejectOnce {
    fn judge(&mut self, attempt: &Attempt<'_, f64>) -> Decision<f64> {
        self.attempts += 1;
        if self.attempts == self.at {
            return Decision::Reject { retry: attempt.step / 2.0 };
        }
        Decision::Accept { next: attempt.step }
    }
}

#[test]
fn a_rejected_step_leaves_no_trace() {
    let rows: [Method<f64>; 3] = [
        Method::of(Arc::new(VaryingAb2)),
        Method::of(Arc::new(VaryingBdf2)),
        Method::pair(Arc::new(VaryingAb2), Arc::new(VaryingTrapezoid), Mode::Pec),
    ];
    for method in rows {
        let start = exact_start(2, 0.1, swing);
        let mut field = Swing { evaluations: 0 };
        let mut rejected = Multistep::of_method(method.clone(), &start, &field, 0.0, 0.1, &[1.0]).unwrap();
        let mut controller = RejectOnce { at: 4, attempts: 0 };
        // The twin takes the shorter step at once.
        let mut twin_field = Swing { evaluations: 0 };
        let mut twin = Multistep::of_method(method, &start, &twin_field, 0.0, 0.1, &[1.0]).unwrap();
        for n in 0..20 {
            if n == 4 {
                assert_eq!(twin.set_step_size(0.05), Status::Running);
            }
            twin.step(&mut twin_field);
            assert_eq!(rejected.step_under(&mut field, &mut controller), Status::Running);
            assert_eq!((rejected.time(), rejected.state()), (twin.time(), twin.state()), "step {n}");
            assert_eq!(rejected.previous(), twin.previous());
        }
        assert_eq!(controller.attempts, 20);
        // The state from which the step was rejected was evaluated once; a pair evaluates at the rejected one too.
        assert!(field.evaluations - twin_field.evaluations <= 1);
    }
}

#[test]
fn a_candidate_can_be_looked_at_and_dropped() {
    let mut field = Swing { evaluations: 0 };
    let start = exact_start(2, 0.1, swing);
    let method = Method::of(Arc::new(VaryingBdf2));
    let mut stepper = Multistep::of_method(method, &start, &field, 0.0, 0.1, &[1.0]).unwrap();
    stepper.step(&mut field);
    let before = (stepper.time(), stepper.state().to_vec());
    assert_eq!(stepper.predict(&mut field), Status::Running);
    assert_eq!(stepper.correct(&mut field), Status::Running);
    let candidate = stepper.candidate().to_vec();
    assert!((candidate[0] - swing(0.2)).abs() < 1e-2);
    stepper.reject();
    assert_eq!(stepper.accept(), Status::Running, "there is nothing to accept any more");
    assert_eq!((stepper.time(), stepper.state().to_vec(), stepper.index()), (before.0, before.1, 1));
    stepper.predict(&mut field);
    stepper.correct(&mut field);
    stepper.accept();
    assert_eq!((stepper.state(), stepper.index()), (candidate.as_slice(), 2));
}

/// The elementary controller: the error of a step is kept near a tolerance.
struct ElementaryController {
    tolerance: f64,
    rejected: usize,
    shortest: f64,
    longest: f64,
}

impl StepController<f64> for ElementaryController {
    fn judge(&mut self, attempt: &Attempt<'_, f64>) -> Decision<f64> {
        let error = attempt.error.unwrap()[0].abs().max(1e-3 * self.tolerance);
        let power = 1.0 / (attempt.order as f64 + 1.0);
        let next = attempt.step * (0.9 * (self.tolerance / error).powf(power)).clamp(0.3, 1.8);
        if error > self.tolerance {
            self.rejected += 1;
            return Decision::Reject { retry: next };
        }
        (self.shortest, self.longest) = (self.shortest.min(attempt.step), self.longest.max(attempt.step));
        Decision::Accept { next }
    }
}

#[test]
fn a_pair_controls_its_steps_by_the_error_that_it_tells() {
    // x' = p + p' - x, whose solution is the narrow peak p.
    let peak = |t: f64| 1.0 / (1.0 + 25.0 * (t - 5.0).powi(2));
    let slope_of_peak = move |t: f64| -50.0 * (t - 5.0) * peak(t).powi(2);
    let errors = [1e-6, 1e-8].map(|tolerance| {
        let mut field =
            Ode::new(1, |t: f64, x: &[f64], f: &mut [f64]| f[0] = peak(t) + slope_of_peak(t) - x[0]);
        let method = Method::pair(Arc::new(VaryingAb2), Arc::new(VaryingTrapezoid), Mode::Pece);
        let mut stepper =
            Multistep::of_method(method, &Starter::Rk4, &field, 0.0, 0.3, &[peak(0.0)]).unwrap();
        let mut controller =
            ElementaryController { tolerance, rejected: 0, shortest: f64::INFINITY, longest: 0.0 };
        let mut most = 0.0_f64;
        while stepper.time() < 10.0 {
            assert_eq!(stepper.step_under(&mut field, &mut controller), Status::Running);
            most = most.max((stepper.state()[0] - peak(stepper.time())).abs());
        }
        assert!(controller.rejected > 0, "a peak comes as a surprise");
        assert!(controller.longest > 5.0 * controller.shortest);
        most
    });
    assert!(errors[0] < 1e-3 && errors[1] < 5e-5, "{errors:?}");
    assert!(errors[1] < 0.1 * errors[0], "{errors:?}");
}

#[test]
fn a_fixed_row_can_not_be_made_to_take_other_steps() {
    let mut field = Swing { evaluations: 0 };
    let start = exact_start(2, 0.1, swing);
    let stepper = || Multistep::new(row("ab2"), &start, &Swing { evaluations: 0 }, 0.0, 0.1, &[1.0]).unwrap();
    let (mut plain, mut controlled) = (stepper(), stepper());
    let mut controller = Bumpy { mean: 0.1, step: 0 };
    for _ in 0..10 {
        plain.step(&mut field);
        controlled.step_under(&mut field, &mut controller);
        controlled.set_step_size(0.7);
        assert_eq!((plain.time(), plain.state()), (controlled.time(), controlled.state()));
    }
    let before = (controlled.index(), controlled.state().to_vec());
    let mut controller = RejectOnce { at: 1, attempts: 0 };
    assert_eq!(controlled.step_under(&mut field, &mut controller), Status::Rejected);
    assert_eq!((controlled.index(), controlled.state().to_vec()), before);
    assert_eq!(controlled.step(&mut field), Status::Rejected);
}

#[test]
fn steps_that_lead_nowhere_end_the_run() {
    struct Next(f64);
    impl StepController<f64> for Next {
        fn judge(&mut self, _attempt: &Attempt<'_, f64>) -> Decision<f64> {
            Decision::Accept { next: self.0 }
        }
    }
    for next in [0.0, -0.1, 1e-18, f64::NAN, f64::INFINITY] {
        let mut field = Swing { evaluations: 0 };
        let method = Method::of(Arc::new(VaryingAb2));
        let start = exact_start(2, 0.1, swing);
        let mut stepper = Multistep::of_method(method, &start, &field, 0.0, 0.1, &[1.0]).unwrap();
        stepper.step(&mut field);
        assert_eq!(stepper.step_under(&mut field, &mut Next(next)), Status::StepTooSmall, "{next}");
        assert_eq!(stepper.index(), 2, "the step that was accepted is kept");
        assert_eq!(stepper.step(&mut field), Status::StepTooSmall);
    }
}

/// [`Stiff`] whose solver fails where a step is longer than it can do, or after some time.
struct Failing {
    longest: f64,
    until: f64,
    found: f64,
}

impl Field<f64> for Failing {
    fn dimension(&self) -> usize {
        1
    }

    fn evaluate(&mut self, t: f64, x: &[f64], f: &mut [f64], _g: &mut [f64]) {
        Stiff { rate: 50.0 }.evaluate(t, x, f, &mut []);
    }

    fn solve(&mut self, t: f64, next: Affine<'_, f64>, x: &mut [f64]) -> Solved {
        if next.first > self.longest {
            return Solved::NotConverged;
        }
        let solved = Stiff { rate: 50.0 }.solve(t, next, x);
        if t > self.until {
            x[0] = self.found;
        }
        solved
    }
}

#[test]
fn a_failed_solve_ends_the_run_at_the_last_good_state() {
    let longest = |longest| Failing { longest, until: f64::INFINITY, found: 0.0 };
    let run = |mut field: Failing| {
        let method = Method::of(row("bdf2"));
        let start = exact_start(2, 0.1, f64::cos);
        let mut stepper = Multistep::of_method(method, &start, &field, 0.0, 0.1, &[1.0]).unwrap();
        while stepper.index() < 20 && stepper.step(&mut field) == Status::Running {}
        let last = (stepper.status(), stepper.index(), stepper.state()[0]);
        if last.0 != Status::Running {
            stepper.step(&mut field);
        }
        assert_eq!(last, (stepper.status(), stepper.index(), stepper.state()[0]));
        last
    };
    assert_eq!(run(longest(0.01)), (Status::NotSolved, 1, 0.1_f64.cos()));
    assert_eq!(run(longest(1.0)).0, Status::Running);
    for found in [f64::NAN, f64::INFINITY] {
        let (status, index, state) = run(Failing { longest: 1.0, until: 0.95, found });
        assert_eq!((status, index), (Status::NonFinite, 9));
        assert!((state - 0.9_f64.cos()).abs() < 1e-2);
    }
}

#[test]
fn a_controller_may_go_on_with_a_shorter_step_after_a_failure() {
    struct Halving;
    impl StepController<f64> for Halving {
        fn judge(&mut self, attempt: &Attempt<'_, f64>) -> Decision<f64> {
            FixedStep.judge(attempt)
        }
        fn after_failure(&mut self, step: f64, status: Status) -> Option<f64> {
            assert_eq!(status, Status::NotSolved);
            Some(step / 2.0)
        }
    }
    let mut field = Failing { longest: 0.02, until: f64::INFINITY, found: 0.0 };
    let method = Method::of(Arc::new(VaryingBdf2));
    let start = exact_start(2, 0.1, f64::cos);
    let mut stepper = Multistep::of_method(method, &start, &field, 0.0, 0.1, &[1.0]).unwrap();
    while stepper.time() < 1.0 {
        assert_eq!(stepper.step_under(&mut field, &mut Halving), Status::Running);
    }
    assert!((stepper.step_size() - 0.0125).abs() < 1e-15);
    assert!((stepper.state()[0] - stepper.time().cos()).abs() < 1e-3);
    // Without such a controller the same failure is the end.
    let mut field = Failing { longest: 0.02, until: f64::INFINITY, found: 0.0 };
    let method = Method::of(Arc::new(VaryingBdf2));
    let mut stepper = Multistep::of_method(method, &start, &field, 0.0, 0.1, &[1.0]).unwrap();
    stepper.step(&mut field);
    assert_eq!(stepper.step(&mut field), Status::NotSolved);
}

#[test]
fn scenarios_and_planners_know_every_starter_of_the_list_by_name() {
    for kind in StarterKind::ALL {
        let name = kind.name();
        assert_eq!(Starter::<f64>::from(kind).name(), name);
        assert_eq!(StarterKind::by_name(name), Some(kind));
    }
    assert_eq!(StarterKind::by_name("rk5"), None);
}

#[test]
fn a_sufficient_start_is_that_of_the_order() {
    for (id, kind) in [("ab4", Starter::Rk4), ("ab5", Starter::Rk8)] {
        let run = |start: &Starter<f64>| {
            let mut field = Swing { evaluations: 0 };
            let mut stepper = Multistep::new(row(id), start, &field, 0.0, 0.1, &[1.0]).unwrap();
            for _ in 0..20 {
                stepper.step(&mut field);
            }
            stepper.state()[0]
        };
        assert_eq!(run(&Starter::Sufficient), run(&kind), "{id}");
    }
}

#[test]
fn a_built_in_ramp_is_the_ladder_of_the_table() {
    let formula = row("ab4");
    let table = FormulaTable::builtin();
    let ladder = (1..formula.steps()).map_while(|known| table.ramp(formula, known).cloned()).collect();
    let run = |start: &Starter<DoubleDouble>| {
        let zero = DoubleDouble::from(0.0);
        let sigma = DoubleDouble::from_rational(&Rational::new(1.into(), 10.into()));
        let mut field = Swing { evaluations: 0 };
        let mut stepper =
            Multistep::new(formula, start, &field, zero, sigma, &[DoubleDouble::from(1.0)]).unwrap();
        for _ in 0..10 {
            stepper.step(&mut field);
        }
        stepper.state()[0]
    };
    assert_eq!(run(&Starter::Ramp), run(&Starter::Rows(ladder)));
}

#[test]
fn a_gap_that_goes_nowhere_is_refused() {
    let field = Ode::new(1, |_t, x: &[f64], f: &mut [f64]| f[0] = -x[0]);
    for sigma in [0.0, f64::NAN, f64::INFINITY] {
        let refused = Multistep::new(row("ab2"), &Starter::Rk4, &field, 0.0, sigma, &[1.0]).err();
        assert!(matches!(refused, Some(IntegrateError::SamplingGap { .. })), "{sigma}");
    }
}
