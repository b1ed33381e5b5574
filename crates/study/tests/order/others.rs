//! Integrators of other people, judged by their samples: SciPy and SUNDIALS from files, and an implicit-explicit method with the
//! defects that a well-known library carried for years because no study looked.
#![allow(clippy::unwrap_used, reason = "a test that can not go on stops")]

use kinstep_study::{Convergence, Criteria, Ladder, OrderStudy, Orders, Problem, Rung, Samples};
use std::convert::Infallible;

/// Samples made by `scripts/other_integrators.py`.
const RUNS: &str = include_str!("../data/other_integrators.json");

#[test]
fn fixed_order_runs_of_scipy_and_sundials_show_their_orders() {
    let document: serde_json::Value = serde_json::from_str(RUNS).unwrap();
    let runs = document["runs"].as_array().unwrap();
    assert!(runs.len() >= 5);
    for run in runs {
        let order = run["order"].as_u64().unwrap() as usize;
        let samples = run["samples"].as_object().unwrap();
        let mut steps: Vec<usize> = samples.keys().map(|steps| steps.parse().unwrap()).collect();
        steps.sort_unstable();
        let ladder = Ladder::from_steps(Problem::SWING.duration, steps).unwrap();
        let states = |rung: Rung| -> Result<Samples, Infallible> {
            let states = samples[&rung.steps.to_string()].as_array().unwrap();
            Ok(Samples { dimension: 1, states: states.iter().map(|x| x.as_f64().unwrap()).collect() })
        };
        let verdict = |claimed: usize| {
            let claims = Orders { formula: Some(claimed), ..Orders::default() };
            let study = OrderStudy::new(ladder.clone()).claiming(claims);
            study.of_samples(Problem::SWING.exact, states).unwrap().formula.unwrap().verdict
        };
        assert!(verdict(order).is_confirmed(), "{}: {}", run["name"], verdict(order));
        assert!(verdict(order + 1).is_not_reached(), "{}: {}", run["name"], verdict(order + 1));
    }
}

/// What can be wrong with an implementation of the semi-implicit BDF.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Defect {
    None,
    /// The formula of k samples runs one step before there are k samples: the oldest one is still the initial value.
    RampTooFast,
    /// The explicit parts of older samples are not shifted during the start: they keep their initial values until the formula
    /// first reads them.
    StaleHistory,
    /// The coefficients of a uniform grid are used for a last step that was clipped to end on time.
    ClippedStep,
}

/// x' = -2 (x - cos(t + 1)) - sin(t + 1), whose solution is cos(t + 1): -2 x is implicit, the rest explicit.
const RATE: f64 = 2.0;
const DURATION: f64 = 1.0;

fn solution(t: f64) -> f64 {
    (t + 1.0).cos()
}

/// The end-point error of SBDF of `order` 2 or 3.
fn sbdf(order: usize, defect: Defect, steps: usize) -> f64 {
    // A clipped run has a gap that does not divide the duration.
    let sigma =
        if defect == Defect::ClippedStep { DURATION / (steps as f64 - 0.5) } else { DURATION / steps as f64 };
    let explicit = |t: f64| -(t + 1.0).sin() + RATE * solution(t);
    let (alpha, beta): (&[f64], &[f64]) = match order {
        2 => (&[1.5, -2.0, 0.5], &[2.0, -1.0]),
        _ => (&[11.0 / 6.0, -3.0, 1.5, -1.0 / 3.0], &[3.0, -3.0, 1.0]),
    };
    let (mut x, mut f) = (vec![solution(0.0); order], vec![explicit(0.0); order]);
    // An honest start takes exact samples; the defective ones start as the library did.
    let exact_start = matches!(defect, Defect::None | Defect::ClippedStep);
    let mut t = 0.0;
    for n in 0..steps {
        let step = if defect == Defect::ClippedStep && n + 1 == steps { DURATION - t } else { sigma };
        f[0] = explicit(t);
        let ready = match defect {
            Defect::RampTooFast => n >= 1,
            _ => n + 1 >= order,
        };
        let next = if ready {
            let past: f64 = alpha[1..].iter().zip(&x).map(|(a, x)| a * x).sum();
            let slope: f64 = beta.iter().zip(&f).map(|(b, f)| b * f).sum();
            (step * slope - past) / (alpha[0] + step * RATE)
        } else if exact_start || defect == Defect::StaleHistory {
            solution(t + step)
        } else {
            (x[0] + step * f[0]) / (1.0 + step * RATE)
        };
        x.rotate_right(1);
        x[0] = next;
        if defect != Defect::StaleHistory || ready {
            f.rotate_right(1);
        }
        t += step;
    }
    (x[0] - solution(t)).abs()
}

fn judged(order: usize, defect: Defect) -> Convergence {
    let steps = [40, 80, 160, 320, 640];
    let sigmas = steps.map(|steps| DURATION / f64::from(steps));
    let errors = steps.map(|steps| sbdf(order, defect, steps as usize));
    Convergence::judge(&sigmas, &errors, 1e-14, Some(order), &Criteria::default())
}

#[test]
fn the_defects_of_a_semi_implicit_bdf_are_found_and_its_order_one_is_named() {
    for order in [2, 3] {
        let sound = judged(order, Defect::None);
        assert!(sound.verdict.is_confirmed(), "order {order}: {}", sound.verdict);
        let clipped = judged(order, Defect::ClippedStep);
        assert!(clipped.verdict.is_not_reached(), "order {order}: {}", clipped.verdict);
        assert!((clipped.finest_slope().unwrap() - 1.0).abs() < 0.2, "order {order}: {}", clipped.verdict);
    }
    for defect in [Defect::RampTooFast, Defect::StaleHistory] {
        let seen = judged(3, defect);
        assert!(seen.verdict.is_not_reached(), "{defect:?}: {}", seen.verdict);
    }
}
