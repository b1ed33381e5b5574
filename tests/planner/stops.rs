//! How runs end when they can not go on, and what keeps them from starting.

#![allow(clippy::unwrap_used)]

use kinstep::nalgebra::{IsometryMatrix3, Vector3};
use kinstep::planner::{Arm, LimitKind, Plan, PlanStatus, PlannerError};
use kinstep::robot::{Chain, Robot, embedded};
use kinstep::scheme;
use kinstep::task::{Circle, Line, Motion, Path, Planar, Plane, Quintic, Sin2, TaskKind, TimeLaw, Tricuspid};

const DURATION: f64 = 4.0;

fn planar() -> Chain {
    embedded::get("planar4").unwrap().chain("base", "tip").unwrap()
}

fn arm(chain: Chain, q0: &[f64], path: impl Path + 'static, law: impl TimeLaw + 'static) -> Arm {
    let start = chain.forward(q0, &mut chain.scratch()).pose();
    let motion = Motion::from_pose(path, law, DURATION, &start);
    Arm::new("arm", chain, q0.to_vec(), TaskKind::PositionXy, motion)
}

fn run(arm: Arm) -> Plan {
    scheme::dtsmp([arm], 0.01, 0.4).duration(DURATION).build().unwrap().run()
}

fn line(x: f64, y: f64) -> Line {
    Line { displacement: Vector3::new(x, y, 0.0) }
}

#[test]
fn a_path_that_leaves_the_workspace_is_unreachable() {
    // The tip stands at 2.9 m of the 4 m reach; the line ends at 6 m.
    let plan = run(arm(planar(), &[0.3, 0.4, 0.5, 0.6], line(4.0, 0.0), Sin2));
    assert_eq!(plan.status, PlanStatus::Unreachable, "{:?}", plan.reason);
    assert!(plan.samples() < plan.steps && plan.samples() > 1, "what was computed is kept");
    assert!(plan.reason.unwrap().contains("move the path nearer"));
}

#[test]
fn a_fast_path_out_of_the_workspace_is_not_blamed_on_the_loop() {
    let path = Planar::whole(Circle { radius: 6.0 });
    let plan = run(arm(planar(), &[0.3, 0.4, 0.5, 0.6], path, Quintic));
    assert_eq!(plan.status, PlanStatus::Unreachable, "{:?}", plan.reason);
}

#[test]
fn a_stretched_arm_is_a_singular_start() {
    let plan = run(arm(planar(), &[0.3, 0.0, 0.0, 0.0], line(-1.0, 0.0), Sin2));
    assert_eq!(plan.status, PlanStatus::Singular);
    assert_eq!(plan.samples(), 1);
    assert!(plan.reason.unwrap().contains("bent arm"));
}

#[test]
fn an_arm_that_passes_a_singularity_is_damped_and_says_so() {
    let chain = Robot::from_urdf(&two_links("-7 7")).unwrap().chain("base", "tip").unwrap();
    // The line passes through the base, where turning the shoulder does not move the tip.
    let tip = chain.forward(&[0.2, 2.2], &mut chain.scratch()).position();
    let arm = arm(chain, &[0.2, 2.2], line(-2.0 * tip.x, -2.0 * tip.y), Sin2);
    let plan = scheme::dtsmp([arm], 0.0005, 0.4).duration(DURATION).build().unwrap().run();
    assert_eq!(plan.status, PlanStatus::Completed, "{:?}", plan.reason);
    let arm = &plan.arms[0];
    assert!(arm.damped_samples > 1 && arm.smallest_singular_value.0 < 2e-3);
    assert!(
        plan.warnings.iter().any(|warning| warning.contains("near a singularity")),
        "{:?}",
        plan.warnings
    );
    // No joint jumps: the damped law bounds the velocity.
    let jump =
        (1..plan.samples()).map(|n| (arm.position(n)[0] - arm.position(n - 1)[0]).abs()).fold(0.0, f64::max);
    assert!(jump < 0.1, "{jump}");
}

#[test]
fn limits_are_watched_on_every_sample() {
    let urdf = two_links("1.0 1.6");
    let chain = Robot::from_urdf(&urdf).unwrap().chain("base", "tip").unwrap();
    let plan = run(arm(chain, &[0.0, 1.5], line(0.3, 0.2), Sin2));
    assert_eq!(plan.status, PlanStatus::Completed, "{:?}", plan.reason);
    assert!(!plan.is_within_limits());
    let violations = &plan.arms[0].violations;
    let elbow = violations.iter().find(|v| v.joint == "elbow" && v.kind == LimitKind::Position).unwrap();
    assert_eq!(elbow.limit, 1.0);
    let lowest = (0..plan.samples()).map(|n| plan.arms[0].position(n)[1]).fold(f64::MAX, f64::min);
    assert_eq!(elbow.value, lowest);
    let shoulder =
        violations.iter().find(|v| v.joint == "shoulder" && v.kind == LimitKind::Velocity).unwrap();
    assert!(shoulder.value.abs() > 0.1 && shoulder.limit.abs() == 0.1);
}

#[test]
fn accelerations_and_jerks_between_samples_are_watched_in_followers_too() {
    // A slider on a line x = s(t): by the law sin^2 its acceleration is known.
    let urdf = |rest: &str| {
        format!(
            r#"<robot name="slide"><link name="base"/><link name="a"/><link name="tip"/>
            <joint name="x" type="prismatic"><parent link="base"/><child link="a"/><axis xyz="1 0 0"/>
            <limit lower="-9" upper="9" velocity="9" effort="1" {rest}/></joint>
            <joint name="y" type="prismatic"><parent link="a"/><child link="tip"/><axis xyz="1 0 0"/>
            <limit lower="-9" upper="9" velocity="9" effort="1" {}/><mimic joint="x" multiplier="-3"/></joint></robot>"#,
            if rest.is_empty() { "acceleration=\"1.5\"" } else { "" }
        )
    };
    let plan = |rest: &str| {
        let chain = Robot::from_urdf(&urdf(rest)).unwrap().chain("base", "tip").unwrap();
        let start = chain.forward(&[0.0], &mut chain.scratch()).pose();
        let motion = Motion::from_pose(line(-4.0, 0.0), Quintic, DURATION, &start);
        let arm = Arm::new("arm", chain, vec![0.0], TaskKind::PositionXy, motion);
        scheme::dtsmp([arm], 0.01, 0.4).duration(DURATION).build().unwrap().run()
    };
    // The slider goes 2 m by a quintic: at most 10/sqrt(3) m / T^2 of acceleration, 60 m / T^3 of jerk at its ends.
    let most = [2.0 * 10.0 / 3.0_f64.sqrt() / DURATION.powi(2), 2.0 * 60.0 / DURATION.powi(3)];
    let kinds = |rest: String| plan(&rest).arms[0].violations.iter().map(|v| v.kind).collect::<Vec<_>>();
    assert_eq!(kinds(format!("acceleration=\"{}\"", 0.999 * most[0])), [LimitKind::Acceleration]);
    assert_eq!(
        kinds(format!("acceleration=\"{}\" jerk=\"{}\"", 1.001 * most[0], 0.97 * most[1])),
        [LimitKind::Jerk]
    );
    // The Euler steps of the start are left with a kink.
    assert_eq!(kinds(format!("acceleration=\"{}\" jerk=\"{}\"", 1.001 * most[0], 7.0 * most[1])), []);
    // Of the follower, which moves three times as fast.
    let plan = plan("");
    let [followed] = &plan.arms[0].violations[..] else { panic!("{:?}", plan.arms[0].violations) };
    assert_eq!(
        (followed.joint.as_str(), followed.kind, followed.limit.abs()),
        ("x", LimitKind::Acceleration, 0.5)
    );
    assert!((followed.value.abs() - most[0]).abs() < 1e-3, "{followed:?}");
}

#[test]
fn a_path_laid_by_its_centre_has_to_begin_at_the_tip() {
    let chain = planar();
    let motion = Motion::centered(
        Planar::whole(Circle { radius: 0.5 }),
        Sin2,
        DURATION,
        Vector3::zeros(),
        IsometryMatrix3::identity().rotation,
    );
    let arm = Arm::new("arm", chain, vec![0.3, 0.4, 0.5, 0.6], TaskKind::PositionXy, motion);
    let error = scheme::dtsmp([arm], 0.01, 0.4).duration(DURATION).build().unwrap_err();
    assert!(matches!(error, PlannerError::PathStart { distance, .. } if distance > 1.0), "{error}");
}

#[test]
fn a_sigma_that_would_fill_the_memory_is_refused_with_an_estimate() {
    let arm = arm(planar(), &[0.3, 0.4, 0.5, 0.6], line(0.1, 0.0), Sin2);
    let error = scheme::dtsmp([arm], 1e-12, 0.4).duration(DURATION).build().unwrap_err();
    assert!(matches!(error, PlannerError::TooManySteps { .. }));
    assert!(error.to_string().contains("GiB"), "{error}");
}

/// A planar arm of two unit links; the elbow has the limits given, the shoulder may turn at 0.1 rad/s.
fn two_links(elbow: &str) -> String {
    let (lower, upper) = elbow.split_once(' ').unwrap();
    format!(
        r#"<robot name="two"><link name="base"/><link name="upper"/><link name="fore"/><link name="tip"/>
        <joint name="shoulder" type="revolute"><parent link="base"/><child link="upper"/><axis xyz="0 0 1"/>
        <limit lower="-7" upper="7" velocity="0.1" effort="1"/></joint>
        <joint name="elbow" type="revolute"><parent link="upper"/><child link="fore"/><origin xyz="1 0 0"/>
        <axis xyz="0 0 1"/><limit lower="{lower}" upper="{upper}" velocity="100" effort="1"/></joint>
        <joint name="end" type="fixed"><parent link="fore"/><child link="tip"/><origin xyz="1 0 0"/></joint></robot>"#
    )
}

#[test]
fn an_arm_with_too_few_joints_can_follow_what_it_can_reach_and_nothing_else() {
    let urdf = r#"<robot name="slide"><link name="base"/><link name="tip"/><joint name="slide" type="prismatic">
        <parent link="base"/><child link="tip"/><axis xyz="1 0 0"/><limit lower="-2" upper="2" velocity="9" effort="1"/>
        </joint></robot>"#;
    let chain = || Robot::from_urdf(urdf).unwrap().chain("base", "tip").unwrap();
    let along = run(arm(chain(), &[0.1], line(0.8, 0.0), Sin2));
    assert_eq!(along.status, PlanStatus::Completed, "{:?}", along.reason);
    assert!(along.arms[0].max_error < 1e-4);
    assert!(along.warnings.iter().any(|warning| warning.contains("1 joints for the 2 components")));
    let across = run(arm(chain(), &[0.1], Planar::whole(Circle { radius: 0.05 }), Sin2));
    assert_eq!(across.status, PlanStatus::Unreachable, "{:?}", across.reason);
}

#[test]
fn an_arm_that_leaves_the_workspace_is_damped_before_it_jumps() {
    // A large path that the arm can follow for two seconds.
    let path = Planar::new(Tricuspid { radius: 0.4 }, Plane::Xy, 1.571, 0.0, std::f64::consts::TAU);
    let plan = run(arm(planar(), &[-0.847, 0.1, 0.2, 0.3], path, Sin2));
    assert_eq!(plan.status, PlanStatus::Unreachable, "{:?}", plan.reason);
    let arm = &plan.arms[0];
    let step =
        |n: usize| (0..4).map(|i| (arm.position(n)[i] - arm.position(n - 1)[i]).abs()).fold(0.0, f64::max);
    let jump = (1..plan.samples()).map(step).fold(0.0, f64::max);
    assert!(jump < 0.3, "a joint moved by {jump} rad in one sample");
}
