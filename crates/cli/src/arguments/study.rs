//! Arguments of the commands that run many plans.

use std::path::PathBuf;

use clap::Args;

use super::OutArguments;

#[derive(Debug, Args)]
pub(crate) struct OrderArguments {
    /// Scenario files, or names of built-in problems; without any, the built-in problems are listed
    #[arg(value_name = "SCENARIO")]
    pub(crate) scenarios: Vec<String>,

    /// A row to study in place of those that the scenario names. May be given again
    #[arg(long, value_name = "ID")]
    pub(crate) formula: Vec<String>,

    /// Lay a value over every scenario. May be given again
    #[arg(long, value_name = "KEY.PATH=VALUE")]
    pub(crate) set: Vec<String>,

    #[command(flatten)]
    pub(crate) written: OutArguments,
}

#[derive(Debug, Args)]
pub(crate) struct SweepArguments {
    /// Scenario files; each is swept
    #[arg(value_name = "SCENARIO", required = true)]
    pub(crate) scenarios: Vec<PathBuf>,

    /// A key of the scenario and its values. May be given again: all combinations are run
    #[arg(long, value_name = "KEY.PATH=VALUES", allow_hyphen_values = true)]
    pub(crate) vary: Vec<String>,

    /// The table: .csv or .json
    #[arg(long, value_name = "FILE")]
    pub(crate) out: PathBuf,

    /// How often distributions are drawn for every combination of the lists
    #[arg(long, default_value_t = 100)]
    pub(crate) samples: usize,

    /// What the draws depend on
    #[arg(long, default_value_t = 1)]
    pub(crate) seed: u64,

    /// Lay a value over every scenario. May be given again
    #[arg(long, value_name = "KEY.PATH=VALUE")]
    pub(crate) set: Vec<String>,

    /// Number of threads; all processors unless given. The table does not depend on it
    #[arg(long)]
    pub(crate) threads: Option<usize>,

    /// Draw the table too, into this folder: a map, lines or histograms as SVG, their numbers beside them as CSV
    #[arg(long, value_name = "DIR")]
    pub(crate) plot: Option<PathBuf>,

    /// Replace a table that is already there, and begin afresh
    #[arg(long)]
    pub(crate) force: bool,
}

#[derive(Debug, Args)]
pub(crate) struct ReproduceArguments {
    #[command(flatten)]
    pub(crate) written: OutArguments,

    /// Leave out the pages
    #[arg(long, requires = "out")]
    pub(crate) no_report: bool,

    /// Write the page about the paper, in Markdown, with every order measured anew
    #[arg(long, value_name = "FILE", conflicts_with = "out")]
    pub(crate) page: Option<PathBuf>,
}
