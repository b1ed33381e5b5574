//! How well the arms can move their tips, over time.

use nalgebra::Vector6;

use super::super::axis::{Axis, Scale};
use super::super::figure::{Figure, Mark};
use super::series::{extent, heights, line, roomy};
use super::{PlanFigures, Subject};
use kinstep::math::RowRotations;

/// A figure of the singular values of the task Jacobian.
struct Measure {
    name: &'static str,
    title: &'static str,
    label: &'static str,
    scale: Scale,
    of: fn(&RowRotations) -> f64,
    sentence: &'static str,
}

/// Returns `sqrt(det(J J^T))` of the task's rows of each arm.
pub(super) fn manipulability(of: &PlanFigures<'_>) -> Vec<Figure> {
    let measure = Measure {
        name: "manipulability",
        title: "manipulability",
        label: "\u{221a}det(J J\u{1d40})",
        scale: Scale::Linear,
        of: |values| values.values().iter().product(),
        sentence: "The volume of the ellipsoid of tip velocities, but for a constant: zero where a direction is lost.",
    };
    figure(of, &measure).into_iter().collect()
}

/// Returns the smallest singular value of the task Jacobian of each arm.
pub(super) fn smallest(of: &PlanFigures<'_>) -> Vec<Figure> {
    let measure = Measure {
        name: "singular",
        title: "smallest singular value of the task Jacobian",
        label: "smallest singular value [m]",
        scale: Scale::Logarithmic,
        of: RowRotations::smallest,
        sentence: "Of the rows of J that the task asks for, in m, and in rad for orientations.",
    };
    figure(of, &measure).into_iter().collect()
}

/// Returns the condition number of the task Jacobian of each arm.
pub(super) fn condition(of: &PlanFigures<'_>) -> Vec<Figure> {
    let measure = Measure {
        name: "condition",
        title: "condition number of the task Jacobian",
        label: "largest / smallest singular value",
        scale: Scale::Logarithmic,
        of: |values| {
            values.values().iter().fold(0.0, |most: f64, value| most.max(*value)) / values.smallest()
        },
        sentence: "How much harder the tip moves in one direction than in another.",
    };
    figure(of, &measure).into_iter().collect()
}

fn figure(of: &PlanFigures<'_>, measure: &Measure) -> Option<Figure> {
    let samples = of.posed_samples();
    let marks: Vec<Mark> = of
        .arms()
        .map(|subject| line(&subject.arm.name, course(of, subject, measure, &samples), subject.place))
        .collect();
    let (low, high) = extent(heights(&marks).filter(|value| *value > 0.0 || measure.scale == Scale::Linear))?;
    let range = match measure.scale {
        Scale::Logarithmic => ((low / 1.5).max(high * 1e-16), high * 1.5),
        _ => (0.0, roomy(Some((0.0, high))).1),
    };
    let y = Axis::new(measure.label, measure.name, measure.scale, range);
    let figure = of.over_time(measure.name.to_owned(), format!("{} over time", measure.title), y, marks);
    Some(Figure { caption: of.caption(measure.sentence), ..figure })
}

fn course(
    of: &PlanFigures<'_>,
    subject: Subject<'_>,
    measure: &Measure,
    samples: &[usize],
) -> Vec<(f64, f64)> {
    let chain = &subject.staged.chain;
    let mut scratch = chain.scratch();
    let mut jacobian = vec![Vector6::zeros(); chain.dof()];
    let mut values = RowRotations::with_capacity(subject.staged.task.rows(), chain.dof());
    let mut at = |sample: usize| {
        chain.forward(subject.arm.position(sample), &mut scratch).geometric_jacobian(&mut jacobian);
        values.compute(jacobian.len(), |row, column| jacobian[column][row]);
        (of.time(sample), (measure.of)(&values))
    };
    samples.iter().map(|sample| at(*sample)).collect()
}
