//! `kinstep plan`, run.

#![allow(clippy::unwrap_used, reason = "a test that can not go on stops")]

use std::path::Path;

use crate::program::{Desk, REPOSITORY, ROW, SMALL, kinstep};
use serde_json::Value;

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is not a number"))
}

#[test]
fn without_a_file_plans_for_two_real_arms_and_says_what_to_try_next() {
    let run = kinstep(&["plan"]).expect(0);
    for said in ["two Panda arms", "la6-wang-guo", "completed", "left", "right", "kept", "Next:"] {
        assert!(run.out.contains(said), "{said:?} is not in\n{}", run.out);
    }
    assert_eq!(run.err, "");
}

#[test]
fn the_summary_has_the_keys_that_scripts_rely_on() {
    let plan = kinstep(&["plan", "--json"]).expect(0).json();
    assert_eq!(plan["status"], "completed");
    assert_eq!(plan["reason"], Value::Null);
    assert_eq!((&plan["formula"], &plan["start"]), (&"la6-wang-guo".into(), &"rk4".into()));
    assert_eq!((number(&plan["sigma"]), number(&plan["h"])), (0.01, 0.4));
    assert_eq!(plan["steps"], 600);
    assert!(plan["warnings"].is_array());
    let arms = plan["arms"].as_array().unwrap();
    assert_eq!(arms.len(), 2);
    for arm in arms {
        assert_eq!(arm["joints"].as_array().unwrap().len(), 7);
        assert_eq!(arm["limits"]["ok"], true);
        assert_eq!(arm["limits"]["violations"], serde_json::json!([]));
        let [all, component, steady] =
            ["max_error", "max_error_component", "max_error_steady"].map(|k| number(&arm[k]));
        assert!(0.0 < component && component <= all && steady <= all && all < 1e-6, "{arm}");
        let [position, orientation] =
            ["max_position_error", "max_orientation_error"].map(|k| number(&arm[k]));
        assert!(position <= all && orientation <= all && position.hypot(orientation) >= all, "{arm}");
    }
}

#[test]
fn a_start_that_was_solved_for_is_written_down_and_gives_the_same_plan_again() {
    let scenario = &format!("{REPOSITORY}/examples/shared_torso.toml");
    let desk = Desk::new(&[]);
    let plan = desk.run(&["plan", scenario, "--out", "one", "--json"]).expect(0).json();
    let start = &plan["arms"][1]["start_pose"];
    assert!(number(&start["distance"]) < 1e-11 && plan["arms"][0]["start_pose"].is_null(), "{plan}");
    assert_eq!(plan["shared"][0]["joints"], serde_json::json!(["lift", "waist"]));
    let written = std::fs::read_to_string(desk.path("one/scenario.toml")).unwrap();
    let written: toml::Table = written.parse().unwrap();
    let kept = written["arm"][1]["q0"].as_array().unwrap();
    for (q, kept) in start["q0"].as_array().unwrap().iter().zip(kept) {
        // The JSON reader of this test may miss the last digit.
        assert!((number(q) - kept.as_float().unwrap()).abs() < 1e-15, "{q} was written as {kept}");
    }
    desk.run(&["plan", "one/scenario.toml", "--out", "two"]).expect(0);
    let [one, two] =
        ["one", "two"].map(|folder| std::fs::read(desk.path(folder).join("trajectory.csv")).unwrap());
    assert_eq!(one, two);
}

#[test]
fn every_scenario_of_the_examples_completes_within_its_limits() {
    let folder = std::fs::read_dir(format!("{REPOSITORY}/examples")).unwrap();
    let is_scenario = |path: &std::path::PathBuf| {
        path.extension().is_some_and(|extension| extension == "toml")
            && !std::fs::read_to_string(path).unwrap().contains("[[formula]]")
    };
    let files: Vec<_> = folder.map(|entry| entry.unwrap().path()).filter(is_scenario).collect();
    assert!(files.len() >= 6, "{files:?}");
    for file in files {
        let plan = kinstep(&["plan", file.to_str().unwrap(), "--json"]).expect(0).json();
        for arm in plan["arms"].as_array().unwrap() {
            assert!(number(&arm["max_error"]) < 1e-6, "{}: {arm}", file.display());
        }
    }
}

#[test]
fn the_margin_is_kept_by_the_law_that_knows_of_it_and_not_by_the_other() {
    let kept = kinstep(&["plan", "examples/obstacle.toml", "--json"]).expect(0).json();
    assert!(number(&kept["distance"]["minimum"]) >= 0.02, "{}", kept["distance"]);
    assert_eq!(kept["distance"]["ok"], true);
    let blind = ["plan", "examples/obstacle.toml", "--set", "law.kind=pseudoinverse"];
    let direct = kinstep(&[&blind[..], &["--json"]].concat()).expect(1).json();
    assert!(number(&direct["distance"]["minimum"]) < 0.0, "{}", direct["distance"]);
    assert_eq!(direct["distance"]["pair"], serde_json::json!(["arm panda_link6", "ball"]));
    let said = kinstep(&blind).expect(1).out;
    assert!(
        said.contains("between arm panda_link6 and ball (margin 0.02 m, not kept), at t = 3.2"),
        "{said}"
    );
    let plain = kinstep(&["plan", "examples/planar_dual.toml", "--json"]).expect(0).json();
    assert!(plain["distance"].is_null());
}

#[test]
fn the_split_row_of_order_six_stays_below_1e_10() {
    let plan = kinstep(&["plan", "examples/dual_panda_split_ab6.toml", "--json"]).expect(0).json();
    assert_eq!((number(&plan["sigma"]), number(&plan["h"])), (0.01, 1.0));
    for arm in plan["arms"].as_array().unwrap() {
        assert!(number(&arm["max_error"]) < 1e-10, "{arm}");
    }
}

#[test]
fn halving_sigma_at_fixed_h_makes_the_error_sixteen_times_smaller() {
    let worst = |sigma: &str| {
        let plan = kinstep(&["plan", "examples/dual_panda.toml", "--set", sigma, "--json"]).expect(0).json();
        plan["arms"].as_array().unwrap().iter().map(|arm| number(&arm["max_error"])).fold(0.0, f64::max)
    };
    let slope = (worst("sigma=0.01") / worst("sigma=0.005")).log2();
    assert!((slope - 4.0).abs() < 0.1, "{slope}");
}

#[test]
fn values_are_laid_over_the_scenario_by_names() {
    let desk = Desk::new(&[("s.toml", SMALL)]);
    let set =
        ["--set", "arm.left.q0=[0.1,0.2, \"pi/4\", 0.4]", "--set", "formula=split-ab2", "--set=law.gain=50"];
    let plan = desk.run(&[&["plan", "s.toml", "--json"], &set[..]].concat()).expect(0).json();
    assert_eq!(plan["formula"], "split-ab2");
    assert!((number(&plan["h"]) - 0.5).abs() < 1e-12);
    for (set, message) in [
        ("arm.lefty.q0=[1]", "did you mean left?"),
        ("arm.left.qq0=[1]", "did you mean q0?"),
        ("law.h=0.9", "outside the feedback range (0, 2/3)"),
        ("sigma", "write key.path=value"),
        ("arm.left.q0=[0.1]", "expected 4 positions (j1, j2, j3, j4), got 1"),
    ] {
        let error = desk.run(&["plan", "s.toml", "--json", "--set", set]).expect(2).error();
        assert!(error["message"].as_str().unwrap().contains(message), "{set}: {error}");
        assert_eq!(error["line"], Value::Null, "what is set from outside has no place in the file");
    }
}

#[test]
fn a_gap_that_does_not_divide_the_duration_is_adjusted_and_said() {
    let desk = Desk::new(&[("s.toml", SMALL)]);
    let run = desk.run(&["plan", "s.toml", "--set", "sigma=0.03", "--json"]).expect(0);
    let plan = run.json();
    assert_eq!((number(&plan["sigma"]), &plan["steps"]), (2.0 / 67.0, &67.into()));
    assert!(plan["warnings"][0].as_str().unwrap().contains("adjusted"), "{plan}");
    assert!(
        desk.run(&["plan", "s.toml", "--set", "sigma=0.03"]).expect(0).out.contains("warning: sigma = 0.03")
    );
}

#[test]
fn smaller_errors_are_promised_only_where_a_smaller_gap_gives_them() {
    let desk = Desk::new(&[("s.toml", SMALL)]);
    let promises = |set: &[&str]| {
        let set: Vec<&str> = set.iter().flat_map(|set| ["--set", set]).collect();
        desk.run(&[&["plan", "s.toml"], &set[..]].concat()).out.contains("times smaller")
    };
    assert!(promises(&[]));
    // At the round-off, and with a loop that does not settle within the run.
    assert!(!promises(&["formula=split-ab6", "law.h=1", "start=rk8", "sigma=0.001"]));
    assert!(!promises(&["law.h=0.0001"]));
}

#[test]
fn numbers_of_any_size_are_written_short() {
    let desk = Desk::new(&[("s.toml", SMALL)]);
    for set in [
        "law.h=1e300",
        "law.h=1e-300",
        "law.h=-1e300",
        "law.gain=-1e300",
        "sigma=1e-300",
        "sigma=1e300",
        "duration=1e300",
        "duration=-1e300",
        "law.threshold=-1e-300",
        "arm.left.path.radius=-1e-300",
    ] {
        let run = desk.run(&["plan", "s.toml", "--set", set]);
        assert!(!run.err.contains("000000000000") && !run.out.contains("000000000000"), "{set}: {}", run.err);
    }
}

#[test]
fn a_crossed_limit_is_exit_1_with_the_joint_the_time_and_the_limit() {
    let run = kinstep(&["plan", "--set", "duration=1", "--json"]).expect(1);
    let plan = run.json();
    assert_eq!(plan["status"], "completed");
    let crossed: Vec<&Value> = plan["arms"]
        .as_array()
        .unwrap()
        .iter()
        .flat_map(|arm| arm["limits"]["violations"].as_array().unwrap())
        .collect();
    assert!(!crossed.is_empty());
    for violation in crossed {
        assert_eq!(violation["kind"], "velocity");
        assert!(violation["joint"].as_str().unwrap().starts_with("panda_joint"));
        assert!(number(&violation["value"]).abs() > number(&violation["limit"]).abs());
        assert!((0.0..=1.0).contains(&number(&violation["t"])));
    }
    let text = kinstep(&["plan", "--set", "duration=1"]).expect(1).out;
    let advice = text
        .lines()
        .filter(|line| line.contains("slow enough"))
        .find_map(|line| line.split("--set duration=").nth(1))
        .expect("a longer duration is advised");
    let longer = format!("duration={}", advice.split_whitespace().next().unwrap());
    kinstep(&["plan", "--set", &longer]).expect(0);
}

#[test]
fn a_duration_that_would_do_is_told_and_the_least_one_is_found() {
    let hurried = ["plan", "--set", "duration=1"];
    let text = kinstep(&hurried).expect(1).out;
    assert!(text.contains("a duration of 1.02 s would do for velocities"), "{text}");
    let plan = kinstep(&[&hurried[..], &["--json"]].concat()).expect(1).json();
    let left = &plan["arms"][0]["limits"];
    let would_do = number(&left["feasible_duration"]);
    let crossed = &left["violations"][0];
    let excess = number(&crossed["value"]) / number(&crossed["limit"]);
    assert!((would_do - excess * number(&plan["duration"])).abs() < 1e-12 && would_do > 1.0);
    assert_eq!(plan["feasible_duration"], left["feasible_duration"]);

    let desk = Desk::new(&[]);
    let run = desk.run(&["plan", "--fastest", "--out", "fast"]).expect(0);
    assert!(
        run.out.contains("The least duration within the joints' limits of motion is 1.02 s"),
        "{}",
        run.out
    );
    let written = std::fs::read_to_string(desk.path("fast/scenario.toml")).unwrap();
    assert!(written.contains("duration = 1.02\n"), "{written}");
    let again = desk.run(&["plan", "fast/scenario.toml", "--json"]).expect(0).json();
    assert!(number(&again["feasible_duration"]) <= 1.02 && number(&again["feasible_duration"]) > 1.01);
    kinstep(&["plan", "--set", "duration=1.01"]).expect(1);
}

#[test]
fn times_of_waypoints_that_are_stretched_are_told() {
    let table = "t,x,y\n0,0,0\n1,0.05,0\n2,0.05,0.05\n4,0,0.05\n";
    let path = "path = { kind = \"spline\", file = \"way.csv\" }\n";
    let begin = SMALL.find("path =").or_else(|| SMALL.find("[arm.path]")).unwrap();
    let text = format!("{}{path}", &SMALL[..begin]);
    let desk = Desk::new(&[("s.toml", &text), ("way.csv", table)]);
    let said = |set: &[&str]| desk.run(&[&["plan", "s.toml"], set].concat()).expect(0).out;
    assert!(said(&["--set", "duration=8"]).contains("take 4 s by their times and 8 s by `duration`"));
    assert!(!said(&["--set", "duration=4"]).contains("by their times"));
}

#[test]
fn a_run_that_stops_is_exit_5_and_what_was_computed_is_written() {
    let desk = Desk::new(&[("s.toml", SMALL)]);
    let set = ["--set", "law.h=0.9", "--set", "allow_unstable=true"];
    let run = desk.run(&[&["plan", "s.toml", "--json", "--out", "results"], &set[..]].concat()).expect(5);
    let plan = run.json();
    assert_eq!(plan["status"], "diverged");
    assert!(plan["reason"].as_str().unwrap().contains("left"), "{plan}");
    let rows = std::fs::read_to_string(desk.path("results/trajectory.csv")).unwrap().lines().count();
    assert_eq!(rows as u64, plan["samples"].as_u64().unwrap() + 1);
    assert!(rows > 5 && rows < 201);

    let singular = desk.run(&["plan", "s.toml", "--json", "--set", "arm.left.q0=[0,0,0,0]"]).expect(5).json();
    assert_eq!(singular["status"], "singular");
    let far = "arm.left.path={kind='line', displacement=[9, 0]}";
    let stopped = desk.run(&["plan", "s.toml", "--json", "--set", far]).expect(5).json();
    assert_eq!(stopped["status"], "unreachable");
    assert!(stopped["reason"].is_string());
}

#[test]
fn the_trajectory_has_the_columns_and_digits_that_scripts_rely_on() {
    let desk = Desk::new(&[("s.toml", SMALL)]);
    desk.run(&["plan", "s.toml", "--out", "deep/results"]).expect(0);
    let names =
        ["plan.json", "report.html", "scenario.toml", "trajectory.csv", "trajectory.csv-metadata.json"];
    assert_eq!(desk.names("deep/results"), names);
    let csv = std::fs::read_to_string(desk.path("deep/results/trajectory.csv")).unwrap();
    let mut lines = csv.lines();
    let positions = "left.j1,left.j2,left.j3,left.j4";
    let velocities = "left.j1.velocity,left.j2.velocity,left.j3.velocity,left.j4.velocity";
    assert_eq!(lines.next().unwrap(), format!("t,{positions},{velocities},left.error"));
    let rows: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
    assert_eq!(rows.len(), 201);
    for (n, row) in rows.iter().enumerate() {
        assert_eq!(row.len(), 10);
        assert_eq!(row[0].parse::<f64>().unwrap(), n as f64 * 0.01);
        for cell in row {
            let digits = cell.trim_start_matches('-').split('e').next().unwrap().replace('.', "");
            assert_eq!(digits.len(), 17, "{cell}");
        }
    }
    assert_eq!(rows[0][1].parse::<f64>().unwrap(), std::f64::consts::PI / 10.0);
    let worst = rows.iter().map(|row| row[9].parse::<f64>().unwrap()).fold(0.0, f64::max);
    let plan: Value =
        serde_json::from_str(&std::fs::read_to_string(desk.path("deep/results/plan.json")).unwrap()).unwrap();
    assert_eq!(worst, number(&plan["arms"][0]["max_error"]));
    // What was planned can be planned again from the folder alone.
    let again = desk.run(&["plan", "deep/results/scenario.toml", "--json"]).expect(0).json();
    assert_eq!(again, plan);
}

#[test]
fn the_same_input_gives_the_same_bytes() {
    let desk = Desk::new(&[]);
    for folder in ["one", "two"] {
        desk.run(&["plan", "--out", folder]).expect(0);
    }
    let bytes = |folder: &str| std::fs::read(desk.path(folder).join("trajectory.csv")).unwrap();
    assert_eq!(bytes("one"), bytes("two"));
}

#[test]
fn rows_of_ones_own_come_by_the_scenario_or_by_an_option() {
    let scenario = SMALL.replace("la6-wang-guo", "mine");
    let beside = scenario.replace("[law]", "formulas = [\"rows.toml\"]\n[law]");
    let desk = Desk::new(&[("s.toml", &scenario), ("beside.toml", &beside), ("rows.toml", ROW)]);
    let builtin = desk.run(&["plan", "s.toml", "--set", "formula=la6-wang-guo", "--json"]).expect(0).json();
    for arguments in
        [&["plan", "beside.toml", "--json"][..], &["plan", "s.toml", "--formulas", "rows.toml", "--json"]]
    {
        let plan = desk.run(arguments).expect(0).json();
        assert_eq!(plan["formula"], "mine");
        assert_eq!(plan["arms"], builtin["arms"], "the same coefficients under another name");
    }
    desk.run(&["plan", "s.toml"]).expect(2);
}

#[test]
fn a_row_that_lies_is_not_run() {
    let lying = ROW.replace("5/16", "5/8");
    let broken = ROW.replace("denominator = 48", "denominator = \"1/0\"");
    let unstable = ROW.replace("[24, -5, -12, -6, -4, 3]", "[1, 1, -1, -1]").replace("48", "4");
    let unstable =
        unstable.replace("order = 3", "order = 1").replace("5/16", "-1/2").replace("true", "false");
    let files =
        [("s.toml", SMALL), ("lying.toml", &lying), ("broken.toml", &broken), ("unstable.toml", &unstable)];
    let desk = Desk::new(&files);
    let plan = |rows: &str| {
        desk.run(&["plan", "s.toml", "--json", "--formulas", rows, "--set", "formula=mine"]).expect(4).error()
    };
    let error = plan("lying.toml");
    assert!(error["message"].as_str().unwrap().contains("5/8"), "{error}");
    assert!(error["file"].as_str().unwrap().ends_with("lying.toml"));
    assert_eq!(plan("broken.toml")["line"], 4);
    assert!(plan("unstable.toml")["message"].as_str().unwrap().contains("not zero-stable"));
}

#[test]
fn a_row_that_lies_is_set_aside_until_it_is_asked_for() {
    let own = SMALL.replace("[law]", "formulas = [\"rows.toml\"]\n[law]");
    let good = ROW.replace("mine", "good");
    let rows = format!("{}\n{good}", ROW.replace("5/16", "5/8").replace("order = 3", "order = 4"));
    let desk = Desk::new(&[("s.toml", SMALL), ("own.toml", &own), ("rows.toml", &rows)]);
    for arguments in
        [&["plan", "own.toml", "--json"][..], &["plan", "s.toml", "--json", "--formulas", "rows.toml"]]
    {
        for used in ["formula=la6-wang-guo", "formula=good"] {
            let plan = desk.run(&[arguments, &["--set", used]].concat()).expect(0).json();
            let warning = plan["warnings"][0].as_str().unwrap();
            assert!(warning.contains("\"mine\"") && warning.contains("order 4"), "{warning}");
        }
        let error = desk.run(&[arguments, &["--set", "formula=mine"]].concat()).expect(4).error();
        let message = error["message"].as_str().unwrap();
        assert!(message.contains("order 4") && message.contains("order 3"), "{message}");
        assert_eq!(error["line"], 5);
    }
    // A row that lies and takes the name of another leaves it open which one is meant.
    std::fs::write(desk.path("rows.toml"), rows.replace("mine", "la6-wang-guo")).unwrap();
    desk.run(&["plan", "own.toml"]).expect(4);
    std::fs::write(desk.path("rows.toml"), rows.replace("denominator = 48", "denominator = \"1/0\""))
        .unwrap();
    desk.run(&["plan", "own.toml"]).expect(4);
}

#[test]
fn what_was_planned_with_own_files_can_be_planned_again_from_the_folder() {
    let urdf = include_str!("../../../../robots/planar4.urdf");
    let scenario = SMALL.replace("[law]", "formulas = [\"rows.toml\"]\n[law]").replace("planar4", "arm.urdf");
    let files = [("s.toml", scenario.as_str()), ("rows.toml", ROW), ("arm.urdf", urdf)];
    let desk = Desk::new(&files);
    let more = ROW.replace("mine", "more");
    std::fs::create_dir_all(desk.path("deep/out")).unwrap();
    std::fs::write(desk.path("deep/out/inside.urdf"), urdf).unwrap();
    std::fs::write(desk.path("more.toml"), &more).unwrap();
    let set = ["--formulas", "more.toml", "--set", "formula=more"];
    for (robot, first, second) in
        [("arm.urdf", "one", "elsewhere/two"), ("deep/out/inside.urdf", "deep/out", "elsewhere/three")]
    {
        let robot = format!("arm.left.robot={robot}");
        desk.run(&[&["plan", "s.toml", "--out", first, "--set", &robot], &set[..]].concat()).expect(0);
        let again = desk.path(first).join("scenario.toml");
        kinstep(&["plan", again.to_str().unwrap(), "--out", desk.path(second).to_str().unwrap()]).expect(0);
        let bytes = |folder: &str| std::fs::read(desk.path(folder).join("trajectory.csv")).unwrap();
        assert_eq!(bytes(first), bytes(second));
        // The rows are recorded already; naming their file once more is no collision.
        desk.run(&["plan", again.to_str().unwrap(), "--formulas", "more.toml"]).expect(0);
    }
    // A robot inside the folder moves with it.
    std::fs::rename(desk.path("deep/out"), desk.path("moved")).unwrap();
    desk.run(&["plan", "moved/scenario.toml"]).expect(0);
}

#[test]
fn files_are_looked_for_beside_the_scenario_and_then_in_the_working_directory() {
    let urdf = include_str!("../../../../robots/planar4.urdf");
    let desk = Desk::new(&[("rows.toml", ROW), ("arm.urdf", urdf)]);
    std::fs::create_dir(desk.path("deep")).unwrap();
    std::fs::write(desk.path("deep/s.toml"), SMALL).unwrap();
    let set =
        ["--set", "formulas=[\"rows.toml\"]", "--set", "formula=mine", "--set", "arm.left.robot=arm.urdf"];
    desk.run(&[&["plan", "deep/s.toml"], &set[..]].concat()).expect(0);
    for (set, name) in [("formulas=[\"no.toml\"]", "no.toml"), ("arm.left.robot=no.urdf", "no.urdf")] {
        let error = desk.run(&["plan", "deep/s.toml", "--json", "--set", set]).expect(6).error();
        let message = error["message"].as_str().unwrap();
        let beside = Path::new("deep").join(name);
        assert!(message.contains(&format!("({})", beside.display())), "{message}");
        assert!(message.contains(&format!("working directory ({name})")), "{message}");
    }
}

#[test]
fn a_scenario_finds_its_robot_beside_itself_from_any_folder() {
    let urdf = include_str!("../../../../robots/planar4.urdf");
    let scenario = SMALL.replace("\"planar4\"", "\"my_arm.urdf\"");
    let desk = Desk::new(&[("s.toml", &scenario), ("my_arm.urdf", urdf)]);
    let file = desk.path("s.toml");
    kinstep(&["plan", file.to_str().unwrap()]).expect(0);
}

#[test]
fn a_task_over_two_tips_is_told_of_wherever_a_plan_is() {
    let arm = |name: &str, height: f64| {
        format!(
            "[[arm]]\nname = \"{name}\"\nrobot = \"panda\"\nbase = \"panda_link0\"\ntip = \"panda_hand_tcp\"\n\
             task = \"position-xy\"\nq0 = [0.0, \"-pi/4\", 0.0, \"-3*pi/4\", 0.0, \"pi/2\", \"pi/4\"]\nmount = {{ xyz = [{height}, 0, {height}] }}\n\
             path = {{ kind = \"circle\", radius = 0.05 }}\n"
        )
    };
    let (head, _) = SMALL.split_once("[[arm]]").unwrap();
    let task = "[[task]]\nkind = \"distance\"\narms = [\"left\", \"right\"]\n";
    let pair = format!("{head}{}{}{task}", arm("left", 0.0), arm("right", 0.4));
    let desk = Desk::new(&[("s.toml", &pair), ("alone.toml", SMALL)]);
    let plan = desk.run(&["plan", "s.toml", "--out", "one", "--json"]).expect(0).json();
    let told = &plan["relations"][0];
    assert_eq!(
        (&told["name"], &told["kind"], &told["rows"]),
        (&"distance".into(), &"distance".into(), &1.into())
    );
    assert_eq!(told["arms"], serde_json::json!(["left", "right"]));
    assert!(number(&told["max_error"]) < 1e-3, "{told}");
    assert!(desk.run(&["plan", "s.toml"]).expect(0).out.contains("distance of left and right: max error"));
    let page = std::fs::read_to_string(desk.path("one/report.html")).unwrap();
    assert!(page.contains("<p>distance of left and right: max error"));
    let written = std::fs::read_to_string(desk.path("one/scenario.toml")).unwrap();
    assert!(written.contains("[[relation]]") && desk.run(&["plan", "one/scenario.toml"]).code == 0);
    let alone = desk.run(&["plan", "alone.toml", "--json"]).expect(0).json();
    assert!(alone.get("relations").is_none(), "{alone}");
}

#[test]
fn two_arms_carry_one_object_to_a_billionth() {
    let plan = kinstep(&["plan", "examples/carry.toml", "--json"]).expect(0).json();
    let told = &plan["relations"][0];
    assert_eq!(
        (&told["name"], &told["kind"], &told["rows"]),
        (&"carry".into(), &"object".into(), &12.into())
    );
    assert!(
        number(&told["max_position_error"]) < 1e-9 && number(&told["max_orientation_error"]) < 1e-9,
        "{told}"
    );
    for arm in plan["arms"].as_array().unwrap() {
        assert!(number(&arm["drift"]) > 0.0 && number(&arm["max_error"]) == 0.0, "{arm}");
    }
    let text = kinstep(&["plan", "examples/carry.toml"]).expect(0).out;
    assert!(text.contains("carry of left and right: max error"), "{text}");
}

#[test]
fn they_do_so_to_a_ten_millionth_while_a_velocity_limit_is_active() {
    let scenario = std::fs::read_to_string(format!("{REPOSITORY}/examples/carry.toml")).unwrap();
    let limited =
        scenario.replacen("base = \"panda_link0\"", "base = \"panda_link0\"\nlimits = \"limits.yaml\"", 1);
    let limit = 0.0488;
    let limits =
        format!("joint_limits:\n  panda_joint1:\n    has_velocity_limits: true\n    max_velocity: {limit}\n");
    let desk = Desk::new(&[("carry.toml", &limited), ("limits.yaml", &limits)]);
    let law = ["--set", "law.kind=qp", "--set", "law.h=0.2", "--out", "plan", "--json"];
    let plan = desk.run(&[&["plan", "carry.toml"], &law[..]].concat()).expect(0).json();
    let told = &plan["relations"][0];
    assert!(
        number(&told["max_position_error"]) < 1e-7 && number(&told["max_orientation_error"]) < 1e-7,
        "{told}"
    );
    assert_eq!(plan["arms"][0]["limits"]["violations"], serde_json::json!([]));
    let table = std::fs::read_to_string(desk.path("plan/trajectory.csv")).unwrap();
    let place =
        table.lines().next().unwrap().split(',').position(|name| name == "left.panda_joint1.velocity");
    let velocity = |line: &str| line.split(',').nth(place.unwrap()).unwrap().parse::<f64>().unwrap();
    let active = table.lines().skip(1).filter(|line| velocity(line).abs() > 0.995 * limit).count();
    assert!(active > 60, "{active} samples of {}", table.lines().count());
}
