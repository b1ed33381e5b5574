//! `kinstep formula compare`: formulas side by side.

use serde::Serialize;

use super::arguments::FormulaCompare;
use super::failure::{Exit, Failure};
use super::formula::checked;
use super::formula_plot::plot_together;
use super::output::{Output, Show};
use kinstep::formula::{Analysis, CheckedRow, Row};
use kinstep::math::{Rational, rational_to_f64};
use kinstep_report::{Table, short};

pub(super) fn run(
    arguments: &FormulaCompare,
    own_rows: &[Row],
    output: &mut Output,
) -> Result<Exit, Failure> {
    let rows =
        arguments.ids.iter().map(|id| checked(id, own_rows)).collect::<Result<Vec<CheckedRow>, Failure>>()?;
    if let Some(path) = &arguments.plot {
        let drawn: Vec<(&str, &Analysis)> = rows.iter().map(|row| (row.row().id(), row.analysis())).collect();
        let written = plot_together(path, arguments.force, &drawn)?;
        if !output.wants_json() {
            output.aside(&format!("written: {}", written.join(", ")));
        }
    }
    let columns = rows.iter().map(|row| Column::new(row.row().id(), row.analysis())).collect();
    output.show(&Comparison { formulas: columns })?;
    Ok(Exit::Done)
}

#[derive(Serialize)]
struct Comparison {
    formulas: Vec<Column>,
}

/// What formulas are compared by; a figure that a formula does not have is null.
#[derive(Serialize)]
struct Column {
    id: String,
    steps: usize,
    order: Option<usize>,
    strictly_zero_stable: bool,
    error_constant: Option<String>,
    per_step_constant: Option<String>,
    h_max: Option<f64>,
    h_max_exact: Option<String>,
    h_opt: Option<f64>,
    r_opt: Option<f64>,
    /// C/h at h_opt: the steady residual in units of sigma^(p+1).
    steady: Option<f64>,
    /// C/(h_max (1 - r_opt)): error against range and decay together.
    economy: Option<f64>,
    residual_noise: Option<f64>,
    feedforward_noise: Option<f64>,
    state_noise: Option<f64>,
    largest_parasitic_root: Option<f64>,
}

impl Column {
    fn new(id: &str, analysis: &Analysis) -> Self {
        let range = analysis.feedback_range();
        let h_max = range.map(kinstep::formula::FeedbackRange::value).filter(|h| h.is_finite());
        let optimum = analysis.optimum();
        let noise = optimum.and_then(|optimum| analysis.noise_gain(optimum.h));
        let per_step = analysis.per_step_constant().map(|c| rational_to_f64(c).abs());
        Self {
            id: id.to_owned(),
            steps: analysis.steps(),
            order: analysis.order(),
            strictly_zero_stable: analysis.is_strictly_zero_stable(),
            error_constant: analysis.error_constant().map(|c| c.to_string()),
            per_step_constant: analysis.per_step_constant().map(ToString::to_string),
            h_max,
            h_max_exact: range.and_then(kinstep::formula::FeedbackRange::exact).map(|h| h.to_string()),
            h_opt: optimum.map(|optimum| optimum.h),
            r_opt: optimum.map(|optimum| optimum.radius),
            steady: per_step.zip(optimum).map(|(c, optimum)| c / optimum.h),
            economy: per_step
                .zip(h_max)
                .zip(optimum)
                .map(|((c, h_max), optimum)| c / (h_max * (1.0 - optimum.radius))),
            residual_noise: noise.map(|noise| noise.residual),
            feedforward_noise: noise.map(|noise| noise.feedforward_per_sigma),
            state_noise: noise.map(|noise| noise.state),
            largest_parasitic_root: analysis.root_moduli().get(1).copied(),
        }
    }
}

/// An exact number where it is short, else to a few digits.
fn exact_or_short(exact: Option<&String>) -> String {
    let Some(text) = exact else { return "-".to_owned() };
    if text.len() <= 12 {
        return text.clone();
    }
    kinstep::math::parse_rational(text)
        .map_or_else(|_| text.clone(), |value: Rational| short(rational_to_f64(&value)))
}

impl Show for Comparison {
    fn text(&self) -> String {
        type Cell = fn(&Column) -> String;
        let lines: [(&str, Cell); 15] = [
            ("steps", |c| c.steps.to_string()),
            ("order", |c| c.order.map_or_else(|| "-".to_owned(), |order| order.to_string())),
            ("only z = 1 on the circle", |c| if c.strictly_zero_stable { "yes" } else { "no" }.to_owned()),
            ("error constant c", |c| exact_or_short(c.error_constant.as_ref())),
            ("per step, C", |c| exact_or_short(c.per_step_constant.as_ref())),
            ("h_max", |c| figure(c.h_max)),
            ("h_opt", |c| figure(c.h_opt)),
            ("r_opt", |c| figure(c.r_opt)),
            ("C/h_opt", |c| figure(c.steady)),
            ("C/(h_max (1 - r_opt))", |c| figure(c.economy)),
            ("noise of the residual", |c| figure(c.residual_noise)),
            ("noise of phi'", |c| figure(c.feedforward_noise)),
            ("noise of the state", |c| figure(c.state_noise)),
            ("largest parasitic root", |c| figure(c.largest_parasitic_root)),
            ("exact h_max", |c| exact_or_short(c.h_max_exact.as_ref())),
        ];
        let mut table =
            Table::new([String::new()].into_iter().chain(self.formulas.iter().map(|c| c.id.clone())));
        for (label, cell) in lines {
            table.row([label.to_owned()].into_iter().chain(self.formulas.iter().map(cell)));
        }
        format!("{table}\nNoise gains at h_opt, those of phi' per unit of sigma.\n")
    }
}

fn figure(value: Option<f64>) -> String {
    value.map_or_else(|| "-".to_owned(), short)
}
