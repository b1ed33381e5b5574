//! What a stepper remembers: past states, what the field was there, and the times of both.
//!
//! ```text
//! age          0          1          2     ...
//! time        t_n      t_(n-1)    t_(n-2)
//! state       x_n      x_(n-1)    x_(n-2)
//! evaluation  f_n, g_n ...
//! ```
//!
//! Only an accepted step is committed, so a rejected one leaves nothing to take back.

#[expect(clippy::module_inception, reason = "the file is named after the one type it holds")]
mod history;
mod ring;
mod times;

pub(crate) use history::Origin;
pub(super) use history::{Depths, History};
pub(super) use ring::{BLOCK, Ring};
pub(super) use times::Times;
