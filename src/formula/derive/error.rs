//! What can be wrong with a stencil, an order or the parameters of a family.

use crate::formula::{DefectKind, MAX_STEPS};

/// Why there is no family of formulas as asked for, or no such member of it.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum DeriveError {
    /// Fewer than two samples.
    #[error("a formula needs at least two samples, such as 1,0 for x_n+1 and x_n; {found} given")]
    TooFewSamples {
        /// How many samples there are.
        found: usize,
    },
    /// No derivative at all.
    #[error(
        "a formula needs at least one derivative to be a formula for; give its offset, such as 0 for x'(t_n)"
    )]
    NoDerivative,
    /// An offset twice in one list.
    #[error("offset {offset} is given twice among the {list}; each instant counts once")]
    Repeated {
        /// `samples` or `derivatives`.
        list: &'static str,
        /// The offset that is given twice.
        offset: i64,
    },
    /// A derivative newer than every sample.
    #[error(
        "the derivative at offset {offset} is newer than the newest sample, at {newest}; \
         the newest sample is what a formula is solved for, so no derivative may come after it"
    )]
    DerivativeBeyondNewest {
        /// The derivative's offset.
        offset: i64,
        /// The newest sample's offset.
        newest: i64,
    },
    /// The oldest instant is too far back.
    #[error("the offsets span {steps} steps; rows of up to {MAX_STEPS} steps are built")]
    TooManySteps {
        /// Newest minus oldest offset.
        steps: u64,
    },
    /// Order zero.
    #[error("order 0 is not consistent; ask for order 1 or higher")]
    OrderZero,
    /// More conditions than the unknowns can meet.
    #[error(
        "order {order} can not be reached: it sets {conditions} conditions, and the {unknowns} unknown coefficients of \
         this stencil meet {}",
        feasible(.highest)
    )]
    Infeasible {
        /// The wanted order.
        order: usize,
        /// How many conditions the order sets.
        conditions: usize,
        /// How many coefficients there are to meet them, one being fixed as the scale.
        unknowns: usize,
        /// The highest order that can be had, `None` where not even order 1 can.
        highest: Option<usize>,
    },
    /// Another number of values than the family has parameters.
    #[error(
        "the family has {expected} free parameters and {found} values are given; one value for each is needed"
    )]
    ParameterCount {
        /// The number of parameters.
        expected: usize,
        /// The number of values.
        found: usize,
    },
    /// The weight of the newest sample is zero, so that the formula can not be solved for it.
    #[error(
        "with these parameters the weight of the newest sample is zero, so the formula can not be solved for it"
    )]
    NothingToSolveFor,
    /// The row itself can not be built.
    #[error(transparent)]
    Row(#[from] DefectKind),
}

#[expect(clippy::ref_option, reason = "the message hands over its field")]
fn feasible(highest: &Option<usize>) -> String {
    match highest {
        Some(order) => {
            format!(
                "those of order {order} at most; ask for order {order}, or give further samples or derivatives"
            )
        }
        None => "not even those of order 1; give further samples or derivatives".to_owned(),
    }
}
