//! The path of each tip beside the desired one.

use nalgebra::Vector3;

use super::super::figure::{Figure, Mark, Shape};
use super::super::view::{View, spread};
use super::{PlanFigures, Subject};
use crate::short;

/// The styles of the path gone, of the desired one, and of its ends.
const GONE: usize = 0;
const DESIRED: usize = 1;
const END: usize = 6;

/// A tip at an instant: where it is, and where it should be.
struct Place {
    t: f64,
    tip: Vector3<f64>,
    desired: Option<Vector3<f64>>,
}

/// Returns a figure for each arm, seen from where its path is widest.
pub(super) fn figures(of: &PlanFigures<'_>) -> Vec<Figure> {
    of.arms().filter_map(|subject| figure(of, subject, &places(of, subject))).collect()
}

fn places(of: &PlanFigures<'_>, subject: Subject<'_>) -> Vec<Place> {
    let chain = &subject.staged.chain;
    let mut scratch = chain.scratch();
    let errors = of.errors[subject.place].filter(|errors| errors.len() >= of.to);
    let mut place = |sample: usize| {
        let tip = chain.forward(subject.arm.position(sample), &mut scratch).position();
        let desired = errors.map(|errors| tip - errors[sample].fixed_rows::<3>(0));
        Place { t: of.time(sample), tip, desired }
    };
    let places = of.posed_samples().into_iter().map(&mut place);
    places.filter(|place| place.tip.iter().all(|x| x.is_finite())).collect()
}

/// The view in which points take most room: along the axis in which they differ least.
fn widest(points: &[Vector3<f64>]) -> View {
    let extent = |axis: usize| spread(points.iter().map(|point| point[axis]));
    let [_, front, side, top] = View::all();
    let [x, y, z] = [0, 1, 2].map(extent);
    if z <= x && z <= y {
        top
    } else if y <= x {
        side
    } else {
        front
    }
}

fn figure(of: &PlanFigures<'_>, subject: Subject<'_>, places: &[Place]) -> Option<Figure> {
    let points: Vec<Vector3<f64>> =
        places.iter().flat_map(|place| [Some(place.tip), place.desired]).flatten().collect();
    let (first, last) = (places.first()?, places.last()?);
    let view = widest(&points);
    let [x, y] = square(&view, &points);
    let mut marks = vec![line("tip", GONE, places, |place| Some(view.at(&place.tip)))];
    let deviations = places.iter().filter_map(|place| Some((place.tip - place.desired?).norm()));
    let farthest = deviations.fold(None, |most: Option<f64>, d| Some(most.map_or(d, |most| most.max(d))));
    if farthest.is_some() {
        marks.push(line("desired", DESIRED, places, |place| Some(view.at(&place.desired?))));
    }
    let end = |name: &str, place: &Place, shape| {
        let points = vec![view.at(&place.tip)];
        Mark::Points { name: name.to_owned(), points, shape, style: END }
    };
    marks.extend([end("first", first, Shape::Circle), end("last", last, Shape::Cross)]);
    let sentence = farthest.map_or_else(String::new, |farthest| {
        format!("In these samples the tip is at most {} m from where it should be.", short(farthest))
    });
    Some(Figure {
        name: subject.stem("paths"),
        title: format!("{}: path of the tip, {}", subject.arm.name, view.title),
        x,
        y,
        is_isometric: true,
        caption: of.caption(&sentence),
        size: None,
        parameter: Some("t".to_owned()),
        marks,
    })
}

fn line(name: &str, style: usize, places: &[Place], at: impl Fn(&Place) -> Option<(f64, f64)>) -> Mark {
    let points: Vec<(f64, f64)> = places.iter().filter_map(at).collect();
    let parameter = places.iter().map(|place| place.t).collect();
    Mark::Line { name: name.to_owned(), points, parameter, style }
}

/// Axes around points, with room, and not much narrower in one direction than in the other.
fn square(view: &View, points: &[Vector3<f64>]) -> [super::super::axis::Axis; 2] {
    let seen: Vec<(f64, f64)> = points.iter().map(|point| view.at(point)).collect();
    let range = |part: fn(&(f64, f64)) -> f64| {
        seen.iter().map(part).fold((f64::MAX, f64::MIN), |(low, high), x| (low.min(x), high.max(x)))
    };
    let (across, up) = (range(|p| p.0), range(|p| p.1));
    let size = (across.1 - across.0).max(up.1 - up.0).max(1e-9);
    let around = |(low, high): (f64, f64)| {
        let room = 0.08 * size + ((0.5 * size - (high - low)) / 2.0).max(0.0);
        (low - room, high + room)
    };
    view.axes(around(across), around(up))
}
