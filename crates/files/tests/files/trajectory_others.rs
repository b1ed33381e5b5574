//! Files of others: every dialect reads back what was written in it, and what is not read is refused by a sentence that says what
//! was recognised.

#![allow(clippy::unwrap_used, reason = "a test that can not go on stops")]

use std::fmt::Write;

use crate::trajectories::trajectories;
use kinstep::robot::{JointKind, Limits, embedded};
use kinstep_files::trajectory::{
    ArmTrajectory, KnownJoint, ReadOptions, Reading, TimeUnit, Trajectory, TrajectoryError, units,
};
use proptest::prelude::*;

/// A robot of so many joints.
fn joints(names: &[String]) -> Vec<KnownJoint> {
    let joint = |name: &String| KnownJoint {
        name: name.clone(),
        kind: JointKind::Continuous,
        limits: Limits::UNLIMITED,
        follows: false,
    };
    names.iter().map(joint).collect()
}

/// A trajectory of one arm with plain names, whose times are whole milliseconds.
fn plain(trajectory: &Trajectory) -> Trajectory {
    let arm = &trajectory.arms[0];
    let names = (0..arm.joints.len()).map(|n| format!("joint_{}", ["b", "a", "d", "c"][n])).collect();
    let arm = ArmTrajectory { name: "arm".to_owned(), joints: names, errors: Vec::new(), ..arm.clone() };
    let times = (0..trajectory.samples()).map(|n| (n * n + 7 * n) as f64 / 1000.0).collect();
    Trajectory { about: None, times, arms: vec![arm] }
}

fn milliseconds(trajectory: &Trajectory) -> Vec<u64> {
    trajectory.times.iter().map(|t| (t * 1000.0).round() as u64).collect()
}

fn list(values: &[f64]) -> String {
    values.iter().map(|value| format!("{value:e}")).collect::<Vec<_>>().join(", ")
}

/// Names and texts of the columns of a table: positions, velocities where they are known.
fn columns(
    trajectory: &Trajectory,
    name: impl Fn(usize, &str, &str) -> String,
) -> Vec<(String, Vec<String>)> {
    let arm = &trajectory.arms[0];
    let width = arm.joints.len();
    let mut columns = Vec::new();
    for (word, values) in [("position", &arm.positions), ("velocity", &arm.velocities)] {
        for (place, joint) in arm.joints.iter().enumerate().filter(|_| !values.is_empty()) {
            let texts = values.iter().skip(place).step_by(width).map(|value| format!("{value:e}")).collect();
            columns.push((name(place, joint, word), texts));
        }
    }
    columns
}

fn table((name, times): (&str, &[String]), columns: &[(String, Vec<String>)], separator: &str) -> String {
    let mut head = vec![name.to_owned()];
    head.extend(columns.iter().map(|(name, _)| name.clone()));
    let mut text = head.join(separator) + "\n";
    for (row, time) in times.iter().enumerate() {
        let mut line = vec![time.clone()];
        line.extend(columns.iter().map(|(_, texts)| texts[row].clone()));
        text += &(line.join(separator) + "\n");
    }
    text
}

fn read(name: &str, text: &str, options: &ReadOptions) -> Result<Reading, TrajectoryError> {
    Trajectory::from_bytes_with(name.as_ref(), text.as_bytes(), options)
}

fn maps(rules: &[&str]) -> ReadOptions {
    ReadOptions { map: rules.iter().map(|rule| rule.parse().unwrap()).collect(), ..ReadOptions::default() }
}

/// The same with velocities for all or for none, and no accelerations where the dialect has none.
fn of_states(trajectory: &Trajectory) -> Trajectory {
    let mut states = trajectory.clone();
    states.arms[0].accelerations.clear();
    states
}

/// Joint states of every sample, in the layouts of both distributions, the joints of every second one backwards.
fn states(trajectory: &Trajectory, is_first_distribution: bool, turns: bool) -> Vec<String> {
    let arm = &trajectory.arms[0];
    let [sec, nanosec] = if is_first_distribution { ["secs", "nsecs"] } else { ["sec", "nanosec"] };
    let state = |(n, ms): (usize, u64)| {
        let backwards = turns && n % 2 == 1;
        let ordered = |values: &[f64]| -> String {
            let mut values = values.to_vec();
            if backwards {
                values.reverse();
            }
            list(&values)
        };
        let mut names = arm.joints.clone();
        if backwards {
            names.reverse();
        }
        let (names, positions) = (names.join(", "), ordered(arm.position(n)));
        let velocities = ordered(arm.velocity(n).unwrap_or_default());
        let (s, ns) = (ms / 1000, ms % 1000 * 1_000_000);
        format!(
            "header:\n  seq: {n}\n  stamp:\n    {sec}: {s}\n    {nanosec}: {ns}\n  frame_id: ''\nname: [{names}]\nposition: \
             [{positions}]\nvelocity: [{velocities}]\neffort: []\n"
        )
    };
    milliseconds(trajectory).into_iter().enumerate().map(state).collect()
}

/// A joint trajectory in block or flow style, with the time as float seconds or in the words of either distribution.
fn command(trajectory: &Trajectory, span: &dyn Fn(u64) -> String, is_block: bool) -> String {
    let arm = &trajectory.arms[0];
    let mut text = format!("joint_names: [{}]\npoints:\n", arm.joints.join(", "));
    for (n, ms) in milliseconds(trajectory).into_iter().enumerate() {
        let known = [
            ("positions", Some(arm.position(n))),
            ("velocities", arm.velocity(n)),
            ("accelerations", arm.acceleration(n)),
        ];
        let mut dash = "-";
        for (key, values) in known {
            let Some(values) = values else { continue };
            let values = if is_block {
                values.iter().fold(String::new(), |mut list, value| {
                    let _ = write!(list, "\n  - {value:e}");
                    list
                })
            } else {
                format!(" [{}]", list(values))
            };
            let _ = writeln!(text, "{dash} {key}:{values}");
            dash = " ";
        }
        let _ = writeln!(text, "  effort: []\n  time_from_start: {}", span(ms));
    }
    text
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn tables_in_every_dialect_read_back(trajectory in trajectories()) {
        let trajectory = of_states(&plain(&trajectory));
        let ms = milliseconds(&trajectory);
        let times = |scale: &dyn Fn(u64) -> String| -> Vec<String> { ms.iter().map(|&ms| scale(ms)).collect() };
        let seconds = times(&|ms| (ms as f64 / 1000.0).to_string());
        let robot = joints(&trajectory.arms[0].joints);
        let same = |text: &str, options: &ReadOptions| prop_assert_eq_ok(&read("a.csv", text, options), &trajectory);

        let own = columns(&trajectory, |_, joint, word| if word == "position" { joint.to_owned() } else { format!("{joint}.{word}") });
        for separator in [",", ";", "\t", " "] {
            same(&table(("t", &seconds), &own, separator), &ReadOptions::default())?;
        }
        let commas: Vec<_> =
            own.iter().map(|(name, texts)| (name.clone(), texts.iter().map(|text| text.replace('.', ",")).collect())).collect();
        same(&table(("t", &seconds), &commas, ";"), &ReadOptions::default())?;

        let topics = columns(&trajectory, |_, joint, word| format!("/joint_states/{joint}/{word}"));
        let mut sparse = table(("__time", &seconds), &topics, ",");
        sparse.push_str(&["1e9", &",".repeat(topics.len()), "\n"].concat());
        same(&sparse, &ReadOptions::default())?;

        let counted = ReadOptions { joints: robot.clone(), ..ReadOptions::default() };
        for first in [0, 1] {
            let entries = columns(&trajectory, |place, _, word| format!("/js/{word}[{}]", place + first));
            same(&table(("time_ms", &times(&|ms| ms.to_string())), &entries, ","), &counted)?;
            let rtde = columns(&trajectory, |place, _, word| format!("actual_q{}_{}", if word == "position" { "" } else { "d" }, place + first));
            let is_moving = !trajectory.arms[0].velocities.is_empty();
            let rules = if is_moving { &["actual_q_*", "actual_qd_*=velocity"][..] } else { &["actual_q_*"] };
            same(&table(("timestamp", &seconds), &rtde, " "), &ReadOptions { joints: robot.clone(), ..maps(rules) })?;
        }
        let named = columns(&trajectory, |_, joint, word| format!("left {joint} {word}"));
        let rules = ["left * position=*", "left * velocity=*.velocity"];
        let rules = if trajectory.arms[0].velocities.is_empty() { &rules[..1] } else { &rules };
        for (unit, scale) in [(TimeUnit::Nanoseconds, 1_000_000), (TimeUnit::Microseconds, 1000), (TimeUnit::Milliseconds, 1)] {
            let options = ReadOptions { time_unit: Some(unit), ..maps(rules) };
            same(&table(("t", &times(&|ms| (ms * scale).to_string())), &named, ","), &options)?;
            let dated = times(&|ms| ((1_700_000_000_000 + ms) * scale).to_string());
            same(&table(("t", &dated), &named, ","), &maps(rules))?;
        }
    }

    #[test]
    fn tables_and_records_of_json_read_back(trajectory in trajectories()) {
        let trajectory = of_states(&plain(&trajectory));
        let seconds: Vec<String> = trajectory.times.iter().map(f64::to_string).collect();
        let own = columns(&trajectory, |_, joint, word| if word == "position" { joint.to_owned() } else { format!("{joint}.{word}") });
        let mut all = vec![("t".to_owned(), seconds)];
        all.extend(own);
        let entry = |(name, texts): &(String, Vec<String>)| format!("\"{name}\": [{}]", texts.join(", "));
        let table = format!("{{{}}}", all.iter().map(entry).collect::<Vec<_>>().join(", "));
        let record = |row: usize| {
            let cells: Vec<String> = all.iter().map(|(name, texts)| format!("\"{name}\": {}", texts[row])).collect();
            format!("{{{}}}", cells.join(", "))
        };
        let records: Vec<String> = (0..trajectory.samples()).map(record).collect();
        for text in [table, format!("[{}]", records.join(",\n ")), records.join("\n")] {
            prop_assert_eq_ok(&read("a.json", &text, &ReadOptions::default()), &trajectory)?;
        }
    }

    #[test]
    fn messages_of_every_kind_read_back(trajectory in trajectories(), is_block in any::<bool>(), first in any::<bool>()) {
        let trajectory = plain(&trajectory);
        let spans: [&dyn Fn(u64) -> String; 4] = [
            &|ms| format!("{{sec: {}, nanosec: {}}}", ms / 1000, ms % 1000 * 1_000_000),
            &|ms| format!("\n    secs: {}\n    nsecs:         {}", ms / 1000, ms % 1000 * 1_000_000),
            &|ms| (ms as f64 / 1000.0).to_string(),
            // What only the parser of all of YAML reads.
            &|ms| format!("!!map {{sec: {}, nanosec: {}}}", ms / 1000, ms % 1000 * 1_000_000),
        ];
        for span in spans {
            let message = command(&trajectory, span, is_block);
            prop_assert_eq_ok(&read("a.yaml", &message, &ReadOptions::default()), &trajectory)?;
            let within = |indent: &str| message.lines().map(|line| [indent, line, "\n"].concat()).collect::<String>();
            let goal = format!("header:\n  stamp: {{secs: 1, nsecs: 0}}\ngoal:\n  trajectory:\n{}---\n", within("    "));
            prop_assert_eq_ok(&read("a.txt", &goal, &ReadOptions::default()), &trajectory)?;
            let display = format!(
                "trajectory:\n- joint_trajectory:\n{}  multi_dof_joint_trajectory: {{joint_names: [], points: []}}\ntrajectory_start:\n  \
                 joint_state: {{name: [x], position: [1]}}\n",
                within("    ")
            );
            prop_assert_eq_ok(&read("a.yaml", &display, &ReadOptions::default()), &trajectory)?;
        }
        let trajectory = of_states(&trajectory);
        for turns in [false, true] {
            let states = states(&trajectory, first, turns);
            let echo = states.join("---\n") + "---\n";
            prop_assert_eq_ok(&read("a.yaml", &echo, &ReadOptions::default()), &trajectory)?;
            let items: String = states
                .iter()
                .flat_map(|state| state.lines().enumerate())
                .map(|(n, line)| [if n == 0 { "- " } else { "  " }, line, "\n"].concat())
                .collect();
            prop_assert_eq_ok(&read("a.yaml", &items, &ReadOptions::default()), &trajectory)?;
        }
    }

    #[test]
    fn no_mutation_makes_a_reader_panic(
        trajectory in trajectories(), places in proptest::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..4),
    ) {
        let trajectory = plain(&trajectory);
        let span = |ms: u64| format!("{{sec: {}, nanosec: {}}}", ms / 1000, ms % 1000 * 1_000_000);
        let own = columns(&trajectory, |place, _, word| format!("{word}.{place}"));
        let seconds: Vec<String> = trajectory.times.iter().map(f64::to_string).collect();
        let texts = [
            ("a.yaml", command(&trajectory, &span, false)),
            ("a.yaml", command(&trajectory, &span, true)),
            ("a.yaml", states(&trajectory, true, true).join("---\n")),
            ("a.csv", table(("t", &seconds), &own, ";")),
            ("a.json", "{\"op\": \"publish\", \"msg\": {\"t\": [0, 1], \"q\": [[0], [1]]}}\n{\"t\": 1}".to_owned()),
        ];
        let options = ReadOptions { joints: joints(&trajectory.arms[0].joints), degrees: true, unwrap: true, ..ReadOptions::default() };
        for (name, text) in texts {
            let mut bytes = text.into_bytes();
            for (place, byte) in &places {
                let at = place.index(bytes.len());
                bytes[at] = if byte % 3 == 0 { b"-:[]{},'\"#&*\t \n"[usize::from(*byte) % 15] } else { *byte };
            }
            for name in [name, "a.unknown"] {
                let _ = Trajectory::from_bytes_with(name.as_ref(), &bytes, &options);
            }
        }
    }
}

/// As an assertion that two are the same to the last bit but for the signs of zeros and rounding of times below a picosecond.
fn prop_assert_eq_ok(
    read: &Result<Reading, TrajectoryError>,
    expected: &Trajectory,
) -> Result<(), TestCaseError> {
    let read = match read {
        Ok(read) => &read.trajectory,
        Err(e) => return Err(TestCaseError::fail(e.to_string())),
    };
    prop_assert_eq!(read.samples(), expected.samples());
    let apart = read.times.iter().zip(&expected.times).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    prop_assert!(apart < 1e-12, "{:?} {:?}", read.times, expected.times);
    prop_assert_eq!(&read.arms, &expected.arms);
    Ok(())
}

#[test]
fn what_is_recognised_and_not_read_is_said() {
    let state = |stamp: &str, names: &str| {
        format!("header: {{stamp: {stamp}}}\nname: [{names}]\nposition: [0, 0]\n---\n")
    };
    let zero = "{sec: 0, nanosec: 0}";
    let mixed = state("{sec: 1, nanosec: 0}", "a, b") + &state("{sec: 2, nanosec: 0}", "c, d");
    let cases = [
        ("a.yaml", "a: 1\nb: 2\n".to_owned(), "here are the keys a, b"),
        ("a.yaml", "name: [a, b]\nposition: [0, 0]\n---\n".to_owned(), "does not say when"),
        ("a.yaml", state(zero, "a, b") + &state(zero, "a, b"), "not stamped"),
        ("a.yaml", mixed, "different joints are mixed here"),
        ("a.yaml", "joint_names: [a]\npoints: []\n".to_owned(), "has no points"),
        (
            "a.yaml",
            "joint_names: [a]\npoints:\n- {positions: [0], time_from_start: {secs: 1}}\n".to_owned(),
            "nanosec",
        ),
        ("a.json", "{\"t\": [0, 1], \"a\": [1]}".to_owned(), "`a` has 1 values, and there are 2 times"),
        ("a.json", "{\"t\": [0, 1]".to_owned(), "not JSON"),
        ("a.json", "[{\"t\": 0, \"a\": 1}, {\"t\": 1}]".to_owned(), "no `a` although the first one has"),
        ("a.csv", "t,position.0\n0,1\n1,2\n".to_owned(), "give the robot"),
        ("a.csv", "__time,/x/a/position,/y/a/position\n0,1,1\n1,2,2\n".to_owned(), "--map"),
    ];
    for (name, text, words) in cases {
        let error = read(name, &text, &ReadOptions::default()).unwrap_err();
        assert!(error.message.contains(words), "{text}: {error}");
    }
    let ur = KnownJoint::of(&embedded::get("ur5e").unwrap());
    let rtde = "timestamp actual_q_0 actual_q_1 actual_q_2 actual_q_3 actual_q_4 actual_q_5\n0 1 2 3 4 5 6\n1 1 2 3 4 5 6\n";
    let options = ReadOptions { joints: ur, ..ReadOptions::default() };
    let reading = read("a.csv", rtde, &options).unwrap();
    assert!(options.hint(&reading.trajectory).unwrap().contains("--map 'actual_q_*'"));
    let prefixed = read("a.csv", "t,left_elbow_joint,left_wrist_1_joint\n0,0,0\n1,0,0\n", &options).unwrap();
    assert!(options.hint(&prefixed.trajectory).unwrap().contains("all 2 joints have the prefix `left_`"));
    let around = read("a.csv", "t,- elbow_joint_position\n0,0\n1,0\n", &options).unwrap();
    assert!(options.hint(&around.trajectory).unwrap().contains("--map '- *_position'"));
    let stripped = ReadOptions { prefix: Some("left_".to_owned()), ..options };
    let prefixed = read("a.csv", "t,left_elbow_joint,left_wrist_1_joint\n0,0,0\n1,0,0\n", &stripped).unwrap();
    assert_eq!(stripped.hint(&prefixed.trajectory), None);
}

#[test]
fn formats_that_are_not_read_are_recognised_and_ends_of_lines_are_not_columns() {
    for (bytes, word) in [
        (&b"\x93NUMPY\x01\x00"[..], "savez"),
        (b"#ROSBAG V2.0\n", "ROS 1"),
        (b"SQLite format 3\0", "storage_id"),
    ] {
        let error = Trajectory::from_bytes("a.csv".as_ref(), bytes).unwrap_err();
        assert!(error.message.contains(word), "{error}");
    }
    let reading = read("a.csv", ",t,a,\n0,0,1,\n1,1,2,\n", &ReadOptions::default()).unwrap();
    assert_eq!(reading.trajectory.arms[0].joints, ["a"]);
    assert!(reading.notes[0].contains("without a name"), "{:?}", reading.notes);
    let effort = read("a.csv", "t,a_effort\n0,1\n1,2\n", &ReadOptions::default()).unwrap();
    assert!(units::questions(&effort.trajectory, &[])[0].contains("`a_effort`"));
}

#[test]
fn partial_states_are_left_out_where_others_name_all() {
    let state = |t: u32, names: &str, q: &str| {
        format!(
            "{{header: {{stamp: {{sec: {t}, nanosec: 0}}}}, name: [{names}], position: [{q}], velocity: [.nan]}}\n---\n"
        )
    };
    let text = state(1, "a", "1") + &state(2, "a, b", "1, 2") + &state(3, "b, a", "4, 3");
    let reading = read("a.yaml", &text, &ReadOptions::default()).unwrap();
    let arm = &reading.trajectory.arms[0];
    assert_eq!((arm.joints.join(" "), &arm.positions[..]), ("a b".to_owned(), &[1.0, 2.0, 3.0, 4.0][..]));
    assert!(arm.velocities.is_empty());
    for words in ["1 of 3 joint states", "an order that changes"] {
        assert!(reading.notes.iter().any(|note| note.contains(words)), "{:?}", reading.notes);
    }
}

#[test]
fn units_are_questioned_only_where_they_can_not_be_right() {
    let ur = KnownJoint::of(&embedded::get("ur5e").unwrap());
    let ask =
        |text: &str| units::questions(&read("a.csv", text, &ReadOptions::default()).unwrap().trajectory, &ur);
    let cases = [
        ("t,elbow_joint\n0,0\n1,3\n", None),
        ("t,elbow_joint\n0,-6.2\n1,6.2\n", None),
        ("t,elbow_joint\n0,0\n1,90\n", Some("--degrees")),
        ("t,elbow_joint\n0,0\n8000000,1\n", Some("--time-unit ns")),
        ("t,elbow_joint,elbow_joint.velocity\n0,0,1\n1000,1,1\n", Some("--time-unit ms")),
        ("t,elbow_joint,elbow_joint.velocity\n0,0,57.29\n1,1,57.29\n", Some("degrees per second")),
        ("t,elbow_joint,elbow_joint.velocity\n0,0,1\n1,1,1\n", None),
    ];
    for (text, words) in cases {
        let questions = ask(text);
        assert_eq!(questions.len(), usize::from(words.is_some()), "{text}: {questions:?}");
        assert!(words.is_none_or(|words| questions[0].contains(words)), "{text}: {questions:?}");
    }
    let options = ReadOptions { degrees: true, joints: ur, ..ReadOptions::default() };
    let reading = read("a.csv", "t,elbow_joint\n0,0\n1,90\n", &options).unwrap();
    assert_eq!(reading.trajectory.arms[0].positions[1], 90_f64.to_radians());
}

#[test]
fn turns_are_found_and_undone_in_continuous_joints_alone() {
    let text = "t,a,b\n0,3.1,3.1\n1,-3.1,-3.1\n2,-3,-3\n";
    let names = ["a", "b"].map(str::to_owned);
    let mut known = joints(&names);
    known[1].kind = JointKind::Revolute;
    let options = ReadOptions { unwrap: true, joints: known, ..ReadOptions::default() };
    let reading = read("a.csv", text, &options).unwrap();
    let arm = &reading.trajectory.arms[0];
    let tau = std::f64::consts::TAU;
    assert_eq!(arm.positions, [3.1, 3.1, -3.1 + tau, -3.1, -3.0 + tau, -3.0]);
    assert!(reading.notes[0].contains("undone in a"), "{:?}", reading.notes);
}
