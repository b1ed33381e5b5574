//! Joint positions for poses: found where there are some, within limits, and never claimed where they do not lead.

#![allow(clippy::unwrap_used, reason = "a test that can not go on stops")]

use kinstep::inverse::{Search, Solution, Target};
use kinstep::nalgebra::{Unit, Vector3};
use kinstep::robot::{Chain, Robot, embedded};
use kinstep::task::{Reference, TaskKind};
use kinstep_strategies::arms;
use proptest::prelude::*;
use proptest::test_runner::{Config, RngSeed};

/// Arms of six, seven and eight joints.
const ARMS: [[&str; 3]; 7] = [
    ["panda", "panda_link0", "panda_link8"],
    ["iiwa14", "iiwa_link_0", "iiwa_link_ee"],
    ["ur5e", "base_link", "tool0"],
    ["ur10e", "base_link", "tool0"],
    ["baxter", "torso", "left_gripper"],
    ["baxter", "torso", "right_gripper"],
    ["torso14", "floor", "left_tool"],
];

fn chain([robot, base, tip]: [&str; 3]) -> Chain {
    embedded::get(robot).unwrap().chain(base, tip).unwrap()
}

/// Joint positions within the limits, or within a turn, at the given fractions.
fn at(chain: &Chain, fractions: &[f64]) -> Vec<f64> {
    let place = |((lower, upper), fraction): ((f64, f64), &f64)| {
        let (lower, upper) = (lower.max(-std::f64::consts::PI), upper.min(std::f64::consts::PI));
        lower + (upper - lower) * fraction
    };
    chain.position_limits().zip(fractions).map(place).collect()
}

/// What a solution says of itself, recomputed.
fn check(chain: &Chain, target: &Target, solution: &Solution) -> Result<(), TestCaseError> {
    let tip = chain.forward(&solution.q, &mut chain.scratch()).pose();
    prop_assert_eq!(target.error(&tip), solution.error);
    prop_assert!(chain.within_limits(&solution.q), "{:?}", solution.q);
    prop_assert_eq!(solution.is_found(), solution.distance() < 1e-11);
    Ok(())
}

proptest! {
    #![proptest_config(Config { cases: 20, rng_seed: RngSeed::Fixed(11), failure_persistence: None, ..Config::default() })]

    #[test]
    fn poses_that_an_arm_can_take_are_found(fractions in prop::collection::vec(0.0..1.0_f64, 8)) {
        for arm in ARMS {
            let chain = chain(arm);
            let pose = chain.forward(&at(&chain, &fractions), &mut chain.scratch()).pose();
            for target in [Target::pose(&pose), Target::position(pose.translation.vector)] {
                let solution = Search::new().solve(&chain, &target).unwrap();
                check(&chain, &target, &solution)?;
                prop_assert!(solution.is_found(), "{arm:?}: {}", solution.distance());
            }
        }
    }

    #[test]
    fn an_axis_needs_no_more_than_its_direction(fractions in prop::collection::vec(0.0..1.0_f64, 8)) {
        for arm in ARMS {
            let chain = chain(arm);
            let pose = chain.forward(&at(&chain, &fractions), &mut chain.scratch()).pose();
            let direction = Unit::new_normalize(pose.rotation * Vector3::z());
            let target = Target::axis(pose.translation.vector, direction);
            let solution = Search::new().solve(&chain, &target).unwrap();
            check(&chain, &target, &solution)?;
            prop_assert!(solution.is_found(), "{arm:?}: {}", solution.distance());
        }
    }

    #[test]
    fn at_twice_the_reach_the_distance_is_told(
        direction in prop::array::uniform3(-1.0..1.0_f64), turn in prop::array::uniform3(-1.0..1.0_f64),
    ) {
        prop_assume!(Vector3::from(direction).norm() > 0.1);
        for arm in &ARMS[..3] {
            let chain = chain(*arm);
            // Beyond twice the reach from the base, whose first joint is less than half a metre up.
            let place = Vector3::from(direction).normalize() * (2.0 * chain.reach() + 0.5);
            let reference = Reference {
                position: place,
                rotation: kinstep::nalgebra::Rotation3::new(Vector3::from(turn)),
                twist: kinstep::nalgebra::Vector6::zeros(),
            };
            let target = Target::of_task(TaskKind::Pose, &reference);
            let solution = Search::new().starts(20).solve(&chain, &target).unwrap();
            check(&chain, &target, &solution)?;
            prop_assert!(!solution.is_found() && solution.position_error() > chain.reach());
        }
    }
}

proptest! {
    #![proptest_config(Config { cases: 60, rng_seed: RngSeed::Fixed(12), failure_persistence: None, ..Config::default() })]

    #[test]
    fn random_arms_find_their_own_tasks(arm in arms(), aside in prop::collection::vec(-0.4..0.4_f64, 9)) {
        let chain = arm.chain().unwrap();
        let q: Vec<f64> = arm.q0().iter().zip(aside).map(|(q, aside)| q + aside).collect();
        let pose = chain.forward(&q, &mut chain.scratch()).pose();
        let twist = kinstep::nalgebra::Vector6::zeros();
        let reference = Reference { position: pose.translation.vector, rotation: pose.rotation, twist };
        let target = Target::of_task(arm.task, &reference);
        let solution = Search::new().near(&arm.q0()).solve(&chain, &target).unwrap();
        check(&chain, &target, &solution)?;
        prop_assert!(solution.is_found(), "{}", solution.distance());
        let distance = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt();
        let (found, known) = (distance(&solution.q, &arm.q0()), distance(&q, &arm.q0()));
        prop_assert!(found <= known * (1.0 + 1e-6), "{known} is nearer than {found}");
    }
}

#[test]
fn the_same_search_gives_the_same_answer_and_another_seed_may_give_another() {
    let chain = chain(ARMS[2]);
    let pose = chain.forward(&[0.3, -1.2, 1.4, -0.9, 0.8, 0.2], &mut chain.scratch()).pose();
    let solve = |seed| Search::new().seed(seed).solve(&chain, &Target::pose(&pose)).unwrap();
    assert_eq!(solve(3), solve(3));
    assert!(solve(4).is_found());
}

#[test]
fn a_joint_is_held_at_the_limit_that_keeps_it_from_the_target() {
    let urdf = r#"<robot name="hand"><link name="base"/><link name="hand"/><link name="tip"/>
        <joint name="turn" type="revolute"><parent link="base"/><child link="hand"/><axis xyz="0 0 1"/>
        <limit lower="-0.5" upper="0.5" velocity="1" effort="1"/></joint>
        <joint name="end" type="fixed"><parent link="hand"/><child link="tip"/><origin xyz="1 0 0"/></joint></robot>"#;
    let chain = Robot::from_urdf(urdf).unwrap().chain("base", "tip").unwrap();
    let target = Target::position_xy(1.0_f64.cos(), 1.0_f64.sin());
    let held = Search::new().solve(&chain, &target).unwrap();
    assert!(!held.is_found());
    assert_eq!(held.q, [0.5]);
    assert!((held.distance() - 2.0 * 0.25_f64.sin()).abs() < 1e-12, "the chord of half a radian");
    let free = Search::new().beyond_limits().solve(&chain, &target).unwrap();
    assert!(free.is_found() && (free.q[0] - 1.0).abs() < 1e-12, "{free:?}");
}

#[test]
fn joints_that_others_follow_are_found_too() {
    let urdf = r#"<robot name="finger"><link name="a"/><link name="b"/><link name="c"/><link name="tip"/>
        <joint name="j1" type="continuous"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/></joint>
        <joint name="j2" type="continuous"><parent link="b"/><child link="c"/><origin xyz="1 0 0"/><axis xyz="0 0 1"/>
        <mimic joint="j1" multiplier="0.5" offset="0.1"/></joint>
        <joint name="end" type="fixed"><parent link="c"/><child link="tip"/><origin xyz="1 0 0"/></joint></robot>"#;
    let chain = Robot::from_urdf(urdf).unwrap().chain("a", "tip").unwrap();
    assert_eq!(chain.dof(), 1);
    // Seven radians are more than a turn, which the follower does not come back from.
    let pose = chain.forward(&[7.0], &mut chain.scratch()).pose();
    let solution = Search::new().near(&[6.5]).solve(&chain, &Target::pose(&pose)).unwrap();
    assert!(solution.is_found() && (solution.q[0] - 7.0).abs() < 1e-9, "{solution:?}");
}
