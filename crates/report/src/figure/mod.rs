//! Figures as SVG in one style, each with its numbers as CSV.
//!
//! A [`Figure`] is axes and marks; [`Figure::to_svg`] draws it, [`Figure::to_csv`] writes the numbers down. Colours
//! are those of Okabe and Ito, which people with any kind of colour vision tell apart, and no mark is told by its colour alone.

mod axis;
#[expect(clippy::module_inception, reason = "the file is named after the one type it holds")]
mod figure;
mod formula;
mod layout;
mod ode;
mod order;
mod outline;
mod pareto;
mod plan;
mod robot;
mod sheet;
mod style;
mod svg;
mod sweep;
mod theme;
mod view;

pub use axis::{Axis, Scale};
pub use figure::{Cell, Figure, Mark, Shape};
pub use formula::{
    boundary_figure, comparison, frequency_figure, locus_figure, portrait, radius_figure, region_figure,
    roots_figure,
};
pub use ode::ode_figures;
pub use order::order_figure;
pub use pareto::{FrontPoint, pareto_figure};
pub use plan::{PlanFigures, plan_figures};
pub use robot::robot_figures;
pub use sheet::sheet;
pub use sweep::sweep_figures;
pub use theme::DARK_THEME;
