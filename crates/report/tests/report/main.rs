//! Pages, and what they promise.

mod markup;
mod paper_page;
mod report_page;
