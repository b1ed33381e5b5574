//! Bodies that are kept apart, or not, and what a plan says of it.

#![allow(clippy::unwrap_used, reason = "a test that can not go on stops")]

use kinstep::collision::{Capsule, CollisionModel, HalfSpace, Pairings};
use kinstep::formula::FormulaTable;
use kinstep::law::{Clearance, Law, Pseudoinverse, QuadraticProgram};
use kinstep::nalgebra::{IsometryMatrix3, Vector3};
use kinstep::planner::{Arm, Plan, PlanStatus, Planner, PlannerBuilder, PlannerError, Surroundings};
use kinstep::robot::embedded;
use kinstep::task::{Line, Motion, Quintic, TaskKind};
use proptest::prelude::*;

const START: [f64; 7] = [0.0, -0.6, 0.0, -2.2, 0.0, 1.6, 0.8];
const MARGIN: f64 = 0.02;

fn at(y: f64) -> IsometryMatrix3<f64> {
    IsometryMatrix3::translation(0.0, y, 0.0)
}

/// A Panda whose base stands at a place on the y axis, and whose hand goes along a line.
fn arm(name: &str, y: f64, way: Vector3<f64>, law: impl Law + 'static) -> Arm {
    let chain =
        embedded::get("panda").unwrap().chain("panda_link0", "panda_hand_tcp").unwrap().mounted(&at(y));
    let start = chain.forward(&START, &mut chain.scratch()).pose();
    let motion = Motion::from_pose(Line { displacement: way }, Quintic, 4.0, &start);
    Arm::new(name, chain, START.to_vec(), TaskKind::Position, motion).with_law(law)
}

fn around(arms: &[(&str, f64)]) -> Surroundings {
    let panda = embedded::get("panda").unwrap();
    let model = CollisionModel::embedded("panda").unwrap();
    arms.iter().fold(Surroundings::new(MARGIN), |all, (name, y)| {
        all.with_machine(*name, panda.clone(), model.clone(), "panda_link0", at(*y), [*name])
    })
}

/// A ball that the wrist would meet.
fn with_ball(surroundings: Surroundings, radius: f64) -> Surroundings {
    surroundings.with_obstacle("ball", Capsule::sphere(Vector3::new(0.25, 0.25, 0.6), radius).unwrap())
}

fn builder(formula: &str, sigma: f64) -> PlannerBuilder {
    let formula = FormulaTable::builtin().get(formula).unwrap();
    Planner::builder().formula(formula).sigma(sigma).duration(4.0).h(0.3)
}

fn sideways() -> Vector3<f64> {
    Vector3::new(0.0, 0.4, 0.0)
}

fn past_the_ball(law: impl Law + 'static, formula: &str, sigma: f64) -> Plan {
    let arm = arm("arm", 0.0, sideways(), law);
    builder(formula, sigma)
        .arm(arm)
        .surroundings(with_ball(around(&[("arm", 0.0)]), 0.07))
        .build()
        .unwrap()
        .run()
}

#[test]
fn the_direct_way_meets_the_ball_and_the_quadratic_program_passes_it() {
    let direct = past_the_ball(Pseudoinverse::new(), "split-ab3", 0.01);
    let closest = direct.distance.as_ref().unwrap();
    assert!(closest.minimum < 0.0 && !direct.keeps_distances(), "{closest:?}");
    assert_eq!(closest.pair, ["arm panda_link6", "ball"]);
    assert_eq!(closest.course[(closest.t / direct.sigma).round() as usize], closest.minimum);
    assert!(
        direct.warnings.iter().any(|said| said.contains("and `ball` overlap by 0.0")),
        "{:?}",
        direct.warnings
    );
    for sigma in [0.02, 0.005] {
        let plan = past_the_ball(QuadraticProgram::new(), "split-ab3", sigma);
        let closest = plan.distance.as_ref().unwrap();
        assert_eq!(plan.status, PlanStatus::Completed, "{:?}", plan.reason);
        assert!(
            closest.minimum >= MARGIN && plan.keeps_distances() && plan.is_within_limits(),
            "{closest:?}"
        );
        assert!(closest.minimum < MARGIN + 0.005, "it comes near: {closest:?}");
        assert!(plan.arms[0].max_error < 1e-5, "the hand keeps to its line: {}", plan.arms[0].max_error);
        assert_eq!(closest.course.len(), plan.samples());
    }
}

#[test]
fn a_program_in_least_squares_leaves_its_path_rather_than_meet_something() {
    // The hand itself would touch the wall.
    let wall = HalfSpace::new(Vector3::new(0.0, 0.25, 0.0), -Vector3::y()).unwrap();
    let surroundings = || around(&[("arm", 0.0)]).with_obstacle("wall", wall);
    let run = |law: QuadraticProgram| {
        let arm = arm("arm", 0.0, sideways(), law);
        builder("split-ab3", 0.01).arm(arm).surroundings(surroundings()).build().unwrap().run()
    };
    let exact = run(QuadraticProgram::new());
    assert_eq!(exact.status, PlanStatus::Limit);
    let reason = exact.reason.as_ref().unwrap();
    assert!(reason.contains("the margin between `arm panda_hand` and `wall`"), "{reason}");
    let yielding = run(QuadraticProgram::new().in_least_squares(1e-6));
    let closest = yielding.distance.as_ref().unwrap();
    assert!(closest.minimum >= MARGIN && closest.pair[1] == "wall", "{} {:?}", closest.minimum, closest.pair);
    assert!(yielding.arms[0].max_error > 0.05, "{}", yielding.arms[0].max_error);
}

#[test]
fn two_arms_see_each_other() {
    let both = |law: fn() -> Box<dyn Law>| {
        let arms =
            [arm("left", 0.35, -sideways() * 0.8, law()), arm("right", -0.35, sideways() * 0.8, law())];
        let system = kinstep::planner::JointSystem::of(["left", "right"]).with_law(law());
        let plan = builder("split-ab3", 0.01).arms(arms).system(system);
        let between = Pairings { within_machines: false, ..Pairings::default() };
        let around = around(&[("left", 0.35), ("right", -0.35)]).with_pairings(between);
        plan.surroundings(around).build().unwrap().run()
    };
    let blind = both(|| Box::new(Pseudoinverse::new()));
    let seeing =
        both(|| Box::new(QuadraticProgram::new().in_least_squares(1e-6).with_criterion(Clearance::new(1.0))));
    let [blind, seeing] = [blind, seeing].map(|plan| plan.distance.unwrap());
    assert!(blind.pair[0].starts_with("left") && blind.pair[1].starts_with("right"), "{:?}", blind.pair);
    assert!(seeing.minimum >= MARGIN && blind.minimum < 0.0, "{} {}", seeing.minimum, blind.minimum);
}

#[test]
fn clearance_moves_away_what_the_task_leaves_free() {
    let plain = past_the_ball(Pseudoinverse::new(), "split-ab3", 0.01).distance.unwrap();
    let law = Pseudoinverse::new().with_criterion(Clearance::new(5.0));
    let plan = past_the_ball(law, "split-ab3", 0.01);
    let moved = plan.distance.as_ref().unwrap();
    assert!(moved.minimum > plain.minimum + 0.02, "{} {}", moved.minimum, plain.minimum);
    assert!(plan.arms[0].max_error < 1e-4, "{}", plan.arms[0].max_error);
}

#[test]
fn nothing_around_changes_no_bit_and_says_nothing() {
    let run = |surroundings: Option<Surroundings>| {
        let builder = builder("split-ab3", 0.01).arm(arm("arm", 0.0, sideways(), QuadraticProgram::new()));
        let builder = surroundings.into_iter().fold(builder, PlannerBuilder::surroundings);
        builder.build().unwrap().run()
    };
    let far = HalfSpace::new(Vector3::new(0.0, 0.0, -5.0), Vector3::z()).unwrap();
    let (alone, before) = (run(None), run(Some(around(&[("arm", 0.0)]).with_obstacle("far", far))));
    assert_eq!(alone.arms[0].positions, before.arms[0].positions);
    assert!(alone.distance.is_none() && before.distance.is_some());
}

#[test]
fn what_makes_no_sense_is_refused() {
    let refused = |surroundings: Surroundings| {
        let arm = arm("arm", 0.0, sideways(), QuadraticProgram::new());
        builder("split-ab3", 0.01).arm(arm).surroundings(surroundings).build().unwrap_err()
    };
    let near = refused(with_ball(around(&[("arm", 0.0)]), 0.15));
    assert!(matches!(near, PlannerError::TooNear { .. }));
    let said = near.to_string();
    assert!(
        said.starts_with("`arm panda_link6` and `ball` start 0.01") && said.contains("the margin is 0.02 m"),
        "{said}"
    );
    let inside = refused(with_ball(around(&[("arm", 0.0)]), 0.3)).to_string();
    assert!(
        inside.starts_with("`arm panda_link6` and `ball` overlap by 0.13") && inside.contains("at the start"),
        "{inside}"
    );
    let stranger = refused(around(&[("arm", 0.0), ("other", 3.0)])).to_string();
    assert!(stranger.contains("there is no arm `other`"), "{stranger}");
    let numbers = refused(around(&[("arm", 0.0)]).with_influence(0.01)).to_string();
    assert!(numbers.contains("pairs count from 0.01 m on, and the margin is 0.02 m"), "{numbers}");
    assert!(refused(Surroundings::new(f64::NAN)).to_string().contains("the margin is NaN m"));
    assert!(refused(around(&[("arm", 0.0)]).with_closing_speed(0.0)).to_string().contains("it is positive"));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    /// Wherever the ball is: the run keeps the margin at every sample, or stops.
    #[test]
    fn no_sample_falls_below_the_margin(
        center in prop::array::uniform3(-0.8..0.8_f64), radius in 0.02..0.2_f64, way in prop::array::uniform3(-0.3..0.3_f64),
        sigma in prop_oneof![Just(0.02), Just(0.005)], formula in prop_oneof![Just("split-ab3"), Just("split-ab6")],
    ) {
        let ball = Capsule::sphere(Vector3::from(center) + Vector3::new(0.0, 0.0, 0.5), radius).unwrap();
        let surroundings = around(&[("arm", 0.0)]).with_obstacle("ball", ball);
        let arm = arm("arm", 0.0, way.into(), QuadraticProgram::new().in_least_squares(1e-6));
        match builder(formula, sigma).arm(arm).surroundings(surroundings).build() {
            Err(PlannerError::TooNear { .. }) => {}
            Err(other) => return Err(TestCaseError::fail(other.to_string())),
            Ok(planner) => {
                let plan = planner.run();
                let closest = plan.distance.as_ref().unwrap();
                prop_assert!(closest.minimum >= MARGIN - 1e-9, "{:?} {:?}", closest.minimum, closest.pair);
            }
        }
    }
}
