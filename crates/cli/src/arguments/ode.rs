//! Arguments of the command that solves initial value problems.

use clap::Args;

use super::OutArguments;

#[derive(Debug, Args)]
pub(crate) struct OdeArguments {
    /// A file with a [problem], or the name of a built-in one; without any, problems and methods are listed
    #[arg(value_name = "PROBLEM")]
    pub(crate) problem: Option<String>,

    /// A row of the formula table, in equal steps
    #[arg(long, value_name = "ID", conflicts_with_all = ["predictor", "corrector", "family"])]
    pub(crate) method: Option<String>,

    /// The explicit row of a predictor-corrector pair (PECE), in equal steps
    #[arg(long, value_name = "ID", requires = "corrector", conflicts_with = "family")]
    pub(crate) predictor: Option<String>,

    /// The implicit row of the pair
    #[arg(long, value_name = "ID", requires = "predictor", conflicts_with = "family")]
    pub(crate) corrector: Option<String>,

    /// A family of varying steps and order, adams or bdf; without it and a method, bdf takes over from adams where the problem is stiff
    #[arg(long, value_name = "FAMILY")]
    pub(crate) family: Option<String>,

    /// The relative tolerance
    #[arg(long, value_name = "R", default_value_t = 1e-6, allow_negative_numbers = true)]
    pub(crate) rtol: f64,

    /// The absolute tolerance; a thousandth of the relative one unless given
    #[arg(long, value_name = "A", allow_negative_numbers = true)]
    pub(crate) atol: Option<f64>,

    /// The step of a method in equal steps; that of the file unless given
    #[arg(long, value_name = "S", allow_negative_numbers = true)]
    pub(crate) sigma: Option<f64>,

    /// The end; the duration of the file unless given. Before zero: backwards in time
    #[arg(long, value_name = "T", allow_negative_numbers = true)]
    pub(crate) until: Option<f64>,

    /// Times at which the state is told, with commas between them
    #[arg(long, value_name = "T1,T2,...", value_delimiter = ',', allow_negative_numbers = true)]
    pub(crate) at: Vec<f64>,

    /// Give up after so many steps
    #[arg(long, value_name = "N", default_value_t = 1_000_000)]
    pub(crate) max_steps: usize,

    /// Lay a value over the file. May be given again
    #[arg(long, value_name = "KEY.PATH=VALUE")]
    pub(crate) set: Vec<String>,

    #[command(flatten)]
    pub(crate) written: OutArguments,
}
