//! `kinstep ode`, run.

#![allow(clippy::unwrap_used, reason = "a test that can not go on stops")]

use crate::program::{Desk, kinstep};
use serde_json::Value;

const BALL: &str = r#"
sigma = 0.01
duration = 5.0
formula = "ab4"

[problem]
parameters = { g = 9.81 }
equations = ["y' = v", "v' = -g"]
initial = ["y = 0", "v = g"]
events = [{ event = "ground: y", direction = "falling", terminal = true }, "top: v"]
"#;

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|entry| entry.as_f64().unwrap()).collect()
}

#[test]
fn the_document_has_the_keys_that_scripts_rely_on() {
    let document = kinstep(&["ode", "kepler", "--rtol", "1e-9", "--at", "1,2", "--json"]).expect(0).json();
    assert_eq!(
        (&document["status"], &document["reason"], &document["method"]),
        (&"completed".into(), &Value::Null, &"adams".into())
    );
    assert_eq!(document["names"], serde_json::json!(["x", "y", "u", "v"]));
    let x = numbers(&document["x"]);
    assert!((x[0] - 0.7).abs() < 1e-6 && x[1].abs() < 1e-6, "{x:?}");
    assert_eq!(document["samples"].as_array().unwrap().len(), 2);
    assert_eq!(document["samples"][1]["t"], 2.0);
    let orders: u64 =
        document["orders"].as_object().unwrap().values().map(|steps| steps.as_u64().unwrap()).sum();
    assert_eq!(document["steps"].as_u64(), Some(orders));
    for key in ["rejected", "evaluations", "jacobians", "factorizations"] {
        assert!(document[key].is_u64(), "{key}: {document}");
    }
    assert_eq!(
        (document["events"].clone(), document["warnings"].clone()),
        (serde_json::json!([]), serde_json::json!([]))
    );
}

#[test]
fn events_of_the_file_happen_and_end_the_solution() {
    let desk = Desk::new(&[("ball.toml", BALL)]);
    for more in
        [&[][..], &["--family", "bdf"], &["--method", "ab4"], &["--predictor", "ab4", "--corrector", "am3"]]
    {
        let document = desk.run(&[&["ode", "ball.toml", "--json"], more].concat()).expect(0).json();
        assert_eq!(document["status"], "event", "{document}");
        let events: Vec<(&str, f64)> = document["events"]
            .as_array()
            .unwrap()
            .iter()
            .map(|event| (event["name"].as_str().unwrap(), event["t"].as_f64().unwrap()))
            .collect();
        assert!(
            matches!(events[..], [("top", top), ("ground", ground)] if (top - 1.0).abs() < 1e-6 && (ground - 2.0).abs() < 1e-6),
            "{events:?}"
        );
    }
}

#[test]
fn the_stiff_family_takes_over_and_the_known_state_is_met() {
    let run = ["ode", "robertson", "--rtol", "1e-8", "--atol", "1e-20", "--json"];
    let document = kinstep(&run).expect(0).json();
    assert_eq!(document["method"], "adams+bdf");
    assert!(document["jacobians"].as_u64().unwrap() > 0);
    assert!(document["reference"]["in_tolerances"].as_f64().unwrap() < 100.0, "{document}");
    let explicit = kinstep(&["ode", "hires", "--family", "adams", "--until", "5", "--json"]).expect(0).json();
    assert!(explicit["warnings"][0].as_str().unwrap().starts_with("stiff from about t = "), "{explicit}");
    let implicit =
        ["ode", "van_der_pol_stiff", "--method", "bdf3", "--sigma", "0.05", "--until", "100", "--json"];
    let implicit = kinstep(&implicit).expect(0).json();
    let close =
        kinstep(&["ode", "van_der_pol_stiff", "--until", "100", "--rtol", "1e-9", "--json"]).expect(0).json();
    let apart = numbers(&implicit["x"])[0] - numbers(&close["x"])[0];
    assert!(apart.abs() < 1e-7, "{apart}");
}

#[test]
fn figures_and_tables_are_written_and_read_back() {
    let desk = Desk::new(&[("ball.toml", BALL)]);
    let run = desk.run(&["ode", "ball.toml", "--at", "0.5,1.5", "--out", "solved"]).expect(0);
    assert!(run.out.starts_with("event at t = "), "{}", run.out);
    let files =
        ["ode.json", "orders.svg", "phase.svg", "samples.csv", "solution.svg", "steps.csv", "steps.svg"];
    assert_eq!(desk.names("solved"), files);
    let samples = std::fs::read_to_string(desk.path("solved/samples.csv")).unwrap();
    let rows: Vec<Vec<f64>> = samples
        .lines()
        .skip(1)
        .map(|line| line.split(',').map(|field| field.parse().unwrap()).collect())
        .collect();
    assert!(samples.starts_with("t,y,v\n") && (rows[0][1] - 9.81 * 0.375).abs() < 1e-9, "{samples}");
    assert!(std::fs::read_to_string(desk.path("solved/solution.svg")).unwrap().contains("ground"));
    desk.run(&["ode", "ball.toml", "--out", "solved"]).expect(6);
    desk.run(&["ode", "ball.toml", "--out", "solved", "--force"]).expect(0);
}

#[test]
fn backwards_in_time_is_a_way_too() {
    let document = kinstep(&["ode", "kepler", "--until=-6.283185307179586", "--rtol", "1e-9", "--json"])
        .expect(0)
        .json();
    let x = numbers(&document["x"]);
    assert!((x[0] - 0.7).abs() < 1e-6 && x[1].abs() < 1e-6, "{x:?}");
}

#[test]
fn a_solution_that_stops_exits_with_5_and_tells_what_there_is() {
    let desk = Desk::new(&[(
        "blowup.toml",
        "sigma = 0.01\nduration = 2.0\nformula = \"ab4\"\n[problem]\nequations = [\"x' = x^2\"]\ninitial = [\"x = 1\"]\n",
    )]);
    for more in [&[][..], &["--family", "bdf"]] {
        let document =
            desk.run(&[&["ode", "blowup.toml", "--at", "0.5,1.5", "--json"], more].concat()).expect(5).json();
        assert!(document["status"] != "completed" && document["reason"].is_string(), "{document}");
        assert_eq!(document["samples"].as_array().unwrap().len(), 1);
        assert!((document["t"].as_f64().unwrap() - 1.0).abs() < 1e-3);
    }
    let few = kinstep(&["ode", "kepler", "--max-steps", "3", "--json"]).expect(5).json();
    assert_eq!(few["status"], "too_many_steps");
}

#[test]
fn what_can_not_be_asked_for_is_refused_with_the_option() {
    let desk = Desk::new(&[("ball.toml", BALL), ("bad.toml", &BALL.replace("top: v", "top: w"))]);
    for (arguments, exit, sentence) in [
        (&["nosuch"][..], 2, "neither a file nor a built-in problem"),
        (&["bad.toml"], 2, "\"w\" means nothing here"),
        (&["kepler", "--rtol", "-1"], 2, "--rtol is -1"),
        (&["kepler", "--atol", "-1"], 2, "--atol is -1"),
        (&["kepler", "--rtol", "0", "--atol", "0"], 2, "both zero"),
        (&["kepler", "--until", "0"], 2, "--until goes from 0.0 to 0.0"),
        (&["kepler", "--at", "100"], 2, "beyond the range"),
        (&["kepler", "--family", "bfd"], 2, "there is no family \"bfd\"; did you mean bdf?"),
        (&["kepler", "--method", "nosuch"], 4, "nosuch"),
        (&["kepler", "--method", "ab4", "--family", "adams"], 2, "cannot be used with"),
        (&["kepler", "--predictor", "ab4"], 2, "--corrector"),
        (&["kepler", "--predictor", "am3", "--corrector", "am3"], 4, "am3"),
        (&["kepler", "--sigma", "0.1"], 2, "--sigma is the step of a method"),
        (&["kepler", "--method", "ab4", "--sigma", "0"], 2, "--sigma is 0"),
        (&["examples/planar_dual.toml"], 6, ""),
    ] {
        let run = desk.run(&[&["ode"], arguments].concat()).expect(exit);
        assert!(run.err.contains(sentence), "{arguments:?}: {}", run.err);
    }
    let arms = kinstep(&["ode", "examples/planar_dual.toml"]).expect(2);
    assert!(arms.err.contains("`kinstep plan` runs it"));
}

#[test]
fn without_a_problem_problems_and_families_are_listed() {
    let run = kinstep(&["ode"]).expect(0);
    assert!(
        ["robertson", "adams", "1 to 12", "bdf"].iter().all(|word| run.out.contains(word)),
        "{}",
        run.out
    );
    assert!(kinstep(&["ode", "--json"]).expect(0).json()["problems"].as_array().unwrap().len() > 30);
}
