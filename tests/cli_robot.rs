//! `kinstep robot`, run.

#![allow(clippy::unwrap_used, reason = "a test that can not go on stops")]

mod cli;

use cli::{Desk, kinstep};
use serde_json::{Value, json};

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
}

const CHAIN: [&str; 4] = ["--base", "base", "--tip", "tip"];

fn planar(command: &str, q: &[&str]) -> Value {
    kinstep(&[&["robot", command, "planar4", "--json"], &CHAIN[..], q].concat()).expect(0).json()
}

#[test]
fn pose_and_jacobian_are_those_of_four_unit_links() {
    let q = [-0.1, 2.0, 0.3, std::f64::consts::FRAC_PI_4];
    for typed in
        [&["--q=-0.1,2,0.3,pi/4"][..], &["--q", "-0.1,2,0.3,pi/4"], &["--q", " -0.1, 2 ,0.3,45*pi/180 "]]
    {
        let result = planar("jacobian", typed);
        assert_eq!(result, planar("fk", typed), "both commands give both");
        assert_eq!(result["joints"], json!(["j1", "j2", "j3", "j4"]));
        let angles: Vec<f64> = q
            .iter()
            .scan(0.0, |sum, q| {
                *sum += q;
                Some(*sum)
            })
            .collect();
        let position = numbers(&result["position"]);
        assert!((position[0] - angles.iter().map(|a| a.cos()).sum::<f64>()).abs() < 1e-12);
        assert!((position[1] - angles.iter().map(|a| a.sin()).sum::<f64>()).abs() < 1e-12);
        let rotation: Vec<Vec<f64>> = result["rotation"].as_array().unwrap().iter().map(numbers).collect();
        assert_eq!((rotation.len(), rotation[0].len()), (3, 3));
        assert!((rotation[1][0] - angles[3].sin()).abs() < 1e-12, "rows, not columns");
        let jacobian: Vec<Vec<f64>> = result["jacobian"].as_array().unwrap().iter().map(numbers).collect();
        assert_eq!((jacobian.len(), jacobian[0].len()), (6, 4));
        assert!((jacobian[0][0] + position[1]).abs() < 1e-12 && (jacobian[1][0] - position[0]).abs() < 1e-12);
        assert_eq!(jacobian[5], [1.0; 4]);
    }
}

#[test]
fn what_does_not_fit_the_chain_says_what_would() {
    let fk = |robot: &str, base: &str, tip: &str, q: &str| {
        kinstep(&["robot", "fk", robot, "--base", base, "--tip", tip, "--q", q, "--json"])
    };
    for (run, code, said) in [
        (fk("planar4", "base", "tip", "1,2,3"), 2, "expected 4 (j1, j2, j3, j4), got 3"),
        (fk("planar4", "base", "tip", "1,2,3,x"), 2, "'x' is not known"),
        (fk("planar4", "base", "tip", "1,2,3,nan"), 2, "'nan' is not known"),
        (fk("planar4", "base", "tp", "1,2,3,4"), 3, "did you mean `tip`?"),
        (fk("planar4", "bsae", "tip", "1,2,3,4"), 3, "did you mean `base`?"),
        (fk("planar4", "tip", "tip", "1,2,3,4"), 3, "base and tip are both"),
        (fk("planar5", "base", "tip", "1,2,3,4"), 2, "did you mean planar4?"),
    ] {
        let error = run.expect(code).error();
        assert!(error["message"].as_str().unwrap().contains(said), "{said}: {error}");
    }
}

#[test]
fn links_that_nothing_moves_between_have_a_pose_and_can_not_follow_a_path() {
    let fixed = ["--base", "panda_link7", "--tip", "panda_hand"];
    let pose = kinstep(&[&["robot", "fk", "panda", "--json"], &fixed[..]].concat()).expect(0).json();
    assert_eq!(numbers(&pose["position"]), [0.0, 0.0, 0.107]);
    let jacobian = kinstep(&[&["robot", "jacobian", "panda"], &fixed[..]].concat()).expect(0);
    assert!(jacobian.out.contains("0.107000000"), "{}", jacobian.out);
    let set = ["arm.left.base=panda_link7", "arm.left.tip=panda_hand"].map(|set| format!("--set={set}"));
    let error = kinstep(&["plan", "--json", &set[0], &set[1]]).expect(3).error();
    assert!(error["message"].as_str().unwrap().contains("nothing moves between"), "{error}");
}

#[test]
fn the_robots_are_listed_shown_and_sound() {
    let list = kinstep(&["robot", "list", "--json"]).expect(0).json();
    let robots = list["robots"].as_array().unwrap();
    assert!(robots.len() >= 5);
    for robot in robots {
        let name = robot["name"].as_str().unwrap();
        let card = kinstep(&["robot", "show", name, "--json"]).expect(0).json();
        assert_eq!(card["links"].as_array().unwrap().len() as u64, robot["links"].as_u64().unwrap());
        let check = kinstep(&["robot", "check", name, "--json"]).expect(0).json();
        assert_eq!((&check["ok"], &check["links"]), (&json!(true), &robot["links"]));
        assert_eq!(check["joints"].as_array().unwrap().len(), card["joints"].as_array().unwrap().len());
        assert!(kinstep(&["robot", "show", name]).expect(0).out.contains("lower"));
    }
}

const ODD: &str = r#"<robot name="odd">
  <link name="base"/>
  <link name="arm"/>
  <joint name="turn" type="revolute">
    <parent link="base"/>
    <child link="arm"/>
    <axis xyz="0 0 2"/>
    <limit lower="1" upper="-1" velocity="1" effort="1"/>
  </joint>
</robot>
"#;

#[test]
fn a_check_lists_every_problem_with_its_place_and_errors_are_exit_3() {
    let desk = Desk::new(&[
        ("odd.urdf", ODD),
        ("even.urdf", &ODD.replace("lower=\"1\" upper=\"-1\"", "lower=\"-1\" upper=\"1\"")),
    ]);
    let check = desk.run(&["robot", "check", "odd.urdf", "--json"]).expect(3).json();
    assert_eq!(check["ok"], false);
    let problems = check["problems"].as_array().unwrap();
    assert!(problems.iter().any(|p| p["severity"] == "error" && p["line"] == 8), "{check}");
    assert!(problems.iter().all(|p| p["column"].is_u64() && p["message"].is_string()));
    let text = desk.run(&["robot", "check", "odd.urdf"]).expect(3).out;
    assert!(text.contains("odd.urdf:8:") && text.contains("defective"), "{text}");

    let check = desk.run(&["robot", "check", "even.urdf", "--json"]).expect(0).json();
    assert_eq!(check["ok"], true);
    assert!(
        check["problems"].as_array().unwrap().iter().any(|p| p["severity"] != "error"),
        "the long axis is noted: {check}"
    );
    let error = desk
        .run(&["robot", "fk", "odd.urdf", "--base", "base", "--tip", "arm", "--q", "0", "--json"])
        .expect(3)
        .error();
    assert!(error["message"].as_str().unwrap().contains("turn"), "{error}");
}

#[test]
fn a_file_that_is_no_robot_is_exit_3_with_its_place() {
    let desk =
        Desk::new(&[("text.urdf", "not a robot"), ("empty.urdf", ""), ("sdf.urdf", "<sdf version='1.9'/>")]);
    for name in ["text.urdf", "empty.urdf", "sdf.urdf"] {
        let check = desk.run(&["robot", "check", name, "--json"]).expect(3).json();
        assert_eq!((&check["ok"], &check["links"], &check["joints"]), (&json!(false), &json!(0), &json!([])));
        let error = desk.run(&["robot", "show", name, "--json"]).expect(3).error();
        assert_eq!((&error["file"], &error["line"]), (&json!(name), &json!(1)));
        assert!(desk.run(&["robot", "show", name]).expect(3).err.starts_with(&format!("{name}:1:")));
    }
}

#[test]
fn limits_may_be_assumed_away_and_strictness_asked_for() {
    let bare = ODD.replace("    <limit lower=\"1\" upper=\"-1\" velocity=\"1\" effort=\"1\"/>\n", "");
    let vendor = ODD.replace("lower=\"1\" upper=\"-1\"", "lower=\"-1\" upper=\"1\" colour=\"red\"");
    let desk = Desk::new(&[("bare.urdf", &bare), ("vendor.urdf", &vendor)]);
    desk.run(&["robot", "check", "bare.urdf"]).expect(3);
    desk.run(&["robot", "check", "bare.urdf", "--assume-unlimited"]).expect(0);
    desk.run(&["robot", "check", "vendor.urdf"]).expect(0);
    desk.run(&["robot", "check", "vendor.urdf", "--strict"]).expect(3);
}

#[test]
fn a_pose_that_is_no_number_is_refused_rather_than_written_as_null() {
    let urdf = r#"<robot name="far"><link name="base"/><link name="a"/><link name="tip"/>
<joint name="one" type="prismatic"><parent link="base"/><child link="a"/><axis xyz="1 0 0"/>
<limit lower="-1e308" upper="1e308" effort="1" velocity="1"/></joint>
<joint name="two" type="prismatic"><parent link="a"/><child link="tip"/><axis xyz="1 0 0"/>
<limit lower="-1e308" upper="1e308" effort="1" velocity="1"/></joint></robot>"#;
    let desk = Desk::new(&[("far.urdf", urdf)]);
    for command in ["fk", "jacobian"] {
        let arguments =
            |q| ["robot", command, "far.urdf", "--base", "base", "--tip", "tip", "--q", q, "--json"];
        let error = desk.run(&arguments("1e308,1e308")).expect(3).error();
        assert!(error["message"].as_str().unwrap().contains("too large"), "{error}");
        desk.run(&arguments("1e300,1")).expect(0);
    }
}
