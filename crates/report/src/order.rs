//! An order study as text, as a table of numbers and as JSON.

use std::fmt::Write;

use super::{Table, short};
use kinstep_study::Criteria;
use kinstep_study::{Convergence, Mark, RowStudy, ScenarioStudy, Studied};

/// The study of a scenario with what came of it.
#[derive(Debug)]
pub struct OrderPage<'a> {
    /// What the scenario is called.
    pub name: &'a str,
    /// What was asked.
    pub study: &'a ScenarioStudy,
    /// What was seen, row by row.
    pub rows: &'a [RowStudy],
}

impl OrderPage<'_> {
    /// Returns the study for people: a line per row, the errors by gap, the verdicts as sentences, and notes.
    pub fn text(&self) -> String {
        let sigmas = self.study.ladder().sigmas();
        let what = match self.study.studied() {
            Studied::Arms => "task errors",
            Studied::Problem => "errors of the solution",
        };
        let ends = sigmas.first().zip(sigmas.last()).map_or_else(String::new, |(coarse, fine)| {
            format!("{} gaps from {} s to {} s", sigmas.len(), short(*coarse), short(*fine))
        });
        let mut text = format!("{}: {what} ({}) at {ends}\n\n", self.name, self.study.measure().name());
        // Writing to a String can not fail.
        let _ = write!(text, "{}\n{}", self.summary(), self.errors(&sigmas));
        text.push_str(&self.legend());
        for row in self.rows {
            let _ = writeln!(text, "{}: {}", row.id, row.seen.verdict);
            for note in &row.report.notes {
                let _ = writeln!(text, "  {note}");
            }
        }
        text
    }

    /// What the signs beside the errors mean, those that stand there.
    fn legend(&self) -> String {
        const LEFT_OUT: [Mark; 5] =
            [Mark::PreAsymptotic, Mark::NearFloor, Mark::Unstable, Mark::NoReference, Mark::Stopped];
        let marks = || self.rows.iter().flat_map(|row| &row.seen.marks);
        let met = LEFT_OUT.into_iter().filter(|mark| marks().any(|found| found == mark));
        let words: Vec<String> = met.map(|mark| format!("{} {}", sign(mark), mark.name())).collect();
        if words.is_empty() {
            return "slopes stand beside the finer gap\n\n".to_owned();
        }
        format!("slopes stand beside the finer gap; {}: left out\n\n", words.join(", "))
    }

    fn summary(&self) -> Table {
        let arms = self.study.studied() == Studied::Arms;
        let mut heading = vec!["formula", "order"];
        heading.extend(if arms { &["h", "start"][..] } else { &["start"][..] });
        heading.extend(["claimed"]);
        heading.extend(if arms { &["whole run", "steady", "joints"][..] } else { &["seen", "steady"][..] });
        heading.extend(["fitted", "rungs", "floor", "verdict"]);
        let mut table = Table::new(heading);
        for row in self.rows {
            let mut cells = vec![row.id.clone(), row.order.to_string()];
            if arms {
                cells.push(row.h.map_or_else(|| "by gain".to_owned(), short));
            }
            cells.push(row.start.to_owned());
            cells.push(row.claimed.map_or_else(|| "-".to_owned(), |claimed| claimed.to_string()));
            let report = &row.report;
            let parts = if arms {
                vec![&report.task_transient, &report.task_steady, &report.joint]
            } else {
                vec![&report.formula, &report.formula_steady]
            };
            let order = |part: &Option<Convergence>| {
                part.as_ref()
                    .and_then(Convergence::order)
                    .map_or_else(|| "-".to_owned(), |o| format!("{o:.2}"))
            };
            cells.extend(parts.into_iter().map(order));
            cells.extend(fitted(&row.seen));
            cells.push(finite(row.seen.floor).map_or_else(|| "-".to_owned(), |floor| format!("{floor:.0e}")));
            cells.push(row.seen.verdict.name().to_owned());
            table.row(cells);
        }
        table
    }

    fn errors(&self, sigmas: &[f64]) -> Table {
        let mut heading = vec!["sigma [s]".to_owned()];
        for row in self.rows {
            heading.extend([row.id.clone(), "slope".to_owned()]);
        }
        let mut table = Table::new(heading);
        for (i, sigma) in sigmas.iter().enumerate() {
            let mut cells = vec![short(*sigma)];
            for row in self.rows {
                let error =
                    finite(row.seen.errors[i]).map_or_else(|| "-".to_owned(), |error| format!("{error:.2e}"));
                cells.push(format!("{error}{}", sign(row.seen.marks[i])));
                let slope =
                    i.checked_sub(1).map(|pair| row.seen.slopes[pair]).filter(|slope| slope.is_finite());
                cells.push(slope.map_or_else(String::new, |slope| format!("{slope:.2}")));
            }
            table.row(cells);
        }
        table
    }

    /// Returns the numbers as CSV: a line per row, kind of error and gap.
    pub fn csv(&self) -> String {
        let mut text = "formula,part,sigma,error,slope,mark,floor\n".to_owned();
        for row in self.rows {
            for (key, part) in row.report.parts() {
                for (i, sigma) in self.study.ladder().sigmas().iter().enumerate() {
                    let slope =
                        i.checked_sub(1).map(|pair| part.slopes[pair]).filter(|slope| slope.is_finite());
                    let slope = slope.map_or_else(String::new, |slope| format!("{slope:.6}"));
                    let (error, mark, floor) = (part.errors[i], part.marks[i].name(), part.floor);
                    let error = finite(error).map_or_else(String::new, |error| format!("{error:e}"));
                    let floor = finite(floor).map_or_else(String::new, |floor| format!("{floor:e}"));
                    let _ = writeln!(text, "{},{key},{sigma:e},{error},{slope},{mark},{floor}", row.id);
                }
            }
        }
        text
    }
}

fn sign(mark: Mark) -> &'static str {
    match mark {
        Mark::Used => " ",
        Mark::PreAsymptotic => "~",
        Mark::NearFloor => "_",
        Mark::Unstable => "*",
        Mark::NoReference => "?",
        Mark::Stopped => "!",
    }
}

/// The fitted order with its 95 % interval, and how many rungs it is from.
fn fitted(seen: &Convergence) -> [String; 2] {
    match &seen.fit {
        Some(fit) => [format!("{:.2}±{:.2}", fit.order, fit.half_width), (fit.to - fit.from).to_string()],
        None => ["-".to_owned(), "0".to_owned()],
    }
}

impl OrderPage<'_> {
    /// Returns the study as one JSON object: the gaps, the criteria, and by row the orders seen (null where nothing was decided), the errors, the
    /// floor, and everything that led there.
    pub fn json(&self) -> serde_json::Value {
        let kind = match self.study.studied() {
            Studied::Arms => "arms",
            Studied::Problem => "problem",
        };
        let rows: Vec<serde_json::Value> = self.rows.iter().map(row_json).collect();
        let Criteria { tolerance, floor_margin } = self.study.criteria();
        serde_json::json!({
            "scenario": self.name,
            "kind": kind,
            "measure": self.study.measure().name(),
            "tolerance": tolerance,
            "floor_margin": floor_margin,
            "sigma": self.study.ladder().sigmas(),
            "formulas": rows,
        })
    }
}

fn row_json(row: &RowStudy) -> serde_json::Value {
    let report = &row.report;
    let order = |part: &Option<Convergence>| part.as_ref().and_then(Convergence::order);
    let parts: serde_json::Map<String, serde_json::Value> =
        report.parts().map(|(key, part)| (key.to_owned(), part_json(part))).collect();
    serde_json::json!({
        "id": row.id,
        "order": row.order,
        "h": row.h,
        "start": row.start,
        "claimed": row.claimed,
        "verdict": row.seen.verdict.name(),
        "verdict_text": row.seen.verdict.to_string(),
        "formula": order(&report.formula),
        "task_transient": order(&report.task_transient),
        "task_steady": order(&report.task_steady),
        "joint": order(&report.joint),
        "floor": finite(row.seen.floor),
        "errors": row.seen.errors,
        "parts": parts,
        "notes": report.notes,
    })
}

fn part_json(part: &Convergence) -> serde_json::Value {
    let fit = part.fit.map(|fit| {
        serde_json::json!({
            "order": fit.order,
            "standard_error": fit.standard_error,
            "half_width_95": fit.half_width,
            "from": fit.from,
            "to": fit.to,
        })
    });
    serde_json::json!({
        "order": part.order(),
        "verdict": part.verdict.name(),
        "verdict_text": part.verdict.to_string(),
        "errors": part.errors,
        "slopes": part.slopes,
        "marks": part.marks.iter().map(|mark| mark.name()).collect::<Vec<_>>(),
        "fit": fit,
        "floor": finite(part.floor),
    })
}

fn finite(value: f64) -> Option<f64> {
    Some(value).filter(|value| value.is_finite())
}
