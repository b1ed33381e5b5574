//! From sample offsets and a wanted order to the exact family of formulas: a particular one plus free parameters.
//!
//! ```
//! use kinstep::formula::derive::{DerivedFamily, Stencil};
//! // Six samples from x_(n+1) back, derivative at t_n: two parameters are left at order three.
//! let stencil = Stencil::new(&[1, 0, -1, -2, -3, -4], &[0])?;
//! let family = DerivedFamily::of_order(stencil, 3)?;
//! assert_eq!(family.parameters().len(), 2);
//! // The weights of the two oldest samples are the parameters; these give (24, -5, -12, -6, -4, 3)/48.
//! let values = ["-1/12", "1/16"].map(|text| kinstep::math::parse_rational(text).unwrap());
//! let checked = family.row("mine", &values)?.check();
//! assert_eq!(checked.analysis().error_constant().unwrap().to_string(), "5/16");
//! # Ok::<(), kinstep::formula::derive::DeriveError>(())
//! ```

mod barrier;
mod conditions;
mod error;
mod family;
mod look_ahead;
mod stencil;

pub use barrier::{Barrier, BarrierProof, barrier};
pub use error::DeriveError;
pub use family::{Affine, DerivedFamily};
pub use look_ahead::LookAhead;
pub use stencil::{Stencil, Unknown};
