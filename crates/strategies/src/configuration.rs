//! Configurations of arms and of chains through trees that are away from singularity, or as near to it as asked for.

use super::tree::{chains_through, turning_trees};
use super::{ArmCase, ChainCase, arms, chains};
use kinstep::math::SingularValues;
use kinstep::robot::{Chain, Robot};
use kinstep::task::TaskKind;
use nalgebra::{Vector3, Vector6};
use proptest::prelude::*;
use std::fmt;

/// The condition number of the task Jacobian below which a configuration is away from singularity.
const AWAY: f64 = 25.0;
/// And the smallest singular value above which it is.
const SMALLEST_AWAY: f64 = 0.05;
/// Rounds of turning every joint once, after which an arm is given up as not to be stretched.
const ROUNDS: usize = 500;

/// A chain of a robot, the task that its tip shall meet, and where its joints stand.
#[derive(Clone, PartialEq)]
pub struct ConfigurationCase {
    /// The robot file.
    pub urdf: String,
    /// Link at which the chain begins.
    pub base: String,
    /// Link at which it ends.
    pub tip: String,
    /// The components of the tip's pose that matter.
    pub task: TaskKind,
    /// The positions of the chain's joints [rad or m].
    pub q: Vec<f64>,
}

impl ConfigurationCase {
    /// The chain. `None` if the file does not read, which its own tests rule out.
    pub fn chain(&self) -> Option<Chain> {
        Robot::from_urdf(&self.urdf).ok()?.chain(&self.base, &self.tip).ok()
    }

    /// The smallest and the largest singular value of the task Jacobian.
    pub fn singular_values(&self) -> (f64, f64) {
        self.chain().map_or((f64::NAN, f64::NAN), |chain| singular_values(&chain, self.task, &self.q))
    }

    fn of_arm(arm: &ArmCase) -> Self {
        let (base, tip) = ("base".to_owned(), "tip".to_owned());
        Self { urdf: arm.urdf(), base, tip, task: arm.task, q: arm.q0() }
    }

    /// The chain with the largest task for which it is away from singularity, if there is any.
    fn of_chain(case: &ChainCase) -> Option<Self> {
        let (chain, q) = (case.chain()?, case.q());
        let mut tasks = [TaskKind::Pose, TaskKind::Position, TaskKind::PositionXy].into_iter();
        let task = tasks.find(|task| chain.dof() >= task.rows() && is_away(&chain, *task, &q))?;
        let (base, tip) = (format!("l{}", case.base), format!("l{}", case.tip));
        Some(Self { urdf: case.tree.urdf(), base, tip, task, q })
    }

    /// The same chain at a condition number of `10^decades`, on the straight way to where it is stretched out. `None` if
    /// stretching does not lead there, as with joints that slide.
    fn moved_towards_singularity(mut self, decades: u8) -> Option<Self> {
        let chain = self.chain()?;
        let stretched = stretched(&chain, &self.q)?;
        let at = |part: f64| -> Vec<f64> {
            self.q.iter().zip(&stretched).map(|(q, end)| q + part * (end - q)).collect()
        };
        let is_nearer = |q: &[f64]| {
            let (smallest, largest) = singular_values(&chain, self.task, q);
            smallest * 10_f64.powi(decades.into()) < largest
        };
        let (mut far, mut near) = (0.0, 1.0);
        if is_nearer(&self.q) || !is_nearer(&stretched) {
            return None;
        }
        // Until no double lies between.
        while far < f64::midpoint(far, near) && f64::midpoint(far, near) < near {
            let middle = f64::midpoint(far, near);
            if is_nearer(&at(middle)) { near = middle } else { far = middle }
        }
        self.q = at(near);
        Some(self)
    }
}

impl fmt::Display for ConfigurationCase {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { urdf, base, tip, task, q } = self;
        write!(f, "task = {}, base = {base}, tip = {tip}, q = {q:?}\n{urdf}", task.name())
    }
}

impl fmt::Debug for ConfigurationCase {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "\n{self}")
    }
}

/// The smallest and the largest singular value of the task Jacobian at `q`.
pub(super) fn singular_values(chain: &Chain, task: TaskKind, q: &[f64]) -> (f64, f64) {
    let mut columns = vec![Vector6::zeros(); chain.dof()];
    chain.forward(q, &mut chain.scratch()).geometric_jacobian(&mut columns);
    match task {
        TaskKind::PositionXy => ends::<2>(&columns),
        TaskKind::Position => ends::<3>(&columns),
        TaskKind::Pose => ends::<6>(&columns),
    }
}

fn ends<const M: usize>(columns: &[Vector6<f64>]) -> (f64, f64) {
    let values = SingularValues::<M>::of(columns);
    (values.smallest(), values.largest())
}

/// Whether the task Jacobian at `q` has a condition number of at most 25 and no singular value below 0.05.
pub(super) fn is_away(chain: &Chain, task: TaskKind, q: &[f64]) -> bool {
    let (smallest, largest) = singular_values(chain, task, q);
    smallest >= SMALLEST_AWAY && largest <= AWAY * smallest
}

/// Turns joint after joint so that the tip is as far from the base's origin as it can get. Where no joint can take it
/// further, no joint velocity moves it along the line of sight: there the Jacobian lacks a rank.
fn stretched(chain: &Chain, q: &[f64]) -> Option<Vec<f64>> {
    let (mut q, mut scratch) = (q.to_vec(), chain.scratch());
    let mut columns = vec![Vector6::zeros(); chain.dof()];
    for _ in 0..ROUNDS {
        let mut largest: f64 = 0.0;
        for joint in 0..q.len() {
            let posed = chain.forward(&q, &mut scratch);
            let tip = posed.position();
            posed.geometric_jacobian(&mut columns);
            let turn = turn_away(&columns[joint], &tip);
            q[joint] += turn;
            largest = largest.max(turn.abs());
        }
        if largest < 1e-13 {
            return Some(q);
        }
    }
    None
}

/// By how much a joint with that column of the Jacobian turns a tip at `tip` furthest from the origin \[rad\].
fn turn_away(column: &Vector6<f64>, tip: &Vector3<f64>) -> f64 {
    let (velocity, axis) =
        (Vector3::from(column.fixed_rows::<3>(0)), Vector3::from(column.fixed_rows::<3>(3)));
    // From the axis to the tip, and from the origin to the axis, both at right angles to it.
    let arm = velocity.cross(&axis);
    let away = tip - axis * axis.dot(tip) - arm;
    velocity.dot(&away).atan2(arm.dot(&away))
}

/// Serial arms, and chains through trees, where the task Jacobian has a condition number of at most 25 and no singular
/// value below 0.05.
pub fn away_from_singularity() -> impl Strategy<Value = ConfigurationCase> {
    let through_trees =
        chains().prop_filter_map("away from singularity", |case| ConfigurationCase::of_chain(&case));
    prop_oneof![arms().prop_map(|arm| ConfigurationCase::of_arm(&arm)), through_trees]
}

/// Serial arms, and chains through trees, whose joints all turn, where the task Jacobian has a condition number of
/// 10, 100, ... or 1e8: nearly stretched out.
pub fn towards_singularity() -> impl Strategy<Value = ConfigurationCase> {
    let through_trees = chains_through(turning_trees())
        .prop_filter_map("away from singularity", |case| ConfigurationCase::of_chain(&case));
    let away = prop_oneof![arms().prop_map(|arm| ConfigurationCase::of_arm(&arm)), through_trees];
    (away, 1_u8..=8)
        .prop_filter_map("can be stretched", |(case, decades)| case.moved_towards_singularity(decades))
}

#[cfg(test)]
mod tests {
    use super::*;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        #[test]
        fn away_is_away(case in away_from_singularity()) {
            let chain = case.chain().unwrap();
            prop_assert!(chain.dof() >= case.task.rows() && case.q.len() == chain.dof());
            prop_assert!(chain.within_limits(&case.q));
            let (smallest, largest) = case.singular_values();
            prop_assert!(smallest >= SMALLEST_AWAY && largest / smallest <= AWAY);
        }

        #[test]
        fn towards_is_as_near_as_asked_for(case in towards_singularity()) {
            let (smallest, largest) = case.singular_values();
            let decades = (largest / smallest).log10();
            prop_assert!((decades - decades.round()).abs() < 1e-3 && (1.0..8.5).contains(&decades), "{}", decades);
        }
    }
}
