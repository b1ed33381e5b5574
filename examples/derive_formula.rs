//! From a stencil with a gap to a checked row: the exact family first, then one member of it.

#![allow(clippy::print_stdout)]

use kinstep::formula::FormulaTable;
use kinstep::formula::derive::{DerivedFamily, Stencil, barrier};
use kinstep::math::parse_rational;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    // x_(n+1), x_n, x_(n-1), x_(n-3), with the derivatives at t_n and t_(n-1).
    let family = DerivedFamily::of_order(Stencil::new(&[1, 0, -1, -3], &[0, -1])?, 3)?;
    for (unknown, polynomial) in family.coefficients() {
        println!("{unknown:<6} {polynomial}");
    }
    println!("C      {}", family.error_constant());

    let values: Vec<_> =
        family.parameters().iter().map(|_| parse_rational("1/4")).collect::<Result<_, _>>()?;
    let row = family.row("mine", &values)?.check().to_toml();
    println!("\n{row}");

    // What is printed is a finished row: any table takes it.
    let table = FormulaTable::from_toml(&row)?;
    println!("feedback range {}", table.get("mine")?.feedback_range());

    // How far look-ahead formulas can go at all.
    for steps in 1..=10 {
        if let Some(barrier) = barrier(steps) {
            println!("{steps} steps: order {} at most", barrier.order);
        }
    }
    Ok(())
}
