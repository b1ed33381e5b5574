//! Which arms are resolved together.

use super::arm::Arm;
use crate::planner::PlannerError;
use crate::robot::ChainJoint;

/// Whether two arms are on one machine and have a joint in common.
fn share_a_joint(one: &Arm, other: &Arm) -> bool {
    let is_common = |joint: &ChainJoint| other.start_of(&joint.name).is_some();
    one.machine.is_some() && one.machine == other.machine && one.chain.joints().iter().any(is_common)
}

/// The sets of arms that are resolved together, because they move joints in common or are tied, directly or through each
/// other: indices in order, of two arms or more.
///
/// A tie is a set of arms, by their indices, that a task or a law is about. Returns nothing for arms that stand alone.
pub fn joint_sets(arms: &[Arm], ties: &[Vec<usize>]) -> Vec<Vec<usize>> {
    let mut sets: Vec<Vec<usize>> = Vec::new();
    let is_tied = |i: usize, j: usize| ties.iter().any(|tie| tie.contains(&i) && tie.contains(&j));
    for (i, arm) in arms.iter().enumerate() {
        let touches = |set: &Vec<usize>| set.iter().any(|&j| is_tied(i, j) || share_a_joint(arm, &arms[j]));
        let (touched, rest): (Vec<_>, Vec<_>) = sets.into_iter().partition(touches);
        sets = rest;
        let mut merged: Vec<usize> = touched.into_iter().flatten().chain([i]).collect();
        merged.sort_unstable();
        sets.push(merged);
    }
    sets.retain(|set| set.len() > 1);
    sets.sort_unstable();
    sets
}

/// Checks that the arms of a set agree on where their joints in common start.
pub(in crate::planner) fn check_common_starts(arms: &[Arm], set: &[usize]) -> Result<(), PlannerError> {
    for (place, &i) in set.iter().enumerate() {
        for &j in &set[..place] {
            check_starts(&arms[j], &arms[i])?;
        }
    }
    Ok(())
}

fn check_starts(one: &Arm, other: &Arm) -> Result<(), PlannerError> {
    if one.machine.is_none() || one.machine != other.machine {
        return Ok(());
    }
    for (joint, &value) in one.chain.joints().iter().zip(&one.q0) {
        if let Some(other_value) = other.start_of(&joint.name).filter(|&there| there != value) {
            return Err(PlannerError::SharedStart {
                joint: joint.name.clone(),
                arm: one.name.clone(),
                value,
                other: other.name.clone(),
                other_value,
            });
        }
    }
    Ok(())
}
