//! Errors against the sampling gap, with the window that an order was fitted to.

use super::axis::{Axis, Scale};
use super::figure::{Figure, Mark, Shape};
use kinstep_study::{Convergence, Mark as Rung};

/// Returns the errors of several rows against the sampling gaps on logarithmic axes: disks count, circles were left
/// out, the thin lines are the fitted powers over their windows and the floors.
pub fn order_figure(name: &str, title: &str, sigmas: &[f64], rows: &[(&str, &Convergence)]) -> Figure {
    let shown = |error: f64| error.is_finite() && error > 0.0;
    let errors = rows.iter().flat_map(|(_, seen)| seen.errors.iter().copied().filter(|&e| shown(e)));
    let (least, most) = errors.fold((f64::INFINITY, 0.0_f64), |(a, b), e| (a.min(e), b.max(e)));
    let (fine, coarse) = (sigmas.last().copied().unwrap_or(0.1), sigmas.first().copied().unwrap_or(1.0));
    let mut marks = Vec::new();
    for (style, (id, seen)) in rows.iter().enumerate() {
        marks.extend(row_marks(id, sigmas, seen, style));
    }
    Figure {
        name: name.to_owned(),
        title: title.to_owned(),
        x: Axis::new("sampling gap sigma [s]", "sigma", Scale::Logarithmic, (fine / 1.2, coarse * 1.2)),
        y: Axis::new("error", "error", Scale::Logarithmic, (least / 2.0, most * 2.0)),
        is_isometric: false,
        caption: String::new(),
        size: None,
        parameter: None,
        marks,
    }
}

fn row_marks(id: &str, sigmas: &[f64], seen: &Convergence, style: usize) -> Vec<Mark> {
    let points = |keep: &dyn Fn(Rung) -> bool| -> Vec<(f64, f64)> {
        let rungs = sigmas.iter().zip(&seen.errors).zip(&seen.marks);
        rungs.filter(|(_, mark)| keep(**mark)).map(|((s, e), _)| (*s, *e)).filter(|p| p.1 > 0.0).collect()
    };
    let mut marks = Vec::new();
    if seen.floor.is_finite() && seen.floor > 0.0 {
        let ends = [sigmas.first(), sigmas.last()].into_iter().flatten();
        marks.push(Mark::Guide { points: ends.map(|&sigma| (sigma, seen.floor)).collect() });
    }
    if let Some(fit) = &seen.fit {
        let window = &sigmas[fit.from..fit.to];
        let line: Vec<(f64, f64)> = window.iter().map(|&sigma| (sigma, fit.error_at(sigma))).collect();
        let middle = line[line.len() / 2];
        marks.push(Mark::Line {
            name: format!("{id}: order {:.2} ± {:.2}", fit.order, fit.half_width),
            points: line,
            parameter: Vec::new(),
            style,
        });
        marks.push(Mark::Label { text: format!("{:.2}", fit.order), at: middle });
    }
    marks.push(Mark::Points {
        name: id.to_owned(),
        points: points(&|mark| mark == Rung::Used),
        shape: Shape::Disk,
        style,
    });
    let left_out = points(&|mark| matches!(mark, Rung::PreAsymptotic | Rung::NearFloor | Rung::Unstable));
    if !left_out.is_empty() {
        let name = format!("{id}, left out");
        marks.push(Mark::Points { name, points: left_out, shape: Shape::Circle, style });
    }
    marks
}

#[cfg(test)]
mod tests {
    use super::*;
    use kinstep_study::Criteria;

    #[test]
    fn the_figure_tells_what_counts_from_what_does_not() {
        let sigmas: Vec<f64> = (0..6).map(|k| 0.1 / f64::from(1 << k)).collect();
        let errors: Vec<f64> = sigmas.iter().map(|s: &f64| s.powi(4) + 1e-9 * s).collect();
        let seen = Convergence::judge(&sigmas, &errors, 1e-10, Some(4), &Criteria::default());
        let figure = order_figure("order", "a study", &sigmas, &[("row", &seen)]);
        let csv = figure.to_csv();
        assert!(csv.lines().filter(|line| line.starts_with("row,")).count() >= 3, "{csv}");
        assert!(csv.contains("\"row, left out\""), "{csv}");
        assert!(figure.to_svg().contains("order 4.0"));
        let nothing = Convergence::judge(&sigmas, &[f64::NAN; 6], 0.0, Some(4), &Criteria::default());
        assert!(!order_figure("order", "nothing", &sigmas, &[("row", &nothing)]).to_svg().contains("NaN"));
    }
}
