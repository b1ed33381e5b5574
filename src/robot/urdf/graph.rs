//! Links and joints to a tree: references, second parents, loops, roots, and parents before children.

use std::collections::HashMap;

use nalgebra::{IsometryMatrix3, Rotation3, Translation3, Vector3};

use super::link::RawLink;
use super::mimic;
use super::raw_joint::RawJoint;
use crate::robot::displacement::displacement;
use crate::robot::model::Stray;
use crate::robot::names::{quote, short_list};
use crate::robot::report::Report;
use crate::robot::{Defect, Joint, JointKind, Limits, Link, Mimic, Robot};

/// The joint between two links, by index.
#[derive(Clone, Copy)]
struct Edge {
    joint: usize,
    parent: usize,
}

/// Assembles the robot. Joints that a tree can not hold are kept aside with their defect.
pub(super) fn assemble(
    name: String,
    links: &[RawLink],
    mut joints: Vec<RawJoint>,
    root: usize,
    report: &mut Report<'_>,
) -> Robot {
    check_joint_names(&mut joints, report);
    let by_name: HashMap<String, usize> =
        links.iter().enumerate().map(|(index, link)| (link.name.clone(), index)).collect();
    let ends: Vec<Option<(usize, usize)>> =
        joints.iter_mut().map(|joint| ends(joint, links, &by_name, report)).collect();
    let mut above = parents(links, &mut joints, &ends, report);
    let looped = open_loops(links, &mut joints, &mut above, report);
    check_roots(links, &joints, &above, &looped, report);
    if !joints.iter().any(|joint| joint.is_movable() || joint.kind.is_none()) {
        report.error(root, "the robot has no movable joint (revolute, continuous or prismatic)");
    }
    let motions = mimic::resolve(&mut joints, report);
    build(name, links, joints, &above, &motions)
}

fn check_joint_names(joints: &mut [RawJoint], report: &mut Report<'_>) {
    let mut first_of: HashMap<String, usize> = HashMap::new();
    for index in 0..joints.len() {
        if joints[index].name.is_empty() {
            continue;
        }
        let Some(&first) = first_of.get(&joints[index].name) else {
            first_of.insert(joints[index].name.clone(), index);
            continue;
        };
        let (here, there) = (joints[index].offset, joints[first].offset);
        let line = report.line(there);
        let reason = format!("the name is used twice, first on line {line}; every joint needs its own");
        joints[index].fail(here, reason, report);
        let reason = format!("the name is used twice, again on line {}", report.line(here));
        joints[first].defect.get_or_insert(report.defect(there, reason));
    }
}

/// Returns the indices of a joint's parent and child links.
fn ends(
    joint: &mut RawJoint,
    links: &[RawLink],
    by_name: &HashMap<String, usize>,
    report: &mut Report<'_>,
) -> Option<(usize, usize)> {
    let mut found = [None, None];
    for (place, (role, is_child)) in [("parent", false), ("child", true)].into_iter().enumerate() {
        let reference = if is_child { joint.child.as_ref() } else { joint.parent.as_ref() };
        let Some(reference) = reference else { continue };
        found[place] = by_name.get(&reference.name).copied();
        if found[place].is_none() {
            let suggestion = report.suggestion(&reference.name, links.iter().map(|link| link.name.as_str()));
            let reason = format!("its {role} link {} is not defined{suggestion}", quote(&reference.name));
            let offset = reference.offset;
            joint.fail(offset, reason, report);
        }
    }
    let (parent, child) = (found[0]?, found[1]?);
    if parent == child {
        let reason = format!("its parent and its child are both {}", quote(&links[parent].name));
        joint.fail(joint.offset, reason, report);
        return None;
    }
    Some((parent, child))
}

/// Returns the joint above each link; a second one is refused, and spoils the first.
fn parents(
    links: &[RawLink],
    joints: &mut [RawJoint],
    ends: &[Option<(usize, usize)>],
    report: &mut Report<'_>,
) -> Vec<Option<Edge>> {
    let mut above: Vec<Option<Edge>> = vec![None; links.len()];
    for (joint, ends) in ends.iter().enumerate() {
        let Some((parent, child)) = *ends else { continue };
        let Some(first) = above[child] else {
            above[child] = Some(Edge { joint, parent });
            continue;
        };
        let reason = |other: &RawJoint, report: &Report<'_>| {
            let name = quote(&links[child].name);
            format!(
                "link {name} has two parents: {} (line {}) leads to it too",
                other.label(),
                report.line(other.offset)
            )
        };
        let second = reason(&joints[first.joint], report);
        joints[joint].fail(joints[joint].offset, second, report);
        let first_reason = reason(&joints[joint], report);
        let defect = report.defect(joints[first.joint].offset, first_reason);
        joints[first.joint].defect.get_or_insert(defect);
    }
    above
}

/// Opens every loop at one joint, marks its joints defective, and returns the links where loops were opened.
fn open_loops(
    links: &[RawLink],
    joints: &mut [RawJoint],
    above: &mut [Option<Edge>],
    report: &mut Report<'_>,
) -> Vec<bool> {
    let mut opened = vec![false; links.len()];
    let mut visited_by = vec![usize::MAX; links.len()];
    for start in 0..links.len() {
        let mut link = start;
        while visited_by[link] == usize::MAX {
            visited_by[link] = start;
            match above[link] {
                Some(edge) => link = edge.parent,
                None => break,
            }
        }
        if above[link].is_some() && visited_by[link] == start {
            open_loop(link, links, joints, above, report);
            opened[link] = true;
        }
    }
    opened
}

fn open_loop(
    link: usize,
    links: &[RawLink],
    joints: &mut [RawJoint],
    above: &mut [Option<Edge>],
    report: &mut Report<'_>,
) {
    let mut members = Vec::new();
    let mut at = link;
    while let Some(edge) = above[at] {
        members.push((edge.joint, at));
        at = edge.parent;
        if at == link {
            break;
        }
    }
    members.reverse();
    let names: Vec<&str> = members.iter().map(|&(_, link)| links[link].name.as_str()).collect();
    let joint_names: Vec<&str> = members.iter().map(|&(joint, _)| joints[joint].name.as_str()).collect();
    let reason = format!(
        "it is part of a loop through the links {} (joints {}); a URDF is a tree",
        short_list(&names, "and"),
        short_list(&joint_names, "and")
    );
    let first = members.iter().map(|&(joint, _)| joint).min().unwrap_or_default();
    for (joint, _) in members {
        let offset = joints[joint].offset;
        if joint == first {
            joints[joint].fail(offset, reason.clone(), report);
        } else {
            joints[joint].defect.get_or_insert_with(|| report.defect(offset, reason.clone()));
        }
    }
    above[link] = None;
}

/// Reports several roots, leaving out links that only a defective joint has cut off.
fn check_roots(
    links: &[RawLink],
    joints: &[RawJoint],
    above: &[Option<Edge>],
    opened: &[bool],
    report: &mut Report<'_>,
) {
    let cut_off: Vec<&str> =
        joints.iter().filter_map(|joint| joint.child.as_ref()).map(|child| child.name.as_str()).collect();
    let cut_off: std::collections::HashSet<&str> = cut_off.into_iter().collect();
    let roots: Vec<usize> = (0..links.len())
        .filter(|&link| {
            above[link].is_none() && !opened[link] && !cut_off.contains(links[link].name.as_str())
        })
        .collect();
    if let [_, second, ..] = roots[..] {
        let names: Vec<&str> = roots.iter().map(|&root| links[root].name.as_str()).collect();
        let cause = format!(
            "the robot has {} roots: {}; join them, or give every arm a base and a tip below one of them",
            roots.len(),
            short_list(&names, "and")
        );
        report.error(links[second].offset, cause);
    }
}

/// Returns the links depth first, children in the order of their joints in the file.
fn preorder(above: &[Option<Edge>]) -> Vec<usize> {
    let mut children: Vec<Vec<(usize, usize)>> = vec![Vec::new(); above.len()];
    for (link, edge) in above.iter().enumerate() {
        if let Some(edge) = edge {
            children[edge.parent].push((edge.joint, link));
        }
    }
    for children in &mut children {
        children.sort_unstable();
    }
    let mut order = Vec::with_capacity(above.len());
    let mut waiting: Vec<usize> = (0..above.len()).filter(|&link| above[link].is_none()).rev().collect();
    while let Some(link) = waiting.pop() {
        order.push(link);
        waiting.extend(children[link].iter().rev().map(|&(_, child)| child));
    }
    order
}

fn build(
    name: String,
    raw_links: &[RawLink],
    raw_joints: Vec<RawJoint>,
    above: &[Option<Edge>],
    motions: &[mimic::Motion],
) -> Robot {
    let order = preorder(above);
    let mut link_of = vec![usize::MAX; raw_links.len()];
    order.iter().enumerate().for_each(|(new, &old)| link_of[old] = new);
    let mut joint_of = vec![None; raw_joints.len()];
    let placed = order.iter().filter_map(|&link| above[link]).map(|edge| edge.joint);
    placed.enumerate().for_each(|(new, old)| joint_of[old] = Some(new));

    let mut joints = Vec::new();
    let mut links = Vec::with_capacity(order.len());
    for &old in &order {
        let parent_joint = above[old].map(|edge| {
            let raw = &raw_joints[edge.joint];
            let (parent, child) = (link_of[edge.parent], link_of[old]);
            joints.push(joint(raw, parent, child, &motions[edge.joint], &joint_of));
            joints.len() - 1
        });
        let raw = &raw_links[old];
        links.push(Link { name: raw.name.clone(), parent_joint, defect: raw.defect.clone() });
    }
    let strays = raw_joints
        .into_iter()
        .zip(&joint_of)
        .filter(|(_, placed)| placed.is_none())
        .map(|(raw, _)| stray(raw));
    Robot { strays: strays.collect(), ..Robot::assembled(name, links, joints) }
}

fn joint(
    raw: &RawJoint,
    parent: usize,
    child: usize,
    motion: &mimic::Motion,
    joint_of: &[Option<usize>],
) -> Joint {
    let mut joint = Joint {
        name: raw.name.clone(),
        kind: raw.kind.unwrap_or(JointKind::Fixed),
        parent,
        child,
        origin: origin(raw),
        axis: axis(raw),
        limits: limits(raw),
        mimic: None,
        follows: None,
        defect: raw.defect.clone(),
        angles: angles(raw),
    };
    match *motion {
        mimic::Motion::Own => {}
        mimic::Motion::Still { at } => {
            joint.place(joint.origin * displacement(joint.kind, joint.axis, at));
            joint.kind = JointKind::Fixed;
            (joint.axis, joint.limits) = (Vector3::x(), Limits::UNLIMITED);
        }
        // A driver without a place in the tree is defective, and then so is its follower.
        mimic::Motion::Follows { at_first_hand, in_the_end } => {
            let placed = |mimic: Mimic| joint_of[mimic.driver].map(|driver| Mimic { driver, ..mimic });
            (joint.follows, joint.mimic) = (placed(at_first_hand), placed(in_the_end));
        }
    }
    joint
}

/// `xyz` and `rpy` as URDF means them: `Rz(yaw) Ry(pitch) Rx(roll)`.
fn origin(raw: &RawJoint) -> IsometryMatrix3<f64> {
    let Some(read) = &raw.read else { return IsometryMatrix3::identity() };
    let [x, y, z] = read.origin.xyz.0;
    let [roll, pitch, yaw] = read.origin.rpy.0;
    let rotation = match raw.quaternion {
        Some(quaternion) => quaternion.to_rotation_matrix(),
        None => Rotation3::from_euler_angles(roll, pitch, yaw),
    };
    IsometryMatrix3::from_parts(Translation3::new(x, y, z), rotation)
}

fn axis(raw: &RawJoint) -> Vector3<f64> {
    let xyz = raw.read.as_ref().map_or([1.0, 0.0, 0.0], |read| read.axis.xyz.0);
    let axis = of_common_size(Vector3::from(xyz));
    // A vector that is as long as rounding lets a unit vector be keeps its bits.
    if (axis.norm() - 1.0).abs() <= 2.0 * f64::EPSILON {
        return axis;
    }
    axis.try_normalize(0.0).unwrap_or_else(Vector3::x)
}

/// A direction whose squares neither vanish nor overflow.
fn of_common_size(axis: Vector3<f64>) -> Vector3<f64> {
    let size = axis.amax();
    if (1e-100..1e100).contains(&size) || size == 0.0 { axis } else { axis / size }
}

/// Roll, pitch and yaw, where the file gives the orientation so.
fn angles(raw: &RawJoint) -> Option<[f64; 3]> {
    let read = raw.read.as_ref().filter(|_| raw.quaternion.is_none());
    read.map(|read| read.origin.rpy.0)
}

fn limits(raw: &RawJoint) -> Limits {
    match &raw.read {
        Some(read) if raw.is_movable() => Limits {
            lower: read.limit.lower,
            upper: read.limit.upper,
            velocity: read.limit.velocity,
            acceleration: raw.acceleration,
            jerk: raw.jerk,
        },
        _ => Limits::UNLIMITED,
    }
}

fn stray(raw: RawJoint) -> Stray {
    let name_of = |end: Option<super::raw_joint::Reference>| end.map(|end| end.name).unwrap_or_default();
    let fallback = || Defect { reason: "it has no place in the tree".to_owned(), line: 1, column: 1 };
    Stray {
        name: raw.name,
        parent: name_of(raw.parent),
        child: name_of(raw.child),
        defect: raw.defect.unwrap_or_else(fallback),
    }
}
