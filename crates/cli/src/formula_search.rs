//! `kinstep formula search`: the best rows of given steps and order.

use std::fmt::Write as _;
use std::io::{self, IsTerminal};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde::Serialize;

use super::arguments::FormulaSearch;
use super::failure::{Exit, Failure};
use super::formula::checked;
use super::output::{Output, Show};
use kinstep::formula::search::Figures;
use kinstep::formula::search::{
    Family, Found, Objective, Observer, Options, Outcome, Progress, SearchError, Target, front_csv, search,
};
use kinstep::formula::{Formula, FormulaTable, Row};
use kinstep_report::figure::{Figure, FrontPoint, pareto_figure};
use kinstep_report::{Table, short};

const ROWS: &str = "rows.toml";
const FRONT: &str = "front.csv";
const PICTURE: &str = "front.svg";

pub(super) fn run(arguments: &FormulaSearch, own_rows: &[Row], output: &mut Output) -> Result<Exit, Failure> {
    let options = options(arguments, own_rows)?;
    let folder = arguments.written.folder(&[ROWS, FRONT, PICTURE])?;
    let watcher = Watcher::new(output.wants_json());
    let outcome = search(&options, &watcher);
    watcher.bar.finish_and_clear();
    let outcome = outcome.map_err(|error| refuse(&error))?;
    if !outcome.complete {
        let cause = if watcher.goes_on() { "after --seconds" } else { "by the interrupt" };
        output.remark(&format!("the search was cut short {cause}; this is what it had found"));
    }
    let report = Report::new(&options, &outcome);
    if let (Objective::Beat(target), true) =
        (&options.objective, outcome.rows.iter().all(|row| row.merit >= 0.0))
    {
        output.remark(&format!(
            "no row within the denominators surpasses {} without being worse in something",
            target.id
        ));
    }
    if let Some(folder) = folder {
        folder.write(ROWS, |out| out.write_all(report.toml().as_bytes()))?;
        folder.write(FRONT, |out| out.write_all(front_csv(&outcome.front).as_bytes()))?;
        folder.write(PICTURE, |out| out.write_all(picture(&options, &outcome).to_svg().as_bytes()))?;
    }
    output.show(&report)?;
    Ok(Exit::Done)
}

/// The front beside the rows of the table that have as many steps and the same order.
fn picture(options: &Options, outcome: &Outcome) -> Figure {
    let point = |found: &Found| FrontPoint {
        id: found.checked.row().id().to_owned(),
        h_max: found.figures.h_max,
        per_step: found.figures.per_step,
        r_opt: found.figures.r_opt,
    };
    let front: Vec<FrontPoint> = outcome.front.iter().map(point).collect();
    let kind = (options.steps, options.order);
    let is_alike = |row: &&Formula| {
        (row.steps(), row.order()) == kind
            && row.is_explicit()
            && row.is_strictly_zero_stable()
            && !row.feedback_range().is_empty()
    };
    let known: Vec<FrontPoint> =
        FormulaTable::builtin().iter().filter(is_alike).map(FrontPoint::of).collect();
    pareto_figure(kind, &front, &known, "rows of the table")
}

fn refuse(error: &SearchError) -> Failure {
    Failure::usage(error.to_string())
}

fn options(arguments: &FormulaSearch, own_rows: &[Row]) -> Result<Options, Failure> {
    let objective = match &arguments.beat {
        Some(id) => {
            let figures = Figures::exact(checked(id, own_rows)?.analysis());
            let figures = figures.ok_or_else(|| refuse(&SearchError::NoTarget { id: id.clone() }))?;
            Objective::Beat(Target { id: id.clone(), figures })
        }
        None => Objective::parse(&arguments.objective).map_err(|e| refuse(&e))?,
    };
    if !(arguments.seconds > 0.0 && arguments.seconds.is_finite() && arguments.seconds <= 1e9) {
        return Err(Failure::usage(format!(
            "--seconds {} is no time to search in; give a positive number of seconds",
            arguments.seconds
        )));
    }
    if !(arguments.least_range >= 0.0 && arguments.least_range.is_finite()) {
        return Err(Failure::usage(format!("--least-range {} is no positive number", arguments.least_range)));
    }
    let family = Family::parse(&arguments.family).map_err(|e| refuse(&e))?;
    Ok(Options {
        denominator: arguments.denominator,
        least_range: arguments.least_range,
        seed: arguments.seed,
        starts: arguments.starts,
        rows: arguments.rows,
        front: arguments.written.out.is_some(),
        limit: Some(Duration::from_secs_f64(arguments.seconds)),
        threads: arguments.threads,
        ..Options::new(family, arguments.steps, arguments.order, objective)
    })
}

/// Shows the progress and passes an interrupt on.
struct Watcher {
    interrupted: Arc<AtomicBool>,
    bar: ProgressBar,
}

impl Watcher {
    fn new(wants_json: bool) -> Self {
        let interrupted = Arc::new(AtomicBool::new(false));
        let flag = Arc::clone(&interrupted);
        // The first interrupt ends the search, a second one the program. Without a handler the system's own way stays.
        let _ = ctrlc::set_handler(move || {
            if flag.swap(true, Ordering::Relaxed) {
                std::process::exit(130);
            }
        });
        let shows = !wants_json && io::stderr().is_terminal();
        let target = if shows { ProgressDrawTarget::stderr() } else { ProgressDrawTarget::hidden() };
        let style = ProgressStyle::with_template("{wide_bar} {pos}/{len} {msg}")
            .unwrap_or_else(|_| ProgressStyle::default_bar());
        Self { interrupted, bar: ProgressBar::with_draw_target(Some(1), target).with_style(style) }
    }
}

impl Observer for Watcher {
    fn goes_on(&self) -> bool {
        !self.interrupted.load(Ordering::Relaxed)
    }

    fn hears(&self, progress: &Progress) {
        let best = progress.best.map_or_else(String::new, |best| format!(", best so far {}", short(best)));
        self.bar.set_length(progress.total as u64);
        self.bar.set_position(progress.done as u64);
        self.bar.set_message(format!("{}{best}", progress.stage));
    }
}

#[derive(Serialize)]
struct Report {
    family: String,
    steps: usize,
    order: usize,
    objective: String,
    seed: u64,
    complete: bool,
    /// The best value of the objective that any row was exactly decided to have, whatever its denominator.
    bound: f64,
    #[serde(skip)]
    is_largest_best: bool,
    #[serde(skip)]
    denominator: u32,
    rows: Vec<Line>,
    front: Vec<Line>,
}

#[derive(Serialize)]
struct Line {
    id: String,
    value: f64,
    denominator: u32,
    h_max: f64,
    h_max_exact: Option<String>,
    per_step_constant: f64,
    error_constant: Option<String>,
    h_opt: f64,
    r_opt: f64,
    feedforward_noise: f64,
    toml: String,
}

impl Line {
    fn new(found: &Found, objective: &Objective) -> Self {
        let (figures, analysis) = (&found.figures, found.checked.analysis());
        Self {
            id: found.checked.row().id().to_owned(),
            value: objective.value(figures),
            denominator: found.denominator,
            h_max: figures.h_max,
            h_max_exact: analysis
                .feedback_range()
                .and_then(kinstep::formula::FeedbackRange::exact)
                .map(|h| h.to_string()),
            per_step_constant: figures.per_step,
            error_constant: analysis.error_constant().map(|c| c.to_string()),
            h_opt: figures.h_opt,
            r_opt: figures.r_opt,
            feedforward_noise: figures.noise,
            toml: found.checked.to_toml(),
        }
    }
}

impl Report {
    fn new(options: &Options, outcome: &Outcome) -> Self {
        let lines = |rows: &[Found]| rows.iter().map(|row| Line::new(row, &options.objective)).collect();
        Self {
            family: options.family.to_string(),
            steps: options.steps,
            order: options.order,
            objective: options.objective.word(),
            seed: options.seed,
            complete: outcome.complete,
            bound: outcome.bound,
            is_largest_best: matches!(options.objective, Objective::Range | Objective::Beat(_)),
            denominator: options.denominator,
            rows: lines(&outcome.rows),
            front: lines(&outcome.front),
        }
    }

    /// All rows, and those of the front that are not among them.
    fn toml(&self) -> String {
        let known = |line: &&Line| self.rows.iter().all(|row| row.id != line.id);
        let all: Vec<&str> =
            self.rows.iter().chain(self.front.iter().filter(known)).map(|line| line.toml.as_str()).collect();
        all.join("\n")
    }
}

/// A value to six decimals, never rounded to a better one.
fn towards_worse(value: f64, is_largest_best: bool) -> String {
    const PLACES: f64 = 1e6;
    let scaled = value * PLACES;
    let worse = if is_largest_best { scaled.floor() } else { scaled.ceil() };
    format!("{:.6}", worse / PLACES)
}

fn table(lines: &[Line]) -> Table {
    let mut table = Table::new(["id", "value", "h_max", "C", "c", "h_opt", "r_opt", "noise of phi'"]);
    for line in lines {
        let constant = line.error_constant.clone().unwrap_or_default();
        let constant = if constant.len() <= 12 {
            constant
        } else {
            let value = kinstep::math::parse_rational(&constant).map(|c| kinstep::math::rational_to_f64(&c));
            value.map_or(constant, short)
        };
        let figures = [line.h_opt, line.r_opt, line.feedforward_noise].map(short);
        let head =
            [line.id.clone(), short(line.value), short(line.h_max), short(line.per_step_constant), constant];
        table.row(head.into_iter().chain(figures));
    }
    table
}

impl Show for Report {
    fn text(&self) -> String {
        let toml: Vec<&str> = self.rows.iter().map(|line| line.toml.as_str()).collect();
        let mut text = format!(
            "{} rows of {} steps and order {}, best at: {}\nthe best of all rows that were decided exactly, whatever their fractions, has {} {}; of denominators up to {}:\n\n{}\n{}",
            self.family,
            self.steps,
            self.order,
            self.objective,
            if self.is_largest_best { "at least" } else { "at most" },
            towards_worse(self.bound, self.is_largest_best),
            self.denominator,
            table(&self.rows),
            toml.join("\n"),
        );
        if !self.front.is_empty() {
            // Writing to a String can not fail.
            let _ = write!(text, "\nPareto front of range, error and decay:\n\n{}", table(&self.front));
        }
        text
    }
}
