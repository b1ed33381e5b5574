//! The path between two links.

use super::model::Stray;
use super::{ChainError, Robot, names};

/// A joint of a path and the direction in which the path passes it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Step {
    pub(super) joint: usize,
    /// From child to parent.
    pub(super) upward: bool,
}

/// Returns the joints from `base` to `tip`, every one of which a chain can carry.
pub(super) fn steps(robot: &Robot, base: &str, tip: &str) -> Result<Vec<Step>, ChainError> {
    let (from, to) = (find_link(robot, base)?, find_link(robot, tip)?);
    if from == to {
        return Err(ChainError::SameLink { link: base.to_owned() });
    }
    let steps = steps_between(robot, from, to).ok_or_else(|| ChainError::NotConnected {
        base: base.to_owned(),
        tip: tip.to_owned(),
        reason: separation(robot, from, to),
    })?;
    for step in &steps {
        check_joint(robot, step.joint, base, tip)?;
    }
    Ok(steps)
}

fn find_link(robot: &Robot, name: &str) -> Result<usize, ChainError> {
    robot.link_by_name.get(name).copied().ok_or_else(|| {
        let all = || robot.links.iter().map(|link| link.name.as_str());
        let nearest: Vec<String> = names::nearest(name, all()).into_iter().map(str::to_owned).collect();
        let hint = match robot.joint(name) {
            Some(joint) => format!(
                "; {} is a joint, between the links {} and {}",
                names::quote(name),
                names::quote(&robot.links[joint.parent].name),
                names::quote(&robot.links[joint.child].name)
            ),
            None if nearest.is_empty() => {
                format!("; its links are {}", names::short_list(&all().collect::<Vec<_>>(), "and"))
            }
            None => String::new(),
        };
        ChainError::UnknownLink { name: name.to_owned(), nearest, hint }
    })
}

/// Returns the steps up to the common ancestor and down again, or `None` when there is no such ancestor.
///
/// Parents stand before their children, so of two different links the one with the larger index is not an
/// ancestor of the other and can be left for its parent.
fn steps_between(robot: &Robot, from: usize, to: usize) -> Option<Vec<Step>> {
    let (mut up, mut down) = (Vec::new(), Vec::new());
    let (mut from, mut to) = (from, to);
    while from != to {
        if from > to {
            let joint = robot.links[from].parent_joint?;
            up.push(Step { joint, upward: true });
            from = robot.joints[joint].parent;
        } else {
            let joint = robot.links[to].parent_joint?;
            down.push(Step { joint, upward: false });
            to = robot.joints[joint].parent;
        }
    }
    up.extend(down.into_iter().rev());
    Some(up)
}

fn check_joint(robot: &Robot, index: usize, base: &str, tip: &str) -> Result<(), ChainError> {
    let joint = &robot.joints[index];
    let (base, tip) = (base.to_owned(), tip.to_owned());
    if let Some(defect) = joint.defect.clone() {
        return Err(ChainError::DefectiveJoint { base, tip, joint: joint.name.clone(), defect });
    }
    if !joint.kind.is_supported() {
        return Err(ChainError::UnsupportedJoint { base, tip, joint: joint.name.clone(), kind: joint.kind });
    }
    for link in [&robot.links[joint.parent], &robot.links[joint.child]] {
        if let Some(defect) = link.defect.clone() {
            return Err(ChainError::DefectiveLink { base, tip, link: link.name.clone(), defect });
        }
    }
    Ok(())
}

/// Says what separates two links: joints that the tree could not hold, or their different roots.
fn separation(robot: &Robot, from: usize, to: usize) -> String {
    let roots = [root_of(robot, from), root_of(robot, to)];
    let touches = |stray: &&Stray| {
        let ends = [&stray.parent, &stray.child].map(|name| robot.link_by_name.get(name));
        ends.into_iter().flatten().any(|&link| roots.contains(&root_of(robot, link)))
    };
    match robot.strays.iter().find(touches) {
        Some(stray) => format!(
            "joint {} is defective (line {}): {}",
            names::quote(&stray.name),
            stray.defect.line,
            stray.defect.reason
        ),
        None => format!(
            "they hang from different roots, {} and {}",
            names::quote(&robot.links[roots[0]].name),
            names::quote(&robot.links[roots[1]].name)
        ),
    }
}

fn root_of(robot: &Robot, mut link: usize) -> usize {
    while let Some(joint) = robot.links[link].parent_joint {
        link = robot.joints[joint].parent;
    }
    link
}
