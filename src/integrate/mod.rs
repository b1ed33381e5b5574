//! The one stepper: every row of the formula table runs through [`Multistep`], on plain ODEs and on arms.
//!
//! ```text
//! sum_{j=0..s} alpha_j x_{n+1-j} = sigma sum_j beta_j f_{n+1-j} + sigma sum_j gamma_j g_{n+1-j}
//! ```
//!
//! with `x' = f(t, x) + g(t, x)`, newest sample first (index `j` is time `n + 1 - j`; not the ascending order of
//! Hairer, Norsett and Wanner).

mod equations;
mod field;
mod multistep;
mod ring;
mod runge_kutta;
mod scalar;
mod starter;
mod weights;

pub use equations::{EquationError, EquationField, EquationText, Equations};
pub use field::{Field, Ode, Parts};
pub use multistep::{IntegrateError, Multistep, Status};
pub use runge_kutta::Tableau;
pub use scalar::{Elementary, Scalar};
pub use starter::Starter;
