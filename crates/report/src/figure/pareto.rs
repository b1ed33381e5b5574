//! Rows of one kind beside each other: which are surpassed, and which are not.

use super::axis::{Axis, Scale};
use super::figure::{Figure, Mark, Shape};
use kinstep::formula::Formula;
use kinstep::math::rational_to_f64;

/// A row among others of its kind: range, error and decay.
#[derive(Debug, Clone, PartialEq)]
pub struct FrontPoint {
    /// What the row is called.
    pub id: String,
    /// The end of the feedback range.
    pub h_max: f64,
    /// |C|.
    pub per_step: f64,
    /// The least spectral radius.
    pub r_opt: f64,
}

impl FrontPoint {
    /// Returns the point of a formula; one without an optimum counts as having the radius 1.
    pub fn of(formula: &Formula) -> Self {
        Self {
            id: formula.id().to_owned(),
            h_max: formula.feedback_range().value(),
            per_step: rational_to_f64(formula.per_step_constant()).abs(),
            r_opt: formula.optimum().map_or(1.0, |optimum| optimum.radius),
        }
    }

    fn at(&self) -> (f64, f64) {
        (self.h_max, self.per_step)
    }
}

/// More rows on a front than this are grouped by decay instead of named.
const MOST_NAMED: usize = 9;

/// Returns the rows of one number of steps and order as points (h_max, C): those that no other one beats in h_max, C and r_opt
/// together, and the `others`, which the legend calls what it is told to.
pub fn pareto_figure(
    (steps, order): (usize, usize),
    front: &[FrontPoint],
    others: &[FrontPoint],
    called: &str,
) -> Figure {
    let mut leaders = front.to_vec();
    leaders.sort_by(|a, b| a.h_max.total_cmp(&b.h_max));
    let mut marks = Vec::new();
    if !others.is_empty() {
        let points = others.iter().map(FrontPoint::at).collect();
        marks.push(Mark::Points { name: called.to_owned(), points, shape: Shape::Circle, style: 6 });
    }
    let groups = if leaders.len() <= MOST_NAMED { named(&leaders) } else { by_decay(&leaders) };
    for (style, (name, points)) in groups.into_iter().enumerate() {
        let shape = [Shape::Disk, Shape::Diamond, Shape::Square, Shape::Cross][style % 4];
        marks.push(Mark::Points { name, points, shape, style });
    }
    let high = |part: fn(&FrontPoint) -> f64| {
        let values = front.iter().chain(others).map(part).filter(|value| value.is_finite());
        1.1 * values.fold(f64::MIN_POSITIVE, f64::max)
    };
    Figure {
        name: format!("pareto-{steps}-{order}"),
        title: format!("{steps} steps, order {order}: range against error"),
        x: Axis::new("end of the feedback range h_max", "h_max", Scale::Linear, (0.0, high(|p| p.h_max))),
        y: Axis::new("error per step |C|", "C", Scale::Linear, (0.0, high(|p| p.per_step))),
        is_isometric: false,
        caption: String::new(),
        size: None,
        parameter: None,
        marks,
    }
}

/// A name in the legend, and the points that it stands for.
type Group = (String, Vec<(f64, f64)>);

fn named(leaders: &[FrontPoint]) -> Vec<Group> {
    leaders.iter().map(|p| (format!("{} (r_opt {:.3})", p.id, p.r_opt), vec![p.at()])).collect()
}

/// Points in six groups of equal width in r_opt, fastest first.
fn by_decay(leaders: &[FrontPoint]) -> Vec<Group> {
    const GROUPS: usize = 6;
    let low = leaders.iter().map(|p| p.r_opt).fold(f64::INFINITY, f64::min);
    let high = leaders.iter().map(|p| p.r_opt).fold(0.0, f64::max);
    let width = ((high - low) / GROUPS as f64).max(f64::MIN_POSITIVE);
    let group_of = |p: &FrontPoint| (((p.r_opt - low) / width) as usize).min(GROUPS - 1);
    let group = |k: usize| {
        let from = low + width * k as f64;
        let points = leaders.iter().filter(|p| group_of(p) == k).map(FrontPoint::at).collect();
        (format!("r_opt {from:.3} to {:.3}", from + width), points)
    };
    (0..GROUPS).map(group).filter(|(_, points): &Group| !points.is_empty()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn points(count: usize) -> Vec<FrontPoint> {
        let point = |k: usize| {
            let x = k as f64 / count as f64;
            FrontPoint { id: format!("row-{k}"), h_max: 1.0 + x, per_step: 0.2 + x * x, r_opt: 0.6 + 0.3 * x }
        };
        (0..count).map(point).collect()
    }

    #[test]
    fn a_long_front_is_grouped_and_loses_no_row() {
        for count in [1, 3, MOST_NAMED, MOST_NAMED + 1, 40] {
            let figure = pareto_figure((5, 3), &points(count), &points(2), "known");
            let groups: Vec<usize> = figure
                .marks
                .iter()
                .map(|mark| if let Mark::Points { points, .. } = mark { points.len() } else { 0 })
                .collect();
            assert_eq!(groups.iter().sum::<usize>(), count + 2);
            assert!(groups.len() <= 1 + MOST_NAMED, "{groups:?}");
            roxmltree::Document::parse(&figure.to_svg()).expect("well-formed");
        }
    }
}
