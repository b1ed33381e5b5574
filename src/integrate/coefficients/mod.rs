//! Coefficients of a row, and the weights that a step makes of them.
//!
//! A row says `sum_j alpha_j x_{n+1-j} = sigma sum_j (beta_j f_{n+1-j} + gamma_j g_{n+1-j})`; solved for the new state,
//!
//! ```text
//! x_{n+1} = known + sigma beta_0 f(t_{n+1}, x_{n+1}) + sigma gamma_0 g(t_{n+1}, x_{n+1})
//! known   = sum_{j=1..s} (-alpha_j x_{n+1-j} + sigma beta_j f_{n+1-j} + sigma gamma_j g_{n+1-j})
//! ```
//!
//! At equal steps the weights are computed once; at varying steps they follow from the ratios of the last steps.

#[expect(clippy::module_inception, reason = "the file is named after the one type it holds")]
mod coefficients;
mod combination;
mod kind;
mod ratio;
mod weighted_row;
mod weights;

pub use coefficients::Coefficients;
pub use kind::RowKind;
pub use ratio::{RatioCoefficients, RatioRow};

pub(super) use combination::combine;
pub(super) use weighted_row::WeightedRow;
pub(super) use weights::{Terms, Weights};
