//! Multistep formulas as rows of exact fractions: read, checked, analysed.
//!
//! A row declares facts about itself and the code computes them; a row that contradicts its own numbers never
//! becomes a [`Formula`]. Order, root condition and feedback range are decided exactly.

mod analysis;
mod bibliography;
mod card_curves;
mod card_snippets;
mod check;
mod closed_form;
mod derivative_rule;
pub mod derive;
mod draft;
mod error;
mod feedback_range;
#[expect(clippy::module_inception, reason = "the file is named after the one type it holds")]
mod formula;
mod hint;
mod limits;
mod noise;
mod order;
mod radius;
mod radius_bound;
mod read;
mod recommend;
mod row;
pub mod search;
mod ssp;
mod table;
mod weights;

pub use analysis::Analysis;
pub use bibliography::bibtex;
pub use card_curves::{FrequencyResponse, RootLocus, StabilityRegion};
pub use card_snippets::{Snippet, recursion};
pub use check::CheckedRow;
pub use closed_form::{Cause, ClosedForm};
pub use derivative_rule::DerivativeRule;
pub use error::{Contradiction, Defect, DefectKind, NotRunnable, Place, TableError, UnknownFormula};
pub use feedback_range::FeedbackRange;
pub use formula::Formula;
pub use hint::{Hint, Slip};
pub use limits::MAX_STEPS;
pub use noise::NoiseGain;
pub use order::order_defect;
pub use radius::Optimum;
pub use read::{Strictness, read_rows};
pub use recommend::{Duty, Merit, Recommendation, merit};
pub use row::{Coefficients, Declared, Row};
pub use table::FormulaTable;

pub use crate::math::RootCondition;
