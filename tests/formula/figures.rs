//! Every row of the table against figures worked out elsewhere.

use std::collections::HashSet;

use kinstep::formula::{Formula, FormulaTable};
use serde::Deserialize;

#[derive(Deserialize)]
struct Document {
    figures: Vec<Figures>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Figures {
    id: String,
    order: usize,
    error_constant: String,
    zero_stable: bool,
    root_moduli: Option<Vec<f64>>,
    h_max: Option<String>,
    h_max_decimal: Option<f64>,
    h_max_polynomial: Option<String>,
    h_opt: Option<f64>,
    r_opt: Option<f64>,
}

fn figures() -> Vec<Figures> {
    let text = include_str!("../data/formula_figures.toml");
    toml::from_str::<Document>(text).expect("the figures are TOML of this shape").figures
}

fn close(found: f64, expected: f64) -> bool {
    (found - expected).abs() <= 1.5e-12 * expected.abs().max(1.0)
}

fn formula(id: &str) -> &'static Formula {
    FormulaTable::builtin().get(id).expect("every row with figures is in the table")
}

#[test]
fn every_figure_has_a_row_and_most_rows_have_figures() {
    // Rows may be added without figures from elsewhere: what they declare is recomputed when the table is read.
    let ids: HashSet<_> = figures().into_iter().map(|f| f.id).collect();
    for id in &ids {
        formula(id);
    }
    assert!(ids.len() >= 116, "figures were lost");
}

#[test]
fn facts_match() {
    for figures in figures() {
        let formula = formula(&figures.id);
        assert_eq!(formula.order(), figures.order, "{}", figures.id);
        assert_eq!(formula.error_constant().to_string(), figures.error_constant, "{}", figures.id);
        assert_eq!(formula.is_zero_stable(), figures.zero_stable, "{}", figures.id);
    }
}

#[test]
fn root_moduli_match() {
    for figures in figures() {
        let Some(expected) = &figures.root_moduli else { continue };
        let found = formula(&figures.id).root_moduli();
        assert_eq!(found.len(), expected.len(), "{}", figures.id);
        for (found, expected) in found.iter().zip(expected) {
            assert!(close(*found, *expected), "{}: modulus {found} is not {expected}", figures.id);
        }
    }
}

#[test]
fn feedback_ranges_match() {
    for figures in figures() {
        let range = formula(&figures.id).feedback_range();
        match figures.h_max.as_deref() {
            Some("inf") => assert!(range.is_unbounded(), "{}: {range}", figures.id),
            Some("0") => assert!(range.is_empty(), "{}: {range}", figures.id),
            Some(exact) => {
                assert_eq!(range.exact().map(|h| h.to_string()).as_deref(), Some(exact), "{}", figures.id);
            }
            None => {}
        }
        if let Some(expected) = figures.h_max_decimal {
            assert!(close(range.value(), expected), "{}: {range} does not end at {expected}", figures.id);
        }
        if let Some(expected) = figures.h_max_polynomial {
            assert_eq!(range.polynomial(), Some(expected), "{}", figures.id);
        }
    }
}

#[test]
fn optima_match() {
    for figures in figures() {
        let Some(expected) = figures.h_opt else { continue };
        let found = formula(&figures.id).optimum().expect("a row with a best h has an optimum");
        assert!(close(found.h, expected), "{}: h_opt {} is not {expected}", figures.id, found.h);
        let expected = figures.r_opt.expect("a best h comes with its radius");
        assert!(close(found.radius, expected), "{}: r_opt {} is not {expected}", figures.id, found.radius);
    }
}
