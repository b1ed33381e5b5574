//! The harness that confirms orders fails when anything that makes the order is broken: a coefficient, the order of the
//! history, the start-up, the kind of feedback, the last step. What is claimed stays as it was.
//!
//! Cases are drawn like those of `order_property.rs`; `PROPTEST_CASES` and `PROPTEST_RNG_SEED` work here too.
#![allow(clippy::unwrap_used, reason = "a test that can not go on stops")]

use kinstep::formula::{Coefficients, Formula, FormulaTable};
use kinstep::integrate::Starter;
use kinstep::math::Rational;
use kinstep_study::strategies::{
    FormulaCase, OrderCase, Shape, TimeLawCase, order_at_fixed_gain, order_at_fixed_step,
};
use kinstep_study::{Ladder, OrderReport, OrderStudy, Orders, Problem, Rung, Samples, Verdict};
use proptest::strategy::{Strategy, ValueTree};
use proptest::test_runner::{Config, RngSeed, TestRunner};
use std::convert::Infallible;

const SEED: u64 = 1972;

/// Draws cases, breaks each by `mutate` (which may find nothing to break), and sees that none is confirmed and that nine of ten
/// are found not to reach what they claim over the whole run.
fn assert_caught(
    strategy: impl Strategy<Value = OrderCase>,
    mutate: impl Fn(OrderCase) -> Option<OrderCase>,
) {
    let cases = std::env::var("PROPTEST_CASES").ok().and_then(|cases| cases.parse().ok()).unwrap_or(24);
    let mut config = Config { failure_persistence: None, ..Config::default() };
    if std::env::var_os("PROPTEST_RNG_SEED").is_none() {
        config.rng_seed = RngSeed::Fixed(SEED);
    }
    let mut runner = TestRunner::new(config);
    let (mut caught, mut broken) = (0, 0);
    while broken < cases {
        let case = strategy.new_tree(&mut runner).unwrap().current();
        let Some(mutant) = mutate(case) else { continue };
        let report = mutant.study().unwrap();
        let verdict = verdict(&report);
        assert!(!verdict.is_confirmed(), "a mutant was confirmed\n{report}\n{mutant}");
        broken += 1;
        caught += usize::from(verdict.is_not_reached());
    }
    assert!(10 * caught >= 9 * broken, "only {caught} of {broken} mutants were caught");
}

fn verdict(report: &OrderReport) -> Verdict {
    report.task_transient.as_ref().unwrap().verdict
}

fn with_beta(formula: &Formula, beta: Vec<Rational>) -> Option<FormulaCase> {
    let gamma = if formula.is_split() { formula.gamma().to_vec() } else { beta.clone() };
    let coefficients = Coefficients::General { alpha: formula.alpha().to_vec(), beta, gamma: Some(gamma) };
    FormulaCase::of("mutant", coefficients)
}

/// Adds a multiple of the difference pattern 1, -(m), ... of order p - 1 to beta: the order conditions below p still hold.
fn with_a_wrong_coefficient(mut case: OrderCase) -> Option<OrderCase> {
    let formula = case.formula.formula();
    let p = formula.order();
    if p < 2 || formula.steps() < p {
        return None;
    }
    let mut beta = formula.beta().to_vec();
    let mut entry = Rational::new(1.into(), 8.into());
    for j in 0..p {
        beta[1 + j] += &entry;
        let factor = Rational::new((p - 1 - j).into(), (j + 1).into());
        entry = -entry * factor;
    }
    case.formula = with_beta(formula, beta).filter(|mutant| mutant.formula().order() == p - 1)?;
    Some(case)
}

/// Reads the newest evaluation of f where the one before is meant, and the other way round.
fn with_swapped_history(mut case: OrderCase) -> Option<OrderCase> {
    let formula = case.formula.formula();
    let mut beta = formula.beta().to_vec();
    if formula.order() < 2 || beta[1] == beta[2] {
        return None;
    }
    beta.swap(1, 2);
    case.formula = with_beta(formula, beta)?;
    Some(case)
}

/// Whether the loop still has a stable step where the case holds it: a mutant that diverges is caught by other means.
fn still_stable(case: OrderCase) -> Option<OrderCase> {
    let (formula, sigma) = (case.formula.formula(), case.ladder.rungs().next()?.sigma);
    let h = case.planner(sigma).ok()?.h();
    (formula.spectral_radius(h) <= 0.95).then_some(case)
}

/// Starts by Euler steps on a path that accelerates at once, where Runge-Kutta was claimed. From a cusp it would
/// not, and an error of order three can hide what the start leaves.
fn with_an_euler_start(mut case: OrderCase) -> Option<OrderCase> {
    let accelerates = matches!(case.time_law, TimeLawCase::Sin2 | TimeLawCase::Linear)
        && !matches!(case.path.shape, Shape::Curve("tricuspid" | "astroid", _));
    if case.formula.formula().order() < 3 || !accelerates {
        return None;
    }
    case.start = Starter::Paper;
    Some(case)
}

#[test]
fn a_wrong_coefficient_is_caught() {
    assert_caught(order_at_fixed_step(), |case| still_stable(with_a_wrong_coefficient(case)?));
}

#[test]
fn a_swapped_history_is_caught() {
    assert_caught(order_at_fixed_step(), |case| still_stable(with_swapped_history(case)?));
}

#[test]
fn an_euler_start_claimed_as_runge_kutta_is_caught() {
    assert_caught(order_at_fixed_step(), with_an_euler_start);
}

#[test]
fn a_fixed_gain_claimed_as_a_fixed_step_is_caught() {
    assert_caught(order_at_fixed_gain(), |mut case| {
        case.orders = Orders::at_fixed_step(case.formula.formula().order());
        Some(case)
    });
}

#[test]
fn an_euler_start_is_forgotten_in_the_steady_half() {
    let mut runner = TestRunner::deterministic();
    let mut seen = 0;
    while seen < 8 {
        let case = order_at_fixed_step().new_tree(&mut runner).unwrap().current();
        // Slow loops carry the start into the second half of the coarse runs.
        let Some(case) = with_an_euler_start(case).filter(|case| case.formula.formula().order() == 3) else {
            continue;
        };
        let report = case.study().unwrap();
        assert!(verdict(&report).is_not_reached(), "{report}\n{case}");
        assert!(report.task_steady.as_ref().unwrap().verdict.is_confirmed(), "{report}\n{case}");
        seen += 1;
    }
}

/// Adams-Bashforth 3 as somebody might write it, with ages and the last step to be got wrong.
fn adams_bashforth(ages: [usize; 3], shorten: bool, rung: Rung) -> Samples {
    let problem = Problem::SWING;
    let f = |t: f64, x: f64| {
        let mut derivative = [0.0];
        (problem.derivative)(t, &[x], &mut derivative);
        derivative[0]
    };
    let exact = |n: usize| {
        let mut x = [0.0];
        (problem.exact)(n as f64 * rung.sigma, &mut x);
        x[0]
    };
    let mut states: Vec<f64> = (0..3).map(exact).collect();
    for n in 2..rung.steps {
        let at = |age: usize| f((n - age) as f64 * rung.sigma, states[n - age]);
        let weighted = 23.0 * at(ages[0]) - 16.0 * at(ages[1]) + 5.0 * at(ages[2]);
        let step = if shorten && n + 1 == rung.steps { 0.5 * rung.sigma } else { rung.sigma };
        states.push(states[n] + step * weighted / 12.0);
    }
    Samples { dimension: 1, states }
}

fn of_samples(run: impl Fn(Rung) -> Samples) -> Verdict {
    let ladder = Ladder::halvings(Problem::SWING.duration, 64, 6).unwrap();
    let study = OrderStudy::new(ladder).claiming(Orders::at_fixed_step(3));
    let report = study.of_samples(Problem::SWING.exact, |rung| Ok::<_, Infallible>(run(rung))).unwrap();
    report.formula.unwrap().verdict
}

#[test]
fn the_integrator_of_somebody_else_is_judged_by_its_samples() {
    assert!(of_samples(|rung| adams_bashforth([0, 1, 2], false, rung)).is_confirmed());
    assert!(of_samples(|rung| adams_bashforth([1, 0, 2], false, rung)).is_not_reached(), "swapped ages");
    assert!(of_samples(|rung| adams_bashforth([2, 1, 0], false, rung)).is_not_reached(), "oldest first");
    assert!(
        of_samples(|rung| adams_bashforth([0, 1, 2], true, rung)).is_not_reached(),
        "a shortened last step"
    );
}

#[test]
fn a_run_with_missing_samples_is_not_judged() {
    let verdict = of_samples(|rung| Samples { dimension: 1, states: vec![1.0; rung.steps] });
    assert!(!verdict.is_decided(), "{verdict}");
}

#[test]
fn a_row_that_lies_is_refused_before_it_can_run() {
    let honest = FormulaCase::from(FormulaTable::builtin().get("ab3").unwrap().clone()).to_string();
    assert!(FormulaTable::from_toml(&honest).is_ok());
    let lying = honest.replace("\"23/12\"", "\"24/12\"").replace("\"-4/3\"", "\"-17/12\"");
    assert_ne!(lying, honest);
    assert!(FormulaTable::from_toml(&lying).unwrap_err().to_string().contains("order"));
}
