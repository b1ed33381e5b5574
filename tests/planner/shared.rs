//! Arms that share joints: one system, with the order, the accuracy and the least norm of one arm.

#![allow(clippy::unwrap_used, reason = "a test that can not go on stops")]

use kinstep::formula::FormulaTable;
use kinstep::integrate::Starter;
use kinstep::law::{Criterion, Instant, Pseudoinverse};
use kinstep::nalgebra::{DMatrix, DVector, Vector3, Vector6};
use kinstep::planner::{Arm, Plan, Planner, PlannerError};
use kinstep::robot::{Chain, Robot, embedded};
use kinstep::task::{Circle, Line, Motion, Planar, Plane, Quintic, TaskKind, TimeLaw};
use std::f64::consts::TAU;
use std::fmt::Write;

const DURATION: f64 = 4.0;
/// Lift and waist, then shoulder roll and pitch, elbow, wrist roll, pitch and yaw of one side.
const LEFT: [f64; 8] = [0.2, 0.1, -0.58, -0.82, -0.7, -1.36, 0.68, 0.08];
const RIGHT: [f64; 8] = [0.2, 0.1, 0.5, -0.8, -0.75, 1.3, 0.7, -0.1];

fn torso(base: &str, tip: &str) -> Chain {
    embedded::get("torso14").unwrap().chain(base, tip).unwrap()
}

fn on_circle(name: &str, chain: Chain, q0: &[f64], task: TaskKind, law: impl TimeLaw + 'static) -> Arm {
    let start = chain.forward(q0, &mut chain.scratch()).pose();
    let path = Planar::new(Circle { radius: 0.05 }, Plane::Yz, 0.0, 0.0, TAU);
    let motion = Motion::from_pose(path, law, DURATION, &start);
    Arm::new(name, chain, q0.to_vec(), task, motion)
}

fn both(task: TaskKind) -> [Arm; 2] {
    let left = on_circle("left", torso("floor", "left_tool"), &LEFT, task, Quintic);
    let right = on_circle("right", torso("floor", "right_tool"), &RIGHT, task, Quintic);
    [left.on_machine("torso"), right.on_machine("torso")]
}

fn planner(arms: impl IntoIterator<Item = Arm>, formula: &str, sigma: f64, h: f64) -> Planner {
    let formula = FormulaTable::builtin().get(formula).unwrap();
    Planner::builder().formula(formula).sigma(sigma).h(h).duration(DURATION).arms(arms).build().unwrap()
}

fn worst(plan: &Plan) -> f64 {
    assert!(plan.is_completed(), "{:?}", plan.reason);
    plan.arms.iter().map(|arm| arm.max_error).fold(0.0, f64::max)
}

#[test]
fn errors_of_arms_with_a_common_torso_fall_with_the_proved_order() {
    for (task, formula, h, order) in [
        (TaskKind::Pose, "la6-wang-guo", 0.4, 4.0),
        (TaskKind::Position, "la6-wang-guo", 0.4, 4.0),
        (TaskKind::Pose, "split-ab4", 1.0, 5.0),
    ] {
        let errors = [0.02, 0.01].map(|sigma| worst(&planner(both(task), formula, sigma, h).run()));
        let slope = (errors[0] / errors[1]).log2();
        assert!((slope - order).abs() < 0.35, "{task:?} {formula}: {slope} from {errors:?}");
    }
}

#[test]
fn a_common_joint_is_one_joint() {
    let plan = planner(both(TaskKind::Pose), "la6-wang-guo", 0.01, 0.4).run();
    let [left, right] = &plan.arms[..] else { panic!("two arms") };
    assert_eq!(plan.shared.len(), 1);
    assert_eq!(plan.shared[0].arms, ["left", "right"]);
    assert_eq!(plan.shared[0].joints, ["lift", "waist"]);
    let mut moved = 0.0_f64;
    for n in 0..plan.samples() {
        assert_eq!(left.position(n)[..2], right.position(n)[..2]);
        assert_eq!(left.velocity(n)[..2], right.velocity(n)[..2]);
        moved = moved.max((left.position(n)[1] - LEFT[1]).abs());
    }
    assert!(moved > 1e-3, "the torso helps: {moved}");
    // What each arm reports of itself is what its own chain says.
    for (arm, tip) in [(left, "left_tool"), (right, "right_tool")] {
        let chain = torso("floor", tip);
        let begin = chain.forward(arm.position(0), &mut chain.scratch()).position();
        let end = chain.forward(arm.position(plan.steps), &mut chain.scratch()).position();
        assert!((begin - end).norm() < 1e-6, "the circle closes");
    }
}

/// The stacked Jacobian and velocity of both arms over lift, waist and six joints of either side.
fn stacked(plan: &Plan, n: usize) -> (DMatrix<f64>, DVector<f64>) {
    let (mut jacobian, mut velocity) = (DMatrix::zeros(12, 14), DVector::zeros(14));
    for (side, (arm, tip)) in plan.arms.iter().zip(["left_tool", "right_tool"]).enumerate() {
        let chain = torso("floor", tip);
        let mut columns = [Vector6::zeros(); 8];
        chain.forward(arm.position(n), &mut chain.scratch()).geometric_jacobian(&mut columns);
        for (joint, column) in columns.iter().enumerate() {
            let place = if joint < 2 { joint } else { joint + 6 * side };
            jacobian.view_mut((6 * side, place), (6, 1)).copy_from(column);
            velocity[place] = arm.velocity(n)[joint];
        }
    }
    (jacobian, velocity)
}

#[test]
fn the_motion_is_the_smallest_that_meets_both_tasks() {
    let plan = planner(both(TaskKind::Pose), "la6-wang-guo", 0.01, 0.4).run();
    let motion = |arm: usize| {
        let (chain, q0) =
            [(torso("floor", "left_tool"), LEFT), (torso("floor", "right_tool"), RIGHT)][arm].clone();
        let start = chain.forward(&q0, &mut chain.scratch()).pose();
        let path = Planar::new(Circle { radius: 0.05 }, Plane::Yz, 0.0, 0.0, TAU);
        Motion::from_pose(path, Quintic, DURATION, &start)
    };
    let motions = [motion(0), motion(1)];
    for n in (20..plan.samples()).step_by(37) {
        let (jacobian, velocity) = stacked(&plan, n);
        let mut wanted = DVector::zeros(12);
        for (side, motion) in motions.iter().enumerate() {
            wanted.rows_mut(6 * side, 6).copy_from(&motion.at(plan.time(n)).twist);
        }
        assert!((&jacobian * &velocity - &wanted).norm() < 1e-12, "both tasks are met");
        let gram = (&jacobian * jacobian.transpose()).cholesky().unwrap();
        let least = jacobian.transpose() * gram.solve(&wanted);
        assert!(
            (least - &velocity).norm() < 1e-11 * (1.0 + velocity.norm()),
            "in the row space of the stack"
        );
    }
}

#[test]
fn arms_of_one_machine_that_share_nothing_move_as_if_they_were_alone() {
    let arms = || {
        let left = on_circle("left", torso("chest", "left_tool"), &LEFT[2..], TaskKind::Position, Quintic);
        let right =
            on_circle("right", torso("chest", "right_tool"), &RIGHT[2..], TaskKind::Position, Quintic);
        [left, right]
    };
    let alone = planner(arms(), "la6-wang-guo", 0.02, 0.4).run();
    let together = planner(arms().map(|arm| arm.on_machine("torso")), "la6-wang-guo", 0.02, 0.4).run();
    assert!(together.shared.is_empty() && together.is_completed(), "{:?}", together.reason);
    for (one, other) in alone.arms.iter().zip(&together.arms) {
        assert_eq!(one.positions, other.positions);
    }
    // And arms of two machines share nothing, whatever their joints are called.
    let [left, right] = both(TaskKind::Pose);
    let plan = planner([left, right.on_machine("another")], "la6-wang-guo", 0.02, 0.4).run();
    assert!(plan.shared.is_empty());
    assert_ne!(plan.arms[0].position(100)[..2], plan.arms[1].position(100)[..2]);
}

#[test]
fn the_order_of_the_arms_does_not_matter_and_others_may_stand_between_them() {
    let [left, right] = both(TaskKind::Position);
    let panda = || {
        let chain = embedded::get("panda").unwrap().chain("panda_link0", "panda_link8").unwrap();
        on_circle("panda", chain, &[0.0, -0.6, 0.0, -2.2, 0.0, 1.6, 0.8], TaskKind::Pose, Quintic)
    };
    let plan = planner([left, panda(), right], "la6-wang-guo", 0.02, 0.4).run();
    let alone = planner([panda()], "la6-wang-guo", 0.02, 0.4).run();
    assert_eq!(plan.arms[1].positions, alone.arms[0].positions);
    let [left, right] = both(TaskKind::Position);
    let turned = planner([right, left], "la6-wang-guo", 0.02, 0.4).run();
    for (one, other) in plan.arms[0].positions.iter().zip(&turned.arms[1].positions) {
        assert!((one - other).abs() < 1e-9);
    }
}

/// A planar trunk of two joints with three branches of three joints each, all links 0.5 m long.
fn tree() -> Robot {
    let mut urdf = r#"<robot name="tree"><link name="base"/>"#.to_owned();
    let mut joint = |name: &str, parent: &str, child: &str, kind: &str, x: f64| {
        let _ = write!(
            urdf,
            r#"<link name="{child}"/><joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>
               <origin xyz="{x} 0 0"/><axis xyz="0 0 1"/></joint>"#
        );
    };
    joint("t1", "base", "trunk1", "continuous", 0.0);
    joint("t2", "trunk1", "trunk2", "continuous", 0.5);
    for branch in ["a", "b", "c"] {
        joint(&format!("{branch}1"), "trunk2", &format!("{branch}_1"), "continuous", 0.5);
        joint(&format!("{branch}2"), &format!("{branch}_1"), &format!("{branch}_2"), "continuous", 0.5);
        joint(&format!("{branch}3"), &format!("{branch}_2"), &format!("{branch}_3"), "continuous", 0.5);
        joint(&format!("{branch}_end"), &format!("{branch}_3"), &format!("{branch}_tip"), "fixed", 0.5);
    }
    Robot::from_urdf(&(urdf + "</robot>")).unwrap()
}

#[test]
fn three_branches_of_one_trunk_are_one_system() {
    let arms = |starts: [f64; 3]| {
        ["a", "b", "c"].into_iter().zip(starts).map(|(branch, q)| {
            let chain = tree().chain("base", &format!("{branch}_tip")).unwrap();
            let q0 = [0.3, 0.4, q, 0.7, -0.6];
            let start = chain.forward(&q0, &mut chain.scratch()).pose();
            let line = Line { displacement: Vector3::new(0.1 * q, -0.15, 0.0) };
            let motion = Motion::from_pose(line, Quintic, DURATION, &start);
            Arm::new(branch, chain, q0.to_vec(), TaskKind::PositionXy, motion).on_machine("tree")
        })
    };
    let errors =
        [0.08, 0.04].map(|sigma| worst(&planner(arms([-1.2, 0.2, 1.3]), "la6-wang-guo", sigma, 0.4).run()));
    let slope = (errors[0] / errors[1]).log2();
    assert!((slope - 4.0).abs() < 0.35, "{slope} from {errors:?}");
    let plan = planner(arms([-1.2, 0.2, 1.3]), "la6-wang-guo", 0.04, 0.4).run();
    assert_eq!(plan.shared[0].joints, ["t1", "t2"]);
    assert_eq!(plan.shared[0].arms, ["a", "b", "c"]);
}

#[test]
fn given_states_hold_the_union_of_the_joints() {
    let reference = planner(both(TaskKind::Pose), "la6-wang-guo", 0.02, 0.4).run();
    let state = |n: usize| [reference.arms[0].position(n), &reference.arms[1].position(n)[2..]].concat();
    let given = Starter::Given((1..5).map(state).collect());
    let formula = FormulaTable::builtin().get("la6-wang-guo").unwrap();
    let builder = Planner::builder().formula(formula).sigma(0.02).h(0.4).duration(DURATION).start(given);
    let plan = builder.arms(both(TaskKind::Pose)).build().unwrap().run();
    assert_eq!(plan.arms[1].positions, reference.arms[1].positions);
}

struct Homing;

impl Criterion for Homing {
    fn velocity(&mut self, _: &Instant<'_>, c: &mut [f64]) {
        c.fill(0.0);
    }

    fn rate(&self) -> Option<f64> {
        Some(1.0)
    }
}

#[test]
fn what_can_not_be_one_system_is_refused() {
    let build = |arms: [Arm; 2]| {
        let formula = FormulaTable::builtin().get("la6-wang-guo").unwrap();
        Planner::builder()
            .formula(formula)
            .sigma(0.02)
            .h(0.4)
            .duration(DURATION)
            .arms(arms)
            .build()
            .unwrap_err()
    };
    let [left, _] = both(TaskKind::Pose);
    let mut q0 = RIGHT;
    q0[1] = 0.3;
    let right =
        on_circle("right", torso("floor", "right_tool"), &q0, TaskKind::Pose, Quintic).on_machine("torso");
    let error = build([left, right]);
    assert_eq!(
        error.to_string(),
        "arms `left` and `right` share joint `waist`, which starts at 0.1 in the one and at 0.3 in the other; give it one position"
    );
    let [left, right] = both(TaskKind::Pose);
    let error = build([left, right.with_law(Pseudoinverse::new().with_criterion(Homing))]);
    assert!(matches!(error, PlannerError::SharedLaw { arm } if arm == "right"));
}

#[test]
fn tips_on_one_link_that_part_ways_are_a_singular_start() {
    // Both arms are the same arm: whatever one does, the other does too, and the stack has no full rank.
    let left =
        on_circle("left", torso("floor", "left_tool"), &LEFT, TaskKind::Pose, Quintic).on_machine("torso");
    let twin =
        on_circle("twin", torso("floor", "left_tool"), &LEFT, TaskKind::Pose, Quintic).on_machine("torso");
    let planner = planner([left, twin], "la6-wang-guo", 0.02, 0.4);
    let plan = planner.run();
    assert!(!plan.is_completed());
    assert!(
        plan.warnings.iter().any(|warning| warning.contains("together have 8 joints for the 12")),
        "{plan:?}"
    );
}
