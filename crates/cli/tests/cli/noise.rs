//! Noise in scenarios, planned and swept.

#![allow(clippy::unwrap_used, reason = "a test that can not go on stops")]

use crate::program::{Desk, SMALL};
use serde_json::Value;

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is not a number"))
}

#[test]
fn a_plan_says_which_noise_it_suffered_and_what_came_of_it() {
    let desk = Desk::new(&[("s.toml", SMALL)]);
    let noise = ["--set", "noise.position=1e-4", "--set", "noise.seed=3", "--set", "law.h=0.3"];
    let plan = |more: &[&str]| desk.run(&[&["plan", "s.toml"], more].concat()).expect(0);
    let document = plan(&[&noise[..], &["--json"]].concat()).json();
    assert_eq!((&document["noise"]["seed"], number(&document["noise"]["position"])), (&Value::from(3), 1e-4));
    assert_eq!(number(&document["noise"]["joints"]), 0.0);
    let (rms, quiet) =
        (number(&document["arms"][0]["rms_error_steady"]), plan(&["--set", "law.h=0.3", "--json"]).json());
    assert!(quiet["noise"].is_null() && number(&quiet["arms"][0]["rms_error_steady"]) < 0.1 * rms);
    let text = plan(&noise).out;
    assert!(text.contains("white noise of seed 3: 1.0e-4 m in the measured position\n"), "{text}");
    assert!(text.contains("root mean square of the error in the second half: left "), "{text}");
    assert!(!plan(&[]).out.contains("noise"));
}

#[test]
fn a_sweep_over_noise_and_seeds_is_one_table_that_grows_with_the_noise() {
    let desk = Desk::new(&[("s.toml", SMALL)]);
    let sweep = |out: &str, threads: &str| {
        let vary = ["--vary", "noise.position=0, 1e-5, 1e-3", "--vary", "noise.seed=linspace(1, 4, 4)"];
        let more = ["--out", out, "--threads", threads];
        desk.run(&[&["sweep", "s.toml"], &vary[..], &more[..]].concat()).expect(0);
        std::fs::read_to_string(desk.path(out)).unwrap()
    };
    let table = sweep("one.json", "1");
    assert_eq!(table, sweep("two.json", "2"), "the bytes depend on the threads");
    let table: Vec<Value> = serde_json::from_str(&table).unwrap();
    assert_eq!(table.len(), 12);
    let rms: Vec<f64> = table.iter().map(|line| number(&line["rms_error_steady"])).collect();
    assert!(rms[..4].iter().all(|&silent| silent == rms[0]), "a seed without noise: {rms:?}");
    for (small, large) in rms[4..8].iter().zip(&rms[8..]) {
        assert!(*small > rms[0] && (large / small - 100.0).abs() < 5.0, "{small} {large}");
    }
    assert!(rms[4..8].windows(2).all(|pair| pair[0] != pair[1]), "seeds differ: {rms:?}");
}

#[test]
fn no_order_is_studied_through_noise() {
    let desk = Desk::new(&[("s.toml", SMALL)]);
    let refused = desk.run(&["order", "s.toml", "--set", "noise.joints=1e-9"]).expect(2);
    assert!(refused.err.contains("noise: no order can be seen through noise"), "{}", refused.err);
    let silent = ["--set", "noise.joints=0", "--set", "study.steps=[50, 100, 200]"];
    desk.run(&[&["order", "s.toml"], &silent[..]].concat()).expect(0);
}
