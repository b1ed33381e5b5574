//! The laboratory on the command line.

use assert_cmd::Command;
use serde_json::Value;

fn kinstep(arguments: &[&str]) -> Command {
    let mut command = Command::cargo_bin("kinstep").expect("the program is built with its tests");
    command.args(arguments);
    command
}

fn json(arguments: &[&str]) -> Value {
    let output = kinstep(arguments).arg("--json").assert().success().get_output().stdout.clone();
    serde_json::from_slice(&output).expect("one JSON document")
}

fn refusal(arguments: &[&str]) -> String {
    let output = kinstep(arguments).assert().code(2).get_output().stderr.clone();
    String::from_utf8(output).expect("text")
}

const SIX: [&str; 6] = ["formula", "derive", "--samples", "1,0,-1,-2,-3,-4", "--order", "3"];

#[test]
fn derive_shows_the_family_and_with_parameters_the_row() {
    let family = json(&SIX);
    assert_eq!(family["parameters"][0]["coefficient"], "x_n-3");
    assert_eq!(family["coefficients"][0]["text"], "1/3 + p1 + 4 p2");
    assert_eq!(family["error_constant"]["text"], "1/12 + p1 + 5 p2");
    assert!(family.get("formulas").is_none());
    let member = json(&[&SIX[..], &["--parameters", "-1/12,1/16"]].concat());
    assert_eq!(member["formulas"][0]["error_constant"], "5/16");
    assert_eq!(member["formulas"][0]["h_max"]["exact"], "2/3");
    let text = kinstep(&SIX).assert().success().get_output().stdout.clone();
    assert!(String::from_utf8_lossy(&text).contains("2 free parameters"));
}

#[test]
fn derive_refuses_in_sentences() {
    let far = refusal(&["formula", "derive", "--samples", "1,0,-1", "--order", "3"]);
    assert!(far.contains("sets 4 conditions") && far.contains("ask for order 2"), "{far}");
    let twice = refusal(&["formula", "derive", "--samples", "1,0,0", "--order", "1"]);
    assert!(twice.contains("offset 0 is given twice"), "{twice}");
    let few = refusal(&[&SIX[..], &["--parameters", "1"]].concat());
    assert!(few.contains("2 free parameters and 1 values"), "{few}");
    let bad = refusal(&[&SIX[..], &["--parameters", "1,1/0"]].concat());
    assert!(bad.contains("p2") && bad.contains("divides by zero"), "{bad}");
    refusal(&["formula", "derive", "--samples", "1,x", "--order", "1"]);
}

const SEARCH: [&str; 10] =
    ["formula", "search", "--steps", "5", "--order", "3", "--starts", "4", "--denominator", "48"];

#[test]
fn search_writes_rows_that_pass_check_and_the_front_as_data() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("found");
    let out = out.to_str().expect("a plain path");
    let found = json(&[&SEARCH[..], &["--out", out]].concat());
    assert!(found["rows"][0]["h_max"].as_f64() > Some(4.0 / 3.0));
    let rows = folder.path().join("found/rows.toml");
    let checked = json(&["formula", "check", rows.to_str().expect("a plain path")]);
    assert!(
        checked["formulas"].as_array().is_some_and(|rows| rows.iter().all(|row| row["declared_ok"] == true))
    );
    let front = std::fs::read_to_string(folder.path().join("found/front.csv")).expect("the front");
    assert!(front.starts_with("id,denominator,h_max,per_step,"), "{front}");
    assert_eq!(front.lines().count(), 1 + found["front"].as_array().map_or(0, Vec::len));
    let picture = std::fs::read_to_string(folder.path().join("found/front.svg")).expect("the figure");
    assert!(picture.contains("rows of the table") && picture.contains("5 steps, order 3"));
    // Files are not replaced unasked.
    kinstep(&[&SEARCH[..], &["--out", out]].concat()).assert().code(6);
}

#[test]
fn search_repeats_itself_whatever_the_threads() {
    let with = |threads| json(&[&SEARCH[..], &["--threads", threads]].concat());
    assert_eq!(with("1"), with("3"));
}

#[test]
fn search_refuses_in_sentences() {
    let with = |arguments: &[&str]| refusal(&[&SEARCH[..], arguments].concat());
    assert!(with(&["--objective", "rnge"]).contains("nearest: range"));
    assert!(with(&["--family", "other"]).contains("look-ahead, general, split, corrected"));
    assert!(with(&["--beat", "la6-wang-gou"]).contains("la6-wang-guo"));
    assert!(with(&["--beat", "la3-leapfrog"]).contains("nothing can be compared with it"));
    assert!(with(&["--seconds", "0"]).contains("--seconds 0"));
    assert!(with(&["--seconds", "nan"]).contains("--seconds NaN"));
    let barrier = refusal(&["formula", "search", "--steps", "5", "--order", "4"]);
    assert!(barrier.contains("r_3 = -1") && barrier.contains("highest possible order is 3"), "{barrier}");
    let narrow = refusal(&["formula", "search", "--steps", "5", "--order", "3", "--denominator", "5"]);
    assert!(narrow.contains("multiples of 6"), "{narrow}");
}

#[test]
fn compare_puts_formulas_side_by_side() {
    let both = json(&["formula", "compare", "la6-wang-guo", "split-ab4"]);
    assert_eq!(both["formulas"][0]["h_max_exact"], "2/3");
    assert_eq!(both["formulas"][1]["r_opt"], 0.0);
    let text = kinstep(&["formula", "compare", "la6-wang-guo", "am3"]).assert().success();
    let text = String::from_utf8_lossy(&text.get_output().stdout).into_owned();
    assert!(text.lines().next().is_some_and(|head| head.contains("la6-wang-guo") && head.contains("am3")));
    assert!(refusal(&["formula", "compare", "la6-wang-guo", "la6-wang-gu"]).contains("la6-wang-guo"));
    refusal(&["formula", "compare", "la6-wang-guo"]);
}

#[test]
fn compare_draws_the_formulas_over_one_another() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name).to_str().expect("a plain path").to_owned();
    let both = ["formula", "compare", "la6-wang-guo", "la6-fast", "--plot"];
    let into =
        |name: &str| [&both[..], &[&path(name)]].concat().iter().map(ToString::to_string).collect::<Vec<_>>();
    let run = |name: &str| {
        let arguments = into(name);
        kinstep(&arguments.iter().map(String::as_str).collect::<Vec<_>>())
    };
    run("figures").assert().success();
    let radius = std::fs::read_to_string(path("figures/comparison-radius.csv")).expect("the numbers");
    assert!(radius.contains("\nla6-wang-guo,") && radius.contains("\nla6-fast,"));
    run("both.svg").assert().success();
    assert!(
        std::fs::read_to_string(path("both.csv")).is_ok_and(|text| text.contains("comparison-boundary,"))
    );
    // Not replaced unasked.
    run("both.svg").assert().code(6);
}

#[test]
fn the_barrier_is_recomputed_and_has_a_reason_for_every_number_of_steps() {
    let barrier = json(&["formula", "barrier", "--steps", "10"]);
    let lines = barrier["barrier"].as_array().expect("lines");
    let orders: Vec<_> = lines.iter().map(|line| line["order"].as_u64().expect("an order")).collect();
    assert_eq!(orders, [1, 1, 2, 3, 3, 4, 4, 5, 5, 6]);
    for line in lines.iter().skip(1) {
        let value = line["value"].as_str().expect("a coefficient");
        assert!(value == "0" || value.starts_with('-'), "{line}");
    }
    refusal(&["formula", "barrier", "--steps", "19"]);
}

#[test]
fn an_irrational_end_of_the_range_is_a_surd_or_has_its_minimal_polynomial() {
    let card = |id: &str| json(&["formula", "show", id])["formulas"][0].clone();
    let surd = &card("la5-18")["h_max"];
    assert_eq!(surd["closed_form"], "(9 sqrt 17 - 27)/16");
    assert_eq!((&surd["polynomial"], &surd["irreducible"]), (&"32 h^2 + 108 h - 81".into(), &true.into()));
    assert_eq!(card("la9-420")["h_max"]["irreducible"], true);
    // A bound, proved, a billionth part below the optimum.
    let row = card("la6-wang-guo");
    let (r, bound) = (row["r_opt"].as_f64().expect("r_opt"), row["r_bound"].as_f64().expect("a bound"));
    assert!(bound < r && r - bound < 1.1e-9);
}
