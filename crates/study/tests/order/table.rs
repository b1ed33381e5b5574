//! Every row of the table that may run shows its order on smooth equations, and no row may run without showing it.
#![allow(clippy::unwrap_used, reason = "a test that can not go on stops")]

use kinstep::formula::{Formula, FormulaTable};
use kinstep_study::{Convergence, Ladder, OrderStudy, Orders, Problem};

/// From far too coarse to the round-off floor; the study finds its own window.
fn ladder(formula: &Formula) -> Ladder {
    let duration = Problem::SWING.duration;
    let ladder = match formula.order() {
        1..=3 => Ladder::halvings(duration, 64, 8),
        4..=5 => Ladder::half_octaves(duration, 64, 13),
        _ => Ladder::half_octaves(duration, 48, 11),
    };
    ladder.expect("these are ladders")
}

fn study(formula: &Formula, claimed: usize, problem: &Problem) -> Convergence {
    let orders = Orders { formula: Some(claimed), ..Orders::default() };
    let report = OrderStudy::new(ladder(formula)).claiming(orders).of_formula(formula, problem).unwrap();
    report.formula.unwrap()
}

/// Rows that are zero-stable, explicit or solved.
fn runnable() -> impl Iterator<Item = &'static Formula> {
    FormulaTable::builtin().iter().filter(|formula| formula.is_zero_stable())
}

#[test]
fn every_row_that_may_run_shows_its_order_on_every_smooth_problem() {
    let mut failures = Vec::new();
    for problem in &Problem::SMOOTH {
        for formula in runnable() {
            let seen = study(formula, formula.order(), problem);
            if !seen.verdict.is_confirmed() {
                failures.push(format!("{} on {}: {}", formula.id(), problem.name, seen.verdict));
            }
        }
    }
    assert!(failures.is_empty(), "{failures:#?}");
}

#[test]
fn no_row_shows_one_order_more() {
    let mut failures = Vec::new();
    for formula in runnable() {
        let seen = study(formula, formula.order() + 1, &Problem::SWING);
        if !seen.verdict.is_not_reached() {
            failures.push(format!("{}: {}", formula.id(), seen.verdict));
        }
    }
    assert!(failures.is_empty(), "{failures:#?}");
}

#[test]
fn weakly_stable_and_implicit_rows_are_among_them_and_the_others_are_refused() {
    assert!(runnable().any(|formula| !formula.is_explicit()));
    assert!(runnable().any(|formula| !formula.is_strictly_zero_stable()));
    let study = OrderStudy::new(Ladder::halvings(Problem::SWING.duration, 64, 4).unwrap());
    for formula in FormulaTable::builtin().iter().filter(|formula| !formula.is_zero_stable()) {
        let refused = study.of_formula(formula, &Problem::SWING).unwrap_err().to_string();
        assert!(refused.contains(formula.id()), "{refused}");
    }
}
