//! Denavit-Hartenberg tables, as papers and data sheets print them: a second door into [`Robot`](super::Robot).

mod file;
mod table;

pub use table::{DhConvention, DhError, DhRow, DhTable};
