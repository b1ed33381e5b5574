//! `report.html`: what a page holds, that nothing in it is taken for markup, and that it loads nothing.

#![allow(clippy::unwrap_used, reason = "a test that can not go on stops")]

use std::fs;
use std::path::Path;

use crate::markup::{check, check_nesting};
use kinstep::formula::FormulaTable;
use kinstep::planner::{Plan, PlanStatus};
use kinstep::robot::embedded;
use kinstep_files::scenario::ScenarioText;
use kinstep_files::trajectory::{About, Recording, Stage, Trajectory};
use kinstep_report::figure::plan_figures;
use kinstep_report::{PlanPage, Suggestion};
use serde_json::Value;

const PLANAR: &str = include_str!("../../../../examples/planar_dual.toml");

/// A plan of a scenario's text, on its stage.
fn run(text: &str, set: &[&str], folder: Option<&Path>) -> (Plan, Stage, String) {
    let mut text = ScenarioText::parse(text).unwrap();
    for assignment in set {
        text.set(assignment).unwrap();
    }
    let scenario = text.scenario().unwrap();
    let plan = scenario.planner(FormulaTable::builtin(), folder).unwrap().run();
    let stage = scenario.stage(folder).unwrap();
    (plan, stage, scenario.to_toml())
}

fn page_of(plan: &Plan, stage: &Stage, scenario: &str) -> String {
    let trajectory = Trajectory::of(plan, Some(About::of(plan, scenario, stage)));
    let recording = Recording { trajectory: &trajectory, stage };
    let page = PlanPage {
        title: "a <b> & \"c\"",
        plan,
        recording,
        figures: &plan_figures(recording, Some(plan)),
        scenario,
        command: "kinstep plan scenario.toml",
        suggestions: &[Suggestion::new("--set 'sigma=<x>'", "because <i>")],
    };
    page.to_html()
}

/// The data of the replay.
fn scene(html: &str) -> Value {
    let (_, rest) = html.split_once("<script type=\"application/json\" id=\"scene\">").unwrap();
    serde_json::from_str(rest.split_once("</script>").unwrap().0).unwrap()
}

#[test]
fn a_page_says_what_noise_the_loop_suffered() {
    let (plan, stage, scenario) = run(PLANAR, &["noise.position=1e-4", "noise.seed=3"], None);
    let html = page_of(&plan, &stage, &scenario);
    assert!(html.contains("white noise of seed 3: 1.0e-4 m in the measured position"));
    let (plan, stage, scenario) = run(PLANAR, &[], None);
    assert!(!page_of(&plan, &stage, &scenario).contains("noise of seed"));
}

#[test]
fn a_page_tells_of_its_plan_and_is_the_same_every_time() {
    let (plan, stage, scenario) = run(PLANAR, &["duration=0.5"], None);
    let html = page_of(&plan, &stage, &scenario);
    check(&html);
    assert_eq!(html, page_of(&plan, &stage, &scenario));
    for said in [
        "Completed",
        "la6-wang-guo",
        "&lt;b&gt; &amp; &quot;c&quot;",
        "because &lt;i&gt;",
        "kinstep.scenario_sha256",
    ] {
        assert!(html.contains(said), "{said:?} is not in the page");
    }
    assert!(html.matches("<figure class=\"figure\" data-time=").count() >= 4);
    let scene = scene(&html);
    assert_eq!(scene["arms"].as_array().unwrap().len(), 2);
    assert_eq!(scene["machines"].as_array().unwrap().len(), 2);
}

#[test]
fn hostile_names_stay_names() {
    let evil = "</script><script>alert(1)</script><!--\" onerror='x' {{title}} & \u{2028}";
    let named = embedded::text("planar4").unwrap().replace("\"j1\"", &format!("\"{}\"", escaped(evil)));
    let desk = tempfile::tempdir().unwrap();
    fs::write(desk.path().join("evil.urdf"), &named).unwrap();
    let folder = desk.path();
    let text = PLANAR.replace("\"planar4\"", "\"evil.urdf\"");
    let (mut plan, mut stage, scenario) = run(&text, &["duration=0.1"], Some(folder));
    assert_eq!(plan.arms[0].joints[0], evil);
    // Scenarios refuse such names for arms; programs can give them.
    plan.arms[0].name = evil.to_owned();
    stage.arms[0].name = evil.to_owned();
    plan.warnings.push(evil.to_owned());
    let html = page_of(&plan, &stage, &scenario);
    check_nesting(&html);
    assert!(!html.contains("<script>alert") && !html.contains("<!--\""));
    assert_eq!(html.matches("</script>").count(), 2);
    assert_eq!(scene(&html)["arms"][0]["name"], evil);
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;")
}

#[test]
fn runs_that_stopped_have_a_page_too() {
    let (whole, stage, scenario) = run(PLANAR, &["duration=0.1"], None);
    for samples in [0, 1, 2] {
        let mut plan = whole.clone();
        plan.status = PlanStatus::NonFinite;
        plan.reason = Some("joint <j> became NaN".to_owned());
        for arm in &mut plan.arms {
            let joints = arm.joints.len();
            arm.positions.truncate(samples * joints);
            arm.velocities.truncate(samples * joints);
            arm.errors.truncate(samples);
        }
        let html = page_of(&plan, &stage, &scenario);
        check(&html);
        assert!(html.contains("Stopped") && html.contains("joint &lt;j&gt; became NaN"));
        assert_eq!(html.contains("No sample was recorded"), samples == 0);
    }
    let diverging = ["law.h=1.9", "allow_unstable=true"];
    let (plan, stage, scenario) = run(PLANAR, &diverging, None);
    assert!(!plan.is_completed());
    check(&page_of(&plan, &stage, &scenario));
}

#[test]
fn numbers_that_are_not_finite_do_no_harm() {
    let (mut plan, stage, scenario) = run(PLANAR, &["duration=0.1"], None);
    plan.arms[0].positions[3] = f64::NAN;
    plan.arms[0].velocities[3] = f64::INFINITY;
    plan.arms[0].errors[1].x = f64::NAN;
    plan.arms[0].max_error = f64::INFINITY;
    plan.arms[0].smallest_singular_value = (f64::NAN, f64::NAN);
    check(&page_of(&plan, &stage, &scenario));
}

#[test]
fn a_long_run_makes_a_small_page() {
    let (plan, stage, scenario) = run(PLANAR, &["sigma=0.0001"], None);
    assert_eq!(plan.samples(), 100_001);
    let html = page_of(&plan, &stage, &scenario);
    assert!(html.len() < 3 << 20, "{} bytes", html.len());
}

#[test]
fn meshes_are_found_reduced_and_reported_where_they_are_missing() {
    let desk = tempfile::tempdir().unwrap();
    for folder in ["package/arm/meshes", "package/arm/urdf"] {
        fs::create_dir_all(desk.path().join(folder)).unwrap();
    }
    fs::write(desk.path().join("package/arm/meshes/bar.obj"), "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
        .unwrap();
    let visual = |file: &str| {
        format!("<visual><geometry><mesh filename=\"package://arm/meshes/{file}\"/></geometry></visual>")
    };
    let urdf = format!(
        "<robot name=\"r\"><link name=\"base\">{}</link><link name=\"tip\">{}<visual><geometry><box size=\"1 2 3\"/></geometry>\
         </visual></link><joint name=\"j\" type=\"continuous\"><parent link=\"base\"/><child link=\"tip\"/><axis xyz=\"0 0 1\"/>\
         </joint></robot>",
        visual("bar.obj"),
        visual("none.stl")
    );
    fs::write(desk.path().join("package/arm/urdf/r.urdf"), urdf).unwrap();
    let text = "sigma = 0.1\nduration = 0.5\n[[arm]]\nname = \"a\"\nrobot = \"package/arm/urdf/r.urdf\"\nbase = \"base\"\n\
                tip = \"tip\"\ntask = \"position\"\nq0 = [0]\npath = { kind = \"line\", displacement = [0, 0, 0] }\n";
    let scenario = ScenarioText::parse(text).unwrap().scenario().unwrap();
    let stage = scenario.stage(Some(desk.path())).unwrap();
    let (plan, ..) = run(PLANAR, &["duration=0.1"], None);
    let html = page_of(&Plan { arms: Vec::new(), ..plan }, &stage, text);
    let machine = &scene(&html)["machines"][0];
    assert_eq!(machine["lacks"], true);
    let shapes: Vec<&str> =
        machine["looks"].as_array().unwrap().iter().map(|look| look["shape"].as_str().unwrap()).collect();
    assert_eq!(shapes, ["mesh", "box"]);
    assert!(html.contains("package://arm/meshes/none.stl was not found"));
}

#[test]
fn many_arms_share_a_page() {
    let arm = |k: usize| {
        format!(
            "[[arm]]\nname = \"arm{k}\"\nrobot = \"ur5e\"\nbase = \"base_link\"\ntip = \"tool0\"\nmount = {{ xyz = [{k}, 0, 0] }}\n\
             task = \"pose\"\nq0 = [0.1, -1.2, 1.4, -1.0, -1.5, 0.2]\n\
             path = {{ kind = \"circle\", radius = 0.05, time_law = \"quintic\" }}\n"
        )
    };
    let text = (0..8).fold("sigma = 0.01\nduration = 1.0\n".to_owned(), |text, k| text + &arm(k));
    let (plan, stage, scenario) = run(&text, &[], None);
    let html = page_of(&plan, &stage, &scenario);
    check(&html);
    assert_eq!(scene(&html)["arms"].as_array().unwrap().len(), 8);
    assert_eq!(scene(&html)["arms"][7]["colour"], 0, "colours begin again");
}
