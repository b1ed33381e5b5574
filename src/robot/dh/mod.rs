//! Denavit-Hartenberg tables, as papers and data sheets print them: another way to a [`Robot`](super::Robot).

mod file;
mod table;

pub use table::{DhConvention, DhError, DhRow, DhTable};
