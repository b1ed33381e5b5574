//! The laboratory on the command line: lists, cards, snippets, figures, the page.

#![allow(clippy::unwrap_used, reason = "a test that can not go on stops")]

use crate::program::{Desk, REPOSITORY, ROW, SMALL, kinstep};
use serde_json::Value;

fn listed(arguments: &[&str]) -> Vec<Value> {
    let all: Vec<&str> = ["formula", "list", "--json"].iter().chain(arguments).copied().collect();
    kinstep(&all).expect(0).json()["formulas"].as_array().unwrap().clone()
}

#[test]
fn a_list_is_narrowed_by_family_steps_order_and_stability() {
    let all = listed(&[]).len();
    let narrowed = listed(&["--family", "look-ahead", "--steps", "4-5", "--order", "3", "--zero-stable"]);
    assert!(!narrowed.is_empty() && narrowed.len() < all / 2);
    for row in &narrowed {
        assert_eq!((&row["family"], row["order"].as_u64()), (&"look-ahead".into(), Some(3)));
        assert!((4..=5).contains(&row["steps"].as_u64().unwrap()) && row["zero_stable"] == true);
    }
    let two = listed(&["--family", "bdf", "--family", "split"]);
    assert!(two.iter().any(|row| row["family"] == "bdf") && two.iter().any(|row| row["family"] == "split"));
    let none = kinstep(&["formula", "list", "--order", "40"]).expect(0);
    assert_eq!(none.out, "No formula is like that.\n");
}

#[test]
fn a_list_is_sorted_best_first_with_gaps_at_the_end() {
    let figure = |row: &Value, key: &str| match key {
        "range" if row["h_max"]["unbounded"] == true => Some(f64::NEG_INFINITY),
        "range" => row["h_max"]["value"].as_f64().filter(|h| *h > 0.0).map(|h| -h),
        "decay" => row["r_opt"].as_f64(),
        "noise" => row["noise_gain"]["feedforward_per_sigma"].as_f64(),
        _ => row["order"].as_f64().map(|order| -order),
    };
    for key in ["range", "decay", "noise", "order"] {
        let rows = listed(&["--sort", key]);
        let figures: Vec<f64> = rows.iter().map(|row| figure(row, key).unwrap_or(f64::INFINITY)).collect();
        assert!(figures.is_sorted(), "{key}: {figures:?}");
    }
    let ids: Vec<String> = listed(&["--sort", "id"]).iter().map(|row| row["id"].to_string()).collect();
    assert!(ids.is_sorted());
}

#[test]
fn a_list_refuses_what_it_does_not_know() {
    let run = kinstep(&["formula", "list", "--family", "lookahead"]).expect(2);
    assert!(
        run.err.contains("there is no family \"lookahead\"") && run.err.contains("look-ahead"),
        "{}",
        run.err
    );
    for steps in ["6-4", "x", "1-", "-3"] {
        kinstep(&["formula", "list", &format!("--steps={steps}")]).expect(2);
    }
}

#[test]
fn own_rows_are_filtered_like_built_in_ones() {
    let desk = Desk::new(&[("mine.toml", ROW)]);
    let run =
        desk.run(&["formula", "list", "--formulas", "mine.toml", "--order", "3", "--steps", "5"]).expect(0);
    assert!(run.out.lines().any(|line| line.starts_with("mine ")), "{}", run.out);
    let run = desk.run(&["formula", "list", "--formulas", "mine.toml", "--order", "4"]).expect(0);
    assert!(!run.out.lines().any(|line| line.starts_with("mine ")), "{}", run.out);
}

#[test]
fn every_kind_of_row_has_a_recommendation_with_a_reason() {
    let document = kinstep(&["formula", "list", "--recommended", "--json"]).expect(0).json();
    let lines = document["recommended"].as_array().unwrap();
    assert!(lines.len() > 10);
    assert!(lines.iter().all(|line| !line["why"].as_str().unwrap().is_empty()));
    let default = document["default"].as_str().unwrap();
    let text = kinstep(&["formula", "list", "--recommended", "--steps", "5"]).expect(0).out;
    assert!(text.contains(&format!("A plan that names no formula runs on {default}")), "{text}");
}

#[test]
fn derivative_rules_are_listed_with_their_noise() {
    let document = kinstep(&["formula", "list", "--derivative-rules", "--json"]).expect(0).json();
    let rules = document["derivative_rules"].as_array().unwrap();
    assert_eq!(rules.len(), 6);
    assert_eq!((&rules[2]["id"], &rules[2]["error_constant"]), (&"bd3".into(), &"-1/4".into()));
    let text = kinstep(&["formula", "list", "--derivative-rules", "--order", "2-3"]).expect(0).out;
    let plain = text.split_whitespace().collect::<Vec<_>>().join(" ");
    assert!(plain.contains("bd3 3 -1/4 3.8370 11/6 -3 3/2 -1/3"), "{text}");
    assert!(!text.contains("bd4"));
}

#[test]
fn the_card_has_exact_optima() {
    let text = kinstep(&["formula", "show", "la6-wang-guo"]).expect(0).out;
    for part in [
        "x_n+1 = 5/24 x_n + 1/2 x_n-1 + 1/4 x_n-2 + 1/6 x_n-3 - 1/8 x_n-4 + 2 sigma f_n",
        "(15 sqrt 33 - 71)/48; ",
        "(3 + sqrt 33)/12",
        "1.000000, ",
        "0 < h < 2/3",
    ] {
        assert!(text.contains(part), "{part} is not in\n{text}");
    }
    let card = &kinstep(&["formula", "show", "la6-wang-guo", "--json"]).expect(0).json()["formulas"][0];
    assert_eq!(card["h_opt_exact"]["closed_form"], "(15 sqrt 33 - 71)/48");
    assert_eq!(card["r_opt_squared_exact"]["closed_form"], "(3 + sqrt 33)/12");
    let ssp = kinstep(&["formula", "show", "la2-euler"]).expect(0).out;
    assert!(ssp.contains("SSP             1: keeps"), "{ssp}");
}

#[test]
fn a_long_row_says_that_its_optimum_is_numeric() {
    let run = kinstep(&["formula", "show", "la11-1560"]).expect(0);
    assert!(run.out.contains("out of reach for a row of this length"), "{}", run.out);
}

#[test]
fn snippets_replace_the_card_and_join_the_document() {
    let rust = kinstep(&["formula", "show", "split-ab3", "--rust"]).expect(0);
    assert_eq!(rust.out, include_str!("../../../../tests/data/snippet_split_ab3.rs"));
    let both = kinstep(&["formula", "show", "ab2", "--latex", "--python"]).expect(0).out;
    assert!(both.contains("\\begin{equation}") && both.contains("def step(x, f, sigma):"), "{both}");
    assert!(!both.contains("stability"), "{both}");
    let bib = kinstep(&["formula", "show", "la6-wang-guo", "--bibtex"]).expect(0).out;
    assert!(bib.starts_with("@article{wang2020,"), "{bib}");
    let card = &kinstep(&["formula", "show", "ab2", "--latex", "--json"]).expect(0).json()["formulas"][0];
    assert!(card["latex"].as_str().unwrap().contains("x_{n+1}") && card["id"] == "ab2");
}

#[test]
fn figures_go_into_a_folder_with_their_numbers_beside_them() {
    let desk = Desk::new(&[]);
    desk.run(&["formula", "show", "la6-wang-guo", "--plot", "pictures"]).expect(0);
    let names = desk.names("pictures");
    assert_eq!(names.len(), 10, "{names:?}");
    for stem in ["roots", "locus", "radius", "region", "noise"] {
        let svg = std::fs::read_to_string(desk.path(&format!("pictures/la6-wang-guo-{stem}.svg"))).unwrap();
        assert!(svg.starts_with("<svg ") && svg.ends_with("</svg>\n"));
        let csv = std::fs::read_to_string(desk.path(&format!("pictures/la6-wang-guo-{stem}.csv"))).unwrap();
        let columns = csv.lines().next().unwrap().split(',').count();
        assert!(csv.lines().all(|line| line.split(',').count() == columns), "{stem}");
    }
    desk.run(&["formula", "show", "la6-wang-guo", "--plot", "pictures"]).expect(6);
    desk.run(&["formula", "show", "la6-wang-guo", "--plot", "pictures", "--force"]).expect(0);
}

#[test]
fn figures_of_several_rows_fit_on_one_page() {
    let desk = Desk::new(&[]);
    desk.run(&["formula", "show", "ab2", "split-ab2", "--plot", "page.svg"]).expect(0);
    assert_eq!(desk.names("."), ["page.csv", "page.svg"]);
    let csv = std::fs::read_to_string(desk.path("page.csv")).unwrap();
    assert!(csv.contains("ab2-radius,ab2,") && csv.contains("split-ab2-noise,"));
    let twice = desk.run(&["formula", "show", "ab2", "ab2", "--plot", "again"]).expect(2);
    assert!(twice.err.contains("written twice"), "{}", twice.err);
}

#[test]
fn the_page_about_the_formulas_is_up_to_date() {
    let desk = Desk::new(&[]);
    desk.run(&["formula", "docs", "--out", "formulas.md"]).expect(0);
    let docs = std::path::Path::new(REPOSITORY).join("docs");
    let again = "kinstep formula docs --out docs/formulas.md --force";
    let read = |path: std::path::PathBuf| std::fs::read_to_string(path).unwrap_or_default();
    assert!(read(desk.path("formulas.md")) == read(docs.join("formulas.md")), "run `{again}`");
    for name in desk.names("pictures") {
        let (new, committed) =
            (read(desk.path("pictures").join(&name)), read(docs.join("pictures").join(&name)));
        assert!(new == committed, "{name}: run `{again}`");
    }
}

#[test]
fn a_plan_without_a_formula_says_which_it_takes() {
    let without = SMALL.replace("formula = \"la6-wang-guo\"\n", "").replace("[law]\nh = 0.4\n", "");
    let desk = Desk::new(&[("s.toml", &without)]);
    let document = kinstep(&["formula", "list", "--recommended", "--json"]).expect(0).json();
    let default = document["default"].as_str().unwrap().to_owned();
    let run = desk.run(&["plan", "s.toml", "--out", "o"]).expect(0);
    assert!(run.out.contains(&format!("The scenario names no formula: {default} does best")), "{}", run.out);
    let written = std::fs::read_to_string(desk.path("o/scenario.toml")).unwrap();
    assert!(written.contains(&format!("formula = \"{default}\"")), "{written}");
}
