//! Which rows are stepped, and how they work together.

#[expect(clippy::module_inception, reason = "the file is named after the one type it holds")]
mod method;
mod mode;

pub use method::Method;
pub use mode::Mode;
