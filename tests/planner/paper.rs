//! The paper's experiments through the library, against figures of an independent simulation.

#![allow(clippy::unwrap_used)]

use kinstep::integrate::Starter;
use kinstep::law::{Posture, Pseudoinverse};
use kinstep::nalgebra::{IsometryMatrix3, Vector3};
use kinstep::planner::{Arm, Plan, PlanStatus, PlannerBuilder};
use kinstep::robot::embedded;
use kinstep::scheme;
use kinstep::task::{Motion, Planar, Plane, Sin2, Sin2Sin2, TaskKind, TimeLaw, Tricuspid};
use std::f64::consts::PI;

/// Experiment A.1: one of the two four-link arms on a tricuspid that begins at a cusp.
fn arm(name: &str, q0: [f64; 4], radius: f64, law: impl TimeLaw + 'static) -> Arm {
    let chain = embedded::get("planar4").unwrap().chain("base", "tip").unwrap();
    let mount = IsometryMatrix3::new(
        Vector3::new(if name == "left" { -2.0 } else { 2.0 }, 0.0, 0.0),
        Vector3::zeros(),
    );
    let chain = chain.mounted(&mount);
    let start = chain.forward(&q0, &mut chain.scratch()).pose();
    let path = Planar::new(Tricuspid { radius }, Plane::Xy, PI / 2.0, 0.0, 2.0 * PI);
    let motion = Motion::from_pose(path, law, 10.0, &start);
    Arm::new(name, chain, q0.to_vec(), TaskKind::PositionXy, motion)
}

fn left() -> Arm {
    arm("left", [0.9 * PI, -0.1 * PI, -0.1 * PI, -0.1 * PI], 0.4, Sin2)
}

fn run(builder: PlannerBuilder) -> Plan {
    builder.duration(10.0).build().unwrap().run()
}

fn assert_within_a_percent(got: f64, expected: f64) {
    assert!((got / expected - 1.0).abs() < 0.01, "{got:e} is not {expected:e}");
}

#[test]
fn the_left_arm_shows_the_published_errors_and_the_biquadrate_pattern() {
    let figures = [
        (0.04, 5.85e-5),
        (0.02, 4.89e-6),
        (0.01, 3.47e-7),
        (0.005, 2.27e-8),
        (0.0025, 1.43e-9),
        (0.00125, 8.99e-11),
    ];
    for (sigma, expected) in figures {
        let plan = run(scheme::dtsmp([left()], sigma, 0.4));
        assert_eq!(plan.status, PlanStatus::Completed);
        assert_within_a_percent(plan.arms[0].max_error, expected);
    }
}

#[test]
fn repetitive_motion_brings_the_joints_back_and_leaves_the_errors_as_they_are() {
    let start = [0.9 * PI, -0.1 * PI, -0.1 * PI, -0.1 * PI];
    let repetitive = || Pseudoinverse::new().with_criterion(Posture::new(20.0, start.to_vec()));
    for (sigma, expected) in [(0.01, 3.47e-7), (0.005, 2.27e-8), (0.0025, 1.43e-9)] {
        let plain = run(scheme::dtsmp([left()], sigma, 0.4));
        let plan = run(scheme::dtsmp([left().with_law(repetitive())], sigma, 0.4));
        assert_within_a_percent(plan.arms[0].max_error, expected);
        // Under the plain law the joints of a closed path do not close.
        assert!(plain.arms[0].drift() > 2.6e-3 && plan.arms[0].drift() < 1e-7, "{}", plan.arms[0].drift());
    }
}

#[test]
fn both_arms_stay_below_the_bounds_that_the_paper_prints() {
    let right = || arm("right", [0.1 * PI; 4], 0.4, Sin2);
    for (plan, bound) in [
        (run(scheme::dtsmp([left(), right()], 0.01, 0.4)), 4e-7),
        (run(scheme::euler([left(), right()], 0.01, 0.4)), 3e-4),
    ] {
        for arm in &plan.arms {
            assert!(arm.max_error_component < bound, "{} of {}", arm.max_error_component, arm.name);
        }
    }
}

#[test]
fn the_error_falls_up_to_the_end_of_the_range_and_explodes_beyond() {
    assert_within_a_percent(run(scheme::dtsmp([left()], 0.01, 0.66)).arms[0].max_error, 2.19e-7);
    let refused = scheme::dtsmp([left()], 0.01, 0.7).duration(10.0).build().unwrap_err().to_string();
    assert!(refused.contains("(0, 2/3)"), "{refused}");
    let edge = scheme::dtsmp([left()], 0.01, 2.0 / 3.0).duration(10.0).build();
    assert!(edge.is_err(), "the end of the range is outside, also as the nearest double");
    let plan = run(scheme::dtsmp([left()], 0.01, 0.7).allow_unstable(true));
    assert_eq!(plan.status, PlanStatus::Diverged, "{:?}", plan.reason);
}

#[test]
fn split_schemes_reach_the_figures_of_an_independent_simulation() {
    let figures =
        [(3, 0.02, 1.6e-6), (4, 0.02, 1.1e-7), (5, 0.02, 1.8e-8), (6, 0.02, 2.4e-9), (8, 0.02, 1.3e-10)];
    for (p, sigma, expected) in figures {
        let arm = arm("left", [0.9 * PI, -0.1 * PI, -0.1 * PI, -0.1 * PI], 0.2, Sin2Sin2);
        let plan = run(scheme::split(p, [arm], sigma, 1.0).unwrap().start(Starter::Ramp));
        let got = plan.arms[0].max_error_component;
        assert!((0.8..1.25).contains(&(got / expected)), "order {p}: {got:e} is not {expected:e}");
    }
}
