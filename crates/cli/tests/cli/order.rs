//! `kinstep order` and `kinstep sweep`, run.

#![allow(clippy::unwrap_used, reason = "a test that can not go on stops")]

use crate::program::{Desk, ROW, SMALL, kinstep};
use serde_json::Value;

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("{value} is not a number"))
}

#[test]
fn two_rows_on_real_arms_show_their_orders_in_one_document() {
    let rows = ["--formula", "la6-wang-guo", "--formula", "split-ab4"];
    let document =
        kinstep(&[&["order", "examples/dual_panda.toml", "--json"], &rows[..]].concat()).expect(0).json();
    let sigma = document["sigma"].as_array().unwrap();
    assert!(sigma.len() >= 5 && sigma.iter().any(|sigma| (number(sigma) - 0.01).abs() < 1e-12), "{sigma:?}");
    let formulas = document["formulas"].as_array().unwrap();
    assert_eq!(formulas.len(), 2);
    for (formula, (id, order)) in formulas.iter().zip([("la6-wang-guo", 4.0), ("split-ab4", 5.0)]) {
        assert_eq!(formula["id"], id);
        for key in ["task_transient", "task_steady"] {
            assert!((number(&formula[key]) - order).abs() < 0.2, "{key}: {formula}");
        }
        assert!(formula.get("joint").is_some() && number(&formula["floor"]) < 1e-13);
        assert_eq!(formula["errors"].as_array().unwrap().len(), sigma.len());
        assert_eq!(formula["verdict"], "confirmed");
    }
}

#[test]
fn a_fixed_gain_costs_an_order() {
    let set = ["--set", "law.gain=20"];
    let document =
        kinstep(&[&["order", "examples/dual_panda.toml", "--json"], &set[..]].concat()).expect(0).json();
    let formula = &document["formulas"][0];
    assert!((number(&formula["task_transient"]) - 3.0).abs() < 0.1, "{formula}");
    assert_eq!(formula["h"], Value::Null);
}

#[test]
fn figures_and_numbers_are_written_beside_each_other() {
    let desk = Desk::new(&[("s.toml", SMALL)]);
    let out = ["--out", "study", "--set", "study.steps=[100, 200, 400, 800]"];
    let run = desk.run(&[&["order", "s.toml"], &out[..]].concat()).expect(0);
    assert!(run.out.contains("order 4 confirmed"), "{}", run.out);
    assert_eq!(desk.names("study"), ["order-s.csv", "order-s.json", "order-s.svg"]);
    let figure = std::fs::read_to_string(desk.path("study/order-s.svg")).unwrap();
    assert!(figure.contains("la6-wang-guo: order ") && figure.ends_with("</svg>\n"), "{figure}");
    desk.run(&[&["order", "s.toml"], &out[..]].concat()).expect(6);
}

#[test]
fn wrong_claims_unusable_rows_and_stopped_runs_have_their_exit_codes() {
    let desk = Desk::new(&[("s.toml", SMALL), ("mine.toml", ROW)]);
    let lying = ROW.replace("order = 3", "order = 4");
    std::fs::write(desk.path("lying.toml"), lying).unwrap();
    let order = |more: &[&str]| desk.run(&[&["order", "s.toml", "--json"], more].concat());
    let steps = "study.steps=[100, 200, 400, 800]";
    let claimed = order(&["--set", steps, "--set", "study.order=5"]).expect(1).json();
    assert_eq!(claimed["formulas"][0]["verdict"], "not reached");
    assert_eq!(
        order(&["--set", steps, "--formulas", "mine.toml", "--formula", "mine"]).expect(0).json()["formulas"]
            [0]["id"],
        "mine"
    );
    order(&["--formulas", "lying.toml", "--formula", "mine"]).expect(4).error();
    order(&["--formula", "bad-bdf7"]).expect(4).error();
    order(&["--formula", "bdf2"]).expect(4).error();
    order(&["--formula", "la6-wang"]).expect(2).error();
    order(&["--set", "law.h=0.9"]).expect(2).error();
    order(&["--set", "study.stepps=[1]"]).expect(2).error();
    let diverging =
        ["--set", "law.h=0.8", "--set", "allow_unstable=true", "--set", "study.steps=[500, 1000, 2000]"];
    let stopped = order(&diverging).expect(5).json();
    let formula = &stopped["formulas"][0];
    assert_eq!(
        (&formula["task_transient"], &formula["verdict"]),
        (&Value::Null, &"not decidable here".into())
    );
    assert!(formula["notes"][0].as_str().unwrap().contains("diverged"), "{formula}");
}

#[test]
fn problems_come_by_name_and_from_files() {
    let list = kinstep(&["order"]).expect(0);
    assert!(list.out.contains("arenstorf") && list.out.contains("detest_b5"), "{}", list.out);
    let several =
        kinstep(&["order", "swing", "problems/kepler.toml", "--formula", "ab3", "--json"]).expect(0).json();
    let studies = several["studies"].as_array().unwrap();
    assert_eq!(studies.len(), 2);
    for study in studies {
        assert!((number(&study["formulas"][0]["formula"]) - 3.0).abs() < 0.1, "{study}");
    }
    let error = kinstep(&["order", "keplr", "--json"]).expect(2).error();
    assert!(error["message"].as_str().unwrap().contains("did you mean kepler?"), "{error}");
    let error = kinstep(&["plan", "problems/kepler.toml", "--json"]).expect(2).error();
    assert!(error["message"].as_str().unwrap().contains("kinstep order"), "{error}");
    let bad = "sigma = 0.1\nduration = 1.0\n[problem]\nequations = [\"x' = y\"]\ninitial = [\"x = 1\"]\n";
    let desk = Desk::new(&[("bad.toml", bad)]);
    let error = desk.run(&["order", "bad.toml", "--json"]).expect(2).error();
    assert!(error["message"].as_str().unwrap().contains("\"y\" means nothing here"), "{error}");
    // The token itself is pointed at.
    assert_eq!((&error["line"], &error["column"]), (&4.into(), &20.into()), "{error}");
    let error =
        kinstep(&["order", "problems/kepler.toml", "--formula", "nosuch", "--json"]).expect(2).error();
    assert!(error["message"].as_str().unwrap().starts_with("--formula nosuch: "), "{error}");
    let error =
        kinstep(&["order", "problems/kepler.toml", "--formula", "bad-bdf7", "--json"]).expect(4).error();
    assert!(
        error["message"].as_str().unwrap().starts_with("--formula bad-bdf7: ") && error["line"].is_null(),
        "{error}"
    );
}

const VARY: [&str; 6] = [
    "--vary",
    "law.h=linspace(0.1, 0.6, 6)",
    "--vary",
    "arm.left.q0[1]=uniform(0.2, 0.4)",
    "--samples",
    "100",
];

#[test]
fn a_sweep_gives_the_same_bytes_whatever_the_threads_and_wherever_it_was_cut_off() {
    let desk = Desk::new(&[("s.toml", SMALL)]);
    let sweep = |out: &str, threads: &str| {
        let more = ["--set", "duration=0.5", "--out", out, "--threads", threads, "--json"];
        desk.run(&[&["sweep", "s.toml"], &VARY[..], &more[..]].concat())
    };
    for kind in ["csv", "json"] {
        let (one, two, cut) = (format!("one.{kind}"), format!("two.{kind}"), format!("cut.{kind}"));
        assert_eq!(sweep(&one, "1").expect(0).json()["statuses"]["completed"], 600);
        sweep(&two, "2").expect(0);
        let table = std::fs::read(desk.path(&one)).unwrap();
        assert!(table == std::fs::read(desk.path(&two)).unwrap(), "the bytes depend on the threads");
        // What a killed run leaves: whole lines and the beginning of the next.
        let journal = journal_of(&table, kind, 250);
        let heading = heading(&desk, kind);
        std::fs::write(desk.path(&format!("{cut}.journal")), format!("{heading}\n{journal}")).unwrap();
        assert_eq!(sweep(&cut, "2").expect(0).json()["resumed"], 250);
        assert!(table == std::fs::read(desk.path(&cut)).unwrap(), "a resumed table differs");
        assert!(!desk.path(&format!("{cut}.journal")).exists());
    }
}

/// The first `lines` records of a table as a journal has them, and half a line.
fn journal_of(table: &[u8], kind: &str, lines: usize) -> String {
    let text = String::from_utf8(table.to_vec()).unwrap();
    // A record of an array ends in a comma that is not its own; in CSV the comma stands before an empty reason.
    let own =
        |line: &str| if kind == "csv" { line.to_owned() } else { line.trim_end_matches(',').to_owned() };
    let records: Vec<String> = text.lines().skip(1).take(lines + 1).map(own).collect();
    let half = &records[lines][..records[lines].len() / 2];
    format!("{}\n{half}", records[..lines].join("\n"))
}

/// The first line of the journal of the sweep, read from one that is killed as soon as it has written it.
fn heading(desk: &Desk, kind: &str) -> String {
    let out = format!("cut.{kind}");
    let program = assert_cmd::cargo::cargo_bin("kinstep");
    let mut child = std::process::Command::new(program)
        .current_dir(desk.path("."))
        .args(["sweep", "s.toml"])
        .args(VARY)
        .args(["--set", "duration=0.5", "--out", &out])
        .stderr(std::process::Stdio::null())
        .stdout(std::process::Stdio::null())
        .spawn()
        .unwrap();
    let journal = desk.path(&format!("{out}.journal"));
    loop {
        let text = std::fs::read_to_string(&journal).unwrap_or_default();
        if let Some((heading, _)) = text.split_once('\n') {
            let _ = child.kill();
            let _ = child.wait();
            let _ = std::fs::remove_file(desk.path(&out));
            return heading.to_owned();
        }
        assert!(child.try_wait().unwrap().is_none() || journal.exists(), "the sweep was over too soon");
        std::thread::sleep(std::time::Duration::from_millis(1));
    }
}

#[test]
fn a_sweep_says_what_is_wrong_before_it_runs_and_keeps_refusals_in_the_table() {
    let desk = Desk::new(&[("s.toml", SMALL)]);
    let sweep = |more: &[&str]| desk.run(&[&["sweep", "s.toml", "--json"], more].concat());
    for (more, code, said) in [
        (&["--vary", "law.hh=1,2", "--out", "a.csv"][..], 2, "did you mean h?"),
        (&["--vary", "law.h=gauss(1,2)", "--out", "a.csv"], 2, "none of linspace"),
        (&["--vary", "arm.left.q0[9]=1,2", "--out", "a.csv"], 2, "the list has 4 entries"),
        (&["--vary", "law.h=0.1", "--out", "a.txt"], 2, ".csv or .json"),
        (&["--vary", "law.h=0.1", "--samples", "0", "--out", "a.csv"], 2, "at least once"),
    ] {
        let error = sweep(more).expect(code).error();
        assert!(error["message"].as_str().unwrap().contains(said), "{error}");
    }
    let run =
        sweep(&["--vary", "law.h=0.3,0.9", "--vary", "formula=la6-wang-guo,split-ab2", "--out", "a.csv"])
            .expect(0)
            .json();
    assert_eq!((&run["statuses"]["completed"], &run["statuses"]["refused"]), (&3.into(), &1.into()));
    let table = std::fs::read_to_string(desk.path("a.csv")).unwrap();
    assert_eq!(table.lines().count(), 5);
    assert!(
        table.lines().any(|line| line.contains(",refused,") && line.contains("outside the feedback range")),
        "{table}"
    );
    assert_eq!(desk.names("."), ["a.csv", "s.toml"]);
    sweep(&["--vary", "law.h=0.3", "--out", "a.csv"]).expect(6).error();
    std::fs::write(desk.path("b.csv.journal"), "kinstep sweep of something else\n").unwrap();
    let error = sweep(&["--vary", "law.h=0.3", "--out", "b.csv"]).expect(6).error();
    assert!(error["message"].as_str().unwrap().contains("of another sweep"), "{error}");
}

#[test]
fn what_can_not_be_compared_has_no_numbers_and_keys_without_effect_are_named() {
    let blowing = "sigma = 0.01\nduration = 2.0\nformula = \"ab4\"\n[problem]\nequations = [\"x' = x^2\"]\ninitial = [\"x = 1\"]\n";
    let desk = Desk::new(&[("b.toml", blowing), ("s.toml", SMALL)]);
    let run = desk.run(&["order", "b.toml", "--out", "study"]).expect(5);
    assert!(run.out.contains("leaves all bounds") && !run.out.contains("NaN!"), "{}", run.out);
    let csv = std::fs::read_to_string(desk.path("study/order-b.csv")).unwrap();
    assert!(!csv.contains("NaN") && !csv.contains("inf"), "{csv}");
    let extended = ["--set", "study.precision=extended", "--set", "study.steps=[100, 200, 400]"];
    let run = desk.run(&[&["order", "s.toml"], &extended[..]].concat()).expect(0);
    assert!(run.out.contains("study.precision = \"extended\" has no effect"), "{}", run.out);
}
