//! Results written down: one trait, one file per format, and files that are whole or not there.

mod advice;
mod decimate;
pub mod figure;
mod file;
mod formula_page;
mod order;
mod page;
mod paper_page;
mod plan;
mod plan_details;
mod plan_json;
mod plan_text;
#[cfg(feature = "raster")]
mod raster;
mod table;

pub use advice::{Suggestion, suggestions};
pub use decimate::decimate;
pub use file::{WriteError, write_whole};
pub use formula_page::{FormulaPage, pareto_front};
pub use order::OrderPage;
pub use page::PlanPage;
pub use paper_page::paper_page;
pub use plan::PlanFormat;
pub use plan_details::plan_details;
pub use plan_json::PlanJson;
pub use plan_text::PlanText;
#[cfg(feature = "raster")]
pub use raster::{RasterError, to_pdf, to_png};
pub use table::{Table, short, sparkline};
