//! `kinstep formula` and `kinstep reproduce`, run.

#![allow(clippy::unwrap_used, reason = "a test that can not go on stops")]

use crate::program::{Desk, ROW, kinstep};
use serde_json::{Value, json};
use std::path::Path;

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is not a number"))
}

fn near(value: &Value, expected: f64, tolerance: f64) {
    assert!((number(value) - expected).abs() < tolerance, "{value} is not {expected}");
}

/// Every key that scripts rely on, whatever the row.
fn assert_shape(card: &Value) {
    for key in [
        "id",
        "steps",
        "order",
        "error_constant",
        "zero_stable",
        "strictly_zero_stable",
        "root_moduli",
        "h_max",
        "h_opt",
        "r_opt",
        "noise_gain",
        "declared_ok",
        "problems",
    ] {
        assert!(card.get(key).is_some(), "{key} is missing in {card}");
    }
    for key in ["exact", "polynomial", "value", "unbounded"] {
        assert!(card["h_max"].get(key).is_some(), "h_max.{key} is missing in {card}");
    }
}

#[test]
fn the_papers_row_is_shown_with_its_figures() {
    let shown = kinstep(&["formula", "show", "la6-wang-guo", "--json"]).expect(0).json();
    let card = &shown["formulas"][0];
    assert_shape(card);
    assert_eq!(
        (&card["steps"], &card["order"], &card["error_constant"]),
        (&json!(5), &json!(3), &json!("5/16"))
    );
    assert_eq!((&card["zero_stable"], &card["strictly_zero_stable"]), (&json!(true), &json!(true)));
    assert_eq!(card["h_max"]["exact"], "2/3");
    assert_eq!((&card["h_max"]["unbounded"], &card["h_max"]["polynomial"]), (&json!(false), &Value::Null));
    near(&card["h_max"]["value"], 2.0 / 3.0, 1e-15);
    near(&card["h_opt"], (15.0 * 33.0_f64.sqrt() - 71.0) / 48.0, 1e-9);
    near(&card["r_opt"], ((3.0 + 33.0_f64.sqrt()) / 12.0).sqrt(), 1e-9);
    let moduli = card["root_moduli"].as_array().unwrap();
    for (modulus, expected) in moduli.iter().zip([1.0, 0.762_656, 0.653_904, 0.653_904, 0.383_313]) {
        near(modulus, expected, 1e-6);
    }
    assert_eq!((&card["declared_ok"], &card["problems"]), (&json!(true), &json!([])));
    let text = kinstep(&["formula", "show", "la6-wang-guo"]).expect(0).out;
    for said in ["5/16", "0 < h < 2/3", "wang2020", "0.762656", "O(sigma^4) at fixed h"] {
        assert!(text.contains(said), "{said} is not in\n{text}");
    }
}

#[test]
fn a_row_typed_at_the_prompt_is_the_row_of_the_table() {
    let typed = ["formula", "show", "--difference", "24,-5,-12,-6,-4,3", "--denominator", "48", "--json"];
    let typed = kinstep(&typed).expect(0).json();
    let known = kinstep(&["formula", "show", "la6-wang-guo", "--json"]).expect(0).json();
    for key in ["steps", "order", "error_constant", "h_max", "h_opt", "root_moduli", "noise_gain"] {
        assert_eq!(typed["formulas"][0][key], known["formulas"][0][key], "{key}");
    }
    let split = ["formula", "show", "--alpha", "1,-1,0", "--beta=0,3/2,-1/2", "--gamma", "0,1,0", "--json"];
    let split = kinstep(&split).expect(0).json();
    assert_eq!(split["formulas"][0]["h_max"]["exact"], "2");
    // What the prompt prints is a row that a file can hold.
    let text =
        kinstep(&["formula", "show", "--difference", "-24,5,12,6,4,-3", "--denominator=-48"]).expect(0).out;
    let desk = Desk::new(&[("typed.toml", &text[text.find("[[formula]]").unwrap()..])]);
    desk.run(&["formula", "check", "typed.toml"]).expect(0);
}

#[test]
fn an_unstable_row_honestly_declared_is_no_failure_and_has_no_range() {
    let run = kinstep(&["formula", "show", "bad-double-root", "bad-bdf7", "--json"]).expect(0);
    for card in run.json()["formulas"].as_array().unwrap() {
        assert_shape(card);
        assert_eq!((&card["zero_stable"], &card["declared_ok"]), (&json!(false), &json!(true)));
        let [exact, polynomial, value] = ["exact", "polynomial", "value"].map(|key| &card["h_max"][key]);
        assert_eq!(
            [exact, polynomial, value, &card["h_opt"], &card["r_opt"], &card["noise_gain"]],
            [&Value::Null; 6]
        );
    }
}

#[test]
fn the_list_walks_the_table() {
    let list = kinstep(&["formula", "list", "--json"]).expect(0).json();
    let rows = list["formulas"].as_array().unwrap();
    assert!(rows.len() > 100);
    let text = kinstep(&["formula", "list"]).expect(0).out;
    for row in rows {
        let id = row["id"].as_str().unwrap();
        assert!(text.lines().any(|line| line.starts_with(&format!("{id} "))), "{id}");
    }
    let desk = Desk::new(&[("mine.toml", ROW)]);
    let own = desk.run(&["formula", "list", "--json", "--formulas", "mine.toml"]).expect(0).json();
    assert_eq!(own["formulas"].as_array().unwrap().len(), rows.len() + 1);
    let card = desk.run(&["formula", "show", "mine", "--json", "--formulas", "mine.toml"]).expect(0).json();
    assert_eq!(card["formulas"][0]["h_max"]["exact"], "2/3");
}

#[test]
fn every_row_of_the_table_has_a_card() {
    let list = kinstep(&["formula", "list", "--json"]).expect(0).json();
    let ids: Vec<&str> =
        list["formulas"].as_array().unwrap().iter().map(|row| row["id"].as_str().unwrap()).collect();
    let shown = kinstep(&[&["formula", "show", "--json"], &ids[..]].concat()).expect(0).json();
    let cards = shown["formulas"].as_array().unwrap();
    assert_eq!(cards.len(), ids.len());
    cards.iter().for_each(assert_shape);
}

#[test]
fn an_unknown_id_is_exit_2_with_the_nearest() {
    let error = kinstep(&["formula", "show", "la6-wang-gou", "--json"]).expect(2).error();
    assert!(error["message"].as_str().unwrap().contains("la6-wang-guo"), "{error}");
    kinstep(&["formula", "show"]).expect(2);
}

#[test]
fn a_wrong_fact_is_exit_1_with_both_values_in_full() {
    let wrong = [
        (ROW.replace("order = 3", "order = 4"), "order 4"),
        (ROW.replace("5/16", "1/3"), "1/3"),
        (ROW.replace("true", "false"), "zero_stable = false"),
        (ROW.replace("24, -5", "24, -4"), "inconsistent"),
        (ROW.replace("denominator = 48", "denominator = 24"), "inconsistent"),
    ];
    for (row, said) in wrong {
        let desk = Desk::new(&[("rows.toml", &format!("{row}\n{}", ROW.replace("mine", "honest")))]);
        let run = desk.run(&["formula", "check", "rows.toml", "--json"]).expect(1);
        let cards = run.json()["formulas"].clone();
        cards.as_array().unwrap().iter().for_each(assert_shape);
        assert_eq!((&cards[0]["declared_ok"], &cards[1]["declared_ok"]), (&json!(false), &json!(true)));
        assert!(cards[0]["problems"][0].as_str().unwrap().contains(said), "{said}: {}", cards[0]["problems"]);
        assert!(desk.run(&["formula", "check", "rows.toml"]).expect(1).out.contains("PROBLEM"));
        desk.run(&["formula", "list", "--formulas", "rows.toml"]).expect(1);
    }
}

#[test]
fn an_unreadable_row_is_exit_4_with_its_place() {
    for (from, to, line) in [
        ("denominator = 48", "denominator = \"1/0\"", 4),
        ("denominator = 48", "denominator = 0", 4),
        ("24, -5", "0, -5", 3),
        ("denominator = 48", "denominator = 4.8", 4),
        ("order = 3", "order = 3\noder = 3", 6),
        ("source = \"a test\"", "", 1),
    ] {
        let desk = Desk::new(&[("rows.toml", &ROW.replace(from, to))]);
        let error = desk.run(&["formula", "check", "rows.toml", "--json"]).expect(4).error();
        assert_eq!((&error["file"], &error["line"]), (&json!("rows.toml"), &json!(line)), "{to}: {error}");
        let run = desk.run(&["formula", "check", "rows.toml"]).expect(4);
        assert!(run.err.starts_with(&format!("rows.toml:{line}:")), "{}", run.err);
    }
    let two = ROW.replace("denominator = 48", "denominator = 0").replace("source", "sauce");
    let desk = Desk::new(&[("rows.toml", &two)]);
    let err = desk.run(&["formula", "check", "rows.toml"]).expect(4).err;
    for said in ["rows.toml:4:", "rows.toml:8:", "did you mean \"source\"?", "\"source\" is missing"] {
        assert!(err.contains(said), "every problem is listed, {said} too:\n{err}");
    }
    let error = desk.run(&["formula", "check", "rows.toml", "--json"]).expect(4).error();
    assert!(error["also"].as_array().unwrap().len() >= 2, "{error}");
    let unequal = "[[formula]]\nid = \"x\"\nalpha = [1, -1]\nbeta = [0, 1, 0]\norder = 1\nerror_constant = \"1/2\"\nzero_stable = true\nsource = \"t\"\n";
    Desk::new(&[("rows.toml", unequal)]).run(&["formula", "check", "rows.toml"]).expect(4);
    kinstep(&["formula", "show", "--difference", "1/0,-1"]).expect(4);
    kinstep(&["formula", "show", "--difference", "0,1,-1"]).expect(4);
    kinstep(&["formula", "show", "--alpha", "1,-1", "--beta", "0,1,0"]).expect(4);
}

#[test]
fn a_draft_is_finished_by_the_program() {
    let draft = "[[formula]]\nid = \"draft\"\ndifference = [12, -3, -4, -6, 0, 1]\ndenominator = 24\n";
    let desk = Desk::new(&[("draft.toml", draft)]);
    desk.run(&["formula", "check", "draft.toml"]).expect(4);
    let run = desk.run(&["formula", "check", "draft.toml", "--draft", "--json"]).expect(0);
    let finished = run.json()["formulas"][0]["toml"].as_str().unwrap().to_owned();
    assert!(finished.contains("order = 3") && finished.contains("\"7/24\""), "{finished}");
    std::fs::write(desk.path("finished.toml"), &finished).unwrap();
    desk.run(&["formula", "check", "finished.toml"]).expect(0);
    assert!(desk.run(&["formula", "check", "draft.toml", "--draft"]).expect(0).out.contains(&finished));
}

#[test]
fn a_taken_id_is_remarked_and_no_failure_of_the_check() {
    let desk = Desk::new(&[("rows.toml", &ROW.replace("mine", "la6-wang-guo"))]);
    let run = desk.run(&["formula", "check", "rows.toml"]).expect(0);
    assert!(run.out.contains("a built-in row has this id"), "{}", run.out);
    desk.run(&["plan", "--formulas", "rows.toml"]).expect(4);
}

#[test]
fn the_papers_experiments_keep_the_papers_bounds() {
    let run = kinstep(&["reproduce", "--json"]).expect(0);
    let experiments = run.json()["experiments"].as_array().unwrap().clone();
    let arms = |id: &str, formula: &str, sigma: f64| {
        let found = experiments
            .iter()
            .find(|e| e["id"] == id && e["formula"] == formula && number(&e["sigma"]) == sigma);
        found.unwrap_or_else(|| panic!("{id} {formula} {sigma}"))["arms"].as_array().unwrap().clone()
    };
    let measured = [
        ("A.1", "la2-euler", 0.01, [2.5e-4, 2.5e-4]),
        ("A.1", "la2-euler", 0.001, [2.5e-6, 2.5e-6]),
        ("A.1", "la6-wang-guo", 0.01, [3.35e-7, 3.35e-7]),
        ("A.1", "la6-wang-guo", 0.001, [3.5e-11, 3.5e-11]),
        ("A.2", "la6-wang-guo", 0.01, [1.4e-7, 4.4e-7]),
        ("B", "la6-wang-guo", 0.01, [2.4e-7, 2.4e-7]),
        ("B", "la6-wang-guo", 0.001, [2.4e-11, 2.4e-11]),
    ];
    for (id, formula, sigma, errors) in measured {
        for (arm, error) in arms(id, formula, sigma).iter().zip(errors) {
            assert!(
                (number(&arm["max_error_component"]) / error - 1.0).abs() < 0.05,
                "{id} {formula} {sigma}: {arm}"
            );
        }
    }
    let all: Vec<&Value> = experiments.iter().flat_map(|e| e["arms"].as_array().unwrap()).collect();
    let bounded: Vec<&&Value> = all.iter().filter(|arm| !arm["paper_bound"].is_null()).collect();
    assert_eq!(bounded.len(), 8);
    assert!(
        bounded.iter().all(|arm| arm["within_bound"] == true && arm["paper_order_of_magnitude"].is_null())
    );
    assert!(all.iter().all(|arm| arm["paper_bound"].is_null() == arm["within_bound"].is_null()));
    assert_grid(&experiments);
}

/// A decade of sigma is about four of the error, and the error falls as h rises.
fn assert_grid(experiments: &[Value]) {
    let error = |sigma: f64, h: f64, arm: usize| {
        let found = experiments
            .iter()
            .find(|e| e["id"] == "table-1" && number(&e["sigma"]) == sigma && number(&e["h"]) == h);
        number(&found.unwrap_or_else(|| panic!("{sigma} {h}"))["arms"][arm]["max_error_component"])
    };
    for arm in [0, 1] {
        let mut previous = f64::INFINITY;
        for h in [0.1, 0.2, 0.3, 0.4, 0.5, 0.6] {
            let ratio = error(0.01, h, arm) / error(0.001, h, arm);
            let range = if h == 0.1 { 6e3..8.5e3 } else { 8e3..1.01e4 };
            assert!(range.contains(&ratio), "h = {h}, arm {arm}: {ratio}");
            assert!(error(0.01, h, arm) < previous);
            previous = error(0.01, h, arm);
        }
    }
}

#[test]
fn the_reproduction_is_written_with_its_trajectories() {
    let desk = Desk::new(&[]);
    let run = desk.run(&["reproduce", "--out", "paper"]).expect(0);
    assert!(run.out.contains("Every bound of the paper is kept."), "{}", run.out);
    let names = desk.names("paper");
    assert!(names.contains(&"reproduce.json".to_owned()) && names.len() == 17, "{names:?}");
    let pages =
        names.iter().filter(|name| Path::new(name).extension().is_some_and(|end| end == "html")).count();
    assert_eq!(pages, 8, "{names:?}");
    desk.run(&["reproduce", "--out", "paper"]).expect(6);
}

#[test]
fn a_card_says_of_roots_and_loops_only_what_is_so() {
    let card = |arguments: &[&str]| kinstep(&[&["formula", "show"], arguments].concat()).out;
    let typo = card(&["--difference", "24,-5,-12,-6,-4,4", "--denominator", "48"]);
    for said in [
        "all roots inside the unit circle; z = 1, a root of every consistent row, is none of them",
        "feedback range  none: the row is inconsistent",
        "with 3 in place of 4 as coefficient 6 it is (24, -5, -12, -6, -4, 3) / 48",
    ] {
        assert!(typo.contains(said), "{said}\n{typo}");
    }
    assert!(!typo.contains("only z = 1") && !typo.contains("in control"), "{typo}");
    let turned = card(&["--difference", "3,-4,-6,-12,-5,24", "--denominator", "48"]);
    assert!(
        turned.contains("oldest sample first; newest first it is (24, -5, -12, -6, -4, 3) / 48"),
        "{turned}"
    );
    assert!(turned.contains("a root outside the unit circle"), "{turned}");
    let right = card(&["--difference", "24,-5,-12,-6,-4,3", "--denominator", "48"]);
    assert!(right.contains("with only z = 1 on the unit circle") && right.contains("in control"), "{right}");
    assert!(!right.contains("remark"), "{right}");
    let double = card(&["--alpha", "1,-2,1", "--beta", "0,1,-1"]);
    assert!(double.contains("a repeated root on the unit circle") && !double.contains("SSP"), "{double}");
    let weak = card(&["la3-leapfrog"]);
    assert!(weak.contains("further roots on the unit circle") && !weak.contains("in control"), "{weak}");
}

#[test]
fn decimals_that_are_exact_in_binary_are_read_without_quotes() {
    let row = |beta: &str| {
        format!(
            "[[formula]]\nid = \"mine\"\nalpha = [1, -1, 0]\nbeta = [0, 1.5, {beta}]\norder = 2\nerror_constant = \"5/12\"\nzero_stable = true\nsource = \"nowhere\"\n"
        )
    };
    let desk = Desk::new(&[("half.toml", &row("-0.5")), ("tenth.toml", &row("-0.1"))]);
    desk.run(&["formula", "check", "half.toml"]).expect(0);
    let refused = desk.run(&["formula", "check", "tenth.toml", "--json"]).expect(4).error();
    assert!(refused["message"].as_str().unwrap().contains("already been rounded"), "{refused}");
}
