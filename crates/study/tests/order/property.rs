//! Random formulas on random arms and paths show the order that was proved for them, and broken ones do not.
//!
//! The number of cases is bounded so that this file takes well under a minute on two cores; every run draws the same
//! ones. The long run:
//!
//! ```text
//! PROPTEST_CASES=2000 PROPTEST_RNG_SEED=1 cargo test --all-features --test order property -- --nocapture
//! ```
#![allow(
    clippy::unwrap_used,
    clippy::print_stdout,
    reason = "a test that can not go on stops, and says what it counted"
)]

use kinstep::planner::PlanStatus;
use kinstep_study::strategies::{
    OrderCase, UnstableCase, diverging, order_at_fixed_gain, order_at_fixed_step,
};
use kinstep_study::{Convergence, OrderReport, Verdict};
use proptest::strategy::Strategy;
use proptest::test_runner::{Config, RngSeed, TestCaseError, TestCaseResult, TestRunner};
use std::cell::RefCell;
use std::fmt;

/// The seed of the bounded run.
const SEED: u64 = 20_201_545;

/// What became of the cases of a property.
#[derive(Default)]
struct Tally {
    confirmed: usize,
    exceeded: usize,
    undecided: usize,
}

impl Tally {
    fn count(&mut self, verdict: &Verdict) {
        match verdict {
            Verdict::Confirmed { .. } => self.confirmed += 1,
            Verdict::Exceeded { .. } => self.exceeded += 1,
            _ => self.undecided += 1,
        }
    }

    fn assert_mostly_confirmed(&self) {
        let all = self.confirmed + self.exceeded + self.undecided;
        assert!(all > 0 && 10 * self.confirmed >= 8 * all, "too few could be decided: {self}");
    }
}

impl fmt::Display for Tally {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { confirmed, exceeded, undecided } = self;
        write!(f, "{confirmed} confirmed, {exceeded} exceeded, {undecided} not decidable")
    }
}

/// Runs `property` on `cases` cases (or as many as `PROPTEST_CASES` says); a failure is shrunk and printed with its seed.
fn check<S: Strategy>(cases: u32, strategy: &S, property: impl Fn(S::Value) -> TestCaseResult) {
    let mut config = Config { failure_persistence: None, max_shrink_iters: 200, ..Config::default() };
    if std::env::var_os("PROPTEST_CASES").is_none() {
        config.cases = cases;
    }
    if std::env::var_os("PROPTEST_RNG_SEED").is_none() {
        config.rng_seed = RngSeed::Fixed(SEED);
    }
    let seed = config.rng_seed;
    if let Err(failure) = TestRunner::new(config).run(strategy, property) {
        panic!("with {seed:?} (set PROPTEST_RNG_SEED to repeat it):\n{failure}");
    }
}

fn study(case: &OrderCase) -> Result<OrderReport, TestCaseError> {
    case.study().map_err(|error| TestCaseError::fail(format!("{error}\n{case}")))
}

fn whole_run(report: &OrderReport) -> &Convergence {
    report.task_transient.as_ref().expect("a study of a planner judges the task")
}

/// The claim of every case is confirmed or, in a few, can not be decided; never contradicted.
fn assert_orders(cases: u32, strategy: &impl Strategy<Value = OrderCase>) {
    let tally = RefCell::new(Tally::default());
    check(cases, strategy, |case| {
        let report = study(&case)?;
        let verdict = whole_run(&report).verdict;
        if verdict.is_not_reached() {
            return Err(TestCaseError::fail(format!("{verdict}\n{report}")));
        }
        tally.borrow_mut().count(&verdict);
        Ok(())
    });
    // Seen with --nocapture.
    println!("{}", tally.borrow());
    tally.borrow().assert_mostly_confirmed();
}

#[test]
fn at_fixed_h_the_task_error_has_one_order_more_than_the_formula() {
    assert_orders(256, &order_at_fixed_step());
}

#[test]
fn at_fixed_gain_the_task_error_has_the_order_of_the_formula() {
    assert_orders(256, &order_at_fixed_gain());
}

#[test]
fn a_step_well_beyond_the_range_ends_diverged() {
    check(256, &diverging(), |case: UnstableCase| {
        let planner = case.planner().map_err(|error| TestCaseError::fail(error.to_string()))?;
        let plan = planner.run();
        let lost_rank = plan.arms[0].smallest_singular_value.0 < 1e-2;
        match plan.status {
            PlanStatus::Diverged => Ok(()),
            PlanStatus::Singular | PlanStatus::Unreachable if lost_rank => Ok(()),
            status => Err(TestCaseError::fail(format!(
                "{}: {:?} (max error {:e})",
                status.name(),
                plan.reason,
                plan.arms[0].max_error
            ))),
        }
    });
}
