//! The least distance between bodies over time.

use super::super::axis::{Axis, Scale};
use super::super::figure::{Figure, Mark, Shape};
use super::PlanFigures;
use super::series::{extent, heights, line, roomy};
use crate::plan_text::came_near;
use crate::short;

/// Returns how near bodies were to each other, where that was looked at, beside the margin.
pub(super) fn figures(of: &PlanFigures<'_>) -> Vec<Figure> {
    let Some(closest) = of.distance.filter(|closest| closest.course.len() >= of.to) else {
        return Vec::new();
    };
    let course = line("least distance", of.series(|n| closest.course[n]), 0);
    let (first, last) = of.span();
    let margin = Mark::Guide { points: vec![(first, closest.margin), (last, closest.margin)] };
    let Some((low, high)) = extent(heights(std::slice::from_ref(&course))) else { return Vec::new() };
    let range = roomy(Some((low.min(closest.margin), high.max(closest.margin))));
    let mut marks = vec![margin, course];
    if (first..=last).contains(&closest.t) {
        let points = vec![(closest.t, closest.minimum)];
        marks.push(Mark::Points { name: String::new(), points, shape: Shape::Disk, style: 0 });
    }
    let y = Axis::new("least distance between bodies [m]", "distance", Scale::Linear, range);
    let title = "least distance between bodies over time".to_owned();
    let sentence = sentence(&format!("{}, at t = {} s", came_near(closest), short(closest.t)));
    let figure = of.over_time("distances".to_owned(), title, y, marks);
    vec![Figure { caption: of.caption(&sentence), ..figure }]
}

/// With a capital letter and a full stop.
fn sentence(said: &str) -> String {
    let mut letters = said.chars();
    letters.next().map_or_else(String::new, |first| format!("{}{}.", first.to_uppercase(), letters.as_str()))
}
