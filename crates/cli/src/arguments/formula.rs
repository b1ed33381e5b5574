//! Arguments of the commands about formulas.

use std::path::PathBuf;

use clap::{Args, Subcommand, ValueEnum};

use super::OutArguments;

#[derive(Debug, Subcommand)]
pub(crate) enum FormulaCommand {
    /// List the formulas: built-in ones and those of --formulas
    #[command(after_help = "\
Examples:
  kinstep formula list
  kinstep formula list --order 3 --steps 4-6 --zero-stable --sort decay
  kinstep formula list --recommended
  kinstep formula list --derivative-rules
  kinstep formula list --formulas mine.toml")]
    List(FormulaList),
    /// Show formulas in full, by id or typed at the prompt
    #[command(after_help = "\
Examples:
  kinstep formula show la6-wang-guo split-ab6
  kinstep formula show --difference 24,-5,-12,-6,-4,3 --denominator 48
  kinstep formula show --alpha 1,-1,0 --beta 0,3/2,-1/2 --gamma 0,1,0
  kinstep formula show la6-wang-guo --plot pictures     five figures as SVG, their numbers as CSV
  kinstep formula show la6-wang-guo --plot card.svg     all figures on one page
  kinstep formula show split-ab6 --rust > split_ab6.rs

Newest sample first: the first coefficient belongs to x_n+1.")]
    Show(FormulaShow),
    /// Check the rows of a file: what they declare against what their coefficients say
    #[command(after_help = "\
Examples:
  kinstep formula check mine.toml
  kinstep formula check draft.toml --draft      computes what is not declared and prints finished rows")]
    Check(FormulaCheck),
    /// Derive all formulas of a stencil and an order, exactly; with parameters, one of them as a row
    #[command(after_help = "\
Examples:
  kinstep formula derive --samples 1,0,-1,-2,-3,-4 --order 3
  kinstep formula derive --samples 1,0,-1,-2,-3,-4 --order 3 --parameters -1/12,1/16
  kinstep formula derive --samples 1,0 --derivatives 0,-1,-2,-3 --order 4       Adams-Bashforth
  kinstep formula derive --samples 1,0,-1,-3 --derivatives 1,0 --order 4        with a gap, implicit

Offsets count samples from t_n: 1 is the new one, 0 the present one, -1 the one before.")]
    Derive(FormulaDerive),
    /// Search for formulas of given steps and order that are best at something
    #[command(after_help = "\
Examples:
  kinstep formula search --steps 5 --order 3 --objective range
  kinstep formula search --steps 7 --order 4 --objective decay --denominator 480 --seconds 30
  kinstep formula search --steps 8 --order 5 --beat la9-240 --out found
  kinstep formula search --steps 5 --order 4 --family corrected --objective noise

The same arguments and seed find the same rows, whatever the number of threads, unless --seconds cuts the search short.
Written are rows.toml, front.csv and the figure front.svg.")]
    Search(FormulaSearch),
    /// Compare formulas side by side
    #[command(after_help = "\
Examples:
  kinstep formula compare la6-wang-guo la6-twenty-four split-ab4
  kinstep formula compare la6-wang-guo la6-fast --plot both.svg     with figures, and their numbers as CSV")]
    Compare(FormulaCompare),
    /// Say which orders look-ahead formulas can have, and why no higher ones
    #[command(after_help = "Example:\n  kinstep formula barrier --steps 12")]
    Barrier(FormulaBarrier),
    /// Write the page about all formulas, in Markdown, with its pictures
    #[command(after_help = "Example:\n  kinstep formula docs --out docs/formulas.md --force")]
    Docs(FormulaDocs),
}

#[derive(Debug, Args)]
pub(crate) struct FormulaDerive {
    /// Offsets of the states, newest first
    #[arg(long, value_name = "O,...", allow_hyphen_values = true, value_delimiter = ',', required = true)]
    pub(crate) samples: Vec<i64>,

    /// Offsets of the derivatives
    #[arg(
        long,
        value_name = "O,...",
        allow_hyphen_values = true,
        value_delimiter = ',',
        default_value = "0"
    )]
    pub(crate) derivatives: Vec<i64>,

    /// The order that every formula is to have at least
    #[arg(long)]
    pub(crate) order: usize,

    /// A value for each free parameter: integers, fractions or decimals
    #[arg(long, value_name = "P,...", allow_hyphen_values = true)]
    pub(crate) parameters: Option<String>,
}

#[derive(Debug, Args)]
pub(crate) struct FormulaSearch {
    /// Number of steps s
    #[arg(long)]
    pub(crate) steps: usize,

    /// Order p
    #[arg(long)]
    pub(crate) order: usize,

    /// What to be best at: range, decay, error-constant, per-step, noise, steady, economy, or weights such as
    /// range=2,decay=1
    #[arg(long, default_value = "range")]
    pub(crate) objective: String,

    /// Look for rows at least as good as this one in range, error and decay, and better in one of them
    #[arg(long, value_name = "ID", conflicts_with = "objective")]
    pub(crate) beat: Option<String>,

    /// The kind of rows: look-ahead, general, split or corrected
    #[arg(long, default_value = "look-ahead")]
    pub(crate) family: String,

    /// The largest denominator of the free coefficients
    #[arg(long, default_value_t = 480)]
    pub(crate) denominator: u32,

    /// Only rows whose feedback range reaches at least this far
    #[arg(long, value_name = "H", default_value_t = 0.0)]
    pub(crate) least_range: f64,

    /// Seed of the random starting points
    #[arg(long, default_value_t = 1)]
    pub(crate) seed: u64,

    /// Number of starting points; the budget of the search
    #[arg(long, default_value_t = 64)]
    pub(crate) starts: usize,

    /// Stop after so many seconds with what is there
    #[arg(long, default_value_t = 60.0)]
    pub(crate) seconds: f64,

    /// Number of threads; all processors unless given
    #[arg(long)]
    pub(crate) threads: Option<usize>,

    /// How many rows to print
    #[arg(long, default_value_t = 3)]
    pub(crate) rows: usize,

    #[command(flatten)]
    pub(crate) written: OutArguments,
}

#[derive(Debug, Args)]
pub(crate) struct FormulaBarrier {
    /// Up to this number of steps, 18 at most
    #[arg(long, value_name = "S", default_value_t = 16, value_parser = clap::value_parser!(u64).range(1..=18))]
    pub(crate) steps: u64,
}

#[derive(Debug, Args)]
pub(crate) struct FormulaCompare {
    /// Ids of two or more formulas
    #[arg(value_name = "ID", required = true, num_args = 2..)]
    pub(crate) ids: Vec<String>,

    /// Draw the formulas over one another: into a folder, a file per figure, or all on one page when the name ends in .svg; numbers
    /// go beside as CSV
    #[arg(long, value_name = "DIR|FILE")]
    pub(crate) plot: Option<PathBuf>,

    /// Replace figures that are already there
    #[arg(long, requires = "plot")]
    pub(crate) force: bool,
}

#[derive(Debug, Args)]
pub(crate) struct FormulaList {
    /// Only formulas of this family. May be given again
    #[arg(long, value_name = "NAME")]
    pub(crate) family: Vec<String>,

    /// Only this number of steps, or a range such as 4-6
    #[arg(long, value_name = "N", value_parser = span)]
    pub(crate) steps: Option<(usize, usize)>,

    /// Only this order, or a range such as 3-5
    #[arg(long, value_name = "N", value_parser = span)]
    pub(crate) order: Option<(usize, usize)>,

    /// Only formulas that are zero-stable
    #[arg(long)]
    pub(crate) zero_stable: bool,

    /// Best first by this column; formulas without it come last
    #[arg(long, value_name = "KEY")]
    pub(crate) sort: Option<SortKey>,

    /// The formula to use for each number of steps and order, and why
    #[arg(long, conflicts_with_all = ["sort", "derivative_rules"])]
    pub(crate) recommended: bool,

    /// The rules for the derivative of a reference that is known by its samples
    #[arg(long, conflicts_with_all = ["family", "steps", "zero_stable", "sort"])]
    pub(crate) derivative_rules: bool,
}

/// Reads `5` or `4-6`.
fn span(text: &str) -> Result<(usize, usize), String> {
    let number = |part: &str| {
        part.trim()
            .parse::<usize>()
            .map_err(|_| format!("\"{part}\" is no number; give one, or a range such as 4-6"))
    };
    let (low, high) = text.split_once('-').unwrap_or((text, text));
    let (low, high) = (number(low)?, number(high)?);
    if low > high { Err(format!("the range {low}-{high} is empty")) } else { Ok((low, high)) }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum SortKey {
    /// Highest order first
    Order,
    /// Widest feedback range first
    Range,
    /// Least error constant c first
    ErrorConstant,
    /// Least r_opt first
    Decay,
    /// Least gain from feedforward noise at h_opt first
    Noise,
    /// By name
    Id,
}

#[derive(Debug, Args)]
pub(crate) struct FormulaDocs {
    /// The page; its pictures go into the folder `pictures` beside it
    #[arg(long, value_name = "FILE")]
    pub(crate) out: PathBuf,

    /// Replace files that are already there
    #[arg(long)]
    pub(crate) force: bool,
}

#[derive(Debug, Args)]
#[expect(clippy::struct_excessive_bools, reason = "they are switches of a command")]
pub(crate) struct FormulaShow {
    /// Ids of formulas
    #[arg(value_name = "ID")]
    pub(crate) ids: Vec<String>,

    /// Numerators of a difference formula, newest sample first
    #[arg(long, value_name = "A,...", allow_hyphen_values = true, conflicts_with_all = ["alpha", "beta", "gamma"])]
    pub(crate) difference: Option<String>,

    /// Denominator of --difference; 1 unless given
    #[arg(long, value_name = "D", allow_hyphen_values = true, requires = "difference")]
    pub(crate) denominator: Option<String>,

    /// Weights of the states, newest sample first
    #[arg(long, value_name = "A,...", allow_hyphen_values = true, requires = "beta")]
    pub(crate) alpha: Option<String>,

    /// Weights of the right-hand side f
    #[arg(long, value_name = "B,...", allow_hyphen_values = true, requires = "alpha")]
    pub(crate) beta: Option<String>,

    /// Weights of the feedback g; those of f unless given
    #[arg(long, value_name = "G,...", allow_hyphen_values = true, requires = "alpha")]
    pub(crate) gamma: Option<String>,

    /// Draw the formulas: into a folder, a file per figure, or all on one page when the name ends in .svg; numbers
    /// go beside as CSV
    #[arg(long, value_name = "DIR|FILE")]
    pub(crate) plot: Option<PathBuf>,

    /// Replace figures that are already there
    #[arg(long, requires = "plot")]
    pub(crate) force: bool,

    /// Print the recursion in LaTeX instead of the card
    #[arg(long)]
    pub(crate) latex: bool,

    /// Print the weights and the recursion as Rust code instead of the card
    #[arg(long)]
    pub(crate) rust: bool,

    /// Print the weights and the recursion as Python code instead of the card
    #[arg(long)]
    pub(crate) python: bool,

    /// Print the source as a BibTeX entry instead of the card
    #[arg(long)]
    pub(crate) bibtex: bool,
}

#[derive(Debug, Args)]
pub(crate) struct FormulaCheck {
    /// A TOML file of rows (`kinstep schema formula` has its keys)
    pub(crate) file: PathBuf,

    /// Compute the facts that rows do not declare, and print the finished rows
    #[arg(long)]
    pub(crate) draft: bool,
}
