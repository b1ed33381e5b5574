//! What can not be searched for.

use crate::formula::MAX_STEPS;

/// Why there is no search.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SearchError {
    /// Steps or order out of reach.
    #[error(
        "explicit rows of {steps} steps have orders 1 to {steps} at most, and {MAX_STEPS} steps at most are searched; \
         order {order} was asked for"
    )]
    OutOfReach {
        /// The steps asked for.
        steps: usize,
        /// The order asked for.
        order: usize,
    },
    /// No strictly zero-stable look-ahead formula exists.
    #[error(
        "no look-ahead formula of {steps} steps and order {order} has only z = 1 on the unit circle: the order fixes \
         r_{index} = {value}, which must be positive; the highest possible order is {highest}, or take --family general"
    )]
    Barrier {
        /// The steps asked for.
        steps: usize,
        /// The order asked for.
        order: usize,
        /// Which coefficient of R is fixed at the wrong sign.
        index: usize,
        /// The value of that coefficient.
        value: String,
        /// The highest order with a strictly zero-stable formula.
        highest: usize,
    },
    /// The order leaves nothing free.
    #[error(
        "order {order} leaves one formula of {steps} steps and nothing to search; `formula derive` shows it"
    )]
    NothingFree {
        /// The steps asked for.
        steps: usize,
        /// The order asked for.
        order: usize,
    },
    /// The denominators allowed are too small.
    #[error(
        "denominators of these formulas are multiples of {least}, so none is within the bound of {bound}; raise it"
    )]
    Denominator {
        /// The largest denominator allowed.
        bound: u32,
        /// The smallest denominator possible.
        least: String,
    },
    /// A word that is no objective.
    #[error("\"{word}\" is no objective{}; known ones: {known}", nearest.as_ref().map_or_else(String::new, |n| format!(" (nearest: {n})")))]
    UnknownObjective {
        /// The word as written.
        word: String,
        /// The nearest known objective, if one is near.
        nearest: Option<String>,
        /// All known objectives.
        known: String,
    },
    /// A weight that is no positive number.
    #[error("the weight \"{text}\" of {word} is no positive number")]
    Weight {
        /// The word of the objective.
        word: String,
        /// The weight as written.
        text: String,
    },
    /// A family that is not known.
    #[error("\"{word}\" is no family; known ones: {known}")]
    UnknownFamily {
        /// The word as written.
        word: String,
        /// All known families.
        known: String,
    },
    /// A formula that can not be a measure for others.
    #[error("{id} has no feedback range with a best step, so nothing can be compared with it")]
    NoTarget {
        /// The id of the formula.
        id: String,
    },
    /// Nothing stable was met.
    #[error("{}", nothing_found(*.starts, *.least_range))]
    NothingFound {
        /// How many starting points there were.
        starts: usize,
        /// The range that a row had to have at least; zero where none was asked for.
        least_range: f64,
    },
    /// So many threads could not be started.
    #[error("{0} threads can not be started; ask for fewer")]
    Threads(usize),
}

fn nothing_found(starts: usize, least_range: f64) -> String {
    let remedy = "raise --starts, or ask for a lower order or more steps";
    if least_range > 0.0 {
        return format!(
            "no strictly zero-stable row with a feedback range of at least {least_range} was found in {starts} starts; lower \
             --least-range, {remedy}"
        );
    }
    format!("no strictly zero-stable row was found in {starts} starts; {remedy}")
}
