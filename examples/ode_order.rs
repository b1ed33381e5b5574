//! Runs formulas of the table on an ordinary differential equation and observes their orders.
//!
//! `cargo run --example ode_order` takes a few rows; `-- ID...` takes yours, `-- FILE.toml ID...` rows from a file.

#![allow(clippy::print_stdout)]

use kinstep::formula::{Formula, FormulaTable};
use kinstep::integrate::{IntegrateError, Multistep, Ode, Starter};
use std::error::Error;
use std::path::Path;

/// Steps per unit of time, each twice the one before.
const LADDER: [usize; 5] = [20, 40, 80, 160, 320];
const DURATION: usize = 4;

fn main() -> Result<(), Box<dyn Error>> {
    let mut ids: Vec<String> = std::env::args().skip(1).collect();
    let mut table = FormulaTable::builtin().clone();
    if let Some(file) = ids.first().filter(|id| Path::new(id).extension().is_some()).cloned() {
        table = table.extended_with(FormulaTable::from_toml(&std::fs::read_to_string(file)?)?)?;
        ids.remove(0);
    }
    if ids.is_empty() {
        ids = ["la2-euler", "la6-wang-guo", "ab4", "split-ab6"].map(str::to_owned).to_vec();
    }
    println!(
        "x' = x cos t, x(0) = 1, on [0, {DURATION}]: largest error for sigma = 1/20, 1/40, ..., and the slopes\n"
    );
    for id in ids {
        let formula = table.get(&id)?;
        let errors = LADDER.iter().map(|&n| largest_error(formula, n)).collect::<Result<Vec<_>, _>>()?;
        let slopes: Vec<String> =
            errors.windows(2).map(|e| format!("{:5.2}", (e[0] / e[1]).log2())).collect();
        let errors: Vec<String> = errors.iter().map(|error| format!("{error:.1e}")).collect();
        println!("{id:14} order {}   {}   slopes {}", formula.order(), errors.join(" "), slopes.join(" "));
    }
    Ok(())
}

/// The largest error along the whole run against the exact solution `exp(sin t)`.
fn largest_error(formula: &Formula, steps_per_second: usize) -> Result<f64, IntegrateError> {
    let mut field = Ode::new(1, |t: f64, x: &[f64], derivative: &mut [f64]| derivative[0] = x[0] * t.cos());
    let sigma = 1.0 / steps_per_second as f64;
    let starter = Starter::sufficient_for(formula.order());
    let mut solution = Multistep::new(formula, &starter, &field, 0.0, sigma, &[1.0])?;
    let mut largest: f64 = 0.0;
    for _ in 0..DURATION * steps_per_second {
        solution.step(&mut field);
        largest = largest.max((solution.state()[0] - solution.time().sin().exp()).abs());
    }
    Ok(largest)
}
