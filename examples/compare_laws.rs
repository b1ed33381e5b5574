//! Every law with every null-space criterion on one scenario, as the table of docs/laws.md.
//!
//! `cargo run --example compare_laws` takes examples/laws.toml, `-- FILE` another one.

#![allow(clippy::print_stdout)]

use std::error::Error;
use std::time::Instant;

use kinstep::formula::FormulaTable;
use kinstep::kind::{Parameters, Value};
use kinstep::law::{CRITERIA, CriterionKind, LAWS, LawKind};
use kinstep::planner::{Plan, PlanStatus};
use kinstep_files::scenario::{CriterionSpec, Scenario, ScenarioText};

/// How often a run is repeated for its time.
const RUNS: usize = 5;
/// The rate of the criteria [1/s].
const RATE: f64 = 2.0;

fn main() -> Result<(), Box<dyn Error>> {
    let text = match std::env::args().nth(1) {
        Some(file) => std::fs::read_to_string(file)?,
        None => include_str!("laws.toml").to_owned(),
    };
    let scenario = ScenarioText::parse(&text)?.scenario()?;
    println!("| law | criterion | largest error | drift | limits crossed | least distance | µs a step |");
    println!("|---|---|--:|--:|--:|--:|--:|");
    for law in LAWS {
        for given in variants(law, &scenario) {
            for criterion in [None].into_iter().chain(CRITERIA.iter().map(Some)) {
                println!("{}", row(&scenario, law, &given, criterion)?);
            }
        }
    }
    Ok(())
}

/// The parameters with which a law is shown.
fn variants(law: &LawKind, scenario: &Scenario) -> Vec<Parameters> {
    let plain = Parameters::new;
    match law.name {
        "damped" => vec![
            plain(),
            plain().with("method", "constant").with("damping", 0.01),
            plain().with("method", "selective"),
        ],
        "weighted" => {
            let heavy = scenario.law.acceleration_limit.iter().flat_map(|limit| match limit {
                Value::Table(joints) => joints.iter().map(|(joint, _)| joint.clone()).collect(),
                _ => Vec::new(),
            });
            let weights = heavy.map(|joint| (joint, Value::from(4.0))).collect();
            vec![plain().with("weights", Value::Table(weights))]
        }
        "qp" => vec![plain(), plain().with("tasks", "least-squares")],
        _ => vec![plain()],
    }
}

fn row(
    scenario: &Scenario,
    law: &LawKind,
    given: &Parameters,
    criterion: Option<&CriterionKind>,
) -> Result<String, Box<dyn Error>> {
    let mut scenario = scenario.clone();
    law.name.clone_into(&mut scenario.law.kind);
    scenario.law.parameters = given.clone();
    let pull = |kind: &CriterionKind| CriterionSpec {
        kind: kind.name.to_owned(),
        parameters: Parameters::new().with("rate", RATE),
    };
    scenario.law.criterion = criterion.map(pull).into_iter().collect();
    let (mut fastest, mut plan) = (f64::INFINITY, None);
    for _ in 0..RUNS {
        let planner = scenario.planner(FormulaTable::builtin(), None)?;
        let begin = Instant::now();
        let run = planner.run();
        fastest = fastest.min(begin.elapsed().as_secs_f64() / run.samples().max(1) as f64);
        plan = Some(run);
    }
    let words = given.iter().filter_map(|(_, value)| match value {
        Value::Text(word) => Some(word.as_str()),
        _ => None,
    });
    let name = [law.name].into_iter().chain(words).collect::<Vec<_>>().join(", ");
    let plan = plan.ok_or("nothing was run")?;
    Ok(format!(
        "| {name} | {} | {} | {:.1} |",
        criterion.map_or("-", |kind| kind.name),
        outcome(&plan),
        fastest * 1e6
    ))
}

/// The largest error and drift of all arms, how many limits they crossed and how near they came to something [m], or when the run
/// stopped.
fn outcome(plan: &Plan) -> String {
    if plan.status != PlanStatus::Completed {
        return format!("stopped at {:.2} s: {} | | | ", plan.time(plan.samples()), plan.status.name());
    }
    let most = |of: fn(&kinstep::planner::ArmPlan) -> f64| plan.arms.iter().map(of).fold(0.0, f64::max);
    let crossed: usize = plan.arms.iter().map(|arm| arm.violations.len()).sum();
    let distance =
        plan.distance.as_ref().map_or_else(|| "-".to_owned(), |near| format!("{:.3}", near.minimum));
    format!(
        "{:.1e} | {:.1e} | {crossed} | {distance}",
        most(|arm| arm.max_error),
        most(kinstep::planner::ArmPlan::drift)
    )
}
