//! What all figures share: colours, sizes, widths of text.

/// Okabe and Ito's palette without its yellow, which is too light for lines on white.
const COLOURS: [&str; 7] = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#222222"];
/// Dashes that go with the colours, so that lines can be told apart in grey.
const DASHES: [&str; 7] = ["", "7 4", "2 3", "9 3 2 3", "12 4", "4 2", "1 2"];

pub(super) const TEXT: &str = "#222222";
pub(super) const GRID: &str = "#e3e3e3";
pub(super) const GUIDE: &str = "#8a8a8a";
pub(super) const FONT: &str = "Helvetica, Arial, sans-serif";
pub(super) const FONT_SIZE: f64 = 13.0;
pub(super) const TITLE_SIZE: f64 = 15.0;

/// The longer side of a plot [px].
pub(super) const PLOT: f64 = 460.0;
/// The height of a plot whose axes have different units [px].
pub(super) const PLOT_HEIGHT: f64 = 330.0;

pub(super) fn colour(index: usize) -> &'static str {
    COLOURS[index % COLOURS.len()]
}

pub(super) fn dash(index: usize) -> &'static str {
    DASHES[index % DASHES.len()]
}

/// About how wide a text is set [px]: a little generous, as fonts differ from place to place.
pub(super) fn text_width(text: &str, size: f64) -> f64 {
    0.58 * size * text.chars().count() as f64
}
