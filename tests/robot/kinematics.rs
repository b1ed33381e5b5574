//! Identities of pose and Jacobian on random trees of all joint types, random base and tip, mimic included. A failure prints the
//! shrunk tree as URDF.
#![allow(clippy::unwrap_used, reason = "a test that can not go on stops")]

use std::collections::HashMap;

use crate::trees::{distance, poses};
use kinstep::nalgebra::{IsometryMatrix3, Rotation3, UnitQuaternion, Vector3, Vector6};
use kinstep::robot::{Chain, ChainError, Robot};
use kinstep_strategies::{ChainCase, TreeCase, chains, trees};
use proptest::prelude::*;
use proptest::sample::Index;

/// A chain run at the tree's positions: pose and the Jacobian's columns by joint name.
struct Run {
    pose: IsometryMatrix3<f64>,
    columns: HashMap<String, Vector6<f64>>,
}

/// Runs the chain between two links; from a link to itself the pose is the identity.
fn run(robot: &Robot, tree: &TreeCase, base: usize, tip: usize) -> Run {
    match robot.chain(&format!("l{base}"), &format!("l{tip}")) {
        Ok(chain) => run_chain(&chain, tree),
        Err(ChainError::SameLink { .. }) => {
            Run { pose: IsometryMatrix3::identity(), columns: HashMap::new() }
        }
        Err(error) => panic!("{error}"),
    }
}

fn run_chain(chain: &Chain, tree: &TreeCase) -> Run {
    let mut scratch = chain.scratch();
    let mut columns = vec![Vector6::repeat(f64::NAN); chain.dof()];
    let posed = chain.forward(&tree.q_of(chain), &mut scratch);
    posed.geometric_jacobian(&mut columns);
    let names = chain.joints().iter().map(|own| own.name.clone());
    Run { pose: posed.pose(), columns: names.zip(columns).collect() }
}

impl Run {
    fn column(&self, name: &str) -> Vector6<f64> {
        self.columns.get(name).copied().unwrap_or_default()
    }

    fn linear(&self, name: &str) -> Vector3<f64> {
        self.column(name).fixed_rows::<3>(0).into()
    }

    fn angular(&self, name: &str) -> Vector3<f64> {
        self.column(name).fixed_rows::<3>(3).into()
    }
}

fn twist(linear: Vector3<f64>, angular: Vector3<f64>) -> Vector6<f64> {
    Vector6::new(linear.x, linear.y, linear.z, angular.x, angular.y, angular.z)
}

/// Twist of the tip by a central difference along joint velocities `rates`.
fn differenced(chain: &Chain, q: &[f64], rates: &[f64]) -> Vector6<f64> {
    const STEP: f64 = 1e-5;
    let at = |sign: f64| {
        let moved: Vec<f64> = q.iter().zip(rates).map(|(q, rate)| q + sign * STEP * rate).collect();
        chain.forward(&moved, &mut chain.scratch()).pose()
    };
    let (ahead, behind) = (at(1.0), at(-1.0));
    let linear = (ahead.translation.vector - behind.translation.vector) / (2.0 * STEP);
    let turn: Rotation3<f64> = ahead.rotation * behind.rotation.inverse();
    twist(linear, UnitQuaternion::from_rotation_matrix(&turn).scaled_axis() / (2.0 * STEP))
}

/// A tree with two of its links, and a third.
fn with_another() -> impl Strategy<Value = (ChainCase, usize)> {
    (chains(), any::<Index>()).prop_map(|(case, other)| {
        let other = other.index(case.tree.links());
        (case, other)
    })
}

proptest! {
    #[test]
    fn the_folded_chain_is_the_product_of_all_frames(case in chains()) {
        let (chain, poses) = (case.chain().unwrap(), poses(&case.tree));
        let expected = poses[case.base].inverse() * poses[case.tip];
        prop_assert!(distance(&run_chain(&chain, &case.tree).pose, &expected) < 1e-12);
    }

    #[test]
    fn every_column_is_a_central_difference_and_j_qdot_is_the_twist(
        case in chains(),
        rates in prop::collection::vec(-1.0..1.0, 10),
    ) {
        let (chain, q) = (case.chain().unwrap(), case.q());
        let run = run_chain(&chain, &case.tree);
        let mut moved = Vector6::zeros();
        for (index, own) in chain.joints().iter().enumerate() {
            let mut unit = vec![0.0; chain.dof()];
            unit[index] = 1.0;
            prop_assert!((run.column(&own.name) - differenced(&chain, &q, &unit)).norm() < 1e-7);
            moved += run.column(&own.name) * rates[index];
        }
        prop_assert!((moved - differenced(&chain, &q, &rates[..chain.dof()])).norm() < 1e-7);
    }

    #[test]
    fn a_reversed_path_is_minus_the_adjoint(ChainCase { tree, base, tip } in chains()) {
        let robot = tree.robot().unwrap();
        let (there, back) = (run(&robot, &tree, base, tip), run(&robot, &tree, tip, base));
        prop_assert!(distance(&back.pose, &there.pose.inverse()) < 1e-12);
        prop_assert_eq!(there.columns.len(), back.columns.len());
        let (p, turn) = (there.pose.translation.vector, there.pose.rotation.inverse());
        for name in there.columns.keys() {
            let (v, w) = (there.linear(name), there.angular(name));
            let expected = twist(-(turn * (v - w.cross(&p))), -(turn * w));
            prop_assert!((back.column(name) - expected).norm() < 1e-11);
        }
    }

    #[test]
    fn chains_compose((ChainCase { tree, base: a, tip: c }, b) in with_another()) {
        let robot = tree.robot().unwrap();
        let (ab, bc, ac) = (run(&robot, &tree, a, b), run(&robot, &tree, b, c), run(&robot, &tree, a, c));
        prop_assert!(distance(&(ab.pose * bc.pose), &ac.pose) < 1e-12);
        let arm = ab.pose.rotation * bc.pose.translation.vector;
        for name in ab.columns.keys().chain(bc.columns.keys()).chain(ac.columns.keys()) {
            let w = ab.angular(name);
            let linear = ab.linear(name) + w.cross(&arm) + ab.pose.rotation * bc.linear(name);
            let expected = twist(linear, w + ab.pose.rotation * bc.angular(name));
            prop_assert!((ac.column(name) - expected).norm() < 1e-11);
        }
    }

    #[test]
    fn a_relative_chain_is_the_difference_of_absolute_ones(
        (ChainCase { tree, base: left, tip: right }, from) in with_another(),
    ) {
        let robot = tree.robot().unwrap();
        let (one, two) = (run(&robot, &tree, from, left), run(&robot, &tree, from, right));
        let relative = run(&robot, &tree, left, right);
        let turn = one.pose.rotation.inverse();
        let apart = two.pose.translation.vector - one.pose.translation.vector;
        for name in one.columns.keys().chain(two.columns.keys()).chain(relative.columns.keys()) {
            let v = two.linear(name) - one.linear(name) - one.angular(name).cross(&apart);
            let expected = twist(turn * v, turn * (two.angular(name) - one.angular(name)));
            prop_assert!((relative.column(name) - expected).norm() < 1e-11);
        }
    }

    #[test]
    fn a_mount_moves_the_pose_and_turns_the_jacobian(
        case in chains(),
        shift in prop::array::uniform3(-3.0..3.0),
        turn in prop::array::uniform3(-3.0..3.0),
    ) {
        let (chain, tree) = (case.chain().unwrap(), &case.tree);
        let mount = IsometryMatrix3::new(Vector3::from(shift), Vector3::from(turn));
        let (plain, mounted) = (run_chain(&chain, tree), run_chain(&chain.mounted(&mount), tree));
        prop_assert!(distance(&mounted.pose, &(mount * plain.pose)) < 1e-12);
        for name in plain.columns.keys() {
            let expected = twist(mount.rotation * plain.linear(name), mount.rotation * plain.angular(name));
            prop_assert!((mounted.column(name) - expected).norm() < 1e-12);
        }
    }

    #[test]
    fn two_poses_are_never_further_apart_than_twice_the_reach(case in chains(), scale in -1.0..1.0) {
        let (chain, q) = (case.chain().unwrap(), case.q());
        let other: Vec<f64> = q.iter().map(|q| scale * q).collect();
        let at = |q: &[f64]| chain.forward(q, &mut chain.scratch()).position();
        prop_assert!((at(&q) - at(&other)).norm() <= 2.0 * chain.reach() + 1e-12);
    }

    #[test]
    fn parents_stand_before_their_children(tree in trees()) {
        let robot = tree.robot().unwrap();
        prop_assert_eq!(robot.links().len(), tree.links());
        prop_assert!(robot.joints().iter().all(|own| own.parent < own.child));
        let drawn: Vec<_> = robot.tree().collect();
        prop_assert_eq!(drawn.len(), robot.links().len());
        for pair in drawn.windows(2) {
            prop_assert!(pair[1].depth <= pair[0].depth + 1);
        }
    }
}
