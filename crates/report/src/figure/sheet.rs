//! Several figures on one page.

use std::fmt::Write;

use super::figure::Figure;
use super::svg::begin;

/// Returns the figures as one SVG document, `columns` side by side.
pub fn sheet(title: &str, figures: &[Figure], columns: usize) -> String {
    let columns = columns.max(1);
    let layouts: Vec<_> = figures.iter().map(Figure::layout).collect();
    let width = |column: usize| {
        layouts.iter().skip(column).step_by(columns).map(|l| l.total_width).fold(0.0, f64::max)
    };
    let lefts: Vec<f64> =
        (0..=columns).map(|column| (0..column).map(width).fold(0.0, |a, b| a + b)).collect();
    let heights: Vec<f64> =
        layouts.chunks(columns).map(|row| row.iter().map(|l| l.total_height).fold(0.0, f64::max)).collect();
    let mut svg = String::new();
    begin(&mut svg, (lefts[columns], heights.iter().sum()), "", title);
    svg.push_str("<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>");
    for (i, (figure, layout)) in figures.iter().zip(&layouts).enumerate() {
        let y = heights[..i / columns].iter().fold(0.0, |a, b| a + b);
        let _ = write!(svg, r#"<g transform="translate({:.1} {y:.1})">"#, lefts[i % columns]);
        figure.draw(&mut svg, layout);
        svg.push_str("</g>");
    }
    svg.push_str("</svg>\n");
    svg
}
