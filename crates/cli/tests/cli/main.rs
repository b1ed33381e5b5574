//! The command line, tested by running it.

mod bad_scenarios;
mod checks;
mod exports;
mod files;
mod formula;
mod formula_lab;
mod lab;
#[path = "../../../report/tests/report/markup.rs"]
mod markup;
mod noise;
mod ode;
mod order;
mod page;
mod plan;
mod plot;
mod program;
mod robot;
mod robot_scenarios;
