//! The arms at intervals, from faint to strong, with the paths of their tips.

use nalgebra::Vector3;

use super::super::figure::{Figure, Mark, Shape};
use super::super::view::{View, spread};
use super::links::links_between;
use super::{PlanFigures, Subject};
use crate::short;

/// How often the arms are drawn.
const DRAWN: usize = 12;
/// How thick a scene may be that lies in a plane, as a share of its size.
const THIN: f64 = 0.02;
/// The style of bases.
const BASE: usize = 6;

/// An arm in space: where its links are in the drawn instants, and where its tip goes.
struct Course<'a> {
    subject: Subject<'a>,
    /// From base to tip, instant by instant.
    arms: Vec<(f64, Vec<Vector3<f64>>)>,
    tip: Vec<(f64, Vector3<f64>)>,
}

/// Returns the motion as seen from the sides that tell something: one of what moves in a plane, else four.
pub(super) fn figures(of: &PlanFigures<'_>) -> Vec<Figure> {
    let courses: Vec<Course<'_>> = of.arms().map(|subject| Course::of(of, subject)).collect();
    let finite = |point: &Vector3<f64>| point.iter().all(|x| x.is_finite());
    let points: Vec<Vector3<f64>> = courses.iter().flat_map(Course::points).filter(finite).collect();
    if points.is_empty() {
        return Vec::new();
    }
    let views = views(&points);
    let alone = views.len() == 1;
    views.iter().map(|view| figure(of, &courses, &points, (view, alone))).collect()
}

/// The directions from which a scene is looked at.
fn views(points: &[Vector3<f64>]) -> Vec<View> {
    let extent = |axis: usize| spread(points.iter().map(|point| point[axis]));
    let size = (0..3).map(extent).fold(0.0, f64::max);
    let [slanted, front, side, top] = View::all();
    let flat = [(2, top), (1, side), (0, front)].into_iter().find(|(axis, _)| extent(*axis) <= THIN * size);
    flat.map_or_else(|| vec![slanted, front, side, top], |(_, view)| vec![view])
}

impl<'a> Course<'a> {
    fn of(of: &PlanFigures<'_>, subject: Subject<'a>) -> Self {
        let stage = of.recording.stage;
        let machine = &stage.machines[subject.staged.machine];
        let chain = &subject.staged.chain;
        let links = links_between(&machine.robot, chain.base(), chain.tip());
        let places = |sample: usize| -> Vec<Vector3<f64>> {
            let positions = |arm: usize| of.positions(&stage.arms[arm].name, sample);
            let poses = machine.link_poses(&stage.machine_positions(subject.staged.machine, positions));
            links.iter().map(|link| poses[*link].translation.vector).collect()
        };
        let arms = instants(of).into_iter().map(|sample| (of.time(sample), places(sample))).collect();
        let tip = of.posed_samples().into_iter();
        let tip = tip.filter_map(|sample| Some((of.time(sample), *places(sample).last()?))).collect();
        Self { subject, arms, tip }
    }

    fn points(&self) -> impl Iterator<Item = Vector3<f64>> + '_ {
        self.arms
            .iter()
            .flat_map(|(_, places)| places.iter().copied())
            .chain(self.tip.iter().map(|(_, place)| *place))
    }

    fn marks(&self, view: &View) -> Vec<Mark> {
        let style = self.subject.place;
        let name = &self.subject.arm.name;
        let count = self.arms.len();
        let mut marks: Vec<Mark> = Vec::new();
        for (k, (t, places)) in self.arms.iter().enumerate() {
            let is_last = k + 1 == count;
            let strength = 0.12 + 0.38 * k as f64 / count.max(2) as f64;
            marks.push(Mark::Stroke {
                name: format!("{name} at {} s", short(*t)),
                points: places.iter().map(|place| view.at(place)).collect(),
                style,
                width: if is_last { 3.4 } else { 1.6 },
                opacity: if is_last { 1.0 } else { strength },
                is_dashed: false,
            });
        }
        marks.push(Mark::Line {
            name: name.clone(),
            points: self.tip.iter().map(|(_, place)| view.at(place)).collect(),
            parameter: self.tip.iter().map(|(t, _)| *t).collect(),
            style,
        });
        marks
    }

    fn base(&self, view: &View) -> Option<(f64, f64)> {
        Some(view.at(self.arms.first()?.1.first()?))
    }
}

impl PlanFigures<'_> {
    /// The joint positions of an arm of the stage; one that the trajectory does not have rests as it stands.
    fn positions(&self, name: &str, sample: usize) -> &[f64] {
        let arm = self.recording.trajectory.arms.iter().find(|arm| arm.name == name);
        arm.map_or(&[], |arm| arm.position(sample))
    }
}

/// The samples at which arms are drawn, the first and the last among them.
fn instants(of: &PlanFigures<'_>) -> Vec<usize> {
    let last = of.to - 1 - of.from;
    let mut samples: Vec<usize> = (0..=DRAWN).map(|k| of.from + last * k / DRAWN).collect();
    samples.dedup();
    samples
}

fn figure(
    of: &PlanFigures<'_>,
    courses: &[Course<'_>],
    points: &[Vector3<f64>],
    (view, alone): (&View, bool),
) -> Figure {
    let seen: Vec<(f64, f64)> = points.iter().map(|point| view.at(point)).collect();
    let range = |values: &dyn Fn(&(f64, f64)) -> f64| {
        let (low, high) =
            seen.iter().map(values).fold((f64::MAX, f64::MIN), |(a, b), x| (a.min(x), b.max(x)));
        (low, high)
    };
    let ((left, right), (low, high)) = (range(&|p| p.0), range(&|p| p.1));
    let room = 0.06 * (right - left).max(high - low).max(1e-6);
    // A scene that is very long in one direction still gets some room in the other.
    let least = 0.35 * (right - left).max(high - low);
    let widen = |low: f64, high: f64| ((least - (high - low)) / 2.0).max(0.0) + room;
    let [x, y] = view.axes(
        (left - widen(left, right), right + widen(left, right)),
        (low - widen(low, high), high + widen(low, high)),
    );
    let bases = courses.iter().filter_map(|course| course.base(view)).collect();
    let base = Mark::Points { name: "base".to_owned(), points: bases, shape: Shape::Square, style: BASE };
    let marks = courses.iter().flat_map(|course| course.marks(view)).chain([base]).collect();
    let name = if alone { "motion".to_owned() } else { format!("motion-{}", view.name) };
    let title = if alone { "motion".to_owned() } else { format!("motion, {}", view.title) };
    let (first, last) = of.span();
    let sentence = format!(
        "From faint to strong: the arms from {} to {} s, with the paths of their tips.",
        short(first),
        short(last)
    );
    Figure {
        name,
        title,
        x,
        y,
        is_isometric: true,
        caption: of.caption(&sentence),
        size: None,
        parameter: Some("t".to_owned()),
        marks,
    }
}
