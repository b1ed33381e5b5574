//! The search for formulas of given steps and order that are best at something.
//!
//! Every candidate has its order by construction: only what the order leaves free is varied. A search in doubles from many
//! seeded starting points finds where the best formulas are; fractions near by with small denominators are then improved step by
//! step, and the winners are decided exactly, as every row is. The work is cut into pieces that do not depend on the
//! number of threads, so the same options find the same rows, unless time or the caller ends the search early.
//!
//! ```
//! use kinstep::formula::search::{Family, Objective, Options, search};
//! let options = Options { denominator: 60, starts: 4, ..Options::new(Family::LookAhead, 5, 3, Objective::Range) };
//! let outcome = search(&options, &())?;
//! let best = &outcome.rows[0];
//! assert_eq!(best.checked.analysis().order(), Some(3));
//! assert!(best.figures.h_max >= 4.0 / 3.0);
//! # Ok::<(), kinstep::formula::search::SearchError>(())
//! ```

mod error;
mod evolve;
mod figures;
mod found;
mod front;
mod judge;
mod lattice;
mod objective;
mod run;
mod space;

pub use error::SearchError;
pub use figures::Figures;
pub use found::Found;
pub use front::{front, front_csv};
pub use objective::{Objective, Target, Weight};
pub use run::{Observer, Options, Outcome, Progress, search};
pub use space::Family;
