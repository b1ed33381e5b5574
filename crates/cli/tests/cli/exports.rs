//! Trajectories handed on by the program, and checked by it.

#![allow(clippy::unwrap_used, reason = "a test that can not go on stops")]

use crate::program::{Desk, SMALL};
use kinstep_files::trajectory::Trajectory;

const EVERYTHING: &[&str] = &[
    "plan.json",
    "report.html",
    "scenario.toml",
    "trajectory.csv",
    "trajectory.csv-metadata.json",
    "trajectory.left.moveit.yaml",
    "trajectory.left.yaml",
    "trajectory.mcap",
    "trajectory.npz",
    #[cfg(feature = "parquet")]
    "trajectory.parquet",
];

/// An arm that ends in motion.
fn hasty() -> String {
    SMALL.replace("radius = 0.1 }", "radius = 0.1, time_law = \"linear\" }")
}

#[test]
fn a_plan_is_written_in_every_format_and_exported_again_to_the_same_bytes() {
    let desk = Desk::new(&[("s.toml", SMALL)]);
    desk.run(&["plan", "s.toml", "--out", "o", "--format", "all"]).expect(0);
    assert_eq!(desk.names("o"), EVERYTHING);
    let run = desk.run(&["export", "o", "--format", "all", "--out", "again", "--json"]).expect(0);
    assert_eq!(run.json()["written"].as_array().unwrap().len(), EVERYTHING.len() - 3);
    for name in desk.names("again") {
        let [one, two] = ["o", "again"].map(|folder| std::fs::read(desk.path(folder).join(&name)).unwrap());
        assert!(one == two, "{name} differs");
    }
    let table = Trajectory::read(desk.path("o/trajectory.csv")).unwrap();
    assert!(table.about.is_some());
    for name in ["o/trajectory.npz", "o/trajectory.mcap", "o/trajectory.left.yaml"] {
        let other = Trajectory::read(desk.path(name)).unwrap();
        assert_eq!(other.about, table.about, "{name}");
        assert_eq!(other.arms[0].positions, table.arms[0].positions, "{name}");
        assert_eq!(other.arms[0].velocities, table.arms[0].velocities, "{name}");
    }
    #[cfg(feature = "parquet")]
    assert_eq!(Trajectory::read(desk.path("o/trajectory.parquet")).unwrap(), table);
}

#[cfg(not(feature = "parquet"))]
#[test]
fn parquet_names_the_feature_that_it_takes() {
    let desk = Desk::new(&[("s.toml", SMALL), ("a.parquet", "PAR1")]);
    let run = desk.run(&["plan", "s.toml", "--out", "o", "--format", "parquet"]).expect(2);
    assert!(run.err.contains("--features parquet"), "{}", run.err);
    assert_eq!(desk.names("."), ["a.parquet", "s.toml"]);
    let run = desk.run(&["check", "a.parquet", "--robot", "planar4"]).expect(2);
    assert!(run.err.contains("--features parquet"), "{}", run.err);
}

#[test]
fn files_are_decided_before_anything_is_computed() {
    let desk = Desk::new(&[("s.toml", SMALL)]);
    let run = desk.run(&["plan", "s.toml", "--out", "o", "--format", "npy"]).expect(2);
    assert!(run.err.contains("did you mean npz?"), "{}", run.err);
    assert!(desk.run(&["plan", "s.toml", "--format", "npz"]).expect(2).err.contains("--out"));
    assert_eq!(desk.names("."), ["s.toml"]);
    std::fs::create_dir(desk.path("o")).unwrap();
    std::fs::write(desk.path("o/trajectory.mcap"), "mine").unwrap();
    desk.run(&["plan", "s.toml", "--out", "o", "--format", "mcap"]).expect(6);
    assert_eq!(desk.names("o"), ["trajectory.mcap"]);
    desk.run(&["plan", "s.toml", "--out", "o", "--format", "mcap", "--force"]).expect(0);
    let error = desk.run(&["export", "o", "--format", "mcap", "--json"]).expect(6).error();
    assert!(error["message"].as_str().unwrap().contains("--force"), "{error}");
}

#[test]
fn an_end_in_motion_is_refused_for_controllers_unless_a_stop_is_added() {
    let desk = Desk::new(&[("s.toml", &hasty())]);
    let run = desk.run(&["plan", "s.toml", "--out", "n/o", "--format", "ros2"]).expect(2);
    assert!(run.err.contains("--append-stop"), "{}", run.err);
    assert_eq!(desk.names("."), ["s.toml"]);
    desk.run(&["plan", "s.toml", "--out", "o", "--format", "ros2", "--append-stop"]).expect(0);
    desk.run(&["export", "o", "--format", "ros2", "--out", "other/deeper"]).expect(2);
    assert_eq!(desk.names("."), ["o", "s.toml"]);
    let table = Trajectory::read(desk.path("o/trajectory.csv")).unwrap();
    let command = Trajectory::read(desk.path("o/trajectory.left.yaml")).unwrap();
    assert_eq!(command.samples(), table.samples() + 1);
    assert!(command.arms[0].velocity(table.samples()).unwrap().iter().all(|velocity| *velocity == 0.0));
    assert!(desk.run(&["check", "o"]).expect(1).out.contains("ends in motion"));
}

#[test]
fn a_lone_table_gets_a_robot_and_its_joints_are_known() {
    let table = "t,j2,j1,j3,j4\n0,0.2,0.1,0.3,0.4\n0.1,0.2,0.1,0.3,0.4\n";
    let robot = ["--robot", "planar4", "--base", "base", "--tip", "tip"];
    let desk = Desk::new(&[("a.csv", table), ("b.csv", &table.replace("j2", "j22"))]);
    let export = |file: &str| desk.run(&[&["export", file, "--format", "mcap"], &robot[..]].concat());
    let error = export("b.csv").expect(3);
    assert!(error.err.contains("j22") && error.err.contains("j2"), "{}", error.err);
    export("a.csv").expect(0);
    let bag = Trajectory::read(desk.path("trajectory.mcap")).unwrap();
    assert_eq!(bag.arms[0].position(0), [0.1, 0.2, 0.3, 0.4]);
    assert_eq!(bag.arms[0].joints, ["j1", "j2", "j3", "j4"]);
    desk.run(&["export", "a.csv", "--format", "npz"]).expect(0);
    let shorter = ["export", "a.csv", "--format", "csv", "--out", "short"];
    let run = desk.run(&[&shorter[..], &["--robot", "planar4", "--base", "base", "--tip", "link3"]].concat());
    assert!(run.expect(0).err.contains("left out, because no joint of the arm: `j4`"));
    let short = Trajectory::read(desk.path("short/trajectory.csv")).unwrap();
    assert_eq!(short.arms[0].joints, ["j1", "j2", "j3"]);
    // A gripper that the robot's file is without is left out for the arm's sake; a check says nothing of what it does not know.
    std::fs::write(desk.path("fingers.csv"), "t,j1,j2,j3,j4,finger\n0,0,0,0,0,1\n1,0,0,0,0,0\n").unwrap();
    let named = ["--out", "fingers", "--arm", "left"];
    let run = desk.run(&[&["export", "fingers.csv", "--format", "moveit"], &robot[..], &named].concat());
    assert!(run.expect(0).err.contains("no joint of the arm: `finger`"));
    assert_eq!(desk.names("fingers"), ["trajectory.left.moveit.yaml"]);
    desk.run(&[&["check", "fingers.csv"], &robot[..]].concat()).expect(3);
    let error = desk.run(&["check", "b.csv", "--robot", "planar4"]).expect(3);
    assert!(error.err.contains("did you mean"), "{}", error.err);
    desk.run(&["check", "a.csv"]).expect(2);
    desk.run(&["check", "none.csv", "--robot", "planar4"]).expect(6);
}

#[test]
fn a_bad_table_is_shown_where_it_is_bad() {
    let desk = Desk::new(&[("a.csv", "t,j1\n0,1\n1,x\n")]);
    let run = desk.run(&["check", "a.csv", "--robot", "planar4"]).expect(2);
    assert!(run.err.starts_with("a.csv:3:3: error: the position of `j1` is not a number"), "{}", run.err);
    let error = desk.run(&["check", "a.csv", "--robot", "planar4", "--json"]).expect(2).error();
    assert_eq!((&error["line"], &error["column"]), (&3.into(), &3.into()));
}

#[test]
fn a_good_plan_passes_every_check_in_every_format() {
    let desk = Desk::new(&[("s.toml", SMALL)]);
    desk.run(&["plan", "s.toml", "--out", "o", "--format", "all"]).expect(0);
    for file in
        ["o", "o/trajectory.csv", "o/trajectory.npz", "o/trajectory.mcap", "o/trajectory.left.moveit.yaml"]
    {
        let run = desk.run(&["check", file, "--scenario", "s.toml", "--json"]).expect(0);
        let checked = run.json();
        assert_eq!(checked["ok"], true, "{file}: {checked}");
        assert!(checked["arms"][0]["max_error"].as_f64().unwrap() < 1e-5, "{checked}");
        assert_eq!(checked["time"]["even"], true, "{file}: {checked}");
    }
    let run = desk.run(&["check", "o", "--max-error", "1e-15"]).expect(1);
    assert!(run.out.contains("FAILED") && run.out.contains("--max-error"), "{}", run.out);
}

#[test]
fn a_spoilt_trajectory_fails_its_checks() {
    let desk = Desk::new(&[("s.toml", SMALL)]);
    desk.run(&["plan", "s.toml", "--out", "o"]).expect(0);
    let text = std::fs::read_to_string(desk.path("o/trajectory.csv")).unwrap();
    let mut lines: Vec<String> = text.lines().map(str::to_owned).collect();
    for line in &mut lines[101..] {
        let mut fields: Vec<String> = line.split(',').map(str::to_owned).collect();
        fields[1] = format!("{}", fields[1].parse::<f64>().unwrap() + 1.0);
        *line = fields.join(",");
    }
    std::fs::write(desk.path("o/spoilt.csv"), lines.join("\n")).unwrap();
    let run = desk.run(&["check", "o/spoilt.csv", "--scenario", "s.toml", "--json"]).expect(1);
    let checked = run.json();
    let arm = &checked["arms"][0];
    assert_eq!((&arm["continuous"], &arm["velocities_agree"]), (&false.into(), &false.into()), "{checked}");
    assert!(arm["max_error"].as_f64().unwrap() > 0.1, "{checked}");
    let failures = checked["failures"].to_string();
    assert!(failures.contains("jumps by") && failures.contains("t = 1 s"), "{failures}");
}

#[cfg(unix)]
#[test]
fn what_can_not_be_written_is_exit_6_and_leaves_nothing() {
    let desk = Desk::new(&[("s.toml", SMALL)]);
    desk.run(&["plan", "s.toml", "--out", "o"]).expect(0);
    desk.run(&["export", "o", "--format", "npz", "--out", "s.toml"]).expect(6);
    desk.run(&["export", "o/scenario.toml", "--format", "npz"]).expect(2);
    std::fs::remove_file(desk.path("o/scenario.toml")).unwrap();
    desk.run(&["export", "o", "--format", "npz"]).expect(6);
    assert_eq!(desk.names("o").len(), 4);
}

#[cfg(unix)]
#[test]
fn an_interrupt_leaves_no_file_that_is_not_whole() {
    use std::process::{Command, Stdio};
    use std::time::{Duration, Instant};
    let desk = Desk::new(&[("s.toml", SMALL)]);
    let arguments = ["plan", "s.toml", "--set", "sigma=1e-5", "--out", "o", "--format", "all"];
    let mut child = Command::new(assert_cmd::cargo::cargo_bin("kinstep"))
        .current_dir(desk.path("."))
        .args(arguments)
        .stdout(Stdio::null())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let begin = Instant::now();
    while !desk.names("o").iter().any(|name| name.contains(".part")) {
        assert!(begin.elapsed() < Duration::from_mins(2), "nothing is written");
        std::thread::sleep(Duration::from_millis(1));
    }
    Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    let mut sentence = String::new();
    std::io::Read::read_to_string(&mut child.stderr.take().unwrap(), &mut sentence).unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(6), "{sentence}");
    assert!(sentence.contains("trajectory.csv can not be written: it was interrupted"), "{sentence}");
    assert_eq!(desk.names("o"), Vec::<String>::new());
}

/// Two arms on one machine.
const TORSO: &str = include_str!("../../../../examples/shared_torso.toml");

/// Two machines of one kind.
fn pair() -> String {
    let (head, arm) = SMALL.split_at(SMALL.find("[[arm]]").unwrap());
    let other = arm.replace("\"left\"", "\"right\"").replace("task =", "mount = { xyz = [3, 0, 0] }\ntask =");
    format!("{head}{arm}\n{other}")
}

/// The messages of a plan in every format, as files.
fn messages(desk: &Desk, scenario: &str) -> Vec<String> {
    let noise = ["--set", "noise.joints=1e-9"];
    let plan = ["plan", scenario, "--out", "o", "--format", "mcap,moveit,ros2"];
    desk.run(&[&plan[..], &noise].concat()).expect(0);
    let is_message = |name: &String| [".mcap", ".yaml"].iter().any(|ending| name.ends_with(ending));
    desk.names("o").into_iter().filter(is_message).map(|name| format!("o/{name}")).collect()
}

/// The names of the arms that are checked, and of those that are not there.
fn checked_arms(checked: &serde_json::Value) -> [Vec<String>; 2] {
    let names = |list: &serde_json::Value| -> Vec<String> {
        let name = |one: &serde_json::Value| one["name"].as_str().or(one.as_str()).unwrap().to_owned();
        list.as_array().unwrap().iter().map(name).collect()
    };
    [names(&checked["arms"]), names(&checked["absent"])]
}

#[test]
fn arms_of_one_machine_take_their_joints_from_its_messages() {
    let desk = Desk::new(&[("s.toml", TORSO)]);
    let files = messages(&desk, "s.toml");
    assert_eq!(files, ["o/trajectory.left.moveit.yaml", "o/trajectory.left.yaml", "o/trajectory.mcap"]);
    let of_table = desk.run(&["check", "o", "--json"]).expect(0).json();
    for file in files {
        let scenario = "o/scenario.toml";
        let checked = desk.run(&["check", &file, "--scenario", scenario, "--json"]).expect(0).json();
        assert_eq!(checked_arms(&checked), [vec!["left", "right"], Vec::new()], "{file}");
        // The times of messages are rounded to nanoseconds, which moves what lies between samples.
        for (arm, known) in [0, 1].map(|arm| (&checked["arms"][arm], &of_table["arms"][arm])) {
            let joints = |arm: &serde_json::Value| arm["joints"].as_array().unwrap().clone();
            for (joint, known) in joints(arm).iter().zip(joints(known)) {
                assert_eq!(joint["joint"], known["joint"]);
                let apart = |key: &str| (joint[key].as_f64().unwrap() - known[key].as_f64().unwrap()).abs();
                assert!(apart("lowest").max(apart("highest")) < 1e-12, "{file}: {joint} {known}");
            }
            assert_eq!(joints(arm).len(), 8);
            let error = |arm: &serde_json::Value| arm["max_error"].as_f64().unwrap();
            assert!((error(arm) - error(known)).abs() < 1e-9, "{file}: {arm}");
        }
    }
}

#[test]
fn two_machines_are_told_apart_in_messages() {
    let desk = Desk::new(&[("s.toml", &pair())]);
    for file in messages(&desk, "s.toml") {
        let run = desk.run(&["check", &file, "--scenario", "s.toml", "--json"]).expect(0);
        let both = ["left", "right"];
        let here: Vec<&str> =
            both.into_iter().filter(|arm| file.contains(arm) || file.contains("mcap")).collect();
        let absent: Vec<&str> = both.into_iter().filter(|arm| !here.contains(arm)).collect();
        assert_eq!(checked_arms(&run.json()), [here, absent.clone()], "{file}");
        let text = desk.run(&["check", &file, "--scenario", "s.toml"]).expect(0).out;
        assert_eq!(text.contains("nothing of it moves here"), !absent.is_empty(), "{text}");
    }
    // Of no name there is no telling which of the two it is, unless the scenario has one only.
    let text = std::fs::read_to_string(desk.path("o/trajectory.left.yaml")).unwrap();
    std::fs::write(desk.path("theirs.yaml"), text.replace("# machine: left\n", "")).unwrap();
    let of_pair = ["check", "theirs.yaml", "--scenario", "s.toml", "--json"];
    let refused = desk.run(&of_pair).expect(2).error().to_string();
    assert!(refused.contains("`arm` may be arm `left` or arm `right`"), "{refused}");
    assert!(refused.contains("--arm NAME says which"), "{refused}");
    let said = desk.run(&[&of_pair[..], &["--arm", "left"]].concat()).expect(0).json();
    assert_eq!(checked_arms(&said), [vec!["left"], vec!["right"]]);
    let refused =
        desk.run(&["check", "o/trajectory.mcap", "--scenario", "s.toml", "--arm", "left"]).expect(2);
    assert!(refused.err.contains("a lone arm, and here move left, right"), "{}", refused.err);
    let refused = desk.run(&["check", "o", "--arm", "left"]).expect(2);
    assert!(refused.err.contains("--arm: this is about files of others"), "{}", refused.err);
    std::fs::write(desk.path("one.toml"), SMALL).unwrap();
    let one = desk.run(&["check", "theirs.yaml", "--scenario", "one.toml", "--json"]).expect(0).json();
    assert_eq!(checked_arms(&one), [vec!["left"], Vec::new()]);
    let refused = desk.run(&["check", "o/trajectory.mcap", "--scenario", "one.toml"]).expect(2).err;
    assert!(refused.contains("the scenario has no arm `right`"), "{refused}");
}

#[test]
fn joints_of_no_arm_and_arms_without_their_joints_are_refused() {
    let desk = Desk::new(&[("s.toml", TORSO)]);
    let files = messages(&desk, "s.toml");
    let start = TORSO.rfind("[[arm]]").unwrap();
    std::fs::write(desk.path("left.toml"), &TORSO[..start]).unwrap();
    for file in &files {
        let refused = desk.run(&["check", file, "--scenario", "left.toml"]).expect(3).err;
        let told =
            "moves `right_shoulder_roll`, which is no joint of arm `left` of the scenario; did you mean";
        assert!(refused.contains(told), "{file}: {refused}");
    }
    let slow = ["plan", "left.toml", "--set", "duration=8", "--out", "one", "--format", "mcap,moveit,ros2"];
    desk.run(&slow).expect(0);
    for file in files.iter().map(|file| file.replacen('o', "one", 1)) {
        let refused = desk.run(&["check", &file, "--scenario", "s.toml"]).expect(3).err;
        let told = "does not move joint `right_shoulder_roll` of arm `right` of the scenario";
        assert!(refused.contains(told), "{file}: {refused}");
    }
    let text = std::fs::read_to_string(desk.path("o/trajectory.left.yaml")).unwrap();
    for (to, told) in [
        (
            "left_wrist_yawn",
            "no joint of arms `left` and `right` of the scenario; did you mean left_wrist_yaw?",
        ),
        ("lift", "joint `lift` twice"),
    ] {
        std::fs::write(desk.path("x.yaml"), text.replacen("left_wrist_yaw", to, 1)).unwrap();
        let run = desk.run(&["check", "x.yaml", "--scenario", "s.toml"]);
        assert!([2, 3].contains(&run.code) && run.err.contains(told), "{}: {}", run.code, run.err);
    }
}

#[test]
fn files_of_others_are_recognised_and_options_say_what_can_not_be() {
    let prefixed = "t;left_j1;left_j2;left_j3;left_j4\n0;0,1;0;0;0\n0,5;0,1;0;0;0\n";
    let counted = "timestamp q_0 q_1 q_2 q_3 i_0\n0 10 0 0 0 x\n1 10 0 0 0 x\n";
    let desk = Desk::new(&[
        ("a.csv", prefixed),
        ("b.csv", counted),
        ("c.csv", "t,j1\n0,0\n9000000,0\n"),
        ("d.csv", "t,- j1 deg\n0,1\n1,1\n"),
    ]);
    let robot = ["--robot", "planar4"];
    let run = desk.run(&[&["check", "a.csv"], &robot[..]].concat()).expect(3);
    assert!(
        run.err.contains("all 4 joints have the prefix `left_`") && run.err.contains("--prefix left_"),
        "{}",
        run.err
    );
    let run = desk.run(&[&["check", "a.csv", "--prefix", "left_"], &robot[..]].concat()).expect(0);
    assert!(run.err.contains("note: numbers have decimal commas"), "{}", run.err);
    let checked =
        desk.run(&[&["check", "a.csv", "--prefix", "left_", "--json"], &robot[..]].concat()).expect(0).json();
    assert_eq!(checked["notes"].as_array().unwrap().len(), 2, "{checked}");
    desk.run(&[&["check", "d.csv", "--map", "- * deg"], &robot[..]].concat()).expect(0);
    let map = ["--map", "q_*", "--degrees"];
    let run = desk.run(&[&["check", "b.csv", "--quiet"], &map[..], &robot[..]].concat()).expect(0);
    assert_eq!(run.err, "");
    let exported =
        desk.run(&[&["export", "b.csv", "--format", "npz"], &map[..], &robot[..]].concat()).expect(0);
    assert!(
        exported.err.contains("counts the robot's joints in its order: j1, j2, j3, j4"),
        "{}",
        exported.err
    );
    let exported = Trajectory::read(desk.path("trajectory.npz")).unwrap();
    assert_eq!(exported.arms[0].positions[0], 10_f64.to_radians());
    let run = desk.run(&["export", "c.csv", "--format", "csv", "--json"]).expect(0);
    assert!(run.json()["warnings"][0].as_str().unwrap().contains("--time-unit"), "{}", run.out);
    let run = desk.run(&[&["check", "b.csv", "--map", "p_*"], &robot[..]].concat()).expect(2);
    assert!(run.err.contains("--map p_*: no column is called so"), "{}", run.err);
}
