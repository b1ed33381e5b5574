//! Where the parts of a drawing go: title, plot, legend and caption.

use super::axis::Tick;
use super::figure::{Figure, Mark};
use super::style::{CAPTION_SIZE, FONT_SIZE, PLOT, PLOT_HEIGHT, TITLE_SIZE, shortened, text_width, wrapped};

pub(super) const LEGEND_SAMPLE: f64 = 30.0;
pub(super) const LEGEND_LINE: f64 = 20.0;
pub(super) const CAPTION_LINE: f64 = 15.0;
pub(super) const TITLE_LINE: f64 = 19.0;
const LEGEND_GAP: f64 = 16.0;
/// Blank beside titles and captions [px].
pub(super) const EDGE: f64 = 12.0;
/// Below the plot: the ticks' labels and the axis's own.
const BELOW: f64 = 56.0;
/// The least plot that is drawn [px].
const LEAST: (f64, f64) = (80.0, 60.0);
/// The least width of a drawing with a caption [px].
const READABLE: f64 = 380.0;
/// A plot keeps at least this share of the width before the legend moves below it.
const PLOT_SHARE: f64 = 0.55;
/// The legend below a plot takes at most this share of the height.
const LEGEND_SHARE: f64 = 0.3;

/// The area inside the axes, and the whole around it [px].
pub(super) struct Layout {
    pub(super) left: f64,
    pub(super) top: f64,
    pub(super) width: f64,
    pub(super) height: f64,
    pub(super) total_width: f64,
    pub(super) total_height: f64,
    pub(super) title: Vec<String>,
    pub(super) caption: Vec<String>,
    pub(super) legend: Legend,
}

/// Where the entries of a legend stand.
pub(super) struct Legend {
    pub(super) at: (f64, f64),
    columns: usize,
    column_width: f64,
    /// How many entries are shown; of those left out a line tells the number.
    pub(super) shown: usize,
    pub(super) left_out: usize,
    /// The most characters of a name.
    pub(super) longest: usize,
}

impl Legend {
    /// The place of an entry [px].
    pub(super) fn place(&self, index: usize) -> (f64, f64) {
        let (row, column) = (index / self.columns, index % self.columns);
        (self.at.0 + self.column_width * column as f64, self.at.1 + LEGEND_LINE * row as f64)
    }

    fn rows(&self) -> usize {
        (self.shown + usize::from(self.left_out > 0)).div_ceil(self.columns)
    }
}

impl Figure {
    /// Names of the legend, each once, in the order of the marks.
    pub(super) fn legend(&self) -> Vec<(&str, &Mark)> {
        let mut entries: Vec<(&str, &Mark)> = Vec::new();
        for mark in &self.marks {
            if let Some((name, _)) = mark.legend().filter(|(name, _)| !name.is_empty())
                && entries.iter().all(|(known, _)| *known != name)
            {
                entries.push((name, mark));
            }
        }
        entries
    }

    pub(super) fn layout(&self) -> Layout {
        match self.size {
            Some(size) => self.layout_within(size),
            None => self.layout_around(),
        }
    }

    /// The drawing around a plot of the usual size.
    fn layout_around(&self) -> Layout {
        let (width, height) =
            self.plot_within((PLOT, if self.is_isometric { PLOT * 0.85 } else { PLOT_HEIGHT }));
        let (left, top) = (self.left_of(height), 44.0);
        let entries = self.legend();
        let names = widest_name(&entries, usize::MAX);
        let beside = if entries.is_empty() { 22.0 } else { LEGEND_GAP + LEGEND_SAMPLE + names + 10.0 };
        let title = text_width(&self.title, TITLE_SIZE) + 2.0 * EDGE;
        let readable = if self.caption.is_empty() { 0.0 } else { READABLE };
        let total_width = (left + width + beside).max(title).max(readable).ceil();
        let caption = wrapped(&self.caption, total_width - 2.0 * EDGE, CAPTION_SIZE);
        let legend = Legend {
            at: (left + width + LEGEND_GAP, top + 10.0),
            columns: 1,
            column_width: 0.0,
            shown: entries.len(),
            left_out: 0,
            longest: usize::MAX,
        };
        let body = height.max(LEGEND_LINE * entries.len() as f64);
        let total_height = (top + body + BELOW + caption_height(&caption)).ceil();
        Layout {
            left,
            top,
            width,
            height,
            total_width,
            total_height,
            title: vec![self.title.clone()],
            caption,
            legend,
        }
    }

    /// The drawing within a given size: what has too much to say says less, and nothing stands on anything else.
    fn layout_within(&self, (total_width, total_height): (f64, f64)) -> Layout {
        let title = wrapped(&self.title, total_width - 2.0 * EDGE, TITLE_SIZE);
        let caption = wrapped(&self.caption, total_width - 2.0 * EDGE, CAPTION_SIZE);
        let top = 44.0 + TITLE_LINE * title.len().saturating_sub(1) as f64;
        let room = total_height - top - BELOW - caption_height(&caption);
        let left = self.left_of(room.max(LEAST.1));
        let entries = self.legend();
        let (legend, beside, below) = place_legend(&entries, (total_width, total_height), (left, room));
        let plot = ((total_width - left - beside).max(LEAST.0), (room - below).max(LEAST.1));
        let (width, height) = self.plot_within(plot);
        let at = if below > 0.0 {
            (EDGE, top + height + BELOW + 6.0)
        } else {
            (left + width + LEGEND_GAP, top + 10.0)
        };
        let legend = Legend { at, ..legend };
        // What was asked for may be too small for anything at all.
        let needed = top + height + BELOW + below + caption_height(&caption);
        // Sums of the parts may be off by rounding.
        let total_height = total_height.max(needed - 1e-6).ceil();
        let total_width = total_width.max(left + width + beside - 1e-6).ceil();
        Layout { left, top, width, height, total_width, total_height, title, caption, legend }
    }

    /// The part of this room that the plot takes: all, unless both axes have one scale.
    fn plot_within(&self, (width, height): (f64, f64)) -> (f64, f64) {
        if !self.is_isometric {
            return (width, height);
        }
        let (dx, dy) = (self.x.range.1 - self.x.range.0, self.y.range.1 - self.y.range.0);
        let scale = (width / dx).min(height / dy);
        (dx * scale, dy * scale)
    }

    /// The room to the left of a plot of this height: the ticks' labels and the axis's own.
    fn left_of(&self, height: f64) -> f64 {
        42.0 + self.y.ticks(height, FONT_SIZE).iter().map(label_width).fold(0.0, f64::max)
    }
}

/// The legend, and what it takes of the width beside the plot and of the height below it.
fn place_legend(
    entries: &[(&str, &Mark)],
    (total_width, total_height): (f64, f64),
    (left, room): (f64, f64),
) -> (Legend, f64, f64) {
    let longest = ((0.4 * total_width) / text_width("x", FONT_SIZE)).max(6.0) as usize;
    let column_width = LEGEND_SAMPLE + widest_name(entries, longest) + 14.0;
    let beside = LEGEND_GAP + column_width;
    let one_column = LEGEND_LINE * entries.len() as f64;
    let mut legend =
        Legend { at: (0.0, 0.0), columns: 1, column_width, shown: entries.len(), left_out: 0, longest };
    if entries.is_empty() {
        return (legend, 22.0, 0.0);
    }
    if total_width - left - beside >= PLOT_SHARE * total_width && one_column <= room.max(LEAST.1) {
        return (legend, beside, 0.0);
    }
    legend.columns = (((total_width - 2.0 * EDGE) / column_width) as usize).max(1);
    let most_rows = ((LEGEND_SHARE * total_height / LEGEND_LINE) as usize).max(1);
    if entries.len().div_ceil(legend.columns) > most_rows {
        legend.shown = (most_rows * legend.columns).saturating_sub(1);
        legend.left_out = entries.len() - legend.shown;
    }
    let below = LEGEND_LINE * legend.rows() as f64 + 8.0;
    (legend, 22.0, below)
}

fn caption_height(caption: &[String]) -> f64 {
    if caption.is_empty() { 0.0 } else { CAPTION_LINE * caption.len() as f64 + 6.0 }
}

fn widest_name(entries: &[(&str, &Mark)], longest: usize) -> f64 {
    entries.iter().map(|(name, _)| text_width(&shortened(name, longest), FONT_SIZE)).fold(0.0, f64::max)
}

fn label_width(tick: &Tick) -> f64 {
    let exponent = tick.label.1.as_ref().map_or(0.0, |e| text_width(e, 10.0));
    text_width(&tick.label.0, FONT_SIZE) + exponent
}

#[cfg(test)]
mod tests {
    use super::super::{Axis, Scale};
    use super::*;
    use proptest::prelude::*;

    fn figure(lines: usize, size: (f64, f64)) -> Figure {
        let line = |k: usize| Mark::Line {
            name: format!("a_rather_long_joint_name_{k}"),
            points: vec![(0.0, 0.0), (1.0, 1.0)],
            parameter: Vec::new(),
            style: k,
        };
        Figure {
            name: "a".to_owned(),
            title: "a title of quite some words that may have to be broken".to_owned(),
            x: Axis::new("time t [s]", "t", Scale::Linear, (0.0, 1.0)),
            y: Axis::new("position [rad]", "q", Scale::Linear, (0.0, 1.0)),
            is_isometric: false,
            caption: "formula la6-wang-guo, sigma = 0.01 s, h = 0.4, start rk4".to_owned(),
            size: Some(size),
            parameter: None,
            marks: (0..lines).map(line).collect(),
        }
    }

    proptest! {
        #[test]
        fn the_parts_of_a_drawing_stand_apart(lines in 0..40_usize, width in 240.0..2400.0_f64, height in 260.0..1600.0_f64) {
            let figure = figure(lines, (width, height));
            let layout = figure.layout();
            prop_assert!(layout.left + layout.width <= layout.total_width + 1e-6);
            let entries = layout.legend.shown + usize::from(layout.legend.left_out > 0);
            prop_assert_eq!(layout.legend.shown + layout.legend.left_out, lines);
            for entry in 0..entries {
                let (x, y) = layout.legend.place(entry);
                let is_beside = x > layout.left + layout.width;
                let is_below = y > layout.top + layout.height + 42.0;
                prop_assert!(is_beside || is_below);
                prop_assert!(y < layout.total_height - caption_height(&layout.caption));
            }
            if width >= 320.0 && height >= 400.0 {
                prop_assert!(layout.total_width == width.ceil() && layout.total_height == height.ceil());
            }
        }
    }
}
