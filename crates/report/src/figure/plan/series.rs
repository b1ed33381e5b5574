//! Values over time.

use super::super::axis::{Axis, Scale};
use super::super::figure::{Figure, Mark};
use super::PlanFigures;
use crate::decimate;

/// The most points of a line: more than a wide drawing has columns of pixels, twice.
const MOST_POINTS: usize = 4000;
/// The shortest range of values that is drawn, as a share of their size: below, lines would show their last digits.
const SHORTEST: f64 = 1e-9;

impl PlanFigures<'_> {
    /// The times and values of all samples that are drawn, decimated.
    pub(super) fn series(&self, value: impl Fn(usize) -> f64) -> Vec<(f64, f64)> {
        let points: Vec<(f64, f64)> = self.samples().map(|n| (self.time(n), value(n))).collect();
        decimate(&points, MOST_POINTS)
    }

    /// A figure over the time that is drawn.
    pub(super) fn over_time(&self, name: String, title: String, y: Axis, marks: Vec<Mark>) -> Figure {
        let x = Axis::new("time t [s]", "t", Scale::Linear, self.span());
        let caption = self.caption("");
        Figure { name, title, x, y, is_isometric: false, caption, size: None, parameter: None, marks }
    }

    /// The first and the last time that is drawn \[s\].
    pub(super) fn span(&self) -> (f64, f64) {
        (self.time(self.from), self.time(self.to - 1))
    }
}

/// A line through points.
pub(super) fn line(name: &str, points: Vec<(f64, f64)>, style: usize) -> Mark {
    Mark::Line { name: name.to_owned(), points, parameter: Vec::new(), style }
}

/// The least and the greatest number of some; nothing of none.
pub(super) fn extent(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    let finite = values.filter(|value| value.is_finite());
    finite.fold(None, |extent, value| {
        let (low, high) = extent.unwrap_or((value, value));
        Some((low.min(value), high.max(value)))
    })
}

/// A range with room around it, long enough for its ticks to be told apart.
pub(super) fn roomy(extent: Option<(f64, f64)>) -> (f64, f64) {
    let (low, high) = extent.unwrap_or((0.0, 1.0));
    let length = (high - low).max(SHORTEST * low.abs().max(high.abs())).max(f64::MIN_POSITIVE * 1e30);
    let room = if high > low { 0.05 * length } else { 0.5 * length.max(1e-3) };
    (low - room, high + room)
}

/// The points' second coordinates.
pub(super) fn heights(marks: &[Mark]) -> impl Iterator<Item = f64> + '_ {
    let points = |mark: &Mark| match mark {
        Mark::Line { points, .. } => points.clone(),
        _ => Vec::new(),
    };
    marks.iter().flat_map(points).map(|point| point.1)
}
