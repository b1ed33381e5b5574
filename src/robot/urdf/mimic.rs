//! Mimic joints: followed to the joint that drives them, chains of them folded into one ratio and offset.

use std::collections::HashMap;

use super::raw_joint::RawJoint;
use crate::robot::names::{quote, short_list};
use crate::robot::report::Report;
use crate::robot::{JointKind, Mimic, unbelievable};

/// How a joint moves once mimic chains are folded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Motion {
    /// By itself, or not at all.
    Own,
    /// It follows something that does not move, or follows with multiplier zero.
    Still { at: f64 },
    /// As its own element says, and as the joint says that drives it in the end.
    Follows { at_first_hand: Mimic, in_the_end: Mimic },
}

/// Resolves every joint, in the order of the file.
pub(super) fn resolve(joints: &mut [RawJoint], report: &mut Report<'_>) -> Vec<Motion> {
    let by_name: HashMap<String, usize> =
        joints.iter().enumerate().rev().map(|(index, joint)| (joint.name.clone(), index)).collect();
    let targets: Vec<Option<usize>> =
        (0..joints.len()).map(|index| target(index, joints, &by_name, report)).collect();
    refuse_cycles(joints, &targets, report);
    let mut motions: Vec<Option<Motion>> = vec![None; joints.len()];
    for index in 0..joints.len() {
        follow(index, joints, &targets, &mut motions, report);
    }
    motions.into_iter().map(|motion| motion.unwrap_or(Motion::Own)).collect()
}

fn target(
    index: usize,
    joints: &mut [RawJoint],
    by_name: &HashMap<String, usize>,
    report: &mut Report<'_>,
) -> Option<usize> {
    let reference = joints[index].mimic.as_ref()?;
    let (name, place) = (reference.name.clone(), reference.offset);
    match by_name.get(&name).copied() {
        Some(target) if target == index => {
            joints[index].fail(place, "it mimics itself".to_owned(), report);
            None
        }
        Some(target) => Some(target),
        None => {
            let mut suggestion = report.suggestion(&name, joints.iter().map(|joint| joint.name.as_str()));
            if suggestion.is_empty() {
                let known: Vec<&str> = joints.iter().map(|joint| joint.name.as_str()).collect();
                suggestion = format!("; the joints are {}", short_list(&known, "and"));
            }
            let reason = format!("it mimics joint {}, which is not defined{suggestion}", quote(&name));
            joints[index].fail(place, reason, report);
            None
        }
    }
}

fn refuse_cycles(joints: &mut [RawJoint], targets: &[Option<usize>], report: &mut Report<'_>) {
    let mut visited_by = vec![usize::MAX; joints.len()];
    for start in 0..joints.len() {
        let mut at = Some(start);
        while let Some(joint) = at.filter(|&joint| visited_by[joint] == usize::MAX) {
            visited_by[joint] = start;
            at = targets[joint];
        }
        if let Some(first) = at.filter(|&joint| visited_by[joint] == start) {
            refuse_cycle(first, joints, targets, report);
        }
    }
}

fn refuse_cycle(first: usize, joints: &mut [RawJoint], targets: &[Option<usize>], report: &mut Report<'_>) {
    let members: Vec<usize> =
        std::iter::successors(Some(first), |&joint| targets[joint].filter(|&next| next != first)).collect();
    let names: Vec<&str> = members.iter().map(|&joint| joints[joint].name.as_str()).collect();
    let reason =
        format!("the joints {} mimic each other in a circle: none of them drives", short_list(&names, "and"));
    for joint in members {
        let place = joints[joint].mimic.as_ref().map_or(joints[joint].offset, |reference| reference.offset);
        joints[joint].fail(place, reason.clone(), report);
    }
}

/// Resolves one joint and, before it, the joints that it follows.
fn follow(
    index: usize,
    joints: &mut [RawJoint],
    targets: &[Option<usize>],
    motions: &mut [Option<Motion>],
    report: &mut Report<'_>,
) {
    let mut waiting = vec![index];
    while let Some(&joint) = waiting.last() {
        match targets[joint].filter(|_| joints[joint].defect.is_none()) {
            Some(target) if motions[target].is_none() && joints[target].defect.is_none() => {
                waiting.push(target);
                continue;
            }
            Some(target) if motions[joint].is_none() => {
                motions[joint] = Some(motion(joint, target, joints, motions[target], report));
            }
            Some(_) => {}
            None => motions[joint] = Some(Motion::Own),
        }
        waiting.pop();
    }
}

fn motion(
    index: usize,
    target: usize,
    joints: &mut [RawJoint],
    target_motion: Option<Motion>,
    report: &mut Report<'_>,
) -> Motion {
    let place = joints[index].mimic.as_ref().map_or(joints[index].offset, |reference| reference.offset);
    let name = quote(&joints[target].name);
    if joints[target].defect.is_some() {
        joints[index].fail(place, format!("it mimics joint {name}, which is defective"), report);
        return Motion::Own;
    }
    let kind = joints[target].kind.unwrap_or(JointKind::Fixed);
    if !kind.is_supported() {
        joints[index].fail(
            place,
            format!("it mimics joint {name}, which is {kind} and has no single position"),
            report,
        );
        return Motion::Own;
    }
    let (multiplier, offset) = ratio(&joints[index]);
    if multiplier == 0.0 {
        joints[index].warn(place, "it mimics with multiplier 0: taken as fixed", report);
        return still(index, offset, joints, report);
    }
    match target_motion.unwrap_or(Motion::Own) {
        Motion::Own if kind == JointKind::Fixed => {
            joints[index].warn(
                place,
                &format!("it mimics joint {name}, which is fixed: taken as fixed"),
                report,
            );
            still(index, offset, joints, report)
        }
        Motion::Still { at } => {
            joints[index].warn(
                place,
                &format!("it mimics joint {name}, which does not move: taken as fixed"),
                report,
            );
            still(index, multiplier * at + offset, joints, report)
        }
        followed => {
            let at_first_hand = Mimic { driver: target, multiplier, offset };
            let in_the_end = match followed {
                Motion::Follows { in_the_end, .. } => at_first_hand.through(in_the_end),
                _ => at_first_hand,
            };
            check_limits(index, in_the_end, joints, report);
            Motion::Follows { at_first_hand, in_the_end }
        }
    }
}

/// A joint that stands where no arm does is refused.
fn still(index: usize, at: f64, joints: &mut [RawJoint], report: &mut Report<'_>) -> Motion {
    if let Some(cause) = unbelievable(at) {
        let place = joints[index].mimic.as_ref().map_or(joints[index].offset, |reference| reference.offset);
        joints[index].fail(place, format!("where it stands still: {cause}"), report);
    }
    Motion::Still { at }
}

fn ratio(joint: &RawJoint) -> (f64, f64) {
    let mimic = joint.read.as_ref().and_then(|read| read.mimic.as_ref());
    mimic.map_or((1.0, 0.0), |mimic| (mimic.multiplier.unwrap_or(1.0), mimic.offset.unwrap_or(0.0)))
}

/// Refuses a follower whose own limits leave its driver no position.
fn check_limits(index: usize, in_the_end: Mimic, joints: &mut [RawJoint], report: &mut Report<'_>) {
    let Mimic { driver, multiplier, offset } = in_the_end;
    let limits = |joint: &RawJoint| {
        let limit = joint.read.as_ref().map(|read| &read.limit);
        limit.map_or((f64::NEG_INFINITY, f64::INFINITY), |limit| (limit.lower, limit.upper))
    };
    if !multiplier.is_normal() || !offset.is_finite() {
        let place = joints[index].mimic.as_ref().map_or(joints[index].offset, |reference| reference.offset);
        let reason = format!("its ratio to joint {} is out of range", quote(&joints[driver].name));
        joints[index].fail(place, reason, report);
    }
    let (lower, upper) = limits(&joints[driver]);
    let (own_lower, own_upper) = limits(&joints[index]);
    let (a, b) = ((own_lower - offset) / multiplier, (own_upper - offset) / multiplier);
    if lower.max(a.min(b)) > upper.min(a.max(b)) {
        let place = joints[index].mimic.as_ref().map_or(joints[index].offset, |reference| reference.offset);
        let reason = format!(
            "it follows joint {}, but no position of that joint ({lower} to {upper}) keeps it within its own limits \
             ({own_lower} to {own_upper})",
            quote(&joints[driver].name)
        );
        joints[index].fail(place, reason, report);
    }
}
