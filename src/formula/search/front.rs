//! Rows that no other surpasses in everything.

use std::fmt::Write as _;

use super::figures::Figures;
use super::found::Found;

/// Whether `a` is nowhere worse than `b` in h_max, C and r_opt, and better in one of them.
fn dominates(a: &Figures, b: &Figures) -> bool {
    let pairs = [(-a.h_max, -b.h_max), (a.per_step, b.per_step), (a.r_opt, b.r_opt)];
    pairs.iter().all(|(a, b)| a <= b) && pairs.iter().any(|(a, b)| a < b)
}

/// Returns the rows that no other one dominates in (h_max, C, r_opt), widest range first, each figure triple once.
pub fn front(rows: Vec<Found>) -> Vec<Found> {
    let mut kept: Vec<Found> = Vec::new();
    for row in rows {
        let figures = row.figures;
        if kept.iter().any(|other| dominates(&other.figures, &figures) || other.figures == figures) {
            continue;
        }
        kept.retain(|other| !dominates(&figures, &other.figures));
        kept.push(row);
    }
    kept.sort_by(|a, b| b.figures.h_max.total_cmp(&a.figures.h_max));
    kept
}

/// Returns rows as a table of values between commas: id, denominator, h_max, C, c, h_opt, r_opt and the gain of noise in phi'.
pub fn front_csv(rows: &[Found]) -> String {
    let mut text = String::from("id,denominator,h_max,per_step,error_constant,h_opt,r_opt,noise\n");
    for row in rows {
        let Figures { h_max, per_step, error_constant, h_opt, r_opt, noise } = row.figures;
        // Writing to a String can not fail.
        let _ = writeln!(
            text,
            "{},{},{h_max},{per_step},{error_constant},{h_opt},{r_opt},{noise}",
            row.checked.row().id(),
            row.denominator
        );
    }
    text
}
