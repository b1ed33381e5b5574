//! Scenarios read, refused and written.

use super::*;

const SMALL: &str = r#"sigma = 0.01
duration = 10.0
formula = "la6-wang-guo"
start = "paper"

[law]
kind = "pseudoinverse"
h = 0.4

[[arm]]
name = "left"
robot = "planar4"
base = "base"
tip = "tip"
task = "position-xy"
q0 = ["9*pi/10", "-pi/10", -0.1, 0]
path = { kind = "tricuspid", radius = 0.4, rotation = "pi/2", time_law = "sin2" }

[[arm]]
name = "right"
robot = "planar4"
base = "base"
tip = "tip"
task = "position-xy"
q0 = [0.1, 0.2, 0.3, 0.4]
[arm.path]
kind = "line"
displacement = [0.1, 0]
"#;

fn read(text: &str) -> Result<Scenario, ScenarioError> {
    ScenarioText::parse(text).and_then(|text| text.scenario())
}

fn refused(text: &str) -> ScenarioError {
    read(text).expect_err("this scenario should be refused")
}

fn with(assignments: &[&str]) -> Result<Scenario, ScenarioError> {
    let mut text = ScenarioText::parse(SMALL)?;
    for assignment in assignments {
        text.set(assignment)?;
    }
    text.scenario()
}

fn place(error: &ScenarioError) -> (usize, usize) {
    let place = error.place.as_ref().expect("the error should have a place");
    (place.line, place.column)
}

#[test]
fn reads_numbers_and_expressions() {
    let scenario = read(SMALL).unwrap();
    assert_eq!(scenario.arm[0].q0[0].value(), 9.0 * std::f64::consts::PI / 10.0);
    assert_eq!(scenario.arm[0].q0[3].value(), 0.0);
    assert_eq!(scenario.arm[1].path.as_ref().unwrap().kind, "line");
    assert_eq!(scenario.start, Some(StarterKind::Paper));
    assert_eq!(scenario.arm[0].mount, Mount::default());
}

#[test]
fn what_is_written_reads_back_the_same() {
    let scenario = with(&[
        "arm.left.mount.xyz=[0.1,\"pi\",1e-300]",
        "arm.right.task=pose",
        "arm.right.path.displacement=[0,0.1,0]",
        "arm.right.path.turn={axis=[0,0,1], angle=\"pi/2\"}",
        "allow_unstable=true",
        "formulas=[\"mine.toml\"]",
    ])
    .unwrap();
    assert_eq!(read(&scenario.to_toml()).unwrap(), scenario);
}

#[test]
fn an_unknown_key_is_refused_with_the_nearest_and_its_place() {
    let error = refused(&SMALL.replace("radius = 0.4", "raduis = 0.4"));
    assert_eq!(error.message, "arm.left.path.raduis: there is no such key; did you mean radius?");
    assert_eq!(place(&error), (17, 30));
    let error = refused(&SMALL.replace("[law]\nkind", "[law]\ngian = 2\nkind"));
    assert_eq!(error.message, "law.gian: there is no such key; did you mean gain?");
    assert_eq!(place(&error), (7, 1));
}

#[test]
fn a_missing_key_is_named_at_its_table() {
    let error = refused(&SMALL.replacen("tip = \"tip\"\n", "", 1));
    assert_eq!(error.message, "arm.left.tip: this key is missing");
    assert_eq!(place(&error), (10, 1));
    assert_eq!(refused("duration = 1").message, "sigma: this key is missing");
}

#[test]
fn an_unknown_word_is_refused_with_the_list() {
    let error = refused(&SMALL.replace("\"tricuspid\"", "\"tricusp\""));
    assert!(
        error.message.starts_with("arm.left.path.kind: \"tricusp\" is not one of circle, tricuspid"),
        "{error}"
    );
    assert!(error.message.ends_with("did you mean tricuspid?"), "{error}");
    assert_eq!(place(&error), (17, 17));
}

#[test]
fn a_wrong_type_and_a_bad_expression_are_refused_where_they_stand() {
    let error = refused(&SMALL.replace("-0.1, 0]", "true, 0]"));
    assert!(
        error.message.starts_with("arm.left.q0[2]: invalid type: boolean `true`, expected a number"),
        "{error}"
    );
    let error = refused(&SMALL.replace("\"9*pi/10\"", "\"9*pie/10\""));
    assert_eq!(
        error.message,
        "arm.left.q0[0]: \"9*pie/10\", column 3: 'pie' is not known; known are pi and functions such as sin, atan2, sqrt, min"
    );
    assert_eq!(place(&error), (16, 7));
}

#[test]
fn a_parameter_of_another_kind_is_refused_with_the_kinds_own() {
    let error = refused(&SMALL.replace("displacement = [0.1, 0]", "displacement = [0.1, 0]\npetals = 3"));
    assert!(
        error
            .message
            .contains("arm.right.path.petals: a line has no such parameter; it has to, displacement"),
        "{error}"
    );
    assert_eq!(place(&error), (29, 10));
    let error = refused(&SMALL.replace("radius = 0.4, ", ""));
    assert_eq!(error.message, "arm.left.path.radius: a tricuspid needs this");
    assert_eq!(place(&error).0, 17);
}

#[test]
fn a_list_of_the_wrong_length_is_refused_rather_than_cut() {
    let error =
        refused(&SMALL.replace("robot = \"planar4\"", "mount = { xyz = [1, 2, 3, 4] }\nrobot = \"planar4\""));
    assert_eq!(error.message, "arm.left.mount.xyz: expected 3 numbers, got 4");
    assert_eq!(place(&error), (12, 17));
    let lissajous = "{ kind = \"lissajous\", amplitudes = [1], frequencies = [1, 2] }";
    let error = with(&[&format!("arm.left.path={lissajous}")]).unwrap_err();
    assert!(error.message.starts_with("arm.left.path.amplitudes: expected 2 numbers, got 1"), "{error}");
}

#[test]
fn the_sampling_gap_is_positive_finite_and_at_most_the_duration() {
    for bad in ["0", "0.0", "-0.01", "nan", "inf", "11", "1e-12", "\"1/0\"", "\"NaN\"", "true"] {
        let error = refused(&SMALL.replace("sigma = 0.01", &format!("sigma = {bad}")));
        assert!(error.message.starts_with("sigma: "), "{bad}: {error}");
        assert_eq!((error.kind, place(&error)), (ErrorKind::Scenario, (1, 9)), "{bad}: {error}");
        assert!(with(&[&format!("sigma={bad}")]).unwrap_err().message.contains("(--set sigma="), "{bad}");
    }
    assert!(read(&SMALL.replace("sigma = 0.01", "sigma = 10")).is_ok());
}

#[test]
fn both_h_and_gain_are_one_too_many_but_setting_one_replaces_the_other() {
    let error = refused(&SMALL.replace("h = 0.4", "h = 0.4\ngain = 20"));
    assert!(error.message.contains("give one of them"), "{error}");
    let scenario = with(&["law.gain=20"]).unwrap();
    assert_eq!((scenario.law.h, scenario.law.gain.unwrap().value()), (None, 20.0));
}

#[test]
fn two_arms_of_one_name_and_odd_names_are_refused() {
    assert!(refused(&SMALL.replace("\"right\"", "\"left\"")).message.contains("two arms"));
    assert!(refused(&SMALL.replace("\"right\"", "\"r.1\"")).message.contains("not a name"));
    assert!(refused(&SMALL.replace("\"right\"", "\"\"")).message.contains("not a name"));
}

#[test]
fn values_are_set_from_outside_by_the_names_of_arms() {
    let scenario =
        with(&["arm.left.q0=[0.1, \"pi/2\", 3, 4]", "formula=split-ab6", "arm.left.path.radius=pi/10"])
            .unwrap();
    assert_eq!(scenario.arm[0].q0[1].value(), std::f64::consts::PI / 2.0);
    assert_eq!(scenario.formula.as_deref(), Some("split-ab6"));
    assert_eq!(
        scenario.arm[0].path.as_ref().unwrap().parameters.number("radius"),
        Some(std::f64::consts::PI / 10.0)
    );
    assert_eq!(scenario.arm[1], read(SMALL).unwrap().arm[1]);
}

#[test]
fn what_can_not_be_set_says_why() {
    for (assignment, said) in [
        ("arm.lefft.q0=[1]", "did you mean left?"),
        ("arm.left.path.raduis=1", "did you mean radius?"),
        ("laww.h=1", "did you mean law?"),
        ("sigma", "write key.path=value"),
        ("=3", "is not a key path"),
        ("arm.left.name.x=3", "is a value"),
        ("arm.left=3", "name a key of arm.left"),
        ("arm.left.q0[9]=3", "the list has 4 entries"),
        ("arm.left.tip[0]=3", "there is no such list"),
        ("sigma.x=1", "is a value"),
    ] {
        let error = with(&[assignment]).unwrap_err();
        assert!(error.message.contains(said), "{assignment}: {error}");
        assert!(error.message.contains(&format!("--set {assignment}")), "{assignment}: {error}");
    }
}

#[test]
fn absurd_lengths_and_angles_are_refused_by_their_keys() {
    let turn = "arm.right.path.turn={axis=[0,0,1], angle=1e7}";
    let lissajous = |amplitudes: &str, frequencies: &str| {
        format!("arm.left.path={{kind='lissajous', amplitudes={amplitudes}, frequencies={frequencies}}}")
    };
    for (assignment, key) in [
        ("arm.left.path.radius=1e300", "arm.left.path.radius"),
        ("arm.left.path.rotation=-1e300", "arm.left.path.rotation"),
        ("arm.left.path.sweep=\"1e5*1e5\"", "arm.left.path.sweep"),
        ("arm.left.path.center=[0,1e7]", "arm.left.path.center[1]"),
        ("arm.left.mount.xyz=[0,0,1e300]", "arm.left.mount.xyz[2]"),
        ("arm.left.mount.rpy=[1e7,0,0]", "arm.left.mount.rpy[0]"),
        ("arm.left.q0=[0,0,0,-1e300]", "arm.left.q0[3]"),
        ("arm.right.path.displacement=[1e300,0]", "arm.right.path.displacement[0]"),
        ("law.threshold=1e300", "law.threshold"),
        (&lissajous("[1,1e9]", "[1,2]"), "arm.left.path.amplitudes[1]"),
        (&lissajous("[1,1]", "[1e9,2]"), "arm.left.path.frequencies[0]"),
    ] {
        let error = with(&[assignment]).unwrap_err();
        assert!(error.message.starts_with(&format!("{key}: ")), "{assignment}: {error}");
        assert!(error.message.contains("at most 1000000"), "{assignment}: {error}");
        assert!(error.message.len() < 250, "{assignment}: {error}");
    }
    let error = with(&["arm.right.task=pose", "arm.right.path.displacement=[0,0,0]", turn]).unwrap_err();
    assert!(error.message.starts_with("arm.right.path.turn.angle: 10000000 is beyond"), "{error}");
    assert!(with(&["arm.left.path.radius=1e6"]).is_ok());
}

#[test]
fn a_value_of_the_wrong_type_is_told_what_to_write_in_words() {
    for (assignment, said) in [
        ("law=3", "a table such as { h = 0.4 }"),
        ("arm.left.path=3", "a table such as { kind = \"circle\", radius = 0.1 }"),
        ("arm.left.mount=3", "a table such as { xyz = "),
        ("arm.left.mount=[0,0,0]", "expected a list"),
        ("arm.left.path.plane=[0,0,1]", "one of xy, yz, zx, yx, zy, xz"),
        ("arm.left.path.plane=3", "one of xy, yz, zx, yx, zy, xz"),
        ("arm.left.path.kind=3", "one of circle, tricuspid, astroid, line, lissajous, rose, fourier"),
        ("arm.left.path.time_law=[1]", "one of sin2, sin2sin2, linear, quintic, trapezoid, s-curve"),
        ("arm.left.task=1", "one of position-xy, position, pose"),
        ("start=1", "one of paper, ramp, rk4, rk8"),
        ("law.kind=1", "one of pseudoinverse"),
    ] {
        let error = with(&[assignment]).unwrap_err();
        assert!(error.message.contains(said), "{assignment}: {error}");
        assert!(
            !error.message.contains("struct") && !error.message.contains("enum"),
            "{assignment}: {error}"
        );
    }
}

fn planned(assignments: &[&str]) -> Result<kinstep::planner::Planner, ScenarioError> {
    // Two robots, six metres apart.
    let assignments = [&["arm.right.mount={xyz=[6,0,0]}"], assignments].concat();
    with(&assignments)?.planner(kinstep::formula::FormulaTable::builtin(), None)
}

fn tip_at(q: &[f64]) -> nalgebra::Vector3<f64> {
    let chain = kinstep::robot::embedded::get("planar4").unwrap().chain("base", "tip").unwrap();
    chain.forward(q, &mut chain.scratch()).position()
}

#[test]
fn a_start_pose_is_solved_for_near_q0() {
    let planner = planned(&["arm.left.start_pose={xyz=[1.5, \"pi/2\"]}"]).unwrap();
    let q = planner.arm(0).positions.to_vec();
    let tip = tip_at(&q);
    assert!((tip.x - 1.5).abs() < 1e-12 && (tip.y - std::f64::consts::FRAC_PI_2).abs() < 1e-12, "{tip}");
    let planner = planned(&["arm.left.start_pose={xyz=[1.5, 1.5]}", "arm.left.q0=[2, -1, -1, -1]"]).unwrap();
    let other = planner.arm(0).positions;
    assert!(q[1] * other[1] < 0.0 || (q[1] - other[1]).abs() > 0.1, "bent another way: {q:?} {other:?}");
    let plan = planner.run();
    assert!(plan.arms[0].start_distance.is_some_and(|distance| distance < 1e-11));
    assert_eq!(plan.arms[1].start_distance, None);
}

#[test]
fn an_arm_can_start_on_its_path() {
    let path = "arm.left.path={kind=\"circle\", radius=0.2, center=[2, 0.5], rotation=\"pi/2\"}";
    assert!(planned(&[path]).unwrap_err().message.contains("start_pose = \"path\""));
    let planner = planned(&[path, "arm.left.start_pose=path"]).unwrap();
    let tip = tip_at(planner.arm(0).positions);
    assert!((tip - nalgebra::Vector3::new(2.0, 0.7, tip.z)).norm() < 1e-12, "{tip}");
}

#[test]
fn a_start_pose_reads_back_as_it_was_written() {
    for start in ["path", "{xyz=[1, \"pi/3\"]}", "{xyz=[1, 1, 0], rpy=[0, 0, \"pi/2\"]}"] {
        let scenario =
            with(&[&format!("arm.left.start_pose={start}"), "arm.left.path.center=[1,1,0]"]).unwrap();
        assert!(scenario.arm[0].start_pose.is_some());
        assert_eq!(read(&scenario.to_toml()).unwrap(), scenario, "{}", scenario.to_toml());
    }
}

#[test]
fn everything_that_is_wrong_is_said_at_once() {
    let error =
        with(&["sigma=-1", "law.threshold=-1", "arm.left.path.radius=-1", "arm.right.q0=[1e9,0,0,0]"]);
    let error = error.unwrap_err();
    let keys: Vec<String> = std::iter::once(&error)
        .chain(&error.also)
        .map(|error| error.path.as_ref().unwrap().to_string())
        .collect();
    assert_eq!(keys, ["sigma", "law.threshold", "arm.left.path.radius", "arm.right.q0[0]"]);
}

#[test]
fn positions_are_those_of_the_file_whatever_is_set() {
    let mut text = ScenarioText::parse(&SMALL.replace("0.3, 0.4]", "true, 0.4]")).unwrap();
    text.set("allow_unstable=true").unwrap();
    text.set("law.threshold=1e-3").unwrap();
    assert_eq!(place(&text.scenario().unwrap_err()), (25, 17));
}

#[test]
fn broken_toml_is_refused_with_its_place() {
    let error = refused("sigma = 1\nduration = \n");
    assert_eq!(place(&error).0, 2);
    assert!(error.message.starts_with("not TOML: "), "{error}");
    assert!(refused("").message.contains("empty"));
    assert!(refused(&"[".repeat(100_000)).message.starts_with("not TOML"));
    assert!(refused(&format!("a={}", "[".repeat(100_000))).message.starts_with("not TOML"));
    assert!(refused("sigma = 1\nsigma = 2").message.contains("duplicate key"));
}

proptest::proptest! {
    #[test]
    fn no_text_makes_the_reader_panic(at in 0..SMALL.len(), cut in 0..40usize, put in ".{0,6}") {
        let end = (at + cut).min(SMALL.len());
        let _ = read(&format!("{}{put}{}", &SMALL[..at], &SMALL[end..]));
    }

    #[test]
    fn no_assignment_makes_the_reader_panic(assignment in "[a-z.=\\[\\]{}\"0-9 ]{0,20}") {
        let _ = with(&[&assignment]);
    }
}

/// A Panda beside obstacles.
const BESIDE: &str = r#"sigma = 0.01
duration = 2.0

[collision]
margin = 0.02

[[obstacle]]
kind = "sphere"
center = [0.25, 0.25, 0.6]
radius = 0.08

[[arm]]
name = "arm"
robot = "panda"
base = "panda_link0"
tip = "panda_hand_tcp"
task = "position"
q0 = [0, -0.6, 0, -2.2, 0, 1.6, 0.8]
path = { kind = "line", displacement = [0, 0.1, 0] }
"#;

fn beside(more: &str) -> Result<kinstep::planner::Planner, ScenarioError> {
    let text = ScenarioText::parse(&BESIDE.replacen("margin = 0.02", more, 1))?;
    let table = kinstep::formula::FormulaTable::builtin();
    text.scenario()?.planner(table, None).map_err(|error| text.placed(error))
}

#[test]
fn obstacles_are_read_written_and_looked_at() {
    let plan = beside("margin = 0.02").unwrap().run();
    let closest = plan.distance.as_ref().unwrap();
    assert_eq!((closest.margin, closest.course.len()), (0.02, plan.samples()));
    let scenario = read(BESIDE).unwrap();
    assert_eq!(read(&scenario.to_toml()).unwrap(), scenario);
    // Without pairs of its own links what is nearest is the ball.
    let plan = beside("margin = 0.02\nself = false\ninfluence = 0.3\nclosing_speed = 0.1").unwrap().run();
    assert_eq!(plan.distance.unwrap().pair[1], "sphere");
    let allowed =
        r#"allowed = [["panda_link6", "sphere"], ["panda_link5", "sphere"], ["panda_hand", "sphere"]]"#;
    let plan = beside(&format!("margin = 0.02\nself = false\n{allowed}")).unwrap().run();
    assert_eq!(plan.distance.unwrap().pair[0], "arm panda_link7");
}

#[test]
fn laws_that_keep_distances_see_all_arms() {
    let second = BESIDE[BESIDE.find("[[arm]]").unwrap()..].replacen("\"arm\"", "\"other\"", 1);
    let law = "[law]\nkind = \"qp\"\n\n[collision]";
    let both = BESIDE.replacen("[collision]", law, 1) + &second + "mount = { xyz = [0, -1, 0] }\n";
    let text = ScenarioText::parse(&both).unwrap();
    let table = kinstep::formula::FormulaTable::builtin();
    let plan = text.scenario().unwrap().planner(table, None).unwrap().run();
    assert!(plan.is_completed() && plan.keeps_distances(), "{:?} {:?}", plan.reason, plan.distance);
}

#[test]
fn what_is_wrong_around_the_arms_is_said_with_its_place() {
    let said = |more: &str| beside(more).map(|_| ()).unwrap_err();
    let near = said("margin = 0.2");
    assert_eq!(place(&near), (5, 10));
    assert!(
        near.message.contains("start 0.") && near.message.contains("the margin is 0.2 m"),
        "{}",
        near.message
    );
    assert!(said("margin = -0.1").message.contains("-0.1 m is not a margin"));
    assert!(
        said("margin = 0.02\ninfluence = 0.01").message.contains("0.01 m is not beyond the margin of 0.02 m")
    );
    assert!(said("margin = 0.02\nclosing_speed = 0").message.contains("0 m/s is not a closing speed"));
    let slip = said("margni = 0.02").message;
    assert!(slip.contains("did you mean") && slip.contains("margin"), "{slip}");
    let pair = said("margin = 0.02\nallowed = [[\"panda_link6\", \"spere\"]]");
    assert!(
        pair.message.contains("there is no link or obstacle \"spere\"; did you mean"),
        "{}",
        pair.message
    );
    assert!(said("margin = 0.02\nsrdf = \"lost.srdf\"").message.contains("collision.srdf: lost.srdf"));
    let with = |from: &str, to: &str| read(&BESIDE.replacen(from, to, 1)).unwrap_err();
    assert!(with("kind = \"sphere\"", "kind = \"shpere\"").message.contains("did you mean"));
    assert!(with("radius = 0.08", "radius = -1").message.contains("-1 m is not a radius; it is positive"));
    assert!(with("radius = 0.08", "").message.contains("a sphere needs this"));
    assert!(
        with("radius = 0.08", "radius = 0.08\nsize = [1, 1, 1]")
            .message
            .contains("a sphere has no such parameter")
    );
    assert!(with("[collision]\nmargin = 0.02\n", "").message.contains("without a table [collision]"));
    let robot = |robot: &str| {
        let text = BESIDE.replacen("\"panda\"", robot, 1);
        read(&text)
            .unwrap()
            .planner(kinstep::formula::FormulaTable::builtin(), None)
            .map(|_| ())
            .unwrap_err()
            .message
    };
    let bare = "'<robot name=\"r\"><link name=\"panda_link0\"/></robot>'";
    assert!(robot(bare).contains("panda_hand_tcp"), "{}", robot(bare));
}
