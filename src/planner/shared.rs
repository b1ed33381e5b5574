//! Arms of one machine that move joints in common: one vector of joints, one stacked task.

use super::field::Owner;
use super::runtime::ArmRuntime;
use super::{Arm, PlannerError, SharedJoints};
use crate::law::StackedPseudoinverse;
use crate::robot::ChainJoint;
use std::ops::Range;

/// Arms that are resolved together, by the least-norm motion of all their joints that meets all their tasks.
///
/// The state holds the union of their joints: those of the first arm, then those of the next that are not there yet. A
/// joint in common has one column in the stacked Jacobian, with entries in the rows of all the arms that it moves.
pub(super) struct SharedArms {
    members: Vec<SharedMember>,
    law: StackedPseudoinverse,
    /// The union of the joints, and where it begins in the state.
    joints: Vec<String>,
    from: usize,
    /// The task velocities `phi'` and `-k e` of all arms.
    velocities: [Vec<f64>; 2],
}

/// One of them, with what it sees of the union in the order of its own joints.
struct SharedMember {
    arm: usize,
    first_row: usize,
    rows: usize,
    places: Vec<usize>,
}

impl SharedArms {
    /// The arms of these indices as one system whose joints begin at `from` in the state.
    pub(super) fn new(arms: &[ArmRuntime], indices: &[usize], from: usize) -> Self {
        let joints = union(indices.iter().map(|&arm| &arms[arm].arm));
        let mut spans: Vec<Option<Range<usize>>> = vec![None; joints.len()];
        let (mut members, mut row) = (Vec::with_capacity(indices.len()), 0);
        for &arm in indices {
            let (names, rows) = (arms[arm].arm.joint_names(), arms[arm].arm.task.rows());
            let place = |name: &String| joints.iter().position(|joint| joint == name);
            let places: Vec<usize> = names.iter().filter_map(place).collect();
            for &place in &places {
                let start = spans[place].as_ref().map_or(row, |span| span.start);
                spans[place] = Some(start..row + rows);
            }
            members.push(SharedMember { arm, first_row: row, rows, places });
            row += rows;
        }
        // A singular value of the whole is at most that of a part: the largest threshold keeps every arm's promise.
        let thresholds = indices.iter().map(|&arm| arms[arm].arm.law.threshold());
        let spans = spans.into_iter().map(Option::unwrap_or_default).collect();
        let law = StackedPseudoinverse::new(row, spans, thresholds.fold(0.0, f64::max));
        Self { members, law, joints, from, velocities: [vec![0.0; row], vec![0.0; row]] }
    }

    /// Where its joints stand in the state.
    pub(super) fn range(&self) -> Range<usize> {
        self.from..self.from + self.joints.len()
    }

    /// How many joints there are for how many task components.
    pub(super) fn size(&self) -> (usize, usize) {
        (self.joints.len(), self.velocities[0].len())
    }

    /// Whether there are fewer joints than task components.
    pub(super) fn has_too_few_joints(&self) -> bool {
        let (joints, rows) = self.size();
        joints < rows
    }

    /// The arms, in order.
    pub(super) fn arms(&self) -> impl Iterator<Item = usize> {
        self.members.iter().map(|member| member.arm)
    }

    /// Its joints in order, each with the arms that it moves and its index in them.
    pub(super) fn owners(&self) -> Vec<Vec<Owner>> {
        let mut owners = vec![Vec::new(); self.joints.len()];
        for member in &self.members {
            for (joint, &place) in member.places.iter().enumerate() {
                owners[place].push((member.arm, joint));
            }
        }
        owners
    }

    /// Kinematics and task errors of all members at time `t`, then both parts of the velocity of all joints.
    pub(super) fn evaluate(
        &mut self,
        arms: &mut [ArmRuntime],
        (t, gain): (f64, f64),
        x: &[f64],
        [f, g]: [&mut [f64]; 2],
    ) {
        let (x, f, g) = (&x[self.range()], &mut f[self.range()], &mut g[self.range()]);
        let [forward, back] = &mut self.velocities;
        for member in &self.members {
            let runtime = &mut arms[member.arm];
            gather(x, &member.places, &mut runtime.positions);
            let twist = runtime.look(t);
            let (twist, error) = runtime.measured(twist);
            for row in 0..member.rows {
                forward[member.first_row + row] = twist[row];
                back[member.first_row + row] = -gain * error[row];
            }
            for (column, &place) in runtime.columns.iter().zip(&member.places) {
                let entries = &mut self.law.column(place, member.first_row)[..member.rows];
                entries.copy_from_slice(&column.as_slice()[..member.rows]);
            }
        }
        let resolution = self.law.resolve([&*forward, &*back], f, g);
        for member in &self.members {
            let runtime = &mut arms[member.arm];
            gather(f, &member.places, &mut runtime.velocities);
            runtime.resolution = resolution;
        }
    }

    /// Kinematics and task errors of all members at time `t`, at other joint positions than those that were evaluated.
    pub(super) fn look(&self, arms: &mut [ArmRuntime], t: f64, x: &[f64]) {
        let x = &x[self.range()];
        for member in &self.members {
            let runtime = &mut arms[member.arm];
            gather(x, &member.places, &mut runtime.positions);
            runtime.look(t);
        }
    }

    /// Who shares what.
    pub(super) fn report(&self, arms: &[ArmRuntime]) -> SharedJoints {
        let is_shared =
            |place: &usize| self.members.iter().filter(|member| member.places.contains(place)).count() > 1;
        SharedJoints {
            arms: self.members.iter().map(|member| arms[member.arm].arm.name.clone()).collect(),
            joints: (0..self.joints.len())
                .filter(is_shared)
                .map(|place| self.joints[place].clone())
                .collect(),
        }
    }
}

fn gather(union: &[f64], places: &[usize], own: &mut [f64]) {
    for (own, &place) in own.iter_mut().zip(places) {
        *own = union[place];
    }
}

/// The names of the joints of several arms, each once.
fn union<'a>(arms: impl Iterator<Item = &'a Arm>) -> Vec<String> {
    let mut union: Vec<String> = Vec::new();
    for name in arms.flat_map(Arm::joint_names) {
        if !union.contains(&name) {
            union.push(name);
        }
    }
    union
}

/// Whether two arms are on one machine and have a joint in common.
fn share_a_joint(one: &Arm, other: &Arm) -> bool {
    let is_common = |joint: &ChainJoint| other.start_of(&joint.name).is_some();
    one.machine.is_some() && one.machine == other.machine && one.chain.joints().iter().any(is_common)
}

/// The sets of arms that move joints in common, directly or through each other: indices in order, of two arms or more.
pub(super) fn sets(arms: &[Arm]) -> Vec<Vec<usize>> {
    let mut sets: Vec<Vec<usize>> = Vec::new();
    for (i, arm) in arms.iter().enumerate() {
        let touches = |set: &Vec<usize>| set.iter().any(|&j| share_a_joint(arm, &arms[j]));
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

/// Checks that arms of a set agree on where their joints in common start, and can be resolved together.
pub(super) fn check(arms: &[Arm], set: &[usize]) -> Result<(), PlannerError> {
    for (place, &i) in set.iter().enumerate() {
        if arms[i].law.least_norm_threshold().is_none() {
            return Err(PlannerError::SharedLaw { arm: arms[i].name.clone() });
        }
        for &j in &set[..place] {
            check_starts(&arms[j], &arms[i])?;
        }
    }
    Ok(())
}

fn check_starts(one: &Arm, other: &Arm) -> Result<(), PlannerError> {
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
