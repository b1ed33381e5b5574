//! `kinstep robot`, run.

#![allow(clippy::unwrap_used, reason = "a test that can not go on stops")]

use crate::program::{Desk, SMALL, kinstep};
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
        (fk("planar4", "base", "tip", "1,2,3"), 2, "expected 4 positions (j1, j2, j3, j4), got 3"),
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

const HAND: [&str; 5] = ["panda", "--base", "panda_link0", "--tip", "panda_hand_tcp"];

#[test]
fn joint_positions_for_a_pose_lead_to_that_pose() {
    let place = ["--position", "0.5, 0.1, 0.3"];
    let typed = [&["robot", "ik", "--json", "--orientation", "pi,0,pi/2"], &HAND[..], &place].concat();
    let answer = kinstep(&typed).expect(0).json();
    assert_eq!((&answer["found"], answer["q"].as_array().unwrap().len()), (&json!(true), 7));
    let q: Vec<String> = numbers(&answer["q"]).iter().map(f64::to_string).collect();
    let pose =
        kinstep(&[&["robot", "fk", "--json", "--q", &q.join(",")], &HAND[..]].concat()).expect(0).json();
    assert_eq!((&pose["position"], &pose["rotation"]), (&answer["position"], &answer["rotation"]));
    for (got, wanted) in numbers(&pose["position"]).iter().zip([0.5, 0.1, 0.3]) {
        assert!((got - wanted).abs() < 1e-12);
    }
    // The same turn as a quaternion: about x by pi, then about z by pi/2.
    let half = std::f64::consts::FRAC_1_SQRT_2.to_string();
    let quaternion = format!("{half},{half},0,0");
    let by = |orientation: &str| {
        let typed = [&["robot", "ik", "--json", "--orientation", orientation], &HAND[..], &place].concat();
        numbers(&kinstep(&typed).expect(0).json()["q"])
    };
    for (one, other) in by("pi,0,pi/2").iter().zip(by(&quaternion)) {
        assert!((one - other).abs() < 1e-6);
    }
}

#[test]
fn a_zero_is_printed_as_a_zero_and_kept_in_full_for_programs() {
    let typed = [
        "robot",
        "ik",
        "iiwa14",
        "--base",
        "iiwa_link_0",
        "--tip",
        "iiwa_link_ee",
        "--position",
        "0.5,0,0.5",
    ];
    let text = kinstep(&typed).expect(0).out;
    let (_, q) = text.split_once("--q=").unwrap();
    let is_plain =
        |number: &str| number.trim() == "0" || number.trim().parse::<f64>().unwrap().abs() >= 1e-16;
    assert!(q.split(',').all(is_plain) && !text.contains("-0.000000000 "), "{text}");
    // The last joint does not move the tip, and is where the search happened to leave it.
    let document = kinstep(&[&typed[..], &["--json"]].concat()).expect(0).json();
    let last = document["q"][6].as_f64().unwrap();
    assert!(last.abs() < 1e-16 && q.trim().ends_with(",0"), "{last:e} {text}");
}

#[test]
fn a_place_out_of_reach_is_answered_with_the_nearest_one() {
    let typed = ["robot", "ik", "planar4", "--base", "base", "--tip", "tip", "--position", "4.8,6.4"];
    let answer = kinstep(&[&typed[..], &["--json"]].concat()).expect(5).json();
    assert_eq!(answer["found"], json!(false));
    assert!((answer["distance"].as_f64().unwrap() - 4.0).abs() < 1e-9, "{answer}");
    let text = kinstep(&typed).expect(5).out;
    assert!(text.starts_with("Not reached within the limits") && text.contains("(2.4000, 3.2000"), "{text}");
}

#[test]
fn a_target_that_is_none_says_what_would_be() {
    let ik = |more: &[&str]| kinstep(&[&["robot", "ik", "--json"], &HAND[..], more].concat());
    let at = ["--position", "0.5,0,0.3"];
    for (more, said) in [
        (&["--position", "0.5"][..], "expected three numbers"),
        (&["--position", "1e9,0,0"], "beyond any arm"),
        (&["--position", "0.5,x,0"], "'x' is not known"),
        (&["--position", "0.5,0", "--axis", "0,0,1"], "expected three numbers"),
        (&[&at[..], &["--axis", "0,0,0"]].concat(), "points nowhere"),
        (&[&at[..], &["--axis", "1,0"]].concat(), "expected three numbers, got 2"),
        (&[&at[..], &["--orientation", "0,0,0,2"]].concat(), "its length is not 1"),
        (&[&at[..], &["--orientation", "0,0"]].concat(), "roll, pitch, yaw"),
        (&[&at[..], &["--q0", "0,0"]].concat(), "got 2"),
    ] {
        let error = ik(more).expect(2).error();
        assert!(error["message"].as_str().unwrap().contains(said), "{more:?}: {error}");
    }
    ik(&[&at[..], &["--axis", "0,0,-1", "--q0", "0,0,0,-1.5,0,1.8,0"]].concat()).expect(0);
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

#[test]
fn lengths_beyond_any_arm_are_refused_wherever_they_are_given() {
    let urdf = include_str!("../../../../tests/bad_input/urdf/origin_beyond_any_arm.urdf");
    let desk = Desk::new(&[("far.urdf", urdf)]);
    let refused =
        desk.run(&["robot", "fk", "far.urdf", "--base", "a", "--tip", "b", "--q", "0"]).expect(3).err;
    assert!(refused.contains("`xyz` of `<origin>`: 1e154 is beyond any arm; lengths [m]"), "{refused}");
    let with = |option: &str, value: &str| {
        let arguments =
            ["robot", "fk", "planar4", "--base", "base", "--tip", "tip", "--q", "0,0,0,0", option, value];
        desk.run(&arguments)
    };
    assert!(with("--tool", "1e154 0 0 0 0 0").expect(2).err.contains("--tool: 1e154 is beyond any arm"));
    assert!(with("--tool", "0 0 0 0 0 1e7").expect(2).err.contains("--tool: 1e7 is beyond any arm"));
    with("--tool", "1e6 0 0 0 0 0").expect(0);
    assert!(
        with("--lock", "j1=1e7")
            .expect(3)
            .err
            .contains("`j1` can not be locked there: 1e7 is beyond any arm")
    );
    let desk = Desk::new(&[("mobile.urdf", MOBILE)]);
    let arguments = ["robot", "check", "mobile.urdf", "--lock", "float=1e154 0 0 0 0 0"];
    assert!(desk.run(&arguments).expect(3).err.contains("beyond any arm"));
}

/// A mobile arm: a floating base, two joints, and elements that kinematics ignores.
const MOBILE: &str = r#"<robot name="mobile">
  <link name="world"/><link name="base"/><link name="arm"/><link name="left"/><link name="right"/>
  <joint name="float" type="floating"><parent link="world"/><child link="base"/></joint>
  <joint name="turn" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 0 1"/>
    <limit lower="0.5" upper="1.5" effort="1" velocity="1"/></joint>
  <joint name="grip" type="prismatic"><parent link="arm"/><child link="left"/><origin xyz="1 0 0"/><axis xyz="0 1 0"/>
    <limit lower="0" upper="0.1" effort="1" velocity="1"/></joint>
  <joint name="follow" type="prismatic"><parent link="arm"/><child link="right"/><origin xyz="1 0 0"/>
    <axis xyz="0 -1 0"/><limit lower="0" upper="0.1" effort="1" velocity="1"/><mimic joint="grip"/></joint>
  <transmission name="t"/><gazebo/>
</robot>
"#;

#[test]
fn a_robot_is_shown_as_a_tree_with_its_chains_and_a_command_that_works() {
    let desk = Desk::new(&[("mobile.urdf", MOBILE)]);
    let text = desk.run(&["robot", "show", "mobile.urdf"]).expect(0).out;
    let expected = "\
mobile: 5 links, 4 joints that move (1 of them by following another), 0 fixed

link     joint   type                     lower  upper  velocity
world
base     float   floating                 -      -      -
arm      turn    revolute                 0.5    1.5    1
├ left   grip    prismatic                0      0.1    1
└ right  follow  prismatic, follows grip  0      0.1    1
";
    let plain = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(plain(&text).starts_with(&plain(expected)), "{text}");
    assert!(plain(&text).contains("base left 2 1.1 turn, grip base right 2 1.1 turn, grip"), "{text}");
    assert!(text.contains("held still: --lock float=0"), "{text}");
    let command = text.lines().find(|line| line.starts_with("  kinstep ")).unwrap();
    let words: Vec<&str> = command.split_whitespace().skip(1).collect();
    desk.run(&words).expect(0);
    let card = desk.run(&["robot", "show", "mobile.urdf", "--json"]).expect(0).json();
    assert_eq!(card["chains"][0]["joints"], json!(["turn", "grip"]));
    assert_eq!((&card["chains"][0]["base"], &card["chains"][0]["dof"]), (&json!("base"), &json!(2)));
}

#[test]
fn names_and_paths_give_no_orders_to_a_terminal() {
    let urdf =
        MOBILE.replace("left", "le\u{9b}31mft&#10;x").replace("name=\"float\"", "name=\"fl\u{9b}oat\"");
    let desk = Desk::new(&[("odd.urdf", &urdf)]);
    let obeyed = |c: char| c.is_control() && c != '\n';
    let shown = desk.run(&["robot", "show", "odd.urdf"]).expect(0).out;
    assert!(shown.contains(r"├ le\u{9b}31mft\nx  grip") && !shown.contains(obeyed), "{shown}");
    assert!(shown.contains(r"--lock $'fl\u009boat=0'"), "{shown}");
    let [command] = &suggested(&shown)[..] else { panic!("one command: {shown}") };
    assert!(command.contains(r"--tip $'le\u009b31mft\x0ax'"), "{command}");
    let tip = "le\u{9b}31mft\nx";
    let pose =
        desk.run(&["robot", "fk", "odd.urdf", "--base", "base", "--tip", tip, "--q", "1,0"]).expect(0).out;
    assert!(pose.starts_with(r"le\u{9b}31mft\nx in base"), "{pose}");
    let short =
        desk.run(&["robot", "fk", "odd.urdf", "--base", "base", "--tip", tip, "--q", "1"]).expect(2).err;
    assert!(!short.contains(obeyed), "{short}");
    let missing = desk.run(&["robot", "show", "a\u{1b}[31m\nb.urdf"]).expect(6).err;
    assert!(
        missing.starts_with(r"error: a\u{1b}[31m\nb.urdf: there is no such file")
            && !missing.contains(obeyed),
        "{missing}"
    );
}

#[test]
fn a_file_that_is_not_there_says_where_it_was_looked_for_and_what_is() {
    let desk = Desk::new(&[("mobile.urdf", MOBILE), ("mine.toml", "[joint.turn]\nzero = 0.1\n")]);
    let missing = |arguments: &[&str]| desk.run(arguments).expect(6).err;
    let robot = missing(&["robot", "show", "mobil.urdf"]);
    assert!(robot.contains("mobil.urdf: there is no such file (looked up from /"), "{robot}");
    assert!(robot.ends_with("); did you mean `mobile.urdf`?\n"), "{robot}");
    let elsewhere = missing(&["robot", "show", "robots/mobile.urdf"]);
    assert!(elsewhere.ends_with("); there is no folder `robots`\n"), "{elsewhere}");
    let calibration = missing(&["robot", "show", "mobile.urdf", "--calibration", "mime.toml"]);
    assert!(calibration.contains("did you mean `mine.toml`?"), "{calibration}");
    assert!(!missing(&["robot", "show", "zzzzzzzz.urdf"]).contains("did you mean"));
    std::fs::create_dir(desk.path("plans")).unwrap();
    std::fs::write(desk.path("plans/s.toml"), SMALL.replace("planar4", "mobil.urdf")).unwrap();
    let scenario = missing(&["plan", "plans/s.toml"]);
    assert!(
        scenario.contains("beside the scenario (plans/mobil.urdf) or in the working directory (mobil.urdf)"),
        "{scenario}"
    );
    assert!(scenario.contains("did you mean `mobile.urdf`?"), "{scenario}");
}

#[test]
fn options_that_can_not_be_meant_say_why() {
    let desk = Desk::new(&[("mobile.urdf", MOBILE), ("taken", "")]);
    let refused =
        |arguments: &[&str], code: i32| desk.run(&[&["robot"], arguments].concat()).expect(code).err;
    let ik = |option: &str| {
        refused(&["ik", "planar4", "--base", "base", "--tip", "tip", "--position", "1,1", option], 2)
    };
    assert!(ik("--starts=0").contains("--starts <STARTS>': give a whole number, at least 1"));
    assert!(ik("--starts=1.5").contains("a whole number"));
    assert!(ik("--seed=-1").contains("give a whole number between 0 and 18446744073709551615"));
    let spaced = ["ik", "planar4", "--base", "base", "--tip", "tip", "--position", "1,1", "--starts", "-1"];
    let spaced = refused(&spaced, 2);
    assert!(spaced.contains("at least 1") && !spaced.contains("tip:"), "{spaced}");
    for q in ["turn=1,turn=0", "grip=0.1,0.2"] {
        let twice = refused(&["show", "mobile.urdf", "--plot", "p", "--q", q], 2);
        assert!(
            twice.contains("`turn` is given twice") || twice.contains("`grip` is given twice"),
            "{twice}"
        );
    }
    let file = refused(&["show", "planar4", "--plot", "taken", "--force"], 6);
    assert!(file.contains("taken: this is a file; --plot names a folder"), "{file}");
    let picture = refused(&["show", "planar4", "--plot", "pp.png"], 2);
    assert!(
        picture
            .contains("--plot pp.png: pictures are drawn as SVG; name a folder, or a file that ends in .svg")
    );
    assert!(!desk.path("pp.png").exists() && !desk.path("p").exists());
}

/// A long arm with a link to the side at every link: half of the links are tips.
fn comb(teeth: usize) -> String {
    let link = |name: String, parent: usize| {
        format!(
            "<link name=\"{name}\"/><joint name=\"to_{name}\" type=\"continuous\"><parent link=\"l{parent}\"/>\
             <child link=\"{name}\"/></joint>"
        )
    };
    let tooth = |i: usize| link(format!("l{i}"), i - 1) + &link(format!("side{i}"), i - 1);
    let teeth: String = (1..=teeth).map(tooth).collect();
    format!("<robot name=\"comb\"><link name=\"l0\"/>{teeth}</robot>")
}

#[test]
fn a_large_tree_is_shown_in_a_text_of_its_own_order() {
    let desk = Desk::new(&[("short.urdf", &comb(2_000)), ("long.urdf", &comb(4_000))]);
    let begun = std::time::Instant::now();
    let [short, long] =
        ["short.urdf", "long.urdf"].map(|file| desk.run(&["robot", "show", file]).expect(0).out);
    assert!(long.len() < 5 * short.len() / 2, "{} and {} bytes", short.len(), long.len());
    assert!(long.lines().all(|line| line.chars().count() < 160));
    assert!(begun.elapsed().as_secs() < 20);
    assert!(
        long.contains(
            "\nand 3951 more; one of them: kinstep robot jacobian long.urdf --base LINK --tip LINK\n"
        ),
        "{long}"
    );
    // Beyond the bound a branch says what it is on.
    assert!(long.contains("… side1000 (on l999)") && !long.contains("side1 (on"), "{long}");
    let card = desk.run(&["robot", "show", "short.urdf", "--json"]).expect(0).json();
    assert_eq!((card["chains"].as_array().unwrap().len(), &card["more_chains"]), (50, &json!(1951)));
    assert_eq!(desk.run(&["robot", "show", "panda", "--json"]).expect(0).json()["more_chains"], 0);
}

/// The commands that a text suggests.
fn suggested(text: &str) -> Vec<String> {
    let command = |line: &str| line.strip_prefix("  kinstep ").map(|rest| format!("kinstep {rest}"));
    text.lines().filter_map(command).collect()
}

#[cfg(unix)]
#[test]
fn suggested_commands_do_what_was_asked_before() {
    // Odd names, a joint without a limit, and one that stands still only because it is asked to.
    let urdf = MOBILE
        .replace("base", "the base")
        .replace("left", "it's left")
        .replace("name=\"float\"", "name=\"the float\"")
        .replace("<limit lower=\"0.5\" upper=\"1.5\" effort=\"1\" velocity=\"1\"/>", "");
    let desk = Desk::new(&[("my robot.urdf", &urdf), ("my own.toml", "[joint.turn]\nxyz = [0, 0, 0.5]\n")]);
    let asked = [
        "my robot.urdf",
        "--assume-unlimited",
        "--lock",
        "the float=0 0 1 0 0 0",
        "--calibration",
        "my own.toml",
    ];
    let text = desk.run(&[&["robot", "show"][..], &asked].concat()).expect(0).out;
    let [command] = &suggested(&text)[..] else { panic!("one command: {text}") };
    assert!(command.contains("--base world") && command.contains(r"--tip 'it'\''s left'"), "{command}");
    desk.shell(command).expect(0);
    // Without what was asked for, the chain is another one: nothing passes the joint without a limit.
    desk.shell(&command.replace("--assume-unlimited", "")).expect(3);
    desk.shell(&command.replace("--lock 'the float=0 0 1 0 0 0'", "")).expect(3);

    let chain =
        ["--base", "world", "--tip", "it's left", "--tool", "0 0 0.1 0 0 0", "--position=0.8,0.603,1.6"];
    let answer = desk.run(&[&["robot", "ik"][..], &asked, &chain].concat()).expect(0).out;
    let [command] = &suggested(&answer)[..] else { panic!("one command: {answer}") };
    let pose = desk.shell(&format!("{command} --json")).expect(0).json();
    for (found, wanted) in pose["position"].as_array().unwrap().iter().zip([0.8, 0.603, 1.6]) {
        assert!((found.as_f64().unwrap() - wanted).abs() < 1e-6, "{pose}");
    }

    let free = desk.run(&["robot", "show", "my robot.urdf", "--assume-unlimited"]).expect(0).out;
    assert!(free.contains("unless it is held still: --lock 'the float=0'"), "{free}");
}

#[cfg(unix)]
#[test]
fn what_to_try_after_a_plan_can_be_typed_as_it_stands() {
    let desk = Desk::new(&[]);
    std::fs::create_dir(desk.path("sp ace")).unwrap();
    std::fs::write(desk.path("sp ace/x.toml"), SMALL).unwrap();
    let text =
        desk.run(&["plan", "sp ace/x.toml", "--set", "law.gain=8", "--out", "my results"]).expect(0).out;
    let commands = suggested(&text);
    assert!(
        commands
            .iter()
            .any(|command| command.starts_with("kinstep plan 'sp ace/x.toml' --set law.gain=8 --set")),
        "{text}"
    );
    for command in commands {
        desk.shell(&command).expect(0);
    }
}

#[test]
fn a_joint_without_limits_moves_when_a_scenario_asks_for_it() {
    let urdf = r#"<robot name="loose"><link name="base"/><link name="a"/><link name="tip"/>
<joint name="j1" type="revolute"><parent link="base"/><child link="a"/><axis xyz="0 0 1"/></joint>
<joint name="j2" type="continuous"><parent link="a"/><child link="tip"/><origin xyz="1 0 0"/><axis xyz="0 0 1"/></joint></robot>"#;
    let scenario = SMALL.replace("planar4", "loose.urdf").replace("0.3, 0.3, 0.3]", "0.3]");
    let scenario = scenario.replace("tip = \"tip\"", "tip = \"tip\"\ntool = { xyz = [1, 0, 0] }");
    let desk = Desk::new(&[("loose.urdf", urdf), ("s.toml", &scenario)]);
    let refused = desk.run(&["plan", "s.toml"]).expect(3).err;
    assert!(
        refused.contains("no `<limit>`") && refused.contains("in a scenario `assume_unlimited = true`"),
        "{refused}"
    );
    desk.run(&["plan", "s.toml", "--set", "arm.left.assume_unlimited=true", "--out", "results"]).expect(0);
    let written = std::fs::read_to_string(desk.path("results/scenario.toml")).unwrap();
    assert!(written.contains("assume_unlimited = true"), "{written}");
    desk.run(&["plan", "results/scenario.toml"]).expect(0);
}

/// Three joints of which each follows the one before it.
const FOLLOWING: &str = r#"<robot name="mc"><link name="a"/><link name="b"/><link name="c"/><link name="d"/>
<joint name="j1" type="revolute"><parent link="a"/><child link="b"/><axis xyz="0 0 1"/>
  <limit lower="-2" upper="2" effort="1" velocity="1"/></joint>
<joint name="j2" type="revolute"><parent link="b"/><child link="c"/><axis xyz="0 0 1"/>
  <limit lower="-2" upper="2" effort="1" velocity="1"/><mimic joint="j1"/></joint>
<joint name="j3" type="revolute"><parent link="c"/><child link="d"/><axis xyz="0 0 1"/>
  <limit lower="-2" upper="2" effort="1" velocity="1"/><mimic joint="j2"/></joint></robot>"#;

#[test]
fn a_joint_stands_still_with_the_locked_one_that_it_follows() {
    let desk = Desk::new(&[("mc.urdf", FOLLOWING), ("mine.toml", "[joint.j2]\nreversed = true\n")]);
    let fk = |extra: &[&str]| {
        let chain = ["robot", "fk", "mc.urdf", "--base", "c", "--tip", "d", "--json"];
        desk.run(&[&chain, extra].concat())
    };
    let held = fk(&["--lock", "j2=0.4"]).expect(0);
    let pose = held.json();
    assert_eq!(pose["joints"], json!([]));
    assert!((pose["rotation"][1][0].as_f64().unwrap() - 0.4_f64.sin()).abs() < 1e-15, "{pose}");
    assert_eq!(held.err, "note: joint `j2` is locked and follows `j1` no longer; `j1` moves without it\n");
    assert_eq!(fk(&["--lock", "j1=0.4"]).expect(0).err, "", "a joint that follows none leaves none alone");
    fk(&["--lock", "j2=0.4", "--q", "0.1"]).expect(2);
    // A correction of the one in the middle reaches the last too.
    let reversed = fk(&["--calibration", "mine.toml", "--q", "0.3"]).expect(0).json();
    assert!((reversed["rotation"][1][0].as_f64().unwrap() + 0.3_f64.sin()).abs() < 1e-15, "{reversed}");
}

#[test]
fn what_was_ignored_is_said_when_asked() {
    let desk = Desk::new(&[("mobile.urdf", MOBILE)]);
    assert_eq!(desk.run(&["robot", "show", "mobile.urdf"]).expect(0).err, "");
    for command in
        [&["robot", "show", "mobile.urdf", "-v"][..], &["robot", "export", "mobile.urdf", "--verbose"]]
    {
        let err = desk.run(command).expect(0).err;
        assert!(err.contains("mobile.urdf:10:3: note: ignored"), "{err}");
        assert!(err.contains("`<transmission>` (1), `<gazebo>` (1)"), "{err}");
    }
}

#[test]
fn joints_are_locked_calibrated_and_tooled_on_the_command_line() {
    let calibration = "[joint.turn]\nzero = 0.25\nxyz = [0, 0, 0.5]\n";
    let desk = Desk::new(&[("mobile.urdf", MOBILE), ("mine.toml", calibration)]);
    let fk = |more: &[&str]| {
        let asked = ["robot", "fk", "mobile.urdf", "--base", "world", "--tip", "arm", "--json"];
        desk.run(&[&asked[..], more].concat())
    };
    let error = fk(&["--q", "1"]).expect(3).error();
    assert!(error["message"].as_str().unwrap().contains("hold the joint still with --lock"), "{error}");
    let position = |more: &[&str]| numbers(&fk(more).expect(0).json()["position"]);
    assert_eq!(position(&["--q", "1", "--lock", "float=0"]), [0.0, 0.0, 0.0]);
    assert_eq!(position(&["--q", "1", "--lock", "float=1 2 3 0 0 pi/2"]), [1.0, 2.0, 3.0]);
    let tool = ["--tool", "1 0 0 0 0 0"];
    let moved =
        position(&[&["--q", "1", "--lock", "float=0", "--calibration", "mine.toml"][..], &tool].concat());
    let expected = [1.25_f64.cos(), 1.25_f64.sin(), 0.5];
    assert!(moved.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-15), "{moved:?}");
    let still = position(&[&["--lock", "turn=1", "--lock", "float=0"][..], &tool].concat());
    assert!((still[0] - 1.0_f64.cos()).abs() < 1e-15, "{still:?}");
    for (arguments, code, said) in [
        (&["--lock", "float"][..], 2, "write JOINT=VALUE"),
        (&["--lock", "float=x"], 2, "'x' is not known"),
        (&["--lock", "flota=0"], 3, "did you mean `float`?"),
        (&["--lock", "turn=2"], 3, "it moves between 0.5 and 1.5"),
        (
            &["--lock", "float=0", "--q", "1", "--tool", "1 2 3"],
            2,
            "expected 6 numbers x y z roll pitch yaw, got 3",
        ),
        (&["--calibration", "nowhere.toml"], 6, "there is no such file"),
        (&["--calibration", "mobile.urdf"], 3, "not TOML"),
    ] {
        let error = fk(arguments).expect(code).error();
        assert!(error["message"].as_str().unwrap().contains(said), "{said}: {error}");
    }
}

#[test]
fn a_robot_written_as_urdf_is_the_same_robot() {
    let desk = Desk::new(&[("arm.toml", "planar = [1.0, 0.5]\nname = \"two\"\n"), ("mobile.urdf", MOBILE)]);
    desk.run(&["robot", "export", "arm.toml", "--urdf", "arm.urdf"]).expect(0);
    desk.run(&["robot", "export", "arm.toml", "--urdf", "arm.urdf"]).expect(6);
    desk.run(&["robot", "export", "arm.toml", "--urdf", "arm.urdf", "--force"]).expect(0);
    let taken = desk.run(&["robot", "export", "arm.toml", "--urdf", "arm.urdf"]).expect(6).err;
    assert!(taken.contains("or name another place") && !taken.contains("folder"), "{taken}");
    std::fs::create_dir(desk.path("folder")).unwrap();
    for force in [&[][..], &["--force"]] {
        let arguments = ["robot", "export", "arm.toml", "--urdf", "folder"];
        let refused = desk.run(&[&arguments, force].concat()).expect(6).err;
        assert_eq!(refused, "error: folder is a folder; name a file\n");
    }
    assert_eq!(desk.names("folder"), Vec::<String>::new());
    let text = desk.run(&["robot", "export", "arm.toml"]).expect(0).out;
    assert_eq!(std::fs::read_to_string(desk.path("arm.urdf")).unwrap(), text);
    assert_eq!(desk.run(&["robot", "export", "arm.toml", "--json"]).expect(0).json()["urdf"], json!(text));
    desk.run(&["robot", "check", "arm.urdf"]).expect(0);
    let fk = |file| {
        let asked = ["robot", "fk", file, "--base", "base", "--tip", "tip", "--q", "0.3,-1", "--json"];
        desk.run(&asked).expect(0).json()
    };
    assert_eq!(fk("arm.toml"), fk("arm.urdf"));
    let locked = desk
        .run(&["robot", "export", "mobile.urdf", "--lock", "float=0", "--lock", "grip=0.05"])
        .expect(0)
        .out;
    assert!(!locked.contains("floating") && !locked.contains("prismatic"), "{locked}");
    std::fs::write(desk.path("wrong.urdf"), MOBILE.replace("0 0 1", "0 0 0")).unwrap();
    assert!(desk.run(&["robot", "export", "wrong.urdf"]).expect(3).err.contains("mend it first"));
}

#[test]
fn a_robot_is_drawn_on_a_page_or_into_a_folder() {
    let desk = Desk::new(&[("mobile.urdf", MOBILE)]);
    let plot = |more: &[&str]| desk.run(&[&["robot", "show", "mobile.urdf"][..], more].concat());
    plot(&["--plot", "page.svg", "--q", "turn=1"]).expect(0);
    plot(&["--plot", "page.svg"]).expect(6);
    plot(&["--plot", "page.svg", "--force", "--q=1,0.05"]).expect(0);
    let page = std::fs::read_to_string(desk.path("page.svg")).unwrap();
    assert!(page.contains("2  turn") && page.contains("1  float"), "joints are numbered and named");
    let numbers = std::fs::read_to_string(desk.path("page.csv")).unwrap();
    let left = format!(
        "top,3  grip,{:.9},{:.9}",
        1.0_f64.cos() - 0.05 * 1.0_f64.sin(),
        1.0_f64.sin() + 0.05 * 1.0_f64.cos()
    );
    let short = |text: &str| text.trim_end_matches('0').to_owned();
    assert!(numbers.lines().any(|line| line == short(&left)), "{left}:\n{numbers}");
    plot(&["--plot", "pictures"]).expect(0);
    assert_eq!(desk.names("pictures"), ["top.csv", "top.svg"], "a flat robot is drawn from above");
    for (q, said) in [
        ("1,2,3", "expected 2 (turn, grip), or some of them as NAME=VALUE, got 3"),
        ("trun=1", "did you mean turn?"),
        ("follow=1", "moves on its own"),
        ("turn=x", "'x' is not known"),
    ] {
        let error = plot(&["--plot", "other.svg", "--q", q, "--json"]).expect(2).error();
        assert!(error["message"].as_str().unwrap().contains(said), "{said}: {error}");
    }
}
