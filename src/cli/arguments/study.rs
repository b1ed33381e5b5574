//! Arguments of the commands that run many plans.

use std::path::PathBuf;

use clap::Args;

use super::OutArguments;

#[derive(Debug, Args)]
pub(in crate::cli) struct OrderArguments {
    /// Scenario files, or names of built-in problems; without any, the built-in problems are listed
    #[arg(value_name = "SCENARIO")]
    pub(in crate::cli) scenarios: Vec<String>,

    /// A row to study in place of those that the scenario names. May be given again
    #[arg(long, value_name = "ID")]
    pub(in crate::cli) formula: Vec<String>,

    /// Lay a value over every scenario. May be given again
    #[arg(long, value_name = "KEY.PATH=VALUE")]
    pub(in crate::cli) set: Vec<String>,

    #[command(flatten)]
    pub(in crate::cli) written: OutArguments,
}

#[derive(Debug, Args)]
pub(in crate::cli) struct SweepArguments {
    /// Scenario files; each is swept
    #[arg(value_name = "SCENARIO", required = true)]
    pub(in crate::cli) scenarios: Vec<PathBuf>,

    /// A key of the scenario and its values. May be given again: all combinations are run
    #[arg(long, value_name = "KEY.PATH=VALUES", allow_hyphen_values = true)]
    pub(in crate::cli) vary: Vec<String>,

    /// The table: .csv or .json
    #[arg(long, value_name = "FILE")]
    pub(in crate::cli) out: PathBuf,

    /// How often distributions are drawn for every combination of the lists
    #[arg(long, default_value_t = 100)]
    pub(in crate::cli) samples: usize,

    /// What the draws depend on
    #[arg(long, default_value_t = 1)]
    pub(in crate::cli) seed: u64,

    /// Lay a value over every scenario. May be given again
    #[arg(long, value_name = "KEY.PATH=VALUE")]
    pub(in crate::cli) set: Vec<String>,

    /// Number of threads; all processors unless given. The table does not depend on it
    #[arg(long)]
    pub(in crate::cli) threads: Option<usize>,

    /// Draw the table too, into this folder: a map, lines or histograms as SVG, their numbers beside them as CSV
    #[arg(long, value_name = "DIR")]
    pub(in crate::cli) plot: Option<PathBuf>,

    /// Replace a table that is already there, and begin afresh
    #[arg(long)]
    pub(in crate::cli) force: bool,
}

#[derive(Debug, Args)]
pub(in crate::cli) struct ReproduceArguments {
    #[command(flatten)]
    pub(in crate::cli) written: OutArguments,

    /// Leave out the pages
    #[arg(long, requires = "out")]
    pub(in crate::cli) no_report: bool,

    /// Write the page about the paper, in Markdown, with every order measured anew
    #[arg(long, value_name = "FILE", conflicts_with = "out")]
    pub(in crate::cli) page: Option<PathBuf>,
}
