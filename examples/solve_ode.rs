#![allow(clippy::print_stdout)]
//! Initial value problems: a stiff one that nobody called so, one with events, and one that is kept as a function of time.
//!
//! `cargo run --example solve_ode`

use kinstep::integrate::{Direction, Event, Ode, Solver};

fn main() -> Result<(), Box<dyn std::error::Error>> {
    relaxation()?;
    bouncing()?;
    dense()
}

/// Van der Pol's relaxation oscillation: the Adams family begins, backward differentiation takes over.
fn relaxation() -> Result<(), Box<dyn std::error::Error>> {
    let mut field = Ode::new(2, |_t, x: &[f64], f: &mut [f64]| {
        f[0] = x[1];
        f[1] = 1000.0 * (1.0 - x[0] * x[0]) * x[1] - x[0];
    });
    let solution = Solver::automatic().tolerance(1e-8, 1e-8).solve(&mut field, 0.0, &[2.0, 0.0], 2000.0)?;
    let (method, taken) = (&solution.method, solution.statistics);
    println!(
        "van der Pol at t = 2000: x = {:.8}, by {method} in {} evaluations",
        solution.x[0], taken.evaluations
    );
    Ok(())
}

/// A ball that comes down, thrown up again with four fifths of its velocity: each flight is a problem of its own.
fn bouncing() -> Result<(), Box<dyn std::error::Error>> {
    let mut fall = Ode::new(2, |_t, x: &[f64], f: &mut [f64]| f.copy_from_slice(&[x[1], -9.81]));
    let (mut t, mut velocity) = (0.0, 5.0);
    for bounce in 1..=3 {
        let ground = Event::new("ground", |_t, x: &[f64]| x[0]).direction(Direction::Falling).terminal();
        let flight = Solver::automatic().event(ground).solve(&mut fall, t, &[0.0, velocity], t + 10.0)?;
        (t, velocity) = (flight.t, -0.8 * flight.x[1]);
        println!("bounce {bounce} at t = {t:.6} s");
    }
    Ok(())
}

/// The solution at any time, by the polynomials of the steps.
fn dense() -> Result<(), Box<dyn std::error::Error>> {
    let mut swing = Ode::new(1, |t: f64, x: &[f64], f: &mut [f64]| f[0] = x[0] * t.cos());
    let solution = Solver::automatic().tolerance(1e-10, 1e-10).dense().solve(&mut swing, 0.0, &[1.0], 6.0)?;
    let state = solution.at(2.5).ok_or("2.5 lies within the solution")?;
    println!("x(2.5) = {:.10}, and exp(sin 2.5) = {:.10}", state[0], 2.5_f64.sin().exp());
    Ok(())
}
