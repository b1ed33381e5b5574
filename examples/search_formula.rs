//! The search as a library: the row with the fastest decay, and one that surpasses a known formula everywhere.

#![allow(clippy::print_stdout, clippy::print_stderr)]

use kinstep::formula::FormulaTable;
use kinstep::formula::search::{Family, Objective, Observer, Options, Progress, front_csv, search};

/// Says how far the search has come.
struct Teller;

impl Observer for Teller {
    fn hears(&self, progress: &Progress) {
        eprintln!("{}: {} of {}, best {:?}", progress.stage, progress.done, progress.total, progress.best);
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let fast = Options { starts: 16, front: true, ..Options::new(Family::LookAhead, 5, 3, Objective::Decay) };
    let outcome = search(&fast, &Teller)?;
    println!("the best row that was decided exactly has {:.6}; with small denominators:\n", outcome.bound);
    for found in &outcome.rows {
        println!("{}", found.checked.to_toml());
    }
    println!("{}", front_csv(&outcome.front));

    let known = FormulaTable::builtin().get("la6-wang-guo")?;
    let better = Options { starts: 16, ..Options::new(Family::LookAhead, 5, 3, Objective::beating(known)?) };
    let best = &search(&better, &())?.rows[0];
    println!(
        "{} surpasses {} by {:.0} %",
        best.checked.row().id(),
        known.id(),
        100.0 * best.merit.abs().exp_m1()
    );
    Ok(())
}
