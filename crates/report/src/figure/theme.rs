//! The colours of a drawing as custom properties of a page's style sheet.

use std::fmt::Write;

use super::style::{COLOURS, GRID, GUIDE, PAPER, TEXT};

/// Values of the custom properties of [`Figure::to_svg_themed`](super::Figure::to_svg_themed) for a dark page: the
/// declarations of a CSS rule. The colours are as far apart as those for white paper, and lighter.
pub const DARK_THEME: &str = "--figure-paper:#16191d;--figure-ink:#e4e7ea;--figure-grid:#333a41;--figure-guide:#8d969f;\
--figure-1:#4aa8e0;--figure-2:#f08a3c;--figure-3:#2fc79a;--figure-4:#e39fc6;--figure-5:#f2bd4b;--figure-6:#9ad4f5";

/// A `style` element that turns the colours of a drawing into custom properties with those colours as fallbacks.
///
/// Rules of a style sheet win over presentation attributes, so one drawing serves files and pages.
pub(super) fn stylesheet() -> String {
    let named = [("paper", PAPER), ("ink", TEXT), ("grid", GRID), ("guide", GUIDE)];
    let named = named.map(|(name, colour)| (name.to_owned(), colour));
    // The last colour of lines is that of text.
    let lines = COLOURS[..6].iter().enumerate().map(|(k, colour)| ((k + 1).to_string(), *colour));
    let mut style = String::from("<style>");
    for (name, colour) in named.into_iter().chain(lines) {
        for part in ["fill", "stroke"] {
            // Writing to a String can not fail.
            let _ = write!(
                style,
                ".kinstep-figure [{part}=\"{colour}\"]{{{part}:var(--figure-{name},{colour})}}"
            );
        }
    }
    let _ = write!(style, ".kinstep-figure{{fill:var(--figure-ink,{TEXT})}}</style>");
    style
}
