//! Tasks over several tips and of masked rows: derivatives, order, and what two arms carry.

#![allow(clippy::unwrap_used, reason = "a test that can not go on stops")]

use kinstep::formula::FormulaTable;
use kinstep::kind::Parameters;
use kinstep::math::rotation_vector;
use kinstep::nalgebra::{IsometryMatrix3, Rotation3, Unit, Vector3};
use kinstep::planner::{
    Arm, JointSystem, Plan, Planner, PlannerBuilder, PlannerError, derivative_errors, rows_at_start,
};
use kinstep::robot::{Chain, embedded};
use kinstep::task::{
    Axes, Circle, Component, Free, Hold, LayPath, Leaning, Mask, Masked, Motion, Planar, Plane, Quintic,
    Relative, TASKS, Task, TaskKind, TaskStart, Tracking, Turning,
};
use proptest::prelude::*;

const DURATION: f64 = 6.0;
const PANDA: [f64; 7] = [0.1, -0.4, 0.2, -2.1, 0.3, 1.8, 0.6];
const IIWA: [f64; 7] = [-0.2, 0.6, 0.1, -1.4, 0.2, 1.0, -0.3];

fn panda() -> Chain {
    embedded::get("panda").unwrap().chain("panda_link0", "panda_hand_tcp").unwrap()
}

fn iiwa(mount: &IsometryMatrix3<f64>) -> Chain {
    embedded::get("iiwa14").unwrap().chain("iiwa_link_0", "iiwa_link_ee").unwrap().mounted(mount)
}

fn mount() -> IsometryMatrix3<f64> {
    IsometryMatrix3::new(Vector3::new(1.2, 0.3, 0.0), Vector3::new(0.1, 0.2, 3.0))
}

fn pose(chain: &Chain, q: &[f64]) -> IsometryMatrix3<f64> {
    chain.forward(q, &mut chain.scratch()).pose()
}

fn free(name: &str, chain: Chain, q0: &[f64]) -> Arm {
    Arm::with_own_task(name, chain, q0.to_vec(), Box::new(Free))
}

/// A circle that leans over, laid anywhere.
#[derive(Debug)]
struct Leant;

impl LayPath for Leant {
    fn laid_at(&self, start: &IsometryMatrix3<f64>) -> Motion {
        let circle = Planar::new(Circle { radius: 0.1 }, Plane::Yz, 0.3, 0.0, 5.0);
        let axis = Unit::new_normalize(Vector3::new(1.0, 2.0, 3.0));
        Motion::from_pose(Leaning::new(circle, axis, 0.4), Quintic, DURATION, start)
    }
}

/// Every mask in a list that has all rows, parts of them and pointing, in all axes.
fn masks() -> Vec<Mask> {
    let parts: [&[usize]; 6] = [&[0, 1, 2, 3, 4, 5], &[0, 1, 2], &[1], &[4], &[2, 3, 5], &[0, 5]];
    let mut masks = Vec::new();
    for axes in Axes::ALL {
        for part in parts {
            masks.push(Mask::of(part.iter().map(|&place| Component::ALL[place]), axes));
        }
        for axis in 0..3 {
            masks.push(Mask::of([Component::Linear(axis)], axes).with_pointing(axis));
        }
    }
    masks
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// Off the path too: rows that are left out may be anywhere.
    #[test]
    fn masked_rows_state_the_derivatives_of_their_errors(
        q in prop::array::uniform7(-1.0..1.0_f64), t in 0.1..5.9_f64, away in prop::array::uniform6(-0.4..0.4_f64),
    ) {
        let chain = panda();
        let [x, y, z, rx, ry, rz] = away;
        let start = pose(&chain, &q) * IsometryMatrix3::new(Vector3::new(x, y, z), Vector3::new(rx, ry, rz));
        let arm = Arm::with_own_task("arm", chain, q.to_vec(), Box::new(Free));
        for mask in masks() {
            let (name, axes) = (mask.name(), mask.axes());
            let base = Rotation3::new(Vector3::new(rz, rx, y));
            let task = Masked::based(mask, Leant.laid_at(&start), base).unwrap();
            let errors = derivative_errors(std::slice::from_ref(&arm), &task, t, 1e-5);
            prop_assert!(errors.jacobian < 1e-8 && errors.feedforward < 1e-8, "{name} {axes:?}: {errors:?}");
        }
    }

    /// Every task over several tips that files can name, with every mask that it takes.
    #[test]
    fn added_tasks_state_the_derivatives_of_their_errors(
        left in prop::array::uniform7(-1.0..1.0_f64), right in prop::array::uniform7(-1.0..1.0_f64),
        third in prop::array::uniform7(-1.0..1.0_f64), t in 0.1..5.9_f64, numbers in prop::collection::vec(0..1000_i32, 8),
    ) {
        let (near, far) = (IsometryMatrix3::identity(), mount());
        let arms = [free("a", panda(), &left), free("b", iiwa(&far), &right), free("c", iiwa(&near), &third)];
        let q = [left, right, third];
        let tips: Vec<_> = arms.iter().zip(&q).map(|(arm, q)| pose(arm.chain(), q)).collect();
        for kind in TASKS {
            let mut numbers = numbers.iter().cycle();
            let mut whole = |low: i32, high: i32| low + numbers.next().map_or(0, |n| n % (high - low + 1));
            let given = (kind.draw.expect(kind.name))(0.4, &mut whole);
            let count = if kind.make.or_more { tips.len() } else { kind.make.tips };
            let paths: Vec<(&'static str, &dyn LayPath)> =
                kind.make.paths.iter().map(|key| (*key, &Leant as &dyn LayPath)).collect();
            let own = masks();
            let masks: Vec<Option<&Mask>> =
                std::iter::once(None).chain(own.iter().filter(|_| kind.make.takes_rows).map(Some)).collect();
            for (mask, paths) in masks.iter().flat_map(|mask| [(*mask, &paths[..]), (*mask, &[])]) {
                let start = TaskStart { paths, mask, ..TaskStart::new(&tips[..count], DURATION) };
                let Ok(task) = (kind.make.make)(&given, &start) else {
                    prop_assert!(paths.is_empty() && mask.is_some_and(|mask| mask.axes() == Axes::Path));
                    continue;
                };
                let at_start = derivative_errors(&arms[..count], &*task, 0.0, 1e-5);
                prop_assert!(at_start.error < 1e-9, "{}: {at_start:?}", kind.name);
                let errors = derivative_errors(&arms[..count], &*task, t, 1e-5);
                prop_assert!(errors.jacobian < 1e-7 && errors.feedforward < 1e-7, "{} {mask:?}: {errors:?}", kind.name);
            }
        }
    }
}

#[test]
fn all_six_rows_in_base_axes_are_the_plain_pose() {
    let (chain, q) = (panda(), PANDA);
    let start = pose(&chain, &q);
    let masked = Masked::new(Mask::pose(), Leant.laid_at(&start)).unwrap();
    let plain = Tracking { kind: TaskKind::Pose, motion: Leant.laid_at(&start) };
    let arms = [free("arm", chain, &q)];
    // On the path they are the same; off it the plain pose leaves out the derivative of the logarithm.
    let [masked, plain] = [&masked as &dyn Task, &plain].map(|task| rows_at_start(&arms, task, 0.0));
    assert!((masked.jacobian - plain.jacobian).amax() < 1e-14);
    let apart = |a: Vec<f64>, b: Vec<f64>| a.iter().zip(&b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(apart(masked.error, plain.error) < 1e-14);
    assert!(apart(masked.feedforward, plain.feedforward) < 1e-14);
    assert_eq!(Mask::pose().plain(&Rotation3::identity()), Some(TaskKind::Pose));
    assert_eq!(
        Mask::of([Component::Linear(1), Component::Linear(0)], Axes::Base).plain(&Rotation3::identity()),
        Some(TaskKind::PositionXy)
    );
    assert_eq!(Mask::pose().plain(&mount().rotation), None);
}

#[test]
fn path_axes_are_refused_where_a_path_has_no_direction() {
    let start = IsometryMatrix3::identity();
    let across = || Mask::of([Component::Linear(1)], Axes::Path);
    let held = Masked::new(across(), Motion::held(&start)).unwrap_err();
    assert!(held.contains("no tangent"), "{held}");
    let astroid = Planar::whole(kinstep::task::Astroid { radius: 0.1 });
    let cusp = Masked::new(across(), Motion::from_pose(astroid, Quintic, 1.0, &start)).unwrap_err();
    assert!(cusp.contains("cusp near u = 0.000"), "{cusp}");
}

fn builder(formula: &str, sigma: f64) -> PlannerBuilder {
    let formula = FormulaTable::builtin().get(formula).unwrap();
    Planner::builder().formula(formula).sigma(sigma).duration(DURATION)
}

/// Two arms of seven joints each that carry one object around a circle while it leans over.
fn carry(formula: &str, sigma: f64) -> Plan {
    let tips = [pose(&panda(), &PANDA), pose(&iiwa(&mount()), &IIWA)];
    let kind = TASKS.iter().find(|kind| kind.name == "object").unwrap();
    let start = TaskStart { paths: &[("path", &Leant)], ..TaskStart::new(&tips, DURATION) };
    let task = (kind.make.make)(&Parameters::default(), &start).unwrap();
    let arms = [free("left", panda(), &PANDA), free("right", iiwa(&mount()), &IIWA)];
    let system = JointSystem::of(["left", "right"]).with_task(task).called("carry");
    builder(formula, sigma).arms(arms).system(system).build().unwrap().run()
}

/// The largest change of the pose of the second tip in the frame of the first [m, rad].
fn change_of_relative_pose(plan: &Plan) -> f64 {
    let relative = |n: usize| {
        pose(&panda(), plan.arms[0].position(n)).inverse() * pose(&iiwa(&mount()), plan.arms[1].position(n))
    };
    let first = relative(0);
    let change = |n: usize| {
        let now = relative(n);
        let linear = (now.translation.vector - first.translation.vector).norm();
        linear.max(rotation_vector(&(now.rotation * first.rotation.inverse())).norm())
    };
    (0..plan.samples()).map(change).fold(0.0, f64::max)
}

#[test]
fn two_arms_of_seven_joints_carry_one_object_to_a_billionth() {
    let plan = carry("split-ab6", 0.01);
    assert!(plan.is_completed(), "{:?}", plan.reason);
    let task = &plan.tasks[0];
    assert_eq!((task.name.as_str(), task.kind.as_str(), task.rows), ("carry", "object", 12));
    let change = change_of_relative_pose(&plan);
    println!("{change:e} {:e} {:e}", task.max_position_error(), task.max_orientation_error());
    assert!(change < 1e-9, "{change:e}");
    assert!(task.max_position_error() < 1e-9 && task.max_orientation_error() < 1e-9);
    let both = task.max_position_error().hypot(task.max_orientation_error());
    assert!(task.max_error() <= both && plan.arms[0].drift() > 0.0);
}

#[test]
fn a_follower_keeps_its_pose_in_the_frame_of_its_leader() {
    let start = pose(&panda(), &PANDA);
    let leader = Arm::new("leader", panda(), PANDA.to_vec(), TaskKind::Pose, Leant.laid_at(&start));
    let follower = free("follower", iiwa(&mount()), &IIWA);
    let held = start.inverse() * pose(&iiwa(&mount()), &IIWA);
    let turning = Motion::from_pose(Turning::new(Hold, Vector3::z_axis(), 0.3), Quintic, DURATION, &held);
    let system =
        JointSystem::of(["leader", "follower"]).with_task(Relative::new(Mask::pose(), turning).unwrap());
    let plan = builder("split-ab6", 0.01).arms([leader, follower]).system(system).build().unwrap().run();
    assert!(plan.is_completed(), "{:?}", plan.reason);
    assert!(
        plan.arms[0].max_error < 1e-9 && plan.tasks[0].max_error() < 1e-9,
        "{:e}",
        plan.tasks[0].max_error()
    );
    assert_eq!(plan.arms[1].max_error, 0.0);
}

#[test]
fn tasks_that_ask_for_the_same_are_named() {
    let tips = [pose(&panda(), &PANDA), pose(&iiwa(&mount()), &IIWA)];
    let own = |name: &str, chain: Chain, q0: &[f64], tip: &IsometryMatrix3<f64>| {
        Arm::new(name, chain, q0.to_vec(), TaskKind::Position, Leant.laid_at(tip))
    };
    let arms = || [own("left", panda(), &PANDA, &tips[0]), own("right", iiwa(&mount()), &IIWA, &tips[1])];
    let relative = |mask: Mask| Relative::new(mask, Leant.laid_at(&(tips[0].inverse() * tips[1]))).unwrap();
    let refused = |arms: [Arm; 2], system: JointSystem| {
        builder("la6-wang-guo", 0.01).arms(arms).system(system).build().err().map(|error| error.to_string())
    };
    let pair = || JointSystem::of(["left", "right"]);
    let linear = || Mask::of(Component::ALL.into_iter().take(3), Axes::Base);
    // How far the tips are apart follows from both positions; in which direction the first sees the second does not.
    let distance = refused(arms(), pair().with_task(relative(linear()))).unwrap();
    assert!(
        distance.contains("`position` of arm `left` with the task `position` of arm `right`"),
        "{distance}"
    );
    let direction = Mask::of(Component::ALL.into_iter().take(2), Axes::Base);
    assert_eq!(refused(arms(), pair().with_task(relative(direction))), None);
    let twice =
        pair().with_task(relative(linear())).called("one").with_task(relative(linear())).called("two");
    let free = || [free("left", panda(), &PANDA), free("right", iiwa(&mount()), &IIWA)];
    let problem = refused(free(), twice).unwrap();
    assert!(problem.starts_with("task `two` asks for what task `one` asks for already"), "{problem}");
    let nothing = builder("la6-wang-guo", 0.01).arms(free()).build().unwrap_err();
    assert_eq!(nothing, PlannerError::NoTask { arm: "left".to_owned() });
}

/// Poses, errors and Jacobians of the second tip in the frame of the first, as Pinocchio has them
/// (`scripts/relative_figures.py`).
#[test]
fn relative_poses_errors_and_jacobians_are_those_of_pinocchio() {
    let text = include_str!("../data/relative_pinocchio.json");
    let figures: serde_json::Value = serde_json::from_str(text).unwrap();
    let numbers = |value: &serde_json::Value| -> Vec<f64> {
        value.as_array().unwrap().iter().map(|number| number.as_f64().unwrap()).collect()
    };
    let (xyz, rpy) = (numbers(&figures["mount"]["xyz"]), numbers(&figures["mount"]["rpy"]));
    let mount = IsometryMatrix3::from_parts(
        Vector3::new(xyz[0], xyz[1], xyz[2]).into(),
        Rotation3::from_euler_angles(rpy[0], rpy[1], rpy[2]),
    );
    let chains = [panda(), iiwa(&mount)];
    let samples = figures["samples"].as_array().unwrap();
    for sample in samples {
        let tip = |key: &str, arm: usize| pose(&chains[arm], &numbers(&sample[key][arm]));
        let relative = tip("q", 0).inverse() * tip("q", 1);
        let position = numbers(&sample["position"]);
        assert!((relative.translation.vector - Vector3::from_row_slice(&position)).norm() < 1e-12);
        let wanted = tip("q_reference", 0).inverse() * tip("q_reference", 1);
        let task = Relative::new(Mask::pose(), Motion::held(&wanted)).unwrap();
        let arms = [
            free("left", panda(), &numbers(&sample["q"][0])),
            free("right", iiwa(&mount), &numbers(&sample["q"][1])),
        ];
        let rows = rows_at_start(&arms, &task, 0.0);
        for (error, theirs) in rows.error.iter().zip(numbers(&sample["error"])) {
            assert!((error - theirs).abs() < 1e-12, "{error} {theirs}");
        }
        // Our rows are derivatives of the error; where that is none, they are the twist that Pinocchio's are.
        let on_path = Relative::new(Mask::pose(), Motion::held(&relative)).unwrap();
        let rows = rows_at_start(&arms, &on_path, 0.0);
        for (row, theirs) in sample["jacobian"].as_array().unwrap().iter().enumerate() {
            for (joint, theirs) in numbers(theirs).into_iter().enumerate() {
                let ours = rows.jacobian[(row, joint)];
                assert!((ours - theirs).abs() < 1e-12, "{row} {joint}: {ours} {theirs}");
            }
        }
    }
    assert_eq!(samples.len(), 5);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(6))]

    /// Of two random arms without tasks of their own, the second in the frame of the first.
    #[test]
    fn errors_of_relations_fall_with_the_order_of_the_row(
        left in prop::array::uniform7(-0.8..0.8_f64), right in prop::array::uniform7(-0.8..0.8_f64),
    ) {
        let q = [PANDA.iter().zip(left), IIWA.iter().zip(right)].map(|own| own.map(|(q, by)| q + 0.5 * by).collect::<Vec<_>>());
        let chains = [panda(), iiwa(&mount())];
        prop_assume!(chains.iter().zip(&q).all(|(chain, q)| chain.check_within_limits(q).is_ok()));
        let relative = pose(&chains[0], &q[0]).inverse() * pose(&chains[1], &q[1]);
        let run = |sigma: f64| {
            let task = Relative::new(Mask::pose(), Leant.laid_at(&relative)).unwrap();
            let arms = [free("left", panda(), &q[0]), free("right", iiwa(&mount()), &q[1])];
            let system = JointSystem::of(["left", "right"]).with_task(task);
            builder("split-ab4", sigma).arms(arms).system(system).build().unwrap().run()
        };
        let plans = [run(0.04), run(0.02)];
        prop_assume!(plans.iter().all(|plan| plan.is_completed() && plan.arms[0].smallest_singular_value.0 > 0.1));
        let [coarse, fine] = plans.map(|plan| plan.tasks[0].max_error());
        let slope = (coarse / fine).log2();
        prop_assert!((4.5..5.6).contains(&slope), "{coarse:e} {fine:e}: {slope}");
    }
}
