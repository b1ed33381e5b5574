//! Solutions of initial value problems.

use super::axis::{Axis, Scale};
use super::figure::{Figure, Mark, Shape};
use kinstep::integrate::Solution;

/// How many unknowns have a line of their own.
const MOST_LINES: usize = 12;
/// How many points a line has at least.
const POINTS: usize = 600;

/// Returns the figures of a solution that kept its steps and is dense: the unknowns over time, the first two in their plane, and
/// the lengths and the orders of the steps.
pub fn ode_figures(title: &str, names: &[String], solution: &Solution<f64>) -> Vec<Figure> {
    let curve = curve(solution);
    let mut figures = vec![over_time(title, names, solution, &curve)];
    if let [first, second, ..] = names {
        figures.push(plane(title, [first, second], &curve));
    }
    figures.extend([steps(title, solution), orders(title, solution)]);
    figures
}

/// Times and states, close enough for a drawing.
fn curve(solution: &Solution<f64>) -> Vec<(f64, Vec<f64>)> {
    let start = solution.steps.first().map_or(0.0, |step| step.t);
    let even = (0..=POINTS).map(|n| start + (solution.t - start) * n as f64 / POINTS as f64);
    let mut curve: Vec<(f64, Vec<f64>)> = even.filter_map(|t| Some((t, solution.at(t)?))).collect();
    curve.extend(solution.steps.iter().map(|step| (step.t, step.x.clone())));
    let sign = if solution.t < start { -1.0 } else { 1.0 };
    curve.sort_by(|a, b| (sign * a.0).total_cmp(&(sign * b.0)));
    curve
}

fn over_time(title: &str, names: &[String], solution: &Solution<f64>, curve: &[(f64, Vec<f64>)]) -> Figure {
    let shown = names.len().min(MOST_LINES);
    let lines = names[..shown].iter().enumerate().map(|(i, name)| Mark::Line {
        name: name.clone(),
        points: curve.iter().map(|(t, x)| (*t, x[i])).collect(),
        parameter: Vec::new(),
        style: i,
    });
    let mut marks: Vec<Mark> = lines.collect();
    let mut happened: Vec<&str> = solution.events.iter().map(|event| event.name.as_str()).collect();
    happened.sort_unstable();
    happened.dedup();
    for (style, name) in happened.into_iter().enumerate() {
        let points = solution.events.iter().filter(|event| event.name == name);
        let points = points.flat_map(|event| event.x[..shown].iter().map(|x| (event.t, *x)));
        marks.push(Mark::Points {
            name: name.to_owned(),
            points: points.collect(),
            shape: Shape::Circle,
            style,
        });
    }
    let caption = if shown < names.len() {
        format!("The first {shown} of {} unknowns.", names.len())
    } else {
        String::new()
    };
    Figure {
        caption,
        ..figure(
            "solution",
            title,
            Axis::new("t", "t", Scale::Linear, times(curve)),
            ("value", "value"),
            marks,
        )
    }
}

fn plane(title: &str, [first, second]: [&String; 2], curve: &[(f64, Vec<f64>)]) -> Figure {
    let points: Vec<(f64, f64)> = curve.iter().map(|(_, x)| (x[0], x[1])).collect();
    let x = Axis::new(first, first, Scale::Linear, range(points.iter().map(|point| point.0)));
    let parameter = curve.iter().map(|(t, _)| *t).collect();
    let line = Mark::Line { name: format!("{second} over {first}"), points, parameter, style: 0 };
    Figure { parameter: Some("t".to_owned()), ..figure("phase", title, x, (second, second), vec![line]) }
}

fn steps(title: &str, solution: &Solution<f64>) -> Figure {
    let lengths = solution.steps.windows(2).map(|pair| (pair[1].t, (pair[1].t - pair[0].t).abs()));
    let points: Vec<(f64, f64)> = lengths.filter(|point| point.1 > 0.0).collect();
    let lengths = range(points.iter().map(|point| point.1));
    let x = Axis::new("t", "t", Scale::Linear, range(points.iter().map(|point| point.0)));
    let line = Mark::Line { name: "length of the step".to_owned(), points, parameter: Vec::new(), style: 0 };
    let y = Axis::new("length of the step", "step", Scale::Logarithmic, (lengths.0 / 2.0, lengths.1 * 2.0));
    Figure { y, ..figure("steps", title, x, ("", ""), vec![line]) }
}

fn orders(title: &str, solution: &Solution<f64>) -> Figure {
    let made = solution.steps.iter().skip(1);
    let points: Vec<(f64, f64)> = made.map(|step| (step.t, step.order as f64)).collect();
    let most = points.iter().map(|point| point.1).fold(1.0, f64::max);
    let x = Axis::new("t", "t", Scale::Linear, range(points.iter().map(|point| point.0)));
    let y = Axis::new("order", "order", Scale::Linear, (0.0, most + 1.0));
    let marks =
        vec![Mark::Points { name: "order of the formula".to_owned(), points, shape: Shape::Disk, style: 0 }];
    Figure { y, ..figure("orders", title, x, ("", ""), marks) }
}

fn figure(name: &str, title: &str, x: Axis, (label, column): (&str, &str), marks: Vec<Mark>) -> Figure {
    let values = marks.iter().flat_map(|mark| match mark {
        Mark::Line { points, .. } | Mark::Points { points, .. } => points.as_slice(),
        _ => &[],
    });
    let (low, high) = range(values.map(|point| point.1));
    let margin = 0.05 * (high - low);
    Figure {
        name: name.to_owned(),
        title: title.to_owned(),
        x,
        y: Axis::new(label, column, Scale::Linear, (low - margin, high + margin)),
        is_isometric: false,
        caption: String::new(),
        size: None,
        parameter: None,
        marks,
    }
}

fn times(curve: &[(f64, Vec<f64>)]) -> (f64, f64) {
    range(curve.iter().map(|(t, _)| *t))
}

fn range(values: impl Iterator<Item = f64>) -> (f64, f64) {
    values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)))
}
