//! A figure drawn.

use std::fmt::Write;

use super::axis::{Axis, Tick};
use super::figure::{Figure, Mark, Shape};
use super::style::{
    FONT, FONT_SIZE, GRID, GUIDE, PLOT, PLOT_HEIGHT, TEXT, TITLE_SIZE, colour, dash, text_width,
};

/// The area inside the axes, and the whole around it [px].
pub(super) struct Layout {
    left: f64,
    top: f64,
    width: f64,
    height: f64,
    pub(super) total_width: f64,
    pub(super) total_height: f64,
}

const LEGEND_GAP: f64 = 16.0;
const LEGEND_SAMPLE: f64 = 30.0;
const LEGEND_LINE: f64 = 20.0;

impl Figure {
    /// Returns the figure as an SVG document.
    pub fn to_svg(&self) -> String {
        let layout = self.layout();
        let (w, h) = (layout.total_width, layout.total_height);
        let mut svg = String::new();
        begin(&mut svg, w, h, &self.title);
        self.draw(&mut svg, &layout);
        svg.push_str("</svg>\n");
        svg
    }

    /// Returns where the axes are in the drawing: left, right, top and bottom [px], and the ends of the horizontal axis.
    pub fn window(&self) -> [f64; 6] {
        let Layout { left, top, width, height, .. } = self.layout();
        [left, left + width, top, top + height, self.x.range.0, self.x.range.1]
    }

    /// Names of the legend, each once, in the order of the marks.
    fn legend(&self) -> Vec<(&str, &Mark)> {
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
        let (width, height) = if self.is_isometric {
            let (dx, dy) = (self.x.range.1 - self.x.range.0, self.y.range.1 - self.y.range.0);
            let scale = (PLOT / dx).min(PLOT * 0.85 / dy);
            (dx * scale, dy * scale)
        } else {
            (PLOT, PLOT_HEIGHT)
        };
        let ticks = self.y.ticks();
        let widest = ticks.iter().map(label_width).fold(0.0, f64::max);
        let left = 42.0 + widest;
        let top = 44.0;
        let legend = self.legend();
        let names = legend.iter().map(|(name, _)| text_width(name, FONT_SIZE)).fold(0.0, f64::max);
        let beside = if legend.is_empty() { 22.0 } else { LEGEND_GAP + LEGEND_SAMPLE + names + 10.0 };
        let title = text_width(&self.title, TITLE_SIZE) + 24.0;
        Layout {
            left,
            top,
            width,
            height,
            total_width: (left + width + beside).max(title).ceil(),
            total_height: (top + height.max(LEGEND_LINE * legend.len() as f64) + 56.0).ceil(),
        }
    }

    /// Draws everything at the origin of the current coordinates.
    pub(super) fn draw(&self, svg: &mut String, layout: &Layout) {
        let pen = Pen { figure: self, layout };
        let (w, h) = (layout.total_width, layout.total_height);
        let _ = write!(svg, r##"<rect width="{w}" height="{h}" fill="#ffffff"/>"##);
        text(svg, (12.0, 25.0), "start", TITLE_SIZE, " font-weight=\"bold\"", &self.title);
        pen.grid(svg);
        let clip = format!("clip-{}", self.name);
        let Layout { left, top, width, height, .. } = layout;
        let _ = write!(
            svg,
            r#"<clipPath id="{clip}"><rect x="{left:.1}" y="{top:.1}" width="{width:.1}" height="{height:.1}"/></clipPath><g clip-path="url(#{clip})">"#
        );
        self.marks.iter().for_each(|mark| pen.mark(svg, mark));
        svg.push_str("</g>");
        let _ = write!(
            svg,
            r#"<rect x="{left:.1}" y="{top:.1}" width="{width:.1}" height="{height:.1}" fill="none" stroke="{TEXT}"/>"#
        );
        pen.labels(svg);
        pen.legend(svg);
    }
}

/// Opens a document of this size.
pub(super) fn begin(svg: &mut String, width: f64, height: f64, title: &str) {
    let _ = write!(
        svg,
        r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" height="{height}" font-family="{FONT}" font-size="{FONT_SIZE}" fill="{TEXT}" role="img"><title>{}</title>"#,
        escaped(title)
    );
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

fn text(svg: &mut String, (x, y): (f64, f64), anchor: &str, size: f64, extra: &str, content: &str) {
    let _ = write!(
        svg,
        r#"<text x="{x:.1}" y="{y:.1}" text-anchor="{anchor}" font-size="{size}"{extra}>{}</text>"#,
        escaped(content)
    );
}

fn label_width(tick: &Tick) -> f64 {
    let exponent = tick.label.1.as_ref().map_or(0.0, |e| text_width(e, 10.0));
    text_width(&tick.label.0, FONT_SIZE) + exponent
}

/// A tick's label, with its exponent raised.
fn tick_text(svg: &mut String, (x, y): (f64, f64), anchor: &str, tick: &Tick) {
    let exponent = tick
        .label
        .1
        .as_ref()
        .map_or_else(String::new, |e| format!(r#"<tspan dy="-5" font-size="10">{e}</tspan>"#));
    let _ = write!(
        svg,
        r#"<text x="{x:.1}" y="{y:.1}" text-anchor="{anchor}">{}{exponent}</text>"#,
        escaped(&tick.label.0)
    );
}

struct Pen<'f> {
    figure: &'f Figure,
    layout: &'f Layout,
}

impl Pen<'_> {
    /// A point on the page, kept within reach of it; `None` where it is not a number.
    fn at(&self, (x, y): (f64, f64)) -> Option<(f64, f64)> {
        // In widths of the plot: dashes of lines that go on for ever would never be done.
        const FAR: f64 = 3.0;
        let along = |axis: &Axis, value: f64| axis.place(value).clamp(-FAR, FAR);
        let (u, v) = (along(&self.figure.x, x), along(&self.figure.y, y));
        let Layout { left, top, width, height, .. } = self.layout;
        (u.is_finite() && v.is_finite()).then_some((left + u * width, top + (1.0 - v) * height))
    }

    fn grid(&self, svg: &mut String) {
        let Layout { left, top, width, height, .. } = self.layout;
        let (right, bottom) = (left + width, top + height);
        let mut lines = String::new();
        for tick in self.figure.x.ticks() {
            let x = left + self.figure.x.place(tick.value) * width;
            let _ = write!(lines, "M{x:.1} {top:.1}V{bottom:.1}");
            tick_text(svg, (x, bottom + 18.0), "middle", &tick);
        }
        for tick in self.figure.y.ticks() {
            let y = bottom - self.figure.y.place(tick.value) * height;
            let _ = write!(lines, "M{left:.1} {y:.1}H{right:.1}");
            tick_text(svg, (left - 7.0, y + 4.5), "end", &tick);
        }
        let _ = write!(svg, r#"<path d="{lines}" stroke="{GRID}" fill="none"/>"#);
    }

    fn labels(&self, svg: &mut String) {
        let Layout { left, top, width, height, .. } = self.layout;
        text(svg, (left + width / 2.0, top + height + 42.0), "middle", FONT_SIZE, "", &self.figure.x.label);
        let (x, y) = (18.0, top + height / 2.0);
        let turn = format!(" transform=\"rotate(-90 {x:.1} {y:.1})\"");
        text(svg, (x, y), "middle", FONT_SIZE, &turn, &self.figure.y.label);
    }

    fn legend(&self, svg: &mut String) {
        let Layout { left, top, width, .. } = self.layout;
        let x = left + width + LEGEND_GAP;
        for (i, (name, mark)) in self.figure.legend().iter().enumerate() {
            let y = top + 10.0 + LEGEND_LINE * i as f64;
            match mark {
                Mark::Line { style, .. } => {
                    let _ = write!(svg, r#"<path d="M{x:.1} {y:.1}h24" {}/>"#, stroke(*style));
                }
                Mark::Points { shape, style, .. } => point(svg, (x + 12.0, y), *shape, *style),
                Mark::Region { style, .. } => {
                    let _ = write!(
                        svg,
                        r#"<rect x="{x:.1}" y="{:.1}" width="24" height="12" fill="{}" fill-opacity="0.25"/>"#,
                        y - 6.0,
                        colour(*style)
                    );
                }
                Mark::Guide { .. } | Mark::Label { .. } => {}
            }
            text(svg, (x + LEGEND_SAMPLE, y + 4.5), "start", FONT_SIZE, "", name);
        }
    }

    fn mark(&self, svg: &mut String, mark: &Mark) {
        match mark {
            Mark::Line { points, style, .. } => self.line(svg, points, &stroke(*style)),
            Mark::Guide { points } => {
                self.line(svg, points, &format!(r#"stroke="{GUIDE}" stroke-width="1" fill="none""#));
            }
            Mark::Points { points, shape, style, .. } => {
                points.iter().filter_map(|p| self.at(*p)).for_each(|p| point(svg, p, *shape, *style));
            }
            Mark::Region { strips, style, .. } => self.region(svg, strips, *style),
            Mark::Label { text: content, at } => self.label(svg, content, *at),
        }
    }

    fn line(&self, svg: &mut String, points: &[(f64, f64)], stroke: &str) {
        // What is nearer than this to the last point does not show.
        const CLOSE: f64 = 0.4;
        let mut path = String::new();
        let mut last: Option<(f64, f64)> = None;
        for (i, point) in points.iter().enumerate() {
            let Some((x, y)) = self.at(*point) else {
                last = None;
                continue;
            };
            let is_end = points.get(i + 1).is_none_or(|next| self.at(*next).is_none());
            match last {
                Some((u, v)) if (x - u).hypot(y - v) < CLOSE && !is_end => continue,
                Some(_) => _ = write!(path, "L{x:.1} {y:.1}"),
                None => _ = write!(path, "M{x:.1} {y:.1}"),
            }
            last = Some((x, y));
        }
        let _ = write!(svg, r#"<path d="{path}" {stroke}/>"#);
    }

    fn region(&self, svg: &mut String, strips: &[[f64; 4]], style: usize) {
        let mut path = String::new();
        for [left, right, lower, upper] in strips {
            if let (Some((x, y)), Some((u, v))) = (self.at((*left, *upper)), self.at((*right, *lower))) {
                let _ = write!(path, "M{x:.1} {y:.1}H{u:.1}V{v:.1}H{x:.1}z");
            }
        }
        let fill = colour(style);
        let _ = write!(
            svg,
            r#"<path d="{path}" fill="{fill}" fill-opacity="0.25" shape-rendering="crispEdges"/>"#
        );
    }

    /// A text below its point, to the right or, where there is no room, to the left, with a white halo.
    fn label(&self, svg: &mut String, content: &str, at: (f64, f64)) {
        let Some((x, y)) = self.at(at) else { return };
        let Layout { left, top, width, height, .. } = self.layout;
        let fits = x + 9.0 + text_width(content, FONT_SIZE) < left + width;
        let (x, anchor) = if fits { (x + 9.0, "start") } else { (x - 9.0, "end") };
        let halo = r##" stroke="#ffffff" stroke-width="4" paint-order="stroke""##;
        text(svg, (x, (y + 20.0).min(top + height - 6.0)), anchor, FONT_SIZE, halo, content);
    }
}

fn stroke(style: usize) -> String {
    let dashes = match dash(style) {
        "" => String::new(),
        dash => format!(r#" stroke-dasharray="{dash}""#),
    };
    format!(r#"stroke="{}" stroke-width="2"{dashes} fill="none" stroke-linejoin="round""#, colour(style))
}

fn point(svg: &mut String, (x, y): (f64, f64), shape: Shape, style: usize) {
    let ink = colour(style);
    let _ = match shape {
        Shape::Disk => write!(svg, r#"<circle cx="{x:.1}" cy="{y:.1}" r="4.5" fill="{ink}"/>"#),
        Shape::Circle => write!(
            svg,
            r##"<circle cx="{x:.1}" cy="{y:.1}" r="4.5" fill="#ffffff" stroke="{ink}" stroke-width="1.8"/>"##
        ),
        Shape::Cross => write!(
            svg,
            r#"<path d="M{:.1} {:.1}l8 8m0 -8l-8 8" stroke="{ink}" stroke-width="2.2" fill="none"/>"#,
            x - 4.0,
            y - 4.0
        ),
        Shape::Diamond => {
            write!(svg, r#"<path d="M{x:.1} {:.1}l5.5 5.5l-5.5 5.5l-5.5 -5.5z" fill="{ink}"/>"#, y - 5.5)
        }
        Shape::Square => write!(
            svg,
            r##"<rect x="{:.1}" y="{:.1}" width="8" height="8" fill="#ffffff" stroke="{ink}" stroke-width="1.8"/>"##,
            x - 4.0,
            y - 4.0
        ),
    };
}
