//! The pictures of a formula.

use std::f64::consts::{PI, TAU};

use nalgebra::Complex;

use super::axis::{Axis, Scale};
use super::figure::{Figure, Mark, Shape};
use kinstep::formula::{Analysis, FrequencyResponse, StabilityRegion};

/// Returns every picture that a row has: its roots, their locus, the spectral radius, the region of stability and, where the
/// loop has a best feedback step, the frequency response. `id` names the files.
pub fn portrait(id: &str, analysis: &Analysis) -> Vec<Figure> {
    let rows = [(id, analysis)];
    let mut figures = vec![roots_figure(id, analysis)];
    if analysis.feedback_range().is_some() {
        figures.extend([locus_figure(id, analysis), radius_figure(&rows)]);
    }
    figures.push(region_figure(id, analysis));
    figures.extend(frequency_figure(id, analysis));
    figures
}

fn plane(figure: &str, id: &str, title: String, half: f64, marks: Vec<Mark>) -> Figure {
    let axis = |label: &str, column: &str| Axis::new(label, column, Scale::Linear, (-half, half));
    Figure {
        name: format!("{id}-{figure}"),
        title,
        x: axis("Re z", "re"),
        y: axis("Im z", "im"),
        is_isometric: true,
        caption: String::new(),
        size: None,
        parameter: None,
        marks,
    }
}

fn unit_circle() -> Mark {
    let point = |k: usize| (TAU * k as f64 / 180.0).sin_cos();
    Mark::Guide { points: (0..=180).map(|k| (point(k).1, point(k).0)).collect() }
}

/// Returns what several rows can be compared by: the spectral radius, the boundaries of their regions of stability, and the
/// frequency response of either kind of noise; a line for each row.
pub fn comparison(rows: &[(&str, &Analysis)]) -> Vec<Figure> {
    let mut figures = vec![radius_figure(rows), boundary_figure(rows)];
    figures.extend(GAINS.iter().filter_map(|gain| gain_figure(rows, gain)));
    figures
}

/// The stem of the files of rows, and what titles call them.
fn stem(rows: &[(&str, &Analysis)]) -> String {
    match rows {
        [(id, _)] => (*id).to_owned(),
        _ => "comparison".to_owned(),
    }
}

fn title_of(rows: &[(&str, &Analysis)], what: &str) -> String {
    match rows {
        [(id, _)] => format!("{id}: {what}"),
        _ => what.to_owned(),
    }
}

/// Returns the roots of rho(z) in the unit disk.
pub fn roots_figure(id: &str, analysis: &Analysis) -> Figure {
    let roots: Vec<(f64, f64)> = analysis.roots().iter().map(|z| (z.re, z.im)).collect();
    let reach = roots.iter().map(|z| z.0.hypot(z.1)).fold(1.0, f64::max);
    let near = |z: &&(f64, f64)| (z.0.hypot(z.1) - 1.0).abs() < 1e-9;
    let outside = |z: &&(f64, f64)| z.0.hypot(z.1) >= 1.0 + 1e-9;
    let inside = |z: &&(f64, f64)| z.0.hypot(z.1) <= 1.0 - 1e-9;
    let part = |name: &str, points: Vec<(f64, f64)>, shape, style| Mark::Points {
        name: name.to_owned(),
        points,
        shape,
        style,
    };
    let groups = [
        part("inside", roots.iter().filter(inside).copied().collect(), Shape::Disk, 0),
        part("on the circle", roots.iter().filter(near).copied().collect(), Shape::Circle, 2),
        part("outside", roots.iter().filter(outside).copied().collect(), Shape::Cross, 1),
    ];
    let shown = |mark: &Mark| matches!(mark, Mark::Points { points, .. } if !points.is_empty());
    let marks = [unit_circle()].into_iter().chain(groups.into_iter().filter(shown)).collect();
    plane("roots", id, format!("{id}: roots of \u{3c1}(z)"), 1.15 * reach, marks)
}

/// Returns the paths of the closed loop's roots as h grows from 0 to beyond the feedback range.
pub fn locus_figure(id: &str, analysis: &Analysis) -> Figure {
    let end = analysis.pictured_h();
    let locus = analysis.root_locus(end, 900);
    let mut marks = vec![unit_circle()];
    for branch in &locus.branches {
        marks.push(Mark::Line {
            name: "path of a root".to_owned(),
            points: branch.iter().map(|z| (z.re, z.im)).collect(),
            parameter: locus.h.clone(),
            style: 0,
        });
    }
    let at = |h: f64| -> Vec<(f64, f64)> {
        let nearest =
            (0..locus.h.len()).min_by(|&i, &j| (locus.h[i] - h).abs().total_cmp(&(locus.h[j] - h).abs()));
        nearest.map_or_else(Vec::new, |i| locus.branches.iter().map(|b| (b[i].re, b[i].im)).collect())
    };
    let points = |name: String, h: f64, shape, style| Mark::Points { name, points: at(h), shape, style };
    marks.push(points("h = 0".to_owned(), 0.0, Shape::Circle, 6));
    if let Some(optimum) = analysis.optimum() {
        marks.push(points(format!("h_opt = {:.4}", optimum.h), optimum.h, Shape::Disk, 2));
    }
    if let Some(range) = analysis.feedback_range().filter(|range| !range.is_empty() && !range.is_unbounded())
    {
        marks.push(points(format!("h_max = {:.4}", range.value()), range.value(), Shape::Cross, 1));
    }
    let reach = locus.branches.iter().flatten().map(|z| z.norm()).fold(1.0, f64::max).min(1.6);
    let title = format!("{id}: roots of the closed loop, h from 0 to {end:.3}");
    Figure { parameter: Some("h".to_owned()), ..plane("locus", id, title, 1.12 * reach, marks) }
}

/// Returns the spectral radius of the closed loop over the feedback step, a line for each row.
pub fn radius_figure(rows: &[(&str, &Analysis)]) -> Figure {
    let end = rows.iter().map(|(_, analysis)| analysis.pictured_h()).fold(0.0, f64::max);
    let mut marks = vec![Mark::Guide { points: vec![(0.0, 1.0), (end, 1.0)] }];
    let mut least = 1.0_f64;
    for (style, (id, analysis)) in rows.iter().enumerate() {
        let points = analysis.radius_curve(end, 1000);
        least = points.iter().map(|p| p.1).fold(least, f64::min);
        marks.push(Mark::Line { name: (*id).to_owned(), points, parameter: Vec::new(), style });
    }
    for (style, (_, analysis)) in rows.iter().enumerate() {
        let Some(optimum) = analysis.optimum() else { continue };
        least = least.min(optimum.radius);
        let at = (optimum.h, optimum.radius);
        marks.push(Mark::Points { name: "optimum".to_owned(), points: vec![at], shape: Shape::Disk, style });
        if rows.len() == 1 {
            let text = format!("h = {:.4}, r = {:.4}", optimum.h, optimum.radius);
            marks.push(Mark::Label { text, at });
        }
    }
    for (style, (_, analysis)) in rows.iter().enumerate() {
        let bounded = |range: &&kinstep::formula::FeedbackRange| !range.is_empty() && !range.is_unbounded();
        if let Some(range) = analysis.feedback_range().filter(bounded) {
            let points = vec![(range.value(), 1.0)];
            marks.push(Mark::Points {
                name: "end of the range".to_owned(),
                points,
                shape: Shape::Cross,
                style,
            });
        }
    }
    // Room for the label below the lowest point.
    let margin = 0.12 * (1.15 - least);
    Figure {
        name: format!("{}-radius", stem(rows)),
        title: title_of(rows, "spectral radius of the closed loop"),
        x: Axis::new("feedback step h", "h", Scale::Linear, (0.0, end)),
        y: Axis::new("spectral radius r(h), decay per step", "r", Scale::Linear, (least - margin, 1.15)),
        is_isometric: false,
        caption: String::new(),
        size: None,
        parameter: None,
        marks,
    }
}

/// Returns where x' = lambda x is integrated stably, in the plane of sigma lambda.
pub fn region_figure(id: &str, analysis: &Analysis) -> Figure {
    let StabilityRegion { real, imaginary, stable, boundary } = analysis.stability_region(260);
    let strips = strips(real, imaginary, &stable);
    // No name in the legend where nothing is stable.
    let name = if strips.is_empty() { "" } else { "stable" }.to_owned();
    let marks = vec![
        Mark::Region { name, strips, style: 5 },
        Mark::Guide { points: vec![(0.0, imaginary.0), (0.0, imaginary.1)] },
        Mark::Guide { points: vec![(real.0, 0.0), (real.1, 0.0)] },
        locus("boundary locus", &boundary, 0),
    ];
    let split = if analysis.is_split() { " (feedforward pair)" } else { "" };
    let title = format!("{id}: stability on x' = \u{3bb}x{split}");
    stability_plane(format!("{id}-region"), title, [real, imaginary], marks)
}

/// The boundary locus, by the angle of the root that lies on the unit circle.
fn locus(name: &str, boundary: &[Complex<f64>], style: usize) -> Mark {
    let count = boundary.len().saturating_sub(1).max(1) as f64;
    Mark::Line {
        name: name.to_owned(),
        parameter: (0..boundary.len()).map(|k| TAU * k as f64 / count).collect(),
        points: boundary.iter().map(|mu| (mu.re, mu.im)).collect(),
        style,
    }
}

/// A figure in the plane of sigma lambda.
fn stability_plane(
    name: String,
    title: String,
    [real, imaginary]: [(f64, f64); 2],
    marks: Vec<Mark>,
) -> Figure {
    Figure {
        name,
        title,
        x: Axis::new("Re \u{3c3}\u{3bb}", "re", Scale::Linear, real),
        y: Axis::new("Im \u{3c3}\u{3bb}", "im", Scale::Linear, imaginary),
        is_isometric: true,
        caption: String::new(),
        size: None,
        parameter: Some("theta".to_owned()),
        marks,
    }
}

/// The stable cells as horizontal strips.
fn strips(real: (f64, f64), imaginary: (f64, f64), stable: &[Vec<bool>]) -> Vec<[f64; 4]> {
    let part = |(low, high): (f64, f64), k: usize, n: usize| low + (high - low) * k as f64 / n as f64;
    let mut strips = Vec::new();
    for (i, row) in stable.iter().enumerate() {
        let (lower, upper) = (part(imaginary, i, stable.len()), part(imaginary, i + 1, stable.len()));
        let mut j = 0;
        while j < row.len() {
            let length = row[j..].iter().take_while(|cell| **cell == row[j]).count();
            if row[j] {
                strips.push([part(real, j, row.len()), part(real, j + length, row.len()), lower, upper]);
            }
            j += length;
        }
    }
    strips
}

/// Returns the boundary loci of the regions where x' = lambda x is integrated stably, a line for each row.
pub fn boundary_figure(rows: &[(&str, &Analysis)]) -> Figure {
    let mut marks = Vec::new();
    let (mut real, mut imaginary) = ((0.0_f64, 0.0_f64), (0.0_f64, 0.0_f64));
    for (style, (id, analysis)) in rows.iter().enumerate() {
        let StabilityRegion { real: across, imaginary: along, boundary, .. } = analysis.stability_region(40);
        real = (real.0.min(across.0), real.1.max(across.1));
        imaginary = (imaginary.0.min(along.0), imaginary.1.max(along.1));
        marks.push(locus(id, &boundary, style));
    }
    let guides = [vec![(0.0, imaginary.0), (0.0, imaginary.1)], vec![(real.0, 0.0), (real.1, 0.0)]];
    let marks = guides.map(|points| Mark::Guide { points }).into_iter().chain(marks).collect();
    let title = title_of(rows, "boundary loci on x' = \u{3bb}x");
    stability_plane(format!("{}-boundary", stem(rows)), title, [real, imaginary], marks)
}

/// What becomes of one kind of noise.
struct Gain {
    column: &'static str,
    name: &'static str,
    of: fn(&FrequencyResponse) -> f64,
}

const GAINS: [Gain; 3] = [
    Gain { column: "residual", name: "residual", of: |r| r.residual },
    Gain { column: "feedforward", name: "feedforward / \u{3c3}", of: |r| r.feedforward_per_sigma },
    Gain { column: "state", name: "joint state", of: |r| r.state },
];

impl Gain {
    /// The line of a row at its best feedback step. A deadbeat loop lets nothing of some noise through: no line on a logarithmic axis.
    fn line(&self, name: String, analysis: &Analysis, h: f64, style: usize) -> Option<Mark> {
        let response = analysis.frequency_response(h, 600);
        let points: Vec<(f64, f64)> = response.iter().map(|r| (r.omega, (self.of)(r))).collect();
        let is_seen = points.iter().any(|p| p.1 >= 1e-9);
        is_seen.then_some(Mark::Line { name, points, parameter: Vec::new(), style })
    }
}

/// Returns how the closed loop at h_opt passes noise on, over the frequency; `None` where the row has no optimum.
pub fn frequency_figure(id: &str, analysis: &Analysis) -> Option<Figure> {
    let h = analysis.optimum()?.h;
    let line = |(style, gain): (usize, &Gain)| gain.line(gain.name.to_owned(), analysis, h, style);
    let marks = GAINS.iter().enumerate().filter_map(line).collect();
    Some(gain_axes(format!("{id}-noise"), format!("{id}, h = {h:.4}: what becomes of noise"), marks))
}

/// One kind of noise for several rows, each at its own h_opt; `None` where none has an optimum or lets anything through.
fn gain_figure(rows: &[(&str, &Analysis)], gain: &Gain) -> Option<Figure> {
    let line = |(style, (id, analysis)): (usize, &(&str, &Analysis))| {
        let h = analysis.optimum()?.h;
        gain.line(format!("{id}, h = {h:.4}"), analysis, h, style)
    };
    let marks: Vec<Mark> = rows.iter().enumerate().filter_map(line).collect();
    let title = format!("what becomes of noise in the {}", gain.name);
    (!marks.is_empty()).then(|| gain_axes(format!("{}-noise-{}", stem(rows), gain.column), title, marks))
}

fn gain_axes(name: String, title: String, marks: Vec<Mark>) -> Figure {
    let values = || {
        marks.iter().flat_map(|mark| match mark {
            Mark::Line { points, .. } => points.as_slice(),
            _ => &[],
        })
    };
    let high = values().map(|p| p.1).filter(|v| v.is_finite()).fold(0.0, f64::max);
    let low = values().map(|p| p.1).filter(|v| *v > 1e-5 * high).fold(high, f64::min);
    Figure {
        name,
        title,
        x: Axis::new("angular frequency \u{3c9} [rad per step]", "omega", Scale::Angle, (0.0, PI)),
        y: Axis::new("amplification", "gain", Scale::Logarithmic, (0.7 * low, 1.5 * high)),
        is_isometric: false,
        caption: String::new(),
        size: None,
        parameter: None,
        marks,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kinstep::formula::FormulaTable;

    fn row(id: &str) -> (&str, &'static Analysis) {
        (id, FormulaTable::builtin().get(id).expect("a built-in row").analysis())
    }

    #[test]
    fn every_formula_has_a_portrait_without_a_stray_number() {
        for formula in FormulaTable::builtin().iter().filter(|formula| formula.steps() <= 6).step_by(3) {
            for figure in portrait(formula.id(), formula.analysis()) {
                let svg = figure.to_svg();
                assert!(!svg.contains("NaN") && !svg.contains("inf"), "{}", figure.name);
                roxmltree::Document::parse(&svg).expect("well-formed");
                assert!(figure.to_csv().lines().count() > 1, "{}", figure.name);
            }
        }
    }

    #[test]
    fn pictures_are_the_same_every_time() {
        let (id, analysis) = row("la6-wang-guo");
        let draw = || portrait(id, analysis).iter().map(Figure::to_svg).collect::<String>();
        assert_eq!(draw(), draw());
    }

    #[test]
    fn a_row_without_a_best_feedback_step_has_no_frequency_response() {
        let figure = |id| frequency_figure(id, row(id).1);
        assert!(figure("la3-leapfrog").is_none());
        assert!(figure("split-ab4").is_some());
    }

    #[test]
    fn a_comparison_has_a_line_for_each_row_that_has_the_figure() {
        let rows = ["la6-wang-guo", "split-ab4", "la3-leapfrog"].map(row);
        let figures = comparison(&rows);
        let lines =
            |figure: &Figure| figure.marks.iter().filter(|mark| matches!(mark, Mark::Line { .. })).count();
        let counts: Vec<(&str, usize)> = figures.iter().map(|f| (f.name.as_str(), lines(f))).collect();
        // Leapfrog has no best feedback step; a deadbeat loop lets nothing of the joint state's noise through.
        let expected = [
            ("comparison-radius", 3),
            ("comparison-boundary", 3),
            ("comparison-noise-residual", 2),
            ("comparison-noise-feedforward", 2),
            ("comparison-noise-state", 1),
        ];
        assert_eq!(counts, expected);
    }
}
