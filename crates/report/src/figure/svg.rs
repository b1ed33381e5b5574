//! A figure drawn.

use std::fmt::Write;

use super::axis::{Axis, Tick};
use super::figure::{Cell, Figure, Mark, Shape};
use super::layout::{CAPTION_LINE, EDGE, LEGEND_SAMPLE, Layout, TITLE_LINE};
use super::outline::outline;
use super::style::{
    CAPTION_SIZE, FONT, FONT_SIZE, GRID, GUIDE, PAPER, TEXT, TITLE_SIZE, colour, dash, shortened, text_width,
};
use super::theme::stylesheet;

impl Figure {
    /// Returns the figure as an SVG document.
    pub fn to_svg(&self) -> String {
        self.document("")
    }

    /// Returns the same drawing for a page: every colour is a custom property of the page's style sheet, `--figure-paper`,
    /// `--figure-ink`, `--figure-grid`, `--figure-guide` and `--figure-1` to `--figure-6`, and what it is in
    /// [`to_svg`](Self::to_svg) where the page does not set it. The root has the class `kinstep-figure`. See
    /// [`DARK_THEME`](super::DARK_THEME).
    pub fn to_svg_themed(&self) -> String {
        self.document(&stylesheet())
    }

    fn document(&self, style: &str) -> String {
        let layout = self.layout();
        let (w, h) = (layout.total_width, layout.total_height);
        let mut svg = String::new();
        begin(&mut svg, (w, h), if style.is_empty() { "" } else { " class=\"kinstep-figure\"" }, &self.title);
        if !self.caption.is_empty() {
            let _ = write!(svg, "<desc>{}</desc>", escaped(&self.caption));
        }
        svg.push_str(style);
        self.draw(&mut svg, &layout);
        svg.push_str("</svg>\n");
        svg
    }

    /// Returns where the axes are in the drawing: left, right, top and bottom \[px\], and the ends of the horizontal axis.
    pub fn window(&self) -> [f64; 6] {
        let Layout { left, top, width, height, .. } = self.layout();
        [left, left + width, top, top + height, self.x.range.0, self.x.range.1]
    }

    /// Draws everything at the origin of the current coordinates.
    pub(super) fn draw(&self, svg: &mut String, layout: &Layout) {
        let pen = Pen { figure: self, layout };
        let (w, h) = (layout.total_width, layout.total_height);
        let _ = write!(svg, r#"<rect width="{w}" height="{h}" fill="{PAPER}"/>"#);
        for (line, content) in layout.title.iter().enumerate() {
            let at = (EDGE, 25.0 + TITLE_LINE * line as f64);
            text(svg, at, "start", TITLE_SIZE, " font-weight=\"bold\"", content);
        }
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
        for (line, content) in layout.caption.iter().rev().enumerate() {
            let at = (EDGE, h - 9.0 - CAPTION_LINE * line as f64);
            text(svg, at, "start", CAPTION_SIZE, "", content);
        }
    }
}

/// Opens a document of this size.
pub(super) fn begin(svg: &mut String, (width, height): (f64, f64), extra: &str, title: &str) {
    let _ = write!(
        svg,
        r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" height="{height}" font-family="{FONT}" font-size="{FONT_SIZE}" fill="{TEXT}" role="img"{extra}><title>{}</title>"#,
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
        let along = |axis: &Axis, value: f64| match axis.place(value) {
            // Nothing that is not positive has a place on a logarithmic axis.
            f64::NEG_INFINITY if value == 0.0 => f64::NAN,
            place => place.clamp(-FAR, FAR),
        };
        let (u, v) = (along(&self.figure.x, x), along(&self.figure.y, y));
        let Layout { left, top, width, height, .. } = self.layout;
        (u.is_finite() && v.is_finite()).then_some((left + u * width, top + (1.0 - v) * height))
    }

    fn grid(&self, svg: &mut String) {
        let Layout { left, top, width, height, .. } = self.layout;
        let (right, bottom) = (left + width, top + height);
        let mut lines = String::new();
        for tick in self.figure.x.ticks(*width, 2.0 * FONT_SIZE) {
            let x = left + self.figure.x.place(tick.value) * width;
            let _ = write!(lines, "M{x:.1} {top:.1}V{bottom:.1}");
            tick_text(svg, (x, bottom + 18.0), "middle", &tick);
        }
        for tick in self.figure.y.ticks(*height, FONT_SIZE) {
            let y = bottom - self.figure.y.place(tick.value) * height;
            let _ = write!(lines, "M{left:.1} {y:.1}H{right:.1}");
            tick_text(svg, (left - 7.0, y + 4.5), "end", &tick);
        }
        let _ = write!(svg, r#"<path d="{lines}" stroke="{GRID}" fill="none"/>"#);
    }

    fn labels(&self, svg: &mut String) {
        let Layout { left, top, width, height, .. } = self.layout;
        let size =
            |label: &str, room: f64| (FONT_SIZE * room / text_width(label, FONT_SIZE)).clamp(8.0, FONT_SIZE);
        let (across, up) = (&self.figure.x.label, &self.figure.y.label);
        let x = left + width / 2.0;
        let room = 2.0 * x.min(self.layout.total_width - x);
        text(svg, (x, top + height + 42.0), "middle", size(across, room), "", across);
        let (x, y) = (18.0, top + height / 2.0);
        let turn = format!(" transform=\"rotate(-90 {x:.1} {y:.1})\"");
        text(svg, (x, y), "middle", size(up, height + 40.0), &turn, up);
    }

    fn legend(&self, svg: &mut String) {
        let legend = &self.layout.legend;
        for (i, (name, mark)) in self.figure.legend().into_iter().take(legend.shown).enumerate() {
            let (x, y) = legend.place(i);
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
                Mark::Stroke { .. } | Mark::Cells { .. } | Mark::Guide { .. } | Mark::Label { .. } => {}
            }
            text(svg, (x + LEGEND_SAMPLE, y + 4.5), "start", FONT_SIZE, "", &shortened(name, legend.longest));
        }
        if legend.left_out > 0 {
            let (x, y) = legend.place(legend.shown);
            text(svg, (x, y + 4.5), "start", FONT_SIZE, "", &format!("and {} more", legend.left_out));
        }
    }

    fn mark(&self, svg: &mut String, mark: &Mark) {
        match mark {
            Mark::Line { points, style, .. } => self.line(svg, points, &stroke(*style)),
            Mark::Stroke { points, style, width, opacity, is_dashed, .. } => {
                let ink = colour(*style);
                let dashes = if *is_dashed { r#" stroke-dasharray="5 4""# } else { "" };
                let stroke = format!(
                    r#"stroke="{ink}" stroke-width="{width}" stroke-opacity="{opacity:.2}"{dashes} fill="none" stroke-linejoin="round" stroke-linecap="round""#
                );
                self.line(svg, points, &stroke);
            }
            Mark::Guide { points } => {
                self.line(svg, points, &format!(r#"stroke="{GUIDE}" stroke-width="1" fill="none""#));
            }
            Mark::Points { points, shape, style, .. } => {
                points.iter().filter_map(|p| self.at(*p)).for_each(|p| point(svg, p, *shape, *style));
            }
            Mark::Region { strips, style, .. } => self.region(svg, strips, *style),
            Mark::Cells { cells, .. } => cells.iter().for_each(|cell| self.cell(svg, cell)),
            Mark::Label { text: content, at } => self.label(svg, content, *at),
        }
    }

    fn line(&self, svg: &mut String, points: &[(f64, f64)], stroke: &str) {
        let mut path = String::new();
        for run in points.split(|point| self.at(*point).is_none()) {
            let places: Vec<(f64, f64)> = run.iter().filter_map(|point| self.at(*point)).collect();
            for (k, (x, y)) in outline(&places).into_iter().enumerate() {
                let _ = write!(path, "{}{x:.1} {y:.1}", if k == 0 { 'M' } else { 'L' });
            }
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

    /// A cell, with its text where there is room for it.
    fn cell(&self, svg: &mut String, cell: &Cell) {
        let (x, y) = cell.at;
        let corners = [(x - 0.5, y + 0.5), (x + 0.5, y - 0.5)].map(|corner| self.at(corner));
        let [Some((left, top)), Some((right, bottom))] = corners else { return };
        let (width, height) = (right - left, bottom - top);
        let fill = shade(cell.shade);
        let _ = write!(
            svg,
            r#"<rect x="{left:.1}" y="{top:.1}" width="{width:.1}" height="{height:.1}" fill="{fill}" stroke="{PAPER}"/>"#
        );
        let size = (FONT_SIZE * (width - 6.0) / text_width(&cell.text, FONT_SIZE)).min(FONT_SIZE);
        if size >= LEAST_SIZE && height > size {
            let at = (f64::midpoint(left, right), f64::midpoint(top, bottom) + 0.35 * size);
            // Neither is a colour of the theme: cells are the same on light and on dark paper.
            let ink = if cell.shade.is_some_and(|shade| shade > 0.5) { "#fdfdfd" } else { "#1c1c1c" };
            text(svg, at, "middle", size, &format!(r#" fill="{ink}""#), &cell.text);
        }
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

/// The least size of letters in cells [px].
const LEAST_SIZE: f64 = 7.0;

/// From nearly white to dark blue, evenly; grey where there is no shade.
fn shade(share: Option<f64>) -> String {
    let Some(share) = share else { return "#c9c9c9".to_owned() };
    let part = |light: f64, dark: f64| (light + (dark - light) * share).round() as u8;
    format!("#{:02x}{:02x}{:02x}", part(243.0, 11.0), part(247.0, 72.0), part(250.0, 112.0))
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
            r#"<circle cx="{x:.1}" cy="{y:.1}" r="4.5" fill="{PAPER}" stroke="{ink}" stroke-width="1.8"/>"#
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
            r#"<rect x="{:.1}" y="{:.1}" width="8" height="8" fill="{PAPER}" stroke="{ink}" stroke-width="1.8"/>"#,
            x - 4.0,
            y - 4.0
        ),
    };
}
