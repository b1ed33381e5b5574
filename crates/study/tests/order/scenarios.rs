//! The orders that the examples and the paper's experiments show, from scenario files and through the library.
#![allow(clippy::unwrap_used, reason = "a test that can not go on stops")]

use kinstep::formula::FormulaTable;
use kinstep::integrate::Starter;
use kinstep::nalgebra::{IsometryMatrix3, Vector3};
use kinstep::planner::{Arm, Feedback, Planner, PlannerError};
use kinstep::robot::embedded;
use kinstep::task::{Circle, Motion, Planar, Plane, Sin2, TaskKind, Tricuspid};
use kinstep_files::scenario::{ScenarioError, ScenarioText};
use kinstep_study::{Criteria, Ladder, OrderReport, OrderStudy, Orders, ScenarioStudy};
use std::f64::consts::{PI, TAU};

const DUAL_PANDA: &str = include_str!("../../../../examples/dual_panda.toml");
const DUAL_PANDA_SPLIT: &str = include_str!("../../../../examples/dual_panda_split_ab6.toml");

/// The planner of a scenario file with another sampling gap.
fn scenario(text: &str, sigma: f64) -> Result<Planner, ScenarioError> {
    let mut text = ScenarioText::parse(text)?;
    text.set(&format!("sigma={sigma:e}"))?;
    text.scenario()?.planner(FormulaTable::builtin(), None)
}

fn strict(ladder: Ladder, orders: Orders) -> OrderStudy {
    OrderStudy::new(ladder).claiming(orders).judged_by(Criteria::default().with_tolerance(0.1))
}

fn assert_task(report: &OrderReport, order: usize) {
    let seen = report.task_transient.as_ref().unwrap();
    assert!(seen.verdict.is_confirmed(), "{report}");
    assert!((seen.finest_slope().unwrap() - order as f64).abs() < 0.1, "{report}");
}

/// The left arm of experiment A.1: four planar links of a metre on a tricuspid from its cusp.
fn a1(sigma: f64, feedback: Feedback, start: Starter<f64>) -> Result<Planner, PlannerError> {
    let chain = embedded::get("planar4").unwrap().chain("base", "tip").unwrap();
    let chain = chain.mounted(&IsometryMatrix3::new(Vector3::new(-2.0, 0.0, 0.0), Vector3::zeros()));
    let q0 = vec![0.9 * PI, -0.1 * PI, -0.1 * PI, -0.1 * PI];
    let pose = chain.forward(&q0, &mut chain.scratch()).pose();
    let path = Planar::new(Tricuspid { radius: 0.4 }, Plane::Xy, PI / 2.0, 0.0, TAU);
    let arm = Arm::new("left", chain, q0, TaskKind::PositionXy, Motion::from_pose(path, Sin2, 10.0, &pose));
    planner("la6-wang-guo", arm, feedback, start, sigma, 10.0)
}

/// Seven joints, full pose, on a circle of 5 cm that accelerates at once.
fn iiwa(id: &str, h: f64, start: Starter<f64>, sigma: f64) -> Result<Planner, PlannerError> {
    let robot = embedded::get("iiwa14").unwrap();
    let tip = robot.leaves().next().unwrap().name.clone();
    let base = robot.roots().next().unwrap().name.clone();
    let chain = robot.chain(&base, &tip).unwrap();
    let q0 = vec![0.2, 0.6, -0.1, -1.4, 0.1, 1.0, 0.3];
    let pose = chain.forward(&q0, &mut chain.scratch()).pose();
    let path = Planar::new(Circle { radius: 0.05 }, Plane::Yz, 0.0, 0.0, TAU);
    let arm = Arm::new("arm", chain, q0, TaskKind::Pose, Motion::from_pose(path, Sin2, 4.0, &pose));
    planner(id, arm, Feedback::Step(h), start, sigma, 4.0)
}

fn planner(
    id: &str,
    arm: Arm,
    feedback: Feedback,
    start: Starter<f64>,
    sigma: f64,
    duration: f64,
) -> Result<Planner, PlannerError> {
    let formula = FormulaTable::builtin().get(id).unwrap();
    Planner::builder()
        .formula(formula)
        .sigma(sigma)
        .duration(duration)
        .feedback(feedback)
        .start(start)
        .arm(arm)
        .build()
}

#[test]
fn two_pandas_on_full_poses_show_order_four() {
    let study = strict(Ladder::halvings(6.0, 300, 5).unwrap(), Orders::at_fixed_step(3));
    let report = study.of_planner(|sigma| scenario(DUAL_PANDA, sigma)).unwrap();
    assert_task(&report, 4);
    assert!(report.task_steady.unwrap().verdict.is_confirmed());
}

/// A Panda along a spline through poses, three times continuously differentiable.
const SPLINE: &str = r#"
sigma = 0.01
duration = 4.0
formula = "la6-wang-guo"
start = "rk4"
[law]
h = 0.4
[[arm]]
name = "arm"
robot = "panda"
base = "panda_link0"
tip = "panda_hand_tcp"
task = "pose"
q0 = [0.0, "-pi/4", 0.0, "-3*pi/4", 0.0, "pi/2", "pi/4"]
[arm.path]
kind = "spline"
points = [[0, 0, 0], [0.1, 0.05, 0], [0.1, 0.15, -0.1], [0, 0.1, -0.1]]
rpy = [[0, 0, 0], [0, 0.2, 0], [0, 0.2, 0.3], [0.1, 0, 0.3]]
time_law = "sin2sin2"
"#;

#[test]
fn a_formula_of_order_three_keeps_it_along_a_spline_through_poses() {
    let study = strict(Ladder::halvings(4.0, 200, 5).unwrap(), Orders::at_fixed_step(3));
    assert_task(&study.of_planner(|sigma| scenario(SPLINE, sigma)).unwrap(), 4);
}

#[test]
fn a_study_says_that_a_motion_is_less_smooth_than_a_row() {
    let read = |text: &str| ScenarioText::parse(text).unwrap().scenario().unwrap();
    let notes = |text: &str, id: &str| {
        let scenario = read(text);
        let rows = scenario.formula_rows(None).unwrap();
        let study = ScenarioStudy::new(&scenario, None, &rows, &[id.to_owned()]).unwrap();
        study.run().unwrap().remove(0).report.notes
    };
    let said = |notes: Vec<String>| {
        notes.iter().any(|note| note.contains("2 continuous derivatives only: errors fall like sigma^3"))
    };
    let planar = SPLINE
        .replace("\"panda\"", "\"planar4\"")
        .replace("panda_link0", "base")
        .replace("panda_hand_tcp", "tip")
        .replace("\"pose\"", "\"position-xy\"")
        .replace("[0.0, \"-pi/4\", 0.0, \"-3*pi/4\", 0.0, \"pi/2\", \"pi/4\"]", "[0.3, 0.3, 0.3, 0.3]");
    assert!(said(notes(&planar.replace("sin2sin2", "s-curve"), "la6-wang-guo")));
    assert!(!said(notes(&planar, "la6-wang-guo")));
}

#[test]
fn two_pandas_with_the_split_row_stay_below_a_tenth_of_a_nanometre() {
    let plan = scenario(DUAL_PANDA_SPLIT, 0.01).unwrap().run();
    assert!(plan.is_completed() && plan.formula == "split-ab6" && plan.h == 1.0);
    for arm in &plan.arms {
        assert!(arm.max_error < 1e-10, "{}: {:e}", arm.name, arm.max_error);
    }
    let study =
        OrderStudy::new(Ladder::half_octaves(6.0, 160, 6).unwrap()).claiming(Orders::at_fixed_step(6));
    let report = study.of_planner(|sigma| scenario(DUAL_PANDA_SPLIT, sigma)).unwrap();
    assert!(report.task_transient.as_ref().unwrap().verdict.is_confirmed(), "{report}");
}

#[test]
fn the_paper_scheme_has_order_four_at_fixed_h_and_three_at_fixed_gain() {
    let ladder = || Ladder::halvings(10.0, 1000, 4).unwrap();
    let fixed_h = strict(ladder(), Orders::at_fixed_step(3));
    assert_task(&fixed_h.of_planner(|sigma| a1(sigma, Feedback::Step(0.4), Starter::Paper)).unwrap(), 4);
    let gain = |sigma| a1(sigma, Feedback::Gain(20.0), Starter::Paper);
    let fixed_gain = strict(ladder(), Orders::at_fixed_gain(3));
    let report = fixed_gain.of_planner(gain).unwrap();
    assert_task(&report, 3);
    assert!((report.task_transient.unwrap().finest_slope().unwrap() - 3.0).abs() < 0.005);
    let mistaken = fixed_h.of_planner(gain).unwrap();
    assert!(mistaken.task_transient.unwrap().verdict.is_not_reached());
}

#[test]
fn the_start_decides_which_order_the_whole_run_shows() {
    let ladder = || Ladder::halvings(4.0, 100, 6).unwrap();
    let study = |orders| strict(ladder(), orders);
    let euler = |sigma| iiwa("la6-wang-guo", 0.4, Starter::Paper, sigma);
    let report = study(Orders::at_fixed_step(3)).of_planner(euler).unwrap();
    assert!(report.task_transient.as_ref().unwrap().verdict.is_not_reached(), "{report}");
    assert!(report.task_steady.as_ref().unwrap().verdict.is_confirmed(), "{report}");
    assert_task(&study(Orders::at_fixed_step(1)).of_planner(euler).unwrap(), 2);
    let rk4 = |sigma| iiwa("la6-wang-guo", 0.4, Starter::Rk4, sigma);
    assert_task(&study(Orders::at_fixed_step(3)).of_planner(rk4).unwrap(), 4);
}

#[test]
fn a_high_order_needs_a_start_of_its_own() {
    let error = |start| iiwa("split-ab6", 1.0, start, 0.01).unwrap().run().arms[0].max_error;
    let (euler, runge_kutta) = (error(Starter::Paper), error(Starter::Sufficient));
    assert!(runge_kutta < 1e-10 && euler > 1e-7, "{runge_kutta:e} and {euler:e}");
}

#[test]
fn joints_keep_what_an_euler_start_did_to_them() {
    // The share of sigma^3 is small in the joints: it takes fine gaps to see it come out.
    let ladder = Ladder::halvings(4.0, 100, 8).unwrap();
    let reference = |sigma| iiwa("split-ab8", 1.0, Starter::Rk8, sigma);
    let joint = |start: Starter<f64>, order| {
        let claims = Orders { joint: Some(order), ..Orders::at_fixed_step(3) };
        let study = OrderStudy::new(ladder.clone()).claiming(claims);
        let row = |sigma| iiwa("la6-wang-guo", 0.4, start.clone(), sigma);
        study.of_planner_against(row, reference).unwrap()
    };
    let (good, euler) = (joint(Starter::Rk4, 3), joint(Starter::Paper, 3));
    assert!(good.joint.as_ref().unwrap().verdict.is_confirmed(), "{good}");
    // Feedback repairs the task; the null space keeps the sigma^2 of the start.
    assert!(euler.joint.as_ref().unwrap().verdict.is_not_reached(), "{euler}");
    assert!(joint(Starter::Paper, 2).joint.unwrap().verdict.is_confirmed());
}

#[test]
fn a_study_of_runs_that_stop_gives_no_number() {
    let unstable = |sigma| {
        let chain = embedded::get("planar4").unwrap().chain("base", "tip").unwrap();
        let q0 = vec![0.3, 0.4, 0.5, 0.6];
        let pose = chain.forward(&q0, &mut chain.scratch()).pose();
        let motion = Motion::from_pose(Planar::whole(Circle { radius: 0.3 }), Sin2, 10.0, &pose);
        let arm = Arm::new("arm", chain, q0, TaskKind::PositionXy, motion);
        let formula = FormulaTable::builtin().get("la6-wang-guo").unwrap();
        let builder = Planner::builder().formula(formula).sigma(sigma).duration(10.0).h(0.8);
        builder.allow_unstable(true).arm(arm).build()
    };
    let study = OrderStudy::new(Ladder::halvings(10.0, 500, 4).unwrap()).claiming(Orders::at_fixed_step(3));
    let report = study.of_planner(unstable).unwrap();
    assert!(!report.task_transient.as_ref().unwrap().verdict.is_decided(), "{report}");
    assert_eq!(report.notes.len(), 4, "{report}");
    assert!(report.to_string().contains("ended `diverged`"), "{report}");
}

#[test]
fn a_planner_on_another_grid_is_not_judged() {
    let study = OrderStudy::new(Ladder::halvings(4.0, 100, 3).unwrap());
    let report = study.of_planner(|sigma| a1(sigma, Feedback::Step(0.4), Starter::Rk4)).unwrap();
    assert!(!report.task_transient.as_ref().unwrap().verdict.is_decided());
    assert!(report.notes[0].contains("give both one duration"), "{report}");
}
