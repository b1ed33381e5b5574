//! `kinstep plan`: a scenario run, its trajectories written, and what to try next.

use std::path::Path;

use super::arguments::PlanArguments;
use super::failure::{Exit, Failure};
use super::folder::Folder;
use super::output::Output;
use super::progress::Progress;
use crate::formula::FormulaTable;
use crate::planner::{Plan, PlanStatus, Planner};
use crate::report::{PlanCsv, PlanFormat, PlanJson, PlanText};
use crate::scenario::{Scenario, ScenarioText, with_formulas};

/// The scenario that runs without a file.
const BUILTIN: &str = include_str!("../../examples/dual_panda.toml");

/// The files of `--out`.
const NAMES: [&str; 3] = ["trajectory.csv", "plan.json", "scenario.toml"];

pub(super) fn run(
    arguments: &PlanArguments,
    own: Option<&Path>,
    output: &mut Output,
) -> Result<Exit, Failure> {
    let text = scenario_text(arguments)?;
    let scenario = text.scenario()?;
    let table = formula_table(&text, &scenario, own)?;
    let planner = scenario.planner(&table, text.folder()).map_err(|e| text.placed(e))?;
    let folder =
        arguments.out.as_deref().map(|path| Folder::open(path, arguments.force, &NAMES)).transpose()?;
    let plan = run_planner(planner);
    if let Some(folder) = &folder {
        folder.write("trajectory.csv", |out| PlanCsv.write(&plan, out))?;
        folder.write("plan.json", |out| PlanJson.write(&plan, out))?;
        folder.write("scenario.toml", |out| out.write_all(scenario.to_toml().as_bytes()))?;
    }
    if output.wants_json() {
        output.text(&written(&PlanJson, &plan))?;
    } else {
        let head = if arguments.scenario.is_none() {
            "The built-in scenario: two Panda arms, full poses.\n"
        } else {
            ""
        };
        output.text(&format!("{head}{}{}", written(&PlanText, &plan), closing(arguments, &plan, &table)))?;
    }
    Ok(exit(&plan))
}

fn scenario_text(arguments: &PlanArguments) -> Result<ScenarioText, Failure> {
    let mut text = match &arguments.scenario {
        Some(file) => ScenarioText::read(file)?,
        None => ScenarioText::parse(BUILTIN)?,
    };
    arguments.set.iter().try_for_each(|assignment| text.set(assignment))?;
    Ok(text)
}

fn formula_table(
    text: &ScenarioText,
    scenario: &Scenario,
    own: Option<&Path>,
) -> Result<FormulaTable, Failure> {
    let table = scenario.formula_table(text.folder()).map_err(|e| text.placed(e))?;
    match own {
        Some(file) => Ok(with_formulas(&table, file)?),
        None => Ok(table),
    }
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
fn closing(arguments: &PlanArguments, plan: &Plan, table: &FormulaTable) -> String {
    let name = arguments.scenario.as_ref().map_or_else(String::new, |file| format!(" {}", file.display()));
    let mut next: Vec<(String, String)> = Vec::new();
    let mut try_next = |command: &str, why: String| next.push((format!("kinstep {command}"), why));
    let mut written = String::new();
    match &arguments.out {
        Some(folder) => {
            written = format!("\nWritten to {}: {}.\n", folder.display(), NAMES.join(", "));
        }
        None => try_next(&format!("plan{name} --out results"), "the trajectory as a file".to_owned()),
    }
    if let Some(formula) = table.get(&plan.formula).ok().filter(|_| plan.is_completed()) {
        let fold = 1_u64 << (formula.order() + 1).min(60);
        let why = format!("errors about {fold} times smaller: order {}", formula.order());
        try_next(&format!("plan{name} --set sigma={}", plan.sigma / 2.0), why);
    }
    if plan.formula != "split-ab6" {
        let why = "a deadbeat loop of order 6".to_owned();
        try_next(&format!("plan{name} --set formula=split-ab6 --set law.h=1"), why);
    }
    if arguments.scenario.is_none() {
        try_next("schema scenario", "every key of a scenario of your own".to_owned());
    }
    let width = next.iter().map(|(command, _)| command.chars().count()).max().unwrap_or(0);
    let lines: Vec<String> =
        next.iter().map(|(command, why)| format!("  {command:width$}  # {why}\n")).collect();
    format!("{written}\nNext:\n{}", lines.concat())
}
