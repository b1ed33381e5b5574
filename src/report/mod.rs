//! Results written down: one trait, one file per format, and files that are whole or not there.

mod file;
mod table;

pub use file::{WriteError, write_whole};
pub use table::{Table, short, sparkline};
