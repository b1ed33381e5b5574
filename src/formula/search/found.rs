//! A row that a search has found.

use crate::formula::CheckedRow;

use super::figures::Figures;

/// A row that was found, with its exactly decided figures.
#[derive(Debug, Clone)]
pub struct Found {
    /// The row, which declares nothing; [`CheckedRow::to_toml`] writes it with all its facts.
    pub checked: CheckedRow,
    /// The exactly decided figures of the row.
    pub figures: Figures,
    /// The merit of the figures (see [`Objective::merit`](super::Objective::merit)).
    pub merit: f64,
    /// The denominator of the free coefficients.
    pub denominator: u32,
}
