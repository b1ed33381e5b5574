//! A trajectory held against what its joints allow, and against itself.
//!
//! Controllers do not play samples: they play a polynomial through them. [`Interpolation`] says which, and everything that is
//! said of a joint follows from the extremes of those polynomials, or from what every smooth motion through the samples has in
//! common.

mod continuity;
mod course;
mod crossing;
mod followers;
mod interpolant;
mod joint_figures;
mod met;
mod noise;
mod resolution;
mod rest;
mod segment;
mod time_figures;

pub use continuity::{Disagreement, Jump};
pub use course::Course;
pub use crossing::Crossing;
pub use followers::Straying;
pub use interpolant::Interpolation;
pub use joint_figures::JointFigures;
pub use met::Met;
pub use rest::Rest;
pub use time_figures::TimeFigures;
