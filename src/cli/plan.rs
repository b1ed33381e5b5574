//! `kinstep plan`: a scenario run, its trajectories written, and what to try next.

use std::path::Path;
use std::time::Instant;

use super::arguments::PictureFormat;
use super::arguments::PlanArguments;
use super::failure::{Exit, Failure};
use super::folder::Folder;
use super::output::Output;
use super::plot;
use super::progress::Progress;
use crate::formula::{Formula, FormulaTable};
use crate::math::figure;
use crate::planner::{LimitKind, Plan, PlanStatus, Planner};
use crate::report::figure::plan_figures;
use crate::report::{PlanFormat, PlanJson, PlanText, plan_details};
use crate::scenario::{FormulaRows, Real, Scenario, ScenarioText};
use crate::trajectory::{About, Csv, Recording, Trajectory, TrajectoryFormat};

/// The scenario that runs without a file.
const BUILTIN: &str = include_str!("../../examples/dual_panda.toml");

/// The files of `--out`.
const NAMES: [&str; 3] = ["trajectory.csv", "plan.json", "scenario.toml"];

/// The folder of the pictures in it.
const FIGURES: &str = "figures";

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
    let folder =
        arguments.out.as_deref().map(|path| Folder::open(path, arguments.force, &NAMES)).transpose()?;
    clock.done("reading");
    let mut plan = run_planner(planner);
    clock.done("planning");
    plan.warnings.extend(rows.warnings());
    let names_formula = scenario.formula.is_some();
    // What is written down says what was run, whatever the default becomes later.
    scenario.formula.get_or_insert_with(|| plan.formula.clone());
    let details = if output.is_verbose() && !output.wants_json() {
        plan_details(&plan, &scenario.stage(text.folder()).map_err(|e| text.placed(e))?)
    } else {
        String::new()
    };
    if let Some(folder) = &folder {
        let stage = scenario.stage(text.folder()).map_err(|e| text.placed(e))?;
        let again = scenario.relocated(text.folder(), own, folder.path())?.to_toml();
        let trajectory = Trajectory::of(&plan, Some(About::of(&plan, &again, &stage)));
        let recording = Recording { trajectory: &trajectory, stage: &stage };
        folder.write("trajectory.csv", |out| Csv.write(recording, out))?;
        folder.write("plan.json", |out| PlanJson.write(&plan, out))?;
        folder.write("scenario.toml", |out| out.write_all(again.as_bytes()))?;
        if arguments.figures {
            let figures = plan_figures(recording, Some(&plan));
            plot::write(&folder.path().join(FIGURES), arguments.force, &figures, &[PictureFormat::Svg])?;
        }
    }
    clock.done("writing");
    if output.is_quiet() {
        for sentence in grave(&plan) {
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
            "{head}{chosen}{}{details}{}",
            written(&PlanText, &plan),
            closing(arguments, &plan, table, &scenario)
        ))?;
    }
    if output.is_verbose() {
        output.aside(&clock.to_string());
    }
    Ok(exit(&plan))
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
fn grave(plan: &Plan) -> Vec<String> {
    let stopped = plan.reason.iter().map(|reason| format!("stopped, {}: {reason}", plan.status.name()));
    let crossed = plan.arms.iter().flat_map(|arm| arm.violations.iter().map(move |limit| (arm, limit)));
    let crossed = crossed.map(|(arm, limit)| {
        let (kind, joint) = (limit.kind.name(), &limit.joint);
        format!("warning: {} crosses the {kind} limit of {joint} at {} s", arm.name, figure(limit.t))
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

pub(super) fn formula_rows(
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
        PlanStatus::Completed if plan.is_within_limits() => Exit::Done,
        PlanStatus::Completed | PlanStatus::Limit => Exit::CheckFailed,
        _ => Exit::Stopped,
    }
}

/// Where the files are, and what to try next.
fn closing(arguments: &PlanArguments, plan: &Plan, table: &FormulaTable, scenario: &Scenario) -> String {
    let name = arguments.scenario.as_ref().map_or_else(String::new, |file| format!(" {}", file.display()));
    let mut next = Vec::new();
    let mut written = String::new();
    match &arguments.out {
        Some(folder) => {
            let pictures = if arguments.figures { ", and the pictures in figures" } else { "" };
            written = format!("\nWritten to {}: {}{pictures}.\n", folder.display(), NAMES.join(", "));
        }
        None => next.push(("--out results".to_owned(), "the trajectory as a file".to_owned())),
    }
    next.extend(suggestions(plan, table, scenario));
    let mut lines: Vec<[String; 2]> =
        next.into_iter().map(|(arguments, why)| [format!("kinstep plan{name} {arguments}"), why]).collect();
    if let Some(folder) = arguments.out.as_ref().filter(|_| !arguments.figures) {
        lines.push([format!("kinstep plot {}", folder.display()), "its pictures".to_owned()]);
    }
    if arguments.scenario.is_none() {
        lines.push(["kinstep schema scenario", "every key of a scenario of your own"].map(str::to_owned));
    }
    let width = lines.iter().map(|[command, _]| command.chars().count()).max().unwrap_or(0);
    let lines: Vec<String> =
        lines.iter().map(|[command, why]| format!("  {command:width$}  # {why}\n")).collect();
    if lines.is_empty() { written } else { format!("{written}\nNext:\n{}", lines.concat()) }
}

/// What would make this plan better, as arguments and the reason.
fn suggestions(plan: &Plan, table: &FormulaTable, scenario: &Scenario) -> Vec<(String, String)> {
    let mut next = Vec::new();
    let Ok(formula) = table.get(&plan.formula) else { return next };
    let best = formula.optimum().map(|optimum| format!("{:.3}", optimum.h));
    if plan.status == PlanStatus::Diverged && !formula.feedback_range().contains(plan.h) {
        next.extend(
            best.map(|h| (format!("--set law.h={h}"), "the formula's best feedback step".to_owned())),
        );
    }
    if !plan.is_completed() {
        return next;
    }
    if let Some(excess) = velocity_excess(plan) {
        let longer = (scenario.duration.value() * excess * 1.05).ceil();
        next.push((
            format!("--set duration={longer}"),
            "slow enough for the joints' velocity limits".to_owned(),
        ));
    }
    if errors_follow_the_order(plan, formula) {
        let halvings = formula.order() + usize::from(scenario.law.gain.is_none());
        let (fold, held) =
            (1_u64 << halvings.min(60), if scenario.law.gain.is_some() { "gain" } else { "h" });
        let why = format!("errors about {fold} times smaller: order {} at the same {held}", formula.order());
        next.push((format!("--set sigma={}", figure(plan.sigma / 2.0)), why));
    }
    if plan.formula != "split-ab6" {
        let arguments = "--set formula=split-ab6 --set law.h=1 --set start=rk8".to_owned();
        next.push((arguments, "a deadbeat loop of order 6".to_owned()));
    }
    next
}

/// Whether a smaller gap may be promised to make the errors smaller: they stand above the round-off, and the loop is fast
/// enough to settle within the run.
fn errors_follow_the_order(plan: &Plan, formula: &Formula) -> bool {
    const ROUND_OFF: f64 = 1e-13;
    const SETTLED: f64 = 1e-3;
    let worst = plan.arms.iter().map(|arm| arm.max_error).fold(0.0, f64::max);
    let left_over = formula.spectral_radius(plan.h).powf(plan.steps as f64 / 2.0);
    worst > ROUND_OFF && left_over < SETTLED
}

/// By what factor the worst joint velocity exceeds its limit, where one does: velocities fall like 1/duration.
fn velocity_excess(plan: &Plan) -> Option<f64> {
    let all = plan.arms.iter().flat_map(|arm| &arm.violations);
    let excess = all.filter(|v| v.kind == LimitKind::Velocity).map(|v| (v.value / v.limit).abs());
    excess.filter(|excess| excess.is_finite()).reduce(f64::max)
}
