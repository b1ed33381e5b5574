//! `kinstep plan`: a scenario run, its trajectories written, and what to try next.

use std::path::Path;

use super::arguments::PlanArguments;
use super::failure::{Exit, Failure};
use super::folder::Folder;
use super::formula_plot::draw;
use super::output::Output;
use super::progress::Progress;
use crate::formula::FormulaTable;
use crate::planner::{Plan, PlanStatus, Planner};
use crate::report::figure::plan_figures;
use crate::report::{PlanFormat, PlanJson, PlanPage, PlanText, Suggestion, suggestions};
use crate::scenario::{FormulaRows, Real, Scenario, ScenarioText};
use crate::trajectory::{About, Csv, Recording, Trajectory, TrajectoryFormat};

/// The scenario that runs without a file.
const BUILTIN: &str = include_str!("../../examples/dual_panda.toml");

/// The files of `--out`.
const NAMES: [&str; 3] = ["trajectory.csv", "plan.json", "scenario.toml"];
/// The page that is among them unless it is not wanted.
const PAGE: &str = "report.html";

/// The folder of the pictures in it.
const FIGURES: &str = "figures";

pub(super) fn run(
    arguments: &PlanArguments,
    own: Option<&Path>,
    output: &mut Output,
) -> Result<Exit, Failure> {
    let text = scenario_text(arguments)?;
    let mut scenario = text.scenario()?;
    let rows = formula_rows(&text, &scenario, own)?;
    // No row has an empty id: without a formula there is nothing to refuse.
    let table = rows.table_for(scenario.formula.as_deref().unwrap_or_default())?;
    let planner = scenario.planner(table, text.folder()).map_err(|e| text.placed(e))?;
    keep_starts(&mut scenario, &planner);
    let folder = arguments
        .out
        .as_deref()
        .map(|path| Folder::open(path, arguments.force, &names(arguments)))
        .transpose()?;
    let mut plan = run_planner(planner);
    plan.warnings.extend(rows.warnings());
    let names_formula = scenario.formula.is_some();
    // What is written down says what was run, whatever the default becomes later.
    scenario.formula.get_or_insert_with(|| plan.formula.clone());
    if let Some(folder) = &folder {
        let stage = scenario.stage(text.folder()).map_err(|e| text.placed(e))?;
        let again = scenario.relocated(text.folder(), own, folder.path())?.to_toml();
        let trajectory = Trajectory::of(&plan, Some(About::of(&plan, &again, &stage)));
        let recording = Recording { trajectory: &trajectory, stage: &stage };
        folder.write("trajectory.csv", |out| Csv.write(recording, out))?;
        folder.write("plan.json", |out| PlanJson.write(&plan, out))?;
        folder.write("scenario.toml", |out| out.write_all(again.as_bytes()))?;
        let figures = plan_figures(recording, Some(&plan));
        if arguments.figures {
            draw(&folder.path().join(FIGURES), arguments.force, "", &figures)?;
        }
        if !arguments.no_report {
            let page = PlanPage {
                title: &title(arguments),
                plan: &plan,
                recording,
                figures: &figures,
                scenario: &again,
                command: "kinstep plan scenario.toml",
                suggestions: &suggestions(&plan, table, &scenario),
            };
            folder.write(PAGE, |out| page.write(out))?;
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
        output.text(&format!(
            "{head}{chosen}{}{}",
            written(&PlanText, &plan),
            closing(arguments, &plan, table, &scenario)
        ))?;
    }
    Ok(exit(&plan))
}

/// The names of the files that are written.
fn names(arguments: &PlanArguments) -> Vec<&'static str> {
    let page = (!arguments.no_report).then_some(PAGE);
    NAMES.into_iter().chain(page).collect()
}

/// What the page is called.
fn title(arguments: &PlanArguments) -> String {
    let name = arguments.scenario.as_ref().and_then(|file| file.file_stem());
    name.map_or_else(|| "The built-in scenario".to_owned(), |name| name.to_string_lossy().into_owned())
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
            written = format!("\nWritten to {}: {}.\n", folder.display(), names(arguments).join(", "));
        }
        None => {
            next.push(Suggestion::new("--out results", "the trajectory as a file, and a page to look at"));
        }
    }
    next.extend(suggestions(plan, table, scenario));
    let line = |next: Suggestion| [format!("kinstep plan{name} {}", next.arguments), next.reason];
    let mut lines: Vec<[String; 2]> = next.into_iter().map(line).collect();
    if arguments.scenario.is_none() {
        lines.push(["kinstep schema scenario", "every key of a scenario of your own"].map(str::to_owned));
    }
    let width = lines.iter().map(|[command, _]| command.chars().count()).max().unwrap_or(0);
    let lines: Vec<String> =
        lines.iter().map(|[command, why]| format!("  {command:width$}  # {why}\n")).collect();
    if lines.is_empty() { written } else { format!("{written}\nNext:\n{}", lines.concat()) }
}
