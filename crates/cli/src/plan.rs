//! `kinstep plan`: a scenario run, its trajectories written, and what to try next.

use std::path::Path;
use std::time::Instant;

use super::arguments::PlanArguments;
use super::failure::{Exit, Failure};
use super::output::Output;
use super::progress::Progress;
use super::results::{PageContext, Results};
use super::shell::{option, quoted};
use kinstep::math::number_text;
use kinstep::planner::{Plan, PlanStatus, Planner};
use kinstep::robot::names::printable;
use kinstep_files::scenario::{FormulaRows, Kinds, Real, Scenario, ScenarioText};
use kinstep_report::{PlanFormat, PlanJson, PlanText, Suggestion, plan_details, suggestions};

/// The scenario that runs without a file.
const BUILTIN: &str = include_str!("../../../examples/dual_panda.toml");

pub(super) fn run(
    arguments: &PlanArguments,
    own: Option<&Path>,
    output: &mut Output,
) -> Result<Exit, Failure> {
    let mut clock = Stages::begin();
    let text = scenario_text(arguments)?;
    let mut scenario = text.scenario()?;
    let rows = formula_rows(&text, &scenario, own)?;
    // No row has an empty id: without a formula there is nothing to refuse.
    let table = rows.table_for(scenario.formula.as_deref().unwrap_or_default())?;
    let planner = scenario.planner(table, text.folder()).map_err(|e| text.placed(e))?;
    keep_starts(&mut scenario, &planner);
    let wants_details = output.is_verbose() && !output.wants_json();
    let is_staged = wants_details || arguments.written.out.is_some();
    let stage = is_staged.then(|| scenario.stage(text.folder())).transpose().map_err(|e| text.placed(e))?;
    let results = Results::open(arguments, stage.as_ref())?;
    clock.done("reading");
    let mut sought = String::new();
    let mut plan = if arguments.fastest {
        let found = scenario.fastest(&Kinds::builtin(), table, text.folder(), run_planner);
        let found = found.map_err(|e| text.placed(e))?;
        scenario = found.scenario;
        sought = found_in(found.runs, &found.plan);
        found.plan
    } else {
        run_planner(planner)
    };
    clock.done("planning");
    plan.warnings.extend(rows.warnings());
    plan.warnings.extend(scenario.limit_findings(text.folder()));
    plan.warnings.extend(scenario.timing_findings(text.folder()));
    if output.is_verbose() {
        scenario.robot_findings(text.folder()).iter().for_each(|found| output.aside(&printable(found)));
    }
    let names_formula = scenario.formula.is_some();
    // What is written down says what was run, whatever the default becomes later.
    scenario.formula.get_or_insert_with(|| plan.formula.clone());
    let next = suggestions(&plan, table, &scenario);
    let details = stage.as_ref().filter(|_| wants_details);
    let details = details.map_or_else(String::new, |stage| plan_details(&plan, stage));
    let mut names = Vec::new();
    if let Some(results) = results {
        let again = scenario.relocated(text.folder(), own, results.path())?.to_toml();
        let context = PageContext { scenario: &again, title: &title(arguments), suggestions: &next };
        names = results.write(&mut plan, &context)?;
    }
    clock.done("writing");
    if output.is_quiet() {
        for sentence in important_warnings(&plan) {
            output.remark(&sentence);
        }
    }
    if output.wants_json() {
        output.text(&written(&PlanJson, &plan))?;
    } else {
        let head = if arguments.scenario.is_none() {
            "The built-in scenario: two Panda arms, full poses.\n"
        } else {
            ""
        };
        let chosen = if names_formula {
            String::new()
        } else {
            format!(
                "The scenario names no formula: {} does best in general (kinstep formula list --recommended).\n",
                plan.formula
            )
        };
        output.report(&format!(
            "{head}{chosen}{sought}{}{details}{}",
            written(&PlanText, &plan),
            closing(arguments, &names, next)
        ))?;
    }
    if output.is_verbose() {
        output.aside(&clock.to_string());
    }
    Ok(exit(&plan))
}

/// Says what a search for the least duration found.
fn found_in(runs: usize, plan: &Plan) -> String {
    let duration = number_text(plan.duration());
    let runs = if runs == 1 { "one plan".to_owned() } else { format!("{runs} plans") };
    if plan.is_completed() {
        format!("The least duration within the joints' limits of motion is {duration} s, found by {runs}.\n")
    } else {
        format!("No duration was found: after {runs} the run stops at {duration} s too.\n")
    }
}

/// What the page is called.
fn title(arguments: &PlanArguments) -> String {
    let name = arguments.scenario.as_ref().and_then(|file| file.file_stem());
    name.map_or_else(|| "The built-in scenario".to_owned(), |name| name.to_string_lossy().into_owned())
}

/// How long the stages of the work took.
struct Stages {
    begun: Instant,
    took: Vec<(&'static str, f64)>,
}

impl Stages {
    fn begin() -> Self {
        Self { begun: Instant::now(), took: Vec::new() }
    }

    fn done(&mut self, stage: &'static str) {
        self.took.push((stage, self.begun.elapsed().as_secs_f64()));
        self.begun = Instant::now();
    }
}

impl std::fmt::Display for Stages {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let stages: Vec<String> =
            self.took.iter().map(|(stage, seconds)| format!("{stage} {seconds:.3} s")).collect();
        write!(f, "{}", stages.join(", "))
    }
}

/// What has to be said of a plan even where nothing else is.
fn important_warnings(plan: &Plan) -> Vec<String> {
    let stopped = plan.reason.iter().map(|reason| format!("stopped, {}: {reason}", plan.status.name()));
    let crossed = plan.arms.iter().flat_map(|arm| arm.violations.iter().map(move |limit| (arm, limit)));
    let crossed = crossed.map(|(arm, limit)| {
        let (kind, joint) = (limit.kind.name(), &limit.joint);
        format!("warning: {} crosses the {kind} limit of {joint} at {} s", arm.name, number_text(limit.t))
    });
    let warnings = plan.warnings.iter().map(|warning| format!("warning: {warning}"));
    stopped.chain(crossed).chain(warnings).collect()
}

/// Puts joint positions that were solved for into the scenario: what is written down says what was run.
fn keep_starts(scenario: &mut Scenario, planner: &Planner) {
    for (i, arm) in scenario.arm.iter_mut().enumerate().filter(|(_, arm)| arm.start_pose.is_some()) {
        arm.q0 = planner.arm(i).positions.iter().map(|&q| Real::from(q)).collect();
    }
}

fn scenario_text(arguments: &PlanArguments) -> Result<ScenarioText, Failure> {
    let mut text = match &arguments.scenario {
        Some(file) => ScenarioText::read(file)?,
        None => ScenarioText::parse(BUILTIN)?,
    };
    arguments.set.iter().try_for_each(|assignment| text.set(assignment))?;
    Ok(text)
}

fn formula_rows(
    text: &ScenarioText,
    scenario: &Scenario,
    own: Option<&Path>,
) -> Result<FormulaRows, Failure> {
    let mut rows = scenario.formula_rows(text.folder()).map_err(|e| text.placed(e))?;
    own.map_or(Ok(()), |file| rows.add_file(file))?;
    Ok(rows)
}

fn run_planner(planner: Planner) -> Plan {
    let mut progress = Progress::new(planner.steps());
    planner.run_with(|done, _| progress.step(done))
}

fn written(format: &dyn PlanFormat, plan: &Plan) -> String {
    let mut bytes = Vec::new();
    // A vector takes every byte.
    let _ = format.write(plan, &mut bytes);
    String::from_utf8_lossy(&bytes).into_owned()
}

fn exit(plan: &Plan) -> Exit {
    match plan.status {
        PlanStatus::Completed
            if plan.is_within_limits() && plan.keeps_distances() && plan.has_converged() =>
        {
            Exit::Done
        }
        PlanStatus::Completed | PlanStatus::Limit => Exit::CheckFailed,
        _ => Exit::Stopped,
    }
}

/// What was laid over the scenario and what these arguments do not set anew, as arguments.
fn still_set(arguments: &PlanArguments, next: &str) -> String {
    let is_set_anew = |set: &str| {
        let key = set.split('=').next().unwrap_or_default().trim();
        next.contains(&format!("--set {key}="))
    };
    arguments.set.iter().filter(|set| !is_set_anew(set)).map(|set| option("--set", set)).collect()
}

/// Where the files are, and what to try next.
fn closing(arguments: &PlanArguments, names: &[String], suggested: Vec<Suggestion>) -> String {
    let name = arguments.scenario.as_ref().map(|file| quoted(&file.display().to_string()));
    let name = name.map_or_else(String::new, |name| format!(" {name}"));
    let mut next = Vec::new();
    let mut written = String::new();
    match &arguments.written.out {
        Some(folder) => {
            let pictures = if arguments.figures { ", and the pictures in figures" } else { "" };
            written = format!("\nWritten to {}: {}{pictures}.\n", folder.display(), names.join(", "));
        }
        None => {
            next.push(Suggestion::new("--out results", "the trajectory as a file, and a page to look at"));
        }
    }
    next.extend(suggested);
    let line = |next: Suggestion| {
        let set = still_set(arguments, &next.arguments);
        [format!("kinstep plan{name}{set} {}", next.arguments), next.reason]
    };
    let mut lines: Vec<[String; 2]> = next.into_iter().map(line).collect();
    if let Some(folder) = arguments.written.out.as_ref().filter(|_| !arguments.figures) {
        lines.push([
            format!("kinstep plot {}", quoted(&folder.display().to_string())),
            "its pictures".to_owned(),
        ]);
    }
    if arguments.scenario.is_none() {
        lines.push(["kinstep schema scenario", "every key of a scenario of your own"].map(str::to_owned));
    }
    let width = lines.iter().map(|[command, _]| command.chars().count()).max().unwrap_or(0);
    let lines: Vec<String> =
        lines.iter().map(|[command, why]| format!("  {command:width$}  # {why}\n")).collect();
    if lines.is_empty() { written } else { format!("{written}\nNext:\n{}", lines.concat()) }
}
