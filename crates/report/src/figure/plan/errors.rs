//! Task errors over time.

use nalgebra::Vector6;

use super::super::axis::{Axis, Scale};
use super::super::figure::{Figure, Mark};
use super::series::{heights, line};
use super::{PlanFigures, Subject};
use kinstep::task::TaskKind;

/// Errors below this are round-off of anything [m, rad].
const LEAST: f64 = 1e-18;
/// The style of the part where the run starts.
const START: usize = 6;

/// A part of the task error, and what it is called.
struct Part {
    name: &'static str,
    title: &'static str,
    label: &'static str,
    column: &'static str,
    of: fn(&Vector6<f64>) -> f64,
}

const PARTS: [Part; 2] = [
    Part {
        name: "errors",
        title: "position error",
        label: "position error [m]",
        column: "position_error",
        of: |error| error.fixed_rows::<3>(0).norm(),
    },
    Part {
        name: "errors-orientation",
        title: "orientation error",
        label: "orientation error [rad]",
        column: "orientation_error",
        of: |error| error.fixed_rows::<3>(3).norm(),
    },
];

/// Returns position and orientation errors where they are known apart, else their norm.
pub(super) fn figures(of: &PlanFigures<'_>) -> Vec<Figure> {
    if of.errors.iter().any(Option::is_some) {
        return PARTS.iter().filter_map(|part| apart(of, part)).collect();
    }
    let known = |subject: &Subject<'_>| subject.arm.errors.len() >= of.to;
    let norm =
        |subject: Subject<'_>| line(&subject.arm.name, of.series(|n| subject.arm.errors[n]), subject.place);
    let lines: Vec<Mark> = of.arms().filter(known).map(norm).collect();
    figure(of, ["errors", "task error", "norm of the task error [m, rad]", "error"], lines)
        .into_iter()
        .collect()
}

fn apart(of: &PlanFigures<'_>, part: &Part) -> Option<Figure> {
    let turns = |subject: &Subject<'_>| part.name == "errors" || subject.staged.task == TaskKind::Pose;
    let drawn = |subject: Subject<'_>| {
        let errors = of.errors[subject.place].filter(|errors| errors.len() >= of.to)?;
        Some(line(&subject.arm.name, of.series(|n| (part.of)(&errors[n])), subject.place))
    };
    let lines = of.arms().filter(turns).filter_map(drawn).collect();
    figure(of, [part.name, part.title, part.label, part.column], lines)
}

fn figure(of: &PlanFigures<'_>, [name, title, label, column]: [&str; 4], lines: Vec<Mark>) -> Option<Figure> {
    if lines.is_empty() {
        return None;
    }
    let range = range(heights(&lines));
    let marks = start(of, range).into_iter().chain(lines).collect();
    let y = Axis::new(label, column, Scale::Logarithmic, range);
    Some(of.over_time(name.to_owned(), format!("{title} over time"), y, marks))
}

/// From nearly the least error to the largest; the least of hundred is not looked at, as errors may pass through zero.
fn range(errors: impl Iterator<Item = f64>) -> (f64, f64) {
    let mut errors: Vec<f64> = errors.filter(|error| *error > LEAST && error.is_finite()).collect();
    errors.sort_by(f64::total_cmp);
    let (Some(&low), Some(&high)) = (errors.get(errors.len() / 100), errors.last()) else {
        return (LEAST, 1.0);
    };
    // At least two decades: what is flat looks so.
    ((low / 2.0).min(high / 100.0), high * 2.0)
}

/// The part of the run before the formula has all the samples that it reads.
fn start(of: &PlanFigures<'_>, (low, high): (f64, f64)) -> Option<Mark> {
    let (name, steps) = of.start.as_ref()?;
    let times = &of.recording.trajectory.times;
    let ends = times[(*steps).min(times.len() - 1)];
    let (first, last) = of.span();
    (first < ends).then(|| Mark::Region {
        name: format!("start: {steps} steps of {name}"),
        strips: vec![[first, ends.min(last), low, high]],
        style: START,
    })
}
