//! Trajectories of others, and what is said of them.

#![allow(clippy::unwrap_used, reason = "a test that can not go on stops")]

use crate::program::Desk;
use serde_json::Value;

const ROBOT: [&str; 2] = ["--robot", "ur5e"];

/// A desk with all files of `tests/checked`.
fn desk() -> Desk {
    let desk = Desk::new(&[]);
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/checked");
    for entry in std::fs::read_dir(folder).unwrap() {
        let entry = entry.unwrap();
        std::fs::copy(entry.path(), desk.path(&entry.file_name().to_string_lossy())).unwrap();
    }
    desk
}

/// What is found of a file that fails a check.
fn found(file: &str, against: &[&str]) -> (Value, String) {
    let arguments = [&["check", file], against].concat();
    let desk = desk();
    let text = desk.run(&arguments).expect(1).out;
    (desk.run(&[&arguments[..], &["--json"]].concat()).expect(1).json(), text)
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap()
}

#[test]
fn what_a_controller_plays_between_samples_is_held_against_the_limits() {
    let (checked, text) = found("peak_between.csv", &ROBOT);
    let crossing = &checked["arms"][0]["limits"]["violations"][0];
    // The cubic between 1.2 and 1.8 s peaks at 3.2428 rad; the limit is pi.
    assert!((number(&crossing["value"]) - 3.2428).abs() < 1e-4, "{crossing}");
    assert!(number(&crossing["t"]) < 1.3 && number(&crossing["outside"]) > 0.5, "{crossing}");
    assert!(text.contains("first at t = 1.22855 s, for 0.5625 s in all"), "{text}");
    let straight = [&["check", "peak_between.csv", "--interpolation", "linear"], &ROBOT[..]].concat();
    desk().run(&straight).expect(0);
    // 1.5 times the mean velocity of 2.5 rad/s in the middle of the cubic.
    let (checked, _) = found("cubic_peak.yaml", &ROBOT);
    let crossing = &checked["arms"][0]["limits"]["violations"][0];
    assert_eq!(
        (&crossing["kind"], &crossing["value"], &crossing["worst_at"]),
        (&"velocity".into(), &3.75.into(), &0.5.into())
    );
    let asked = [&["check", "cubic_peak.yaml", "--interpolation", "quintic"], &ROBOT[..]].concat();
    let refused = desk().run(&asked).expect(2).err;
    assert!(refused.contains("declare no accelerations") && refused.contains("cubic"), "{refused}");
}

#[test]
fn goals_of_few_points_and_exact_profiles_are_ordinary() {
    for file in ["rest_then_move.csv", "symmetric_peak.csv"] {
        let checked = desk().run(&[&["check", file, "--json"], &ROBOT[..]].concat()).expect(0).json();
        assert_eq!(
            (&checked["ok"], &checked["failures"]),
            (&true.into(), &Value::Array(Vec::new())),
            "{file}"
        );
    }
}

#[test]
fn a_crossing_is_told_from_its_beginning() {
    let (checked, text) = found("beyond.csv", &ROBOT);
    let crossing = &checked["arms"][0]["limits"]["violations"][0];
    assert_eq!((number(&crossing["t"]), number(&crossing["outside"])), (0.0, 3.0), "{crossing}");
    assert!(text.contains("first at t = 0 s, for 3 s in all"), "{text}");
}

#[test]
fn followers_are_checked_in_the_file_and_out_of_it() {
    let (checked, text) = found("mimic_with_follower.csv", &["--robot", "mimic.urdf"]);
    assert_eq!(checked["arms"][0]["followers_follow"], false);
    assert!(text.contains("arm.b: follows a but is 1.7 away from 2 a + 0.1 at t = 1.8 s"), "{text}");
    let desk = desk();
    desk.run(&["plan", "mimic4.toml", "--out", "o"]).expect(1);
    for arguments in [&["check", "o/trajectory.csv", "--robot", "mimic4.urdf"][..], &["check", "o"]] {
        let text = desk.run(arguments).expect(1).out;
        assert!(text.contains("a.b: velocity -1.2104 crosses its limit -0.2"), "{text}");
    }
}

#[test]
fn a_path_is_asked_for_from_its_beginning_to_its_end() {
    let desk = desk();
    desk.run(&["plan", "mimic4.toml", "--set", "duration=20", "--out", "o"]).expect(0);
    let table = std::fs::read_to_string(desk.path("o/trajectory.csv")).unwrap();
    let asked = |name: &str, lines: Vec<String>| {
        std::fs::write(desk.path(name), lines.join("\n")).unwrap();
        desk.run(&["check", name, "--scenario", "o/scenario.toml"])
    };
    let part = |from: usize, to: usize| -> Vec<String> {
        let kept = table.lines().enumerate().filter(|(n, _)| *n == 0 || (from..to).contains(n));
        kept.map(|(_, line)| line.to_owned()).collect()
    };
    let shifted = |lines: Vec<String>| -> Vec<String> {
        let later = |line: String| match line.split_once(',') {
            Some((time, rest)) if time != "t" => format!("{},{rest}", time.parse::<f64>().unwrap() + 100.0),
            _ => line,
        };
        lines.into_iter().map(later).collect()
    };
    let half = asked("half.csv", part(0, 1002)).expect(1).out;
    assert!(half.contains("the samples go from 0 to 10 s of it: 10 to 20 s is missing, 50 %"), "{half}");
    let end = asked("end.csv", part(1001, 9999)).expect(1).out;
    assert!(end.contains("from 10 to 20 s of it: 0 to 10 s is missing"), "{end}");
    let later = asked("later.csv", shifted(part(0, 9999))).expect(0).out;
    assert!(later.contains("100 s is taken for the path's beginning"), "{later}");
    let standing = asked("standing.csv", part(0, 5)).expect(1).out;
    assert!(standing.contains("is missing"), "{standing}");
}

#[test]
fn a_file_of_limits_adds_what_a_robot_lacks() {
    let desk = desk();
    std::fs::write(
        desk.path("joint_limits.yaml"),
        "joint_limits:\n  shoulder_pan_joint:\n    has_velocity_limits: false\n    has_acceleration_limits: true\n    max_acceleration: 14.0\n",
    )
    .unwrap();
    let check = ["check", "cubic_peak.yaml", "--robot", "ur5e", "--limits", "joint_limits.yaml"];
    let text = desk.run(&check).expect(1).out;
    // 6 q / T^2 at both ends of a cubic from rest to rest.
    assert!(text.contains("acceleration 15 crosses its limit 14 by 1, first at t = 0 s"), "{text}");
    let unknown = std::fs::read_to_string(desk.path("joint_limits.yaml")).unwrap().replace("pan", "span");
    std::fs::write(desk.path("joint_limits.yaml"), unknown).unwrap();
    assert!(desk.run(&check).expect(3).err.contains("shoulder_pan_joint"));
}

#[test]
fn an_arm_that_converges_is_written_as_it_moves() {
    let desk = Desk::new(&[("s.toml", CONVERGING)]);
    desk.run(&["plan", "s.toml", "--out", "o"]).expect(0);
    let text = desk.run(&["check", "o"]).expect(1).out;
    assert!(!text.contains("crosses its limit") && !text.contains("differs"), "{text}");
    // The loop starts at once, which no arm can: that is so.
    assert!(text.contains("jumps by"), "{text}");
}

const CONVERGING: &str = r#"
sigma = 0.01
duration = 5.0
formula = "la6-twenty-four"
[law]
kind = "pseudoinverse"
h = 0.4
[[arm]]
name = "left"
robot = "panda"
base = "panda_link0"
tip = "panda_link8"
task = "position"
q0 = [0, -0.5, 0, -2, 0, 1.6, 0.8]
approach = "converge"
path = { kind = "circle", radius = 0.05, center = [0.36, 0.03, 0.65], time_law = "sin2" }
"#;
