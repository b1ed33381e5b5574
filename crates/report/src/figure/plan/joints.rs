//! Joint positions and velocities over time, a figure for each arm.

use super::super::axis::{Axis, Scale};
use super::super::figure::{Figure, Mark};
use super::series::{extent, heights, line, roomy};
use super::{PlanFigures, Subject};
use kinstep::robot::ChainJoint;

/// A limit is drawn where a joint comes nearer to it than this share of its range, or is faster than the rest of it.
const NEAR: f64 = 0.15;

/// A joint of an arm, by its place.
type Drawn<'a> = (usize, &'a ChainJoint);

impl<'a> PlanFigures<'a> {
    fn drawn_joints(&self, subject: Subject<'a>) -> Vec<Drawn<'a>> {
        let joints = subject.staged.chain.joints().iter().enumerate();
        joints.filter(|(_, joint)| self.shows_joint(&joint.name)).collect()
    }
}

/// The unit of joints: one, or that of either kind.
fn unit(joints: &[Drawn<'_>], per: &str) -> String {
    let turns = |joint: &Drawn<'_>| joint.1.kind.is_rotation();
    let units = match (joints.iter().any(turns), joints.iter().all(turns)) {
        (_, true) => vec!["rad"],
        (true, false) => vec!["rad", "m"],
        (false, false) => vec!["m"],
    };
    units.into_iter().map(|unit| format!("{unit}{per}")).collect::<Vec<_>>().join(" or ")
}

/// Returns the joint positions of each arm, with the limits that they come near to.
pub(super) fn positions(of: &PlanFigures<'_>) -> Vec<Figure> {
    of.arms().filter_map(|subject| positions_of(of, subject)).collect()
}

fn positions_of(of: &PlanFigures<'_>, subject: Subject<'_>) -> Option<Figure> {
    let joints = of.drawn_joints(subject);
    let mut marks: Vec<Mark> = joints
        .iter()
        .map(|(k, joint)| line(&joint.name, of.series(|n| subject.arm.position(n)[*k]), *k))
        .collect();
    if marks.is_empty() {
        return None;
    }
    let near: Vec<(usize, f64)> = joints
        .iter()
        .zip(&marks)
        .flat_map(|((k, joint), mark)| limits_near(joint, mark).into_iter().map(|limit| (*k, limit)))
        .collect();
    let range = roomy(extent(heights(&marks).chain(near.iter().map(|limit| limit.1))));
    marks.extend(near.iter().map(|(k, limit)| guide(of, *limit, *k)));
    let caption = if near.is_empty() {
        "No joint comes near a limit."
    } else {
        "Dashed across: limits that are near, in their joints' colours."
    };
    let y = Axis::new(&format!("joint position [{}]", unit(&joints, "")), "position", Scale::Linear, range);
    let title = format!("{}: joint positions", subject.arm.name);
    let figure = of.over_time(subject.stem("joints"), title, y, marks);
    Some(Figure { caption: of.caption(caption), ..figure })
}

/// The limits that a joint comes near to.
fn limits_near(joint: &ChainJoint, mark: &Mark) -> Vec<f64> {
    let Some((low, high)) = extent(heights(std::slice::from_ref(mark))) else { return Vec::new() };
    let limits = joint.limits;
    let near = NEAR * (limits.upper - limits.lower);
    let mut found = Vec::new();
    if near.is_finite() && low - limits.lower < near {
        found.push(limits.lower);
    }
    if near.is_finite() && limits.upper - high < near {
        found.push(limits.upper);
    }
    found
}

fn guide(of: &PlanFigures<'_>, value: f64, style: usize) -> Mark {
    let (first, last) = of.span();
    let points = vec![(first, value), (last, value)];
    Mark::Stroke { name: String::new(), points, style, width: 1.2, opacity: 0.8, is_dashed: true }
}

/// Returns the joint velocities of each arm, as shares of their limits where these differ.
pub(super) fn velocities(of: &PlanFigures<'_>) -> Vec<Figure> {
    of.arms().filter_map(|subject| velocities_of(of, subject)).collect()
}

fn velocities_of(of: &PlanFigures<'_>, subject: Subject<'_>) -> Option<Figure> {
    let joints = of.drawn_joints(subject);
    let measure = Measure::of(&joints);
    let velocity = |n: usize, k: usize| subject.arm.velocity(n).map_or(f64::NAN, |velocity| velocity[k]);
    if joints.is_empty() || subject.arm.velocity(of.from).is_none() {
        return None;
    }
    let mut marks: Vec<Mark> = joints
        .iter()
        .map(|(k, joint)| line(&joint.name, of.series(|n| velocity(n, *k) / measure.unit_of(joint)), *k))
        .collect();
    let peak = heights(&marks).filter(|value| value.is_finite()).fold(0.0, |most: f64, v| most.max(v.abs()));
    let limit = measure.limit().filter(|limit| peak > (1.0 - 2.0 * NEAR) * limit);
    let limits = limit.into_iter().flat_map(|limit| [-limit, limit]);
    let range = roomy(extent(heights(&marks).chain(limits.clone())));
    marks.extend(limits.map(|limit| guide(of, limit, 6)));
    let y = Axis::new(&measure.label(&joints), "velocity", Scale::Linear, range);
    let figure =
        of.over_time(subject.stem("velocities"), format!("{}: joint velocities", subject.arm.name), y, marks);
    Some(Figure { caption: of.caption(&measure.sentence(peak, limit.is_some())), ..figure })
}

/// What velocities are measured by.
enum Measure {
    /// In their units; no limits are known of some joints.
    Plain,
    /// In their units; all joints have this limit [rad/s or m/s].
    OneLimit(f64),
    /// As shares of each joint's own limit.
    Shares,
}

impl Measure {
    fn of(joints: &[Drawn<'_>]) -> Self {
        let limits = || joints.iter().map(|(_, joint)| joint.limits.velocity);
        match limits().next() {
            Some(first) if limits().all(|limit| limit == first && limit.is_finite()) => Self::OneLimit(first),
            Some(_) if limits().all(|limit| limit.is_finite() && limit > 0.0) => Self::Shares,
            _ => Self::Plain,
        }
    }

    fn unit_of(&self, joint: &ChainJoint) -> f64 {
        if matches!(self, Self::Shares) { joint.limits.velocity } else { 1.0 }
    }

    /// The limit in the figure.
    fn limit(&self) -> Option<f64> {
        match self {
            Self::Plain => None,
            Self::OneLimit(limit) => Some(*limit),
            Self::Shares => Some(1.0),
        }
    }

    fn label(&self, joints: &[Drawn<'_>]) -> String {
        match self {
            Self::Shares => "joint velocity / its limit".to_owned(),
            _ => format!("joint velocity [{}]", unit(joints, "/s")),
        }
    }

    fn sentence(&self, peak: f64, is_drawn: bool) -> String {
        match self.limit() {
            None => String::new(),
            Some(_) if is_drawn => "Dashed across: the limits.".to_owned(),
            Some(limit) => {
                format!("No joint is faster than {:.0} % of its limit.", (100.0 * peak / limit).ceil())
            }
        }
    }
}
