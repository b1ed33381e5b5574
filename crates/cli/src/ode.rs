//! `kinstep ode`: an initial value problem, solved.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

use serde::Serialize;

use super::arguments::OdeArguments;
use super::failure::{Exit, Failure};
use super::folder::Folder;
use super::order::{problems, scenario_text};
use super::output::{Output, Show};
use kinstep::formula::Formula;
use kinstep::integrate::{Equations, Event, Family, IntegrateError, Method, Mode, Solution, Solver};
use kinstep_files::scenario::{
    ErrorKind, FormulaRows, KeyPath, ProblemSpec, Scenario, ScenarioError, ScenarioText, suggestion,
};
use kinstep_report::figure::{Figure, ode_figures};
use kinstep_report::{Table, short};

/// How many lines of a table are printed.
const MOST_LINES: usize = 40;

/// A state at a time.
#[derive(Serialize)]
struct Told {
    #[serde(skip_serializing_if = "Option::is_none")]
    name: Option<String>,
    t: f64,
    x: Vec<f64>,
}

/// What was found, under the keys that scripts rely on.
#[derive(Serialize)]
struct Solved {
    status: &'static str,
    reason: Option<String>,
    method: String,
    t: f64,
    x: Vec<f64>,
    names: Vec<String>,
    steps: usize,
    rejected: usize,
    evaluations: usize,
    jacobians: usize,
    factorizations: usize,
    orders: BTreeMap<usize, usize>,
    samples: Vec<Told>,
    events: Vec<Told>,
    /// By how much the state is off what the file has from elsewhere, at most.
    #[serde(skip_serializing_if = "Option::is_none")]
    reference: Option<Off>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    written: Vec<String>,
    warnings: Vec<String>,
    #[serde(skip)]
    next: String,
}

/// The distance from a state that is known.
#[derive(Serialize)]
struct Off {
    source: String,
    /// The largest over the components \[1\].
    largest_error: f64,
    /// The largest in units of what the tolerances allow.
    in_tolerances: f64,
}

pub(super) fn run(
    arguments: &OdeArguments,
    own: Option<&Path>,
    output: &mut Output,
) -> Result<Exit, Failure> {
    let Some(name) = &arguments.problem else { return list(output) };
    let text = scenario_text(name, &arguments.set)?;
    let scenario = text.scenario()?;
    let (Some(problem), Some(equations)) =
        (&scenario.problem, scenario.equations().map_err(|e| text.placed(e))?)
    else {
        let message = format!(
            "{name} moves arms: `kinstep plan` runs it; an initial value problem is a table [problem]"
        );
        return Err(Failure::usage(message));
    };
    let end = arguments.until.unwrap_or(scenario.duration.value());
    let atol = arguments.atol.unwrap_or(1e-3 * arguments.rtol);
    let solver = solver(arguments, &text, &scenario, own)?
        .tolerance(arguments.rtol, atol)
        .most_steps(arguments.max_steps)
        .sample_at(arguments.at.iter().copied())
        .keep_steps()
        .dense();
    let solver = watch(solver, problem, &equations);
    let folder = open(arguments, &equations)?;
    let initial: Vec<f64> = equations.initial();
    let solution = solver.solve(&mut equations.field(), 0.0, &initial, end).map_err(|e| refusal(&e))?;
    let mut solved = Solved::of(&solution, &equations);
    solved.reference = off(problem, &solution, &text, (arguments.rtol, atol))?;
    solved.next = format!(
        "\nNext:\n  kinstep ode {name} --out solution            figures, samples and steps\n  kinstep ode {name} --rtol 1e-10             closer\n"
    );
    if let Some(folder) = folder {
        solved.written = write(&folder, name, &solution, &equations, &solved)?;
        solved.next.clear();
    }
    if !output.wants_json() {
        solved.warnings.iter().for_each(|warning| output.remark(&format!("warning: {warning}")));
    }
    output.show(&solved)?;
    Ok(if solution.status.is_success() { Exit::Done } else { Exit::Stopped })
}

/// The sentences of the solver name what it calls so; here they are options.
fn refusal(error: &IntegrateError) -> Failure {
    let is_of_row = matches!(
        error,
        IntegrateError::NotRunnable(_)
            | IntegrateError::Kind { .. }
            | IntegrateError::OnePart { .. }
            | IntegrateError::MixedPair { .. }
            | IntegrateError::NoStep { .. }
    );
    let sentence = [
        ("the relative tolerance", "--rtol"),
        ("an absolute tolerance", "--atol"),
        ("the sampling gap", "--sigma"),
        ("the range of time", "--until"),
        ("the relative and --atol are", "--rtol and --atol are"),
    ]
    .iter()
    .fold(error.to_string(), |sentence, (from, to)| sentence.replace(from, to));
    Failure::new(if is_of_row { Exit::Formula } else { Exit::Usage }, sentence)
}

/// What is asked for: a row, a pair, a family, or whatever suits.
fn solver<'e>(
    arguments: &OdeArguments,
    text: &ScenarioText,
    scenario: &Scenario,
    own: Option<&Path>,
) -> Result<Solver<'e, f64>, Failure> {
    if let Some(id) = &arguments.family {
        let family = Family::by_id(id).ok_or_else(|| {
            let known = suggestion(id, Family::ALL.iter().map(|family| family.id()));
            Failure::usage(format!("--family: there is no family \"{id}\"; {known}"))
        })?;
        return Ok(Solver::family(family));
    }
    let mut rows = scenario.formula_rows(text.folder()).map_err(|e| text.placed(e))?;
    own.map_or(Ok(()), |file| rows.add_file(file))?;
    let step = arguments.sigma.unwrap_or(scenario.sigma.value());
    match (&arguments.method, &arguments.predictor, &arguments.corrector) {
        (Some(id), ..) => Ok(Solver::method(Method::of(&row(&rows, "--method", id)?), step)),
        (None, Some(predictor), Some(corrector)) => {
            let (predictor, corrector) =
                (row(&rows, "--predictor", predictor)?, row(&rows, "--corrector", corrector)?);
            Ok(Solver::method(Method::pair(&predictor, &corrector, Mode::Pece), step))
        }
        _ if arguments.sigma.is_some() => Err(Failure::usage(
            "--sigma is the step of a method in equal steps; name one by --method, or leave it out",
        )),
        _ => Ok(Solver::automatic()),
    }
}

fn row(rows: &FormulaRows, option: &str, id: &str) -> Result<Formula, Failure> {
    let table = rows.table_for(id)?;
    let row = table.get(id).map_err(|e| Failure::new(Exit::Formula, format!("{option}: {e}")))?;
    Ok(row.clone())
}

fn watch<'e>(mut solver: Solver<'e, f64>, problem: &ProblemSpec, equations: &Equations) -> Solver<'e, f64> {
    for (place, (name, spec)) in equations.events().zip(&problem.events).enumerate() {
        let mut field = equations.field();
        let event =
            Event::new(name, move |t, x: &[f64]| field.event(place, t, x)).direction(spec.direction());
        solver = solver.event(if spec.is_terminal() { event.terminal() } else { event });
    }
    solver
}

/// How far the solution is from the state that the file has from elsewhere, where it ends at that time.
fn off(
    problem: &ProblemSpec,
    solution: &Solution<f64>,
    text: &ScenarioText,
    (rtol, atol): (f64, f64),
) -> Result<Option<Off>, Failure> {
    let Some(reference) = &problem.reference else { return Ok(None) };
    let at = KeyPath::dotted("problem").key("reference").key("x");
    if reference.x.len() != solution.x.len() {
        let (got, expected) = (reference.x.len(), solution.x.len());
        let sentence = format!("{got} numbers where there are {expected} unknowns");
        return Err(text.placed(ScenarioError::at(ErrorKind::Scenario, &at, sentence)).into());
    }
    if reference.t.value() != solution.t {
        return Ok(None);
    }
    let pairs = || solution.x.iter().zip(reference.x.iter().map(kinstep::kind::Real::value));
    Ok(Some(Off {
        source: reference.source.clone(),
        largest_error: pairs().map(|(x, known)| (x - known).abs()).fold(0.0, f64::max),
        in_tolerances: pairs()
            .map(|(x, known)| (x - known).abs() / (rtol * known.abs() + atol))
            .fold(0.0, f64::max),
    }))
}

const FILES: [&str; 3] = ["ode.json", "steps.csv", "samples.csv"];
const FIGURES: [&str; 4] = ["solution", "phase", "steps", "orders"];

fn open(arguments: &OdeArguments, equations: &Equations) -> Result<Option<Folder>, Failure> {
    let figures = FIGURES.iter().filter(|name| **name != "phase" || equations.unknowns().len() > 1);
    let figures = figures.map(|name| format!("{name}.svg"));
    let names: Vec<String> = FILES.iter().map(|name| (*name).to_owned()).chain(figures).collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    arguments.written.folder(&names)
}

fn write(
    folder: &Folder,
    name: &str,
    solution: &Solution<f64>,
    equations: &Equations,
    solved: &Solved,
) -> Result<Vec<String>, Failure> {
    let names = equations.unknowns();
    let document = serde_json::to_value(solved)
        .map_err(|e| Failure::new(Exit::File, format!("the result can not be written as JSON: {e}")))?;
    folder.write(FILES[0], |out| writeln!(out, "{document:#}"))?;
    let steps = solution.steps.iter().map(|step| (step.t, &step.x, Some(step.order)));
    folder.write(FILES[1], |out| out.write_all(table(names, true, steps).as_bytes()))?;
    let samples = solution.samples.iter().map(|sample| (sample.t, &sample.x, None));
    folder.write(FILES[2], |out| out.write_all(table(names, false, samples).as_bytes()))?;
    let title = format!("{name}: {}", solution.method);
    let figures: Vec<Figure> = ode_figures(&title, names, solution);
    for figure in &figures {
        folder.write(&format!("{}.svg", figure.name), |out| out.write_all(figure.to_svg().as_bytes()))?;
    }
    let files = FILES
        .iter()
        .map(|name| (*name).to_owned())
        .chain(figures.iter().map(|figure| format!("{}.svg", figure.name)));
    Ok(files.map(|name| folder.path().join(name).display().to_string()).collect())
}

/// A table of comma-separated values with 17 significant digits.
fn table<'x>(
    names: &[String],
    has_order: bool,
    rows: impl Iterator<Item = (f64, &'x Vec<f64>, Option<usize>)>,
) -> String {
    let mut text = format!("t,{}{}\n", names.join(","), if has_order { ",order" } else { "" });
    for (t, x, order) in rows {
        // Writing to a String can not fail.
        let _ = write!(text, "{t:.16e}");
        for value in x {
            let _ = write!(text, ",{value:.16e}");
        }
        let _ = writeln!(text, "{}", order.map_or_else(String::new, |order| format!(",{order}")));
    }
    text
}

impl Solved {
    fn of(solution: &Solution<f64>, equations: &Equations) -> Self {
        let statistics = solution.statistics;
        let orders = statistics.orders.iter().enumerate().filter(|(_, steps)| **steps > 0);
        let samples =
            solution.samples.iter().map(|sample| Told { name: None, t: sample.t, x: sample.x.clone() });
        let events = solution.events.iter();
        let events =
            events.map(|event| Told { name: Some(event.name.clone()), t: event.t, x: event.x.clone() });
        Self {
            status: solution.status.name(),
            reason: solution.reason.clone(),
            method: solution.method.clone(),
            t: solution.t,
            x: solution.x.clone(),
            names: equations.unknowns().to_vec(),
            steps: statistics.steps,
            rejected: statistics.rejected,
            evaluations: statistics.evaluations,
            jacobians: statistics.jacobians,
            factorizations: statistics.factorizations,
            orders: orders.map(|(order, steps)| (order, *steps)).collect(),
            samples: samples.collect(),
            events: events.collect(),
            reference: None,
            written: Vec::new(),
            warnings: solution.warnings.clone(),
            next: String::new(),
        }
    }

    fn told(&self, title: &str, rows: &[Told]) -> String {
        if rows.is_empty() {
            return String::new();
        }
        let shown = self.names.len().min(8);
        let heads = [title, "t"].into_iter().chain(self.names[..shown].iter().map(String::as_str));
        let mut table = Table::new(heads);
        for row in rows.iter().take(MOST_LINES) {
            let values = row.x[..shown].iter().map(|x| format!("{x:.10e}"));
            table.row([row.name.clone().unwrap_or_default(), row.t.to_string()].into_iter().chain(values));
        }
        let more = rows.len().saturating_sub(MOST_LINES);
        let more = if more > 0 { format!("and {more} more\n") } else { String::new() };
        format!("\n{table}{more}")
    }
}

impl Show for Solved {
    fn text(&self) -> String {
        let Self { status, method, t, steps, rejected, evaluations, jacobians, factorizations, .. } = self;
        let mut text = format!(
            "{status} at t = {t} by {method}: {steps} steps ({rejected} rejected), {evaluations} evaluations"
        );
        if *jacobians > 0 {
            let _ = write!(text, ", {jacobians} Jacobians, {factorizations} factorizations");
        }
        let orders = self.orders.iter().map(|(order, steps)| format!("{order}: {steps}"));
        let _ = writeln!(text, "\nsteps by order  {}", orders.collect::<Vec<_>>().join(", "));
        if let Some(reason) = &self.reason {
            let _ = writeln!(text, "STOPPED  {reason}");
        }
        let mut table = Table::new(["unknown", "value"]);
        for (name, x) in self.names.iter().zip(&self.x).take(MOST_LINES) {
            table.row([name.clone(), format!("{x:.16e}")]);
        }
        let _ = write!(text, "\n{table}");
        text.push_str(&self.told("sample", &self.samples));
        text.push_str(&self.told("event", &self.events));
        if let Some(Off { source, largest_error, in_tolerances }) = &self.reference {
            let (error, times) = (short(*largest_error), short(*in_tolerances));
            let _ = writeln!(
                text,
                "\n{error} off the known state at most, {times} times what the tolerances allow ({source})"
            );
        }
        if !self.written.is_empty() {
            let _ = writeln!(text, "\nwrote {}", self.written.join(", "));
        }
        text + &self.next
    }
}

/// The problems, and what solves them.
fn list(output: &mut Output) -> Result<Exit, Failure> {
    let problems = problems()?;
    if output.wants_json() {
        let named = |(name, source): &(&str, String)| serde_json::json!({ "name": name, "source": source });
        let families: Vec<&str> = Family::ALL.iter().map(|family| family.id()).collect();
        output.json(&serde_json::json!({
            "problems": problems.iter().map(named).collect::<Vec<_>>(), "families": families,
        }))?;
        return Ok(Exit::Done);
    }
    let mut table = Table::new(["problem", "what it is"]);
    for (name, source) in &problems {
        table.row([*name, source.as_str()]);
    }
    let mut families = Table::new(["family", "orders"]);
    for family in Family::ALL {
        let orders = family.orders();
        families.row([family.id().to_owned(), format!("{} to {}", orders.start(), orders.end())]);
    }
    output.report(&format!(
        "{table}\n{families}\nMethods in equal steps are the rows of `kinstep formula list`.\n\nNext:\n  kinstep ode kepler\n  kinstep ode van_der_pol --set problem.parameters.m=1000 --until 2000\n"
    ))?;
    Ok(Exit::Done)
}
