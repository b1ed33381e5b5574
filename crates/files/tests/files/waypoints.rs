//! Waypoints in scenarios and in tables beside them, and the least duration of a motion.
#![allow(clippy::unwrap_used, reason = "a test that can not go on stops")]

use std::path::Path;

use kinstep::formula::FormulaTable;
use kinstep::planner::{LimitKind, Plan, Planner};
use kinstep_files::scenario::{Kinds, Scenario, ScenarioError, ScenarioText, TimeLawSpec};
use nalgebra::{IsometryMatrix3, Vector3};
use proptest::prelude::*;

const PANDA: &str = r#"
sigma = 0.01
duration = 3.0
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
start_pose = "path"
"#;

const INLINE: &str = r#"
[arm.path]
kind = "spline"
center = [0.0, 0.0, 0.0]
points = [[0.45, -0.15, 0.45], [0.55, -0.05, 0.4], [0.5, 0.1, 0.3], [0.4, 0.15, 0.35]]
rpy = [["pi", 0.0, 0.0], ["pi", 0.2, 0.0], ["pi", 0.2, 0.3], ["pi", 0.0, 0.3]]
"#;

fn read(text: &str) -> Scenario {
    ScenarioText::parse(text).unwrap().scenario().unwrap()
}

fn plan(scenario: &Scenario, folder: Option<&Path>) -> Result<Plan, ScenarioError> {
    Ok(scenario.planner(FormulaTable::builtin(), folder)?.run())
}

fn with_table(table: &str, more: &str) -> (tempfile::TempDir, Scenario) {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("w.csv"), table).unwrap();
    let text =
        format!("{PANDA}[arm.path]\nkind = \"spline\"\nfile = \"w.csv\"\ncenter = [0.0, 0.0, 0.0]\n{more}");
    let scenario = read(&text);
    (folder, scenario)
}

fn table_of_rpy() -> String {
    let pi = std::f64::consts::PI;
    format!(
        "x,y,z,roll,pitch,yaw\n0.45,-0.15,0.45,{pi},0,0\n0.55,-0.05,0.4,{pi},0.2,0\n0.5,0.1,0.3,{pi},0.2,0.3\n0.4,0.15,0.35,{pi},0,0.3\n"
    )
}

#[test]
fn a_table_says_what_the_lists_of_a_scenario_say() {
    let inline = plan(&read(&format!("{PANDA}{INLINE}")), None).unwrap();
    let (folder, scenario) = with_table(&table_of_rpy(), "");
    let tabled = plan(&scenario, Some(folder.path())).unwrap();
    assert!(inline.is_completed() && inline.arms[0].max_error < 1e-4, "{}", inline.arms[0].max_error);
    assert_eq!(inline.arms[0].positions, tabled.arms[0].positions);
    // Columns may stand in any order, and in capitals.
    let turned = "Yaw,Pitch,Roll,Z,Y,X\n".to_owned();
    let rows = table_of_rpy()
        .lines()
        .skip(1)
        .map(|row| row.split(',').rev().collect::<Vec<_>>().join(","))
        .collect::<Vec<_>>();
    let (folder, scenario) = with_table(&(turned + &rows.join("\r\n")), "");
    assert_eq!(plan(&scenario, Some(folder.path())).unwrap().arms[0].positions, inline.arms[0].positions);
}

#[test]
fn rotation_vectors_and_quaternions_are_orientations_too() {
    let quaternions = "x,y,z,qx,qy,qz,qw\n0.4,0,0.4,1,0,0,0\n0.5,0,0.4,1,0,0,0\n0.5,0.1,0.4,0.995004165278026,0,0,0.099833416646828\n";
    let vectors = "x,y,z,rx,ry,rz\n0.4,0,0.4,3.141592653589793,0,0\n0.5,0,0.4,3.141592653589793,0,0\n0.5,0.1,0.4,2.941592653589793,0,0\n";
    let [one, other] = [quaternions, vectors].map(|table| {
        let (folder, scenario) = with_table(table, "");
        plan(&scenario, Some(folder.path())).unwrap()
    });
    let apart = one.arms[0]
        .positions
        .iter()
        .zip(&other.arms[0].positions)
        .map(|(a, b)| (a - b).abs())
        .fold(0.0, f64::max);
    assert!(one.is_completed() && apart < 1e-9, "{apart}");
}

#[test]
fn waypoints_without_a_center_are_laid_to_the_tip() {
    let text = format!("{PANDA}{INLINE}")
        .replace("center = [0.0, 0.0, 0.0]\n", "")
        .replace("start_pose = \"path\"\n", "");
    let scenario = read(&text);
    let start = IsometryMatrix3::new(Vector3::new(1.0, 2.0, 3.0), Vector3::new(0.1, 0.2, 0.3));
    let motion = scenario.arm[0].path.as_ref().unwrap().motion(&start, 3.0).unwrap();
    let (begin, end) = (motion.at(0.0), motion.at(3.0));
    assert!((begin.position - Vector3::new(1.0, 2.0, 3.0)).norm() < 1e-12);
    assert!((begin.rotation.matrix() - start.rotation.matrix()).norm() < 1e-12);
    assert!((end.position - begin.position - Vector3::new(-0.05, 0.3, -0.1)).norm() < 1e-12);
    let turned = nalgebra::Rotation3::from_euler_angles(std::f64::consts::PI, 0.0, 0.3)
        * nalgebra::Rotation3::from_euler_angles(std::f64::consts::PI, 0.0, 0.0).inverse();
    assert!((end.rotation.matrix() - (turned * start.rotation).matrix()).norm() < 1e-12);
}

#[test]
fn times_are_the_time_law_and_are_stretched_to_the_duration() {
    let table = "t,x,y,z\n0,0.45,0,0.45\n1,0.5,0,0.45\n4,0.5,0.1,0.4\n5,0.4,0.1,0.4\n";
    let (folder, mut scenario) = with_table(table, "");
    scenario.arm[0].task = kinstep::task::TaskKind::Position.into();
    let arm = &scenario.arms(Some(folder.path())).unwrap()[0];
    // Nothing but the poses of the plan says where the tip was: 0.6 s of 3 are 1 s of 5.
    let plan = plan(&scenario, Some(folder.path())).unwrap();
    let tip = |n: usize| {
        arm.chain().forward(plan.arms[0].position(n), &mut arm.chain().scratch()).pose().translation.vector
    };
    assert!((tip(60) - Vector3::new(0.5, 0.0, 0.45)).norm() < 1e-4);
    assert!((tip(240) - Vector3::new(0.5, 0.1, 0.4)).norm() < 1e-4);
    // From rest to rest.
    assert!(plan.arms[0].velocity(0).iter().chain(plan.arms[0].velocity(300)).all(|v| v.abs() < 1e-9));
    let said = scenario.timing_findings(Some(folder.path()));
    assert_eq!(said, ["arm `arm`: its waypoints take 5 s by their times and 3 s by `duration`, which holds"]);
    scenario.duration = 5.0.into();
    assert!(scenario.timing_findings(Some(folder.path())).is_empty());
}

#[test]
fn a_scenario_that_moves_takes_its_table_along() {
    let (folder, scenario) = with_table(&table_of_rpy(), "");
    let elsewhere = tempfile::tempdir().unwrap();
    let moved = scenario.relocated(Some(folder.path()), None, elsewhere.path()).unwrap();
    let again = read(&moved.to_toml());
    let [one, other] =
        [(&scenario, folder.path()), (&again, elsewhere.path())].map(|(s, f)| plan(s, Some(f)).unwrap());
    assert_eq!(one.arms[0].positions, other.arms[0].positions);
}

#[test]
fn waypoints_turn_the_tip_by_themselves_or_a_turn_does() {
    let text = format!("{PANDA}{INLINE}turn = {{ axis = [0, 0, 1], angle = 0.3 }}\n");
    let refused = ScenarioText::parse(&text).unwrap().scenario().unwrap_err();
    assert!(
        refused.message.starts_with("arm.arm.path.turn: the waypoints say how the tip is turned"),
        "{refused}"
    );
    let (folder, scenario) = with_table(&table_of_rpy(), "turn = { axis = [0, 0, 1], angle = 0.3 }");
    assert_eq!(plan(&scenario, Some(folder.path())).unwrap_err().message, refused.message);
    // A pose is asked for that the table does not have.
    let (folder, scenario) = with_table("x,y,z\n0.45,0,0.45\n0.5,0,0.45\n0.5,0.1,0.4\n", "");
    let refused = plan(&scenario, Some(folder.path())).unwrap_err();
    assert!(refused.message.starts_with("arm.arm.start_pose: the task \"pose\" needs to know"), "{refused}");
}

#[test]
fn a_time_law_is_a_word_or_a_table_and_is_written_as_it_was_read() {
    let text = format!("{PANDA}{INLINE}time_law = {{ kind = \"s-curve\", ramp = \"1/4\" }}\n");
    let scenario = read(&text);
    let law = scenario.arm[0].path.as_ref().unwrap().time_law.clone().unwrap();
    assert_eq!(law.parameters.number("ramp"), Some(0.25));
    assert_eq!(read(&scenario.to_toml()), scenario);
    let word = format!("{PANDA}{INLINE}time_law = \"s-curve\"\n");
    assert_eq!(read(&word).arm[0].path.as_ref().unwrap().time_law, Some(TimeLawSpec::new("s-curve")));
    assert!(read(&word).to_toml().contains("time_law = \"s-curve\""));
}

proptest! {
    #[test]
    fn any_table_is_read_or_refused_at_its_place(
        rows in prop::collection::vec("[-0-9.,eE;nainxyzqrtw \"\r]{0,24}", 0..6),
        head in prop::sample::select(vec!["", "x,y,z\n", "t,x,y,z\n", "x,y,z,qx,qy,qz,qw\n", "x,y,z,rx,ry,rz\n", "\u{feff}x,y,z,roll,pitch,yaw\n"]),
    ) {
        let (folder, scenario) = with_table(&format!("{head}{}", rows.join("\n")), "");
        if let Err(refused) = scenario.arms(Some(folder.path())) {
            let named = ["w.csv", "arm."].iter().any(|name| refused.message.contains(name)) || refused.place.is_some();
            prop_assert!(named, "{refused:?}");
        }
    }
}

fn fastest(scenario: &Scenario) -> kinstep_files::scenario::Fastest {
    scenario.fastest(&Kinds::builtin(), FormulaTable::builtin(), None, Planner::run).unwrap()
}

fn keeps(plan: &Plan) -> bool {
    plan.is_completed() && plan.arms[0].violations.iter().all(|v| v.kind == LimitKind::Position)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]

    #[test]
    fn the_least_duration_is_feasible_and_a_little_less_is_not(
        duration in 0.5..8.0_f64, law in prop::sample::select(vec!["sin2", "quintic", "trapezoid", "s-curve"]),
        reach in 0.05..0.15_f64,
    ) {
        let text = format!("{PANDA}[arm.path]\nkind = \"circle\"\nradius = {reach}\nplane = \"yz\"\ntime_law = \"{law}\"\n")
            .replace("start_pose = \"path\"\n", "");
        let mut scenario = read(&text);
        scenario.duration = ((duration / 0.01).round() * 0.01).into();
        let found = fastest(&scenario);
        prop_assert!(keeps(&found.plan));
        prop_assert_eq!(found.scenario.duration.value(), found.plan.duration());
        let steps = found.plan.steps - (found.plan.steps / 500).max(1) - 1;
        scenario.duration = (steps as f64 * 0.01).into();
        let shorter = plan(&scenario, None).unwrap();
        prop_assert!(!keeps(&shorter), "{} {steps}", found.plan.steps);
        let would_do = shorter.feasible_duration().unwrap();
        prop_assert!(would_do > shorter.duration() && (would_do / found.plan.duration() - 1.0).abs() < 0.02, "{would_do}");
    }
}

#[test]
fn without_limits_of_motion_there_is_no_least_duration() {
    let text = r#"
sigma = 0.01
duration = 1.0
[[arm]]
name = "arm"
robot = """
<robot name="free"><link name="a"/><link name="b"/><link name="c"/>
<joint name="one" type="continuous"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/></joint>
<joint name="two" type="continuous"><parent link="b"/><child link="c"/><origin xyz="1 0 0"/><axis xyz="0 0 1"/></joint>
</robot>"""
base = "a"
tip = "c"
tool = { xyz = [1.0, 0.0, 0.0] }
task = "position-xy"
q0 = [0.3, 0.8]
path = { kind = "circle", radius = 0.1 }
"#;
    let refused =
        read(text).fastest(&Kinds::builtin(), FormulaTable::builtin(), None, Planner::run).unwrap_err();
    assert!(refused.message.starts_with("duration: no joint has a limit of velocity"), "{refused}");
}
