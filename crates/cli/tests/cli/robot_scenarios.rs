//! Scenarios whose robots are tables, calibrated, locked or tooled.

#![allow(clippy::unwrap_used, reason = "a test that can not go on stops")]

use crate::program::{Desk, kinstep_in};

const SCENARIO: &str = r#"sigma = 0.01
duration = 1.0
formula = "la6-wang-guo"

[law]
h = 0.4

[[arm]]
name = "left"
robot = "robots/arm.toml"
base = "base"
tip = "link4"
calibration = "robots/mine.toml"
lock = { j3 = "pi/6" }
tool = { xyz = [1.0, 0, 0], rpy = [0, 0, 0.2] }
task = "position-xy"
q0 = ["pi/10", 0.3, 0.3]
path = { kind = "circle", radius = 0.1 }
"#;

/// The same arm written by hand: three joints, of which one is turned, and a longer last link.
const BY_HAND: &str = r#"<robot name="hand"><link name="base"/><link name="a"/><link name="b"/><link name="c"/><link name="end"/>
<joint name="j1" type="continuous"><parent link="base"/><child link="a"/><axis xyz="0 0 1"/></joint>
<joint name="j2" type="continuous"><parent link="a"/><child link="b"/><origin xyz="1 0 0" rpy="0 0 0.05"/><axis xyz="0 0 1"/></joint>
<joint name="j4" type="continuous"><parent link="b"/><child link="c"/>
  <origin xyz="1.8660254037844386 0.5 0" rpy="0 0 0.5235987755982988"/><axis xyz="0 0 1"/></joint>
<joint name="end" type="fixed"><parent link="c"/><child link="end"/><origin xyz="1 0 0"/></joint></robot>
"#;

fn desk() -> Desk {
    let desk = Desk::new(&[("s.toml", SCENARIO), ("hand.urdf", BY_HAND)]);
    std::fs::create_dir(desk.path("robots")).unwrap();
    std::fs::write(desk.path("robots/arm.toml"), "planar = [1, 1, 1, 1]\n").unwrap();
    std::fs::write(desk.path("robots/mine.toml"), "[joint.j2]\nzero = 0.05\n").unwrap();
    desk
}

/// The positions in a trajectory file.
fn numbers(desk: &Desk, folder: &str) -> Vec<f64> {
    let text = std::fs::read_to_string(desk.path(folder).join("trajectory.csv")).unwrap();
    let lines = text.lines().filter(|line| line.starts_with(|c: char| c.is_ascii_digit()));
    lines.flat_map(|line| line.split(',').map(|cell| cell.parse().unwrap())).collect()
}

#[test]
fn a_changed_robot_moves_as_the_one_written_by_hand() {
    let desk = desk();
    desk.run(&["plan", "s.toml", "--out", "changed"]).expect(0);
    let by_hand = SCENARIO
        .lines()
        .filter(|line| !["calibration", "lock", "tool"].iter().any(|key| line.starts_with(key)))
        .map(|line| line.replace("robots/arm.toml", "hand.urdf").replace("link4", "end"))
        .collect::<Vec<_>>()
        .join("\n");
    std::fs::write(desk.path("hand.toml"), by_hand).unwrap();
    desk.run(&["plan", "hand.toml", "--out", "hand"]).expect(0);
    let (changed, hand) = (numbers(&desk, "changed"), numbers(&desk, "hand"));
    assert!(changed.len() > 700 && changed.len() == hand.len(), "{} and {}", changed.len(), hand.len());
    assert!(changed.iter().zip(&hand).all(|(a, b)| (a - b).abs() < 1e-9));
}

#[test]
fn a_written_scenario_finds_its_calibration_and_plans_the_same_again() {
    let desk = desk();
    desk.run(&["plan", "s.toml", "--out", "one"]).expect(0);
    std::fs::create_dir(desk.path("elsewhere")).unwrap();
    let written = desk.path("one/scenario.toml");
    kinstep_in(&desk.path("elsewhere"), &["plan", written.to_str().unwrap(), "--out", "two"]).expect(0);
    let bytes = |folder: &str| std::fs::read(desk.path(folder).join("trajectory.csv")).unwrap();
    assert_eq!(bytes("one"), bytes("elsewhere/two"));
    // Without the correction the arm goes elsewhere.
    std::fs::write(desk.path("robots/mine.toml"), "[joint.j2]\nzero = 0.0\n").unwrap();
    desk.run(&["plan", "s.toml", "--out", "three"]).expect(0);
    assert_ne!(bytes("one"), bytes("three"));
}

/// Two arms on one trunk, from the floor and so with two joints in common.
const TRUNK: &str = include_str!("../bad_input/scenario/arms_share_a_joint_independently.toml");

#[test]
fn arms_that_shall_be_independent_may_not_share_a_joint() {
    let desk = Desk::new(&[("s.toml", &TRUNK.replace("duration = 4.0", "duration = 8.0"))]);
    let refused = desk.run(&["plan", "s.toml"]).expect(2).err;
    assert!(
        refused.contains("arm.right.independent: arms `left` and `right` both move joint `lift`"),
        "{refused}"
    );
    // Whichever of the two asks for it.
    let other = ["--set", "arm.right.independent=false", "--set", "arm.left.independent=true"];
    assert!(
        desk.run(&[&["plan", "s.toml"][..], &other].concat()).expect(2).err.contains("arm.left.independent")
    );
    desk.run(&["plan", "s.toml", "--set", "arm.right.independent=false"]).expect(0);
    // What is said as a remedy is one.
    let still = "{ lift = 0.1, waist = 0.1 }";
    let locks = ["left", "right"].map(|arm| format!("arm.{arm}.lock={still}"));
    let starts = ["left", "right"].map(|arm| format!("arm.{arm}.q0=[0.3, 0.4, -0.8, 0.2, 0.5, 0.1]"));
    let set = locks.iter().chain(&starts).flat_map(|set| ["--set", set.as_str()]);
    desk.run(&["plan", "s.toml"].into_iter().chain(set).collect::<Vec<_>>()).expect(0);
}

#[test]
fn a_free_joint_on_the_path_is_named_with_its_remedy() {
    let free = BY_HAND.replace("name=\"j4\" type=\"continuous\"", "name=\"j4\" type=\"floating\"");
    let scenario = SCENARIO.replace("robots/arm.toml", "free.urdf").replace("link4", "end");
    let scenario = scenario.replace("calibration = \"robots/mine.toml\"\nlock = { j3 = \"pi/6\" }\n", "");
    let desk = Desk::new(&[("s.toml", &scenario), ("free.urdf", &free)]);
    let error = desk.run(&["plan", "s.toml"]).expect(3).err;
    assert!(error.contains("passes joint `j4` of type floating") && error.contains("with `lock`"), "{error}");
    desk.run(&["plan", "s.toml", "--set", "arm.left.lock={ j4 = 0 }", "--set", "arm.left.q0=[0.3, 0.5]"])
        .expect(0);
}

#[test]
fn a_file_of_limits_goes_over_the_robots_own() {
    let desk = desk();
    let limits = |rest: &str| {
        format!("joint_limits:\n  j1:\n    has_acceleration_limits: true\n    max_acceleration: 0.01\n{rest}")
    };
    let scenario = SCENARIO.replace("calibration = ", "limits = \"robots/limits.yaml\"\ncalibration = ");
    std::fs::write(desk.path("limited.toml"), scenario).unwrap();
    std::fs::write(desk.path("robots/limits.yaml"), limits("default_velocity_scaling_factor: 0.1\n"))
        .unwrap();
    let said = desk.run(&["plan", "limited.toml", "--out", "limited", "--json"]).expect(1);
    assert!(said.out.contains("\"kind\": \"acceleration\""), "{}", said.out);
    assert!(
        said.out.contains("limits.yaml:5:34: note: `default_velocity_scaling_factor` is not applied"),
        "{}",
        said.out
    );
    // What is written down finds the file again.
    desk.run(&["plan", "limited/scenario.toml"]).expect(1);
    let shown = desk.run(&["robot", "show", "robots/arm.toml", "--limits", "robots/limits.yaml"]).expect(0);
    assert!(shown.out.contains("acceleration") && shown.out.contains("0.01"), "{}", shown.out);
    std::fs::write(desk.path("robots/limits.yaml"), limits("  elbow: {}\n")).unwrap();
    let refused = desk.run(&["plan", "limited.toml"]).expect(3);
    assert!(
        refused.err.contains("arm.left.limits") && refused.err.contains("no joint `elbow`"),
        "{}",
        refused.err
    );
}

#[test]
fn a_start_off_the_path_is_refused_with_both_remedies_and_each_works() {
    let scenario = |approach: &str, center: &str| {
        format!(
            "sigma = 0.01\nduration = 2.0\n[[arm]]\nname = \"left\"\nrobot = \"planar4\"\nbase = \"base\"\ntip = \"tip\"\n\
             task = \"position-xy\"\nq0 = [\"pi/10\", 0.3, 0.3, 0.4]\n{approach}\n\
             path = {{ kind = \"circle\", radius = 0.2, center = {center} }}\n"
        )
    };
    let (near, far) = ("[2.5, 2.7]", "[2.0, 2.2]");
    let reach = scenario("approach = \"reach\"", far);
    let converge = scenario("approach = \"converge\"\napproach_tolerance = 1e-4", near);
    let too_far = scenario("approach = \"converge\"", far);
    let files = [
        ("no.toml", scenario("", near)),
        ("reach.toml", reach),
        ("converge.toml", converge),
        ("far.toml", too_far),
    ];
    let desk = Desk::new(&files.each_ref().map(|(name, text)| (*name, text.as_str())));
    let refused = desk.run(&["plan", "no.toml"]).expect(2);
    assert!(
        refused.err.contains("approach = \"reach\"") && refused.err.contains("approach = \"converge\""),
        "{}",
        refused.err
    );
    assert!(desk.run(&["plan", "far.toml"]).expect(2).err.contains("approach = \"reach\""));
    for name in ["reach", "converge"] {
        let file = format!("{name}.toml");
        let plan = desk.run(&["plan", &file, "--out", name, "--json"]).expect(0).json();
        assert!(plan["arms"][0]["max_error"].as_f64().unwrap() < 1e-4, "{plan}");
        assert_eq!(plan["lead"].is_u64(), name == "reach");
        assert_eq!(plan["arms"][0]["convergence"]["reached"].is_f64(), name == "converge");
        desk.run(&["plot", name, "--out", &format!("{name}-pictures")]).expect(0);
    }
}

#[test]
fn a_run_that_stopped_is_drawn_checked_and_exported_and_says_so() {
    let scenario = |q0: &str, path: &str, more: &str| {
        format!(
            "sigma = 0.01\nduration = 4.0\nformula = \"la6-wang-guo\"\n{more}\n[[arm]]\nname = \"left\"\nrobot = \"planar4\"\n\
             base = \"base\"\ntip = \"tip\"\ntask = \"position-xy\"\nq0 = {q0}\npath = {path}\n"
        )
    };
    let bent = "[0.3, 0.4, 0.5, 0.6]";
    let far = scenario(bent, "{ kind = \"line\", displacement = [4.0, 0.0, 0.0] }", "");
    let wild = "allow_unstable = true\nlaw = { h = 5.0 }";
    let diverged = scenario(bent, "{ kind = \"circle\", radius = 0.3 }", wild);
    let singular = scenario("[0, 0, 0, 0]", "{ kind = \"circle\", radius = 0.1 }", "");
    let desk =
        Desk::new(&[("unreachable.toml", &far), ("diverged.toml", &diverged), ("singular.toml", &singular)]);
    for (name, is_drawn) in [("unreachable", true), ("diverged", true), ("singular", false)] {
        desk.run(&["plan", &format!("{name}.toml"), "--out", name, "--no-report"]).expect(5);
        let [draws, checks] = if is_drawn { [0, 1] } else { [5, 5] };
        let pictures = format!("{name}-pictures");
        let exported = format!("{name}-exported");
        let runs = [
            desk.run(&["plot", name, "--out", &pictures]).expect(draws),
            desk.run(&["export", name, "--format", "npz", "--out", &exported]).expect(draws),
            desk.run(&["check", name]).expect(checks),
        ];
        for run in runs {
            let said = run.out + &run.err;
            assert!(said.contains("the run stopped after t = ") && said.contains(name), "{name}: {said}");
        }
    }
}
