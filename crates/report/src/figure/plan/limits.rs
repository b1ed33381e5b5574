//! The distance to the nearest joint limit over time.

use super::super::axis::{Axis, Scale};
use super::super::figure::{Figure, Mark, Shape};
use super::series::{extent, heights, line, roomy};
use super::{PlanFigures, Subject};
use crate::short;
use kinstep::robot::ChainJoint;

/// Returns how far the joints of each arm are from the nearest of their limits.
pub(super) fn figures(of: &PlanFigures<'_>) -> Vec<Figure> {
    let subjects: Vec<(Subject<'_>, Vec<usize>)> = of
        .arms()
        .map(|subject| (subject, limited(of, subject)))
        .filter(|(_, joints)| !joints.is_empty())
        .collect();
    let mut marks: Vec<Mark> =
        subjects.iter().map(|(subject, joints)| course(of, *subject, joints)).collect();
    let Some((low, high)) = extent(heights(&marks)) else { return Vec::new() };
    let range = roomy(Some((low.min(0.0), high)));
    let closest: Vec<(Mark, String)> =
        subjects.iter().filter_map(|(subject, joints)| closest(of, *subject, joints)).collect();
    let sentences: Vec<String> = closest.iter().map(|(_, sentence)| sentence.clone()).collect();
    if low < 0.0 {
        marks.insert(0, Mark::Guide { points: vec![(of.span().0, 0.0), (of.span().1, 0.0)] });
    }
    marks.extend(closest.into_iter().map(|(mark, _)| mark));
    let turns = |(subject, joints): &(Subject<'_>, Vec<usize>)| {
        joints.iter().all(|joint| subject.staged.chain.joints()[*joint].kind.is_rotation())
    };
    let unit = if subjects.iter().all(turns) { "rad" } else { "rad or m" };
    let y = Axis::new(&format!("distance to the nearest limit [{unit}]"), "distance", Scale::Linear, range);
    let title = "distance to the nearest joint limit".to_owned();
    let figure = of.over_time("limits".to_owned(), title, y, marks);
    vec![Figure { caption: of.caption(&sentences.join(" ")), ..figure }]
}

/// The drawn joints that have a limit.
fn limited(of: &PlanFigures<'_>, subject: Subject<'_>) -> Vec<usize> {
    let joints = subject.staged.chain.joints().iter().enumerate();
    let is_limited = |joint: &ChainJoint| joint.limits.lower.is_finite() || joint.limits.upper.is_finite();
    joints.filter(|(_, joint)| is_limited(joint) && of.shows_joint(&joint.name)).map(|(k, _)| k).collect()
}

/// How far a joint is from its nearer limit; less than nothing beyond it.
fn distance(subject: Subject<'_>, joint: usize, sample: usize) -> f64 {
    let (limits, q) = (subject.staged.chain.joints()[joint].limits, subject.arm.position(sample)[joint]);
    (q - limits.lower).min(limits.upper - q)
}

fn nearest(subject: Subject<'_>, joints: &[usize], sample: usize) -> (usize, f64) {
    let distances = joints.iter().map(|joint| (*joint, distance(subject, *joint, sample)));
    distances.min_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((0, f64::NAN))
}

fn course(of: &PlanFigures<'_>, subject: Subject<'_>, joints: &[usize]) -> Mark {
    line(&subject.arm.name, of.series(|n| nearest(subject, joints, n).1), subject.place)
}

/// Where an arm is closest to a limit, and which joint that is.
fn closest(of: &PlanFigures<'_>, subject: Subject<'_>, joints: &[usize]) -> Option<(Mark, String)> {
    let samples = of.samples().map(|n| (n, nearest(subject, joints, n)));
    let (sample, (joint, distance)) =
        samples.filter(|(_, (_, distance))| distance.is_finite()).min_by(|a, b| a.1.1.total_cmp(&b.1.1))?;
    let (t, joint) = (of.time(sample), &subject.staged.chain.joints()[joint]);
    let unit = if joint.kind.is_rotation() { "rad" } else { "m" };
    let sentence =
        format!("{}: {} by {} {unit} at {} s.", subject.arm.name, joint.name, short(distance), short(t));
    let points = vec![(t, distance)];
    let mark = Mark::Points { name: String::new(), points, shape: Shape::Disk, style: subject.place };
    Some((mark, sentence))
}
