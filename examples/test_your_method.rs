//! Tests the order of an integrator of one's own: Heun's method, and the same with a slip of the pen.
//!
//! `cargo run --example test_your_method` shows what a study says of both. In a crate of your own, put
//! `kinstep-study = "0.1"` under `[dev-dependencies]` and the two tests below into `tests/`; with the feature `proptest` there are
//! strategies for random formulas, arms and paths besides.

#![allow(clippy::print_stdout)]

use kinstep_study::{Ladder, OrderReport, OrderStudy, Orders, Problem, Rung, Samples};
use std::convert::Infallible;

/// One step of Heun's method; `slip` takes the second slope at the old time.
fn heun(t: f64, x: f64, sigma: f64, slip: bool) -> f64 {
    let f = |t: f64, x: f64| x * t.cos();
    let first = f(t, x);
    let second = f(if slip { t } else { t + sigma }, x + sigma * first);
    x + sigma * (first + second) / 2.0
}

/// The samples of a run at 0, sigma, ..., T: all that a study wants to know of an integrator.
fn run(rung: Rung, slip: bool) -> Samples {
    let mut states = vec![1.0];
    for n in 0..rung.steps {
        states.push(heun(n as f64 * rung.sigma, states[n], rung.sigma, slip));
    }
    Samples { dimension: 1, states }
}

fn study(slip: bool) -> Result<OrderReport, Box<dyn std::error::Error>> {
    let ladder = Ladder::halvings(Problem::SWING.duration, 64, 6)?;
    let claims = Orders { formula: Some(2), ..Orders::default() };
    let study = OrderStudy::new(ladder).claiming(claims);
    Ok(study.of_samples(Problem::SWING.exact, |rung| Ok::<_, Infallible>(run(rung, slip)))?)
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("Heun's method:\n{}", study(false)?);
    println!("The same with a slip of the pen:\n{}", study(true)?);
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use kinstep_study::{assert_confirmed, assert_order};

    #[test]
    fn my_method_has_order_two() {
        assert_confirmed!(study(false).unwrap());
    }

    #[test]
    fn end_point_errors_alone_will_do() {
        let sigmas = [0.1, 0.05, 0.025, 0.0125];
        let errors = sigmas.map(|sigma: f64| {
            let steps = (2.0 / sigma).round() as usize;
            let rung = Rung { steps, sigma };
            (run(rung, false).states[steps] - 2.0_f64.sin().exp()).abs()
        });
        assert_order!(2, sigmas, errors);
    }

    #[test]
    #[should_panic(expected = "order 2 not reached")]
    fn the_slip_is_found() {
        assert_confirmed!(study(true).unwrap());
    }
}
