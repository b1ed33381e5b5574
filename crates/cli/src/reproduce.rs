//! `kinstep reproduce`: the experiments of T. Wang and D. Guo, IEEE Access 8 (2020), beside what the paper states.

use std::fmt::Write;
use std::path::Path;

use serde::Serialize;

use super::arguments::ReproduceArguments;
use super::failure::{Exit, Failure};
use super::folder::Folder;
use super::output::{Output, Show};
use super::progress::Progress;
use kinstep::formula::FormulaTable;
use kinstep::planner::Plan;
use kinstep_files::scenario::{Scenario, ScenarioText};
use kinstep_files::trajectory::{About, Csv, Recording, Trajectory, TrajectoryFormat};
use kinstep_report::figure::plan_figures;
use kinstep_report::{PlanPage, Table, paper_page, short, write_whole};

const EXAMPLE_A1: &str = include_str!("../../../examples/planar_dual.toml");
const EXAMPLE_A2: &str = include_str!("../../../examples/planar_dual_a2.toml");
const EXAMPLE_B: &str = include_str!("../../../examples/cooperative.toml");

const EULER: &str = "la2-euler";
const DTSMP: &str = "la6-wang-guo";
/// The feedback step of all of the paper's figures.
const H: f64 = 0.4;

/// What the paper says of the largest error of an arm.
#[derive(Clone, Copy)]
enum Stated {
    /// "less than".
    Below(f64),
    /// Only its order of magnitude.
    About(f64),
    Nothing,
}

/// One run, and what the paper says of its two arms.
struct Experiment {
    id: &'static str,
    text: &'static str,
    formula: &'static str,
    sigma: f64,
    h: f64,
    stated: [Stated; 2],
}

fn experiments() -> Vec<Experiment> {
    use Stated::{About, Below};
    let of = |id, text, formula, sigma, stated| Experiment { id, text, formula, sigma, h: H, stated };
    let mut all = vec![
        of("A.1", EXAMPLE_A1, EULER, 0.01, [Below(3e-4); 2]),
        of("A.1", EXAMPLE_A1, EULER, 0.001, [About(1e-6); 2]),
        of("A.1", EXAMPLE_A1, DTSMP, 0.01, [Below(4e-7); 2]),
        of("A.1", EXAMPLE_A1, DTSMP, 0.001, [About(1e-11); 2]),
        of("A.2", EXAMPLE_A2, DTSMP, 0.01, [Below(2.5e-7), Below(8e-7)]),
        of("A.2", EXAMPLE_A2, DTSMP, 0.001, [Stated::Nothing; 2]),
        of("B", EXAMPLE_B, DTSMP, 0.01, [Below(4e-7); 2]),
        of("B", EXAMPLE_B, DTSMP, 0.001, [About(1e-11); 2]),
    ];
    for sigma in GRID_SIGMA {
        all.extend(
            GRID_H.map(|h| Experiment { h, ..of(GRID, EXAMPLE_A2, DTSMP, sigma, [Stated::Nothing; 2]) }),
        );
    }
    all
}

/// The paper's Table 1, on the scenario of A.2.
const GRID: &str = "table-1";
const GRID_SIGMA: [f64; 3] = [0.01, 0.005, 0.001];
const GRID_H: [f64; 6] = [0.1, 0.2, 0.3, 0.4, 0.5, 0.6];

impl Experiment {
    fn scenario(&self) -> Result<Scenario, Failure> {
        let mut scenario = ScenarioText::parse(self.text)?.scenario()?;
        scenario.formula = Some(self.formula.to_owned());
        scenario.sigma = self.sigma.into();
        scenario.law.h = Some(self.h.into());
        Ok(scenario)
    }

    /// What its files are called before their extension; none are written of the grid.
    fn stem(&self) -> Option<String> {
        (self.id != GRID).then(|| format!("{}-{}-{}", self.id, self.formula, self.sigma))
    }

    /// Writes its trajectory and its page.
    fn write(&self, plan: &Plan, folder: &Folder, stem: &str, pages: bool) -> Result<(), Failure> {
        let scenario = self.scenario()?;
        let (text, stage) = (scenario.to_toml(), scenario.stage(None)?);
        let trajectory = Trajectory::of(plan, Some(About::of(plan, &text, &stage)));
        let recording = Recording { trajectory: &trajectory, stage: &stage };
        folder.write(&format!("{stem}.csv"), |out| Csv.write(recording, out))?;
        if pages {
            let page = PlanPage {
                title: &format!("Experiment {}: {}, sigma = {} s", self.id, self.formula, self.sigma),
                plan,
                recording,
                figures: &plan_figures(recording, Some(plan)),
                scenario: &text,
                command: "kinstep plan scenario.toml",
                suggestions: &[],
            };
            folder.write(&format!("{stem}.html"), |out| page.write(out))?;
        }
        Ok(())
    }

    fn outcome(&self, plan: &Plan) -> Outcome {
        let arms = plan.arms.iter().zip(self.stated).map(|(arm, stated)| {
            let (paper_bound, paper_order_of_magnitude) = match stated {
                Stated::Below(bound) => (Some(bound), None),
                Stated::About(size) => (None, Some(size)),
                Stated::Nothing => (None, None),
            };
            ArmOutcome {
                name: arm.name.clone(),
                max_error_component: arm.max_error_component,
                paper_bound,
                within_bound: paper_bound.map(|bound| plan.is_completed() && arm.max_error_component < bound),
                paper_order_of_magnitude,
            }
        });
        Outcome {
            id: self.id,
            formula: self.formula,
            sigma: plan.sigma,
            h: plan.h,
            status: plan.status.name(),
            arms: arms.collect(),
        }
    }
}

#[derive(Serialize)]
struct Reproduction {
    experiments: Vec<Outcome>,
    decades: Vec<Decade>,
}

#[derive(Serialize)]
struct Outcome {
    id: &'static str,
    formula: &'static str,
    sigma: f64,
    h: f64,
    status: &'static str,
    arms: Vec<ArmOutcome>,
}

#[derive(Serialize)]
struct ArmOutcome {
    name: String,
    max_error_component: f64,
    paper_bound: Option<f64>,
    within_bound: Option<bool>,
    paper_order_of_magnitude: Option<f64>,
}

/// By what factor the error fell when sigma fell tenfold at the same h.
#[derive(Serialize)]
struct Decade {
    id: &'static str,
    formula: &'static str,
    h: f64,
    arm: String,
    ratio: f64,
}

pub(super) fn run(arguments: &ReproduceArguments, output: &mut Output) -> Result<Exit, Failure> {
    if let Some(page) = &arguments.page {
        return write_page(page, arguments.written.force, output);
    }
    let experiments = experiments();
    let endings: &[&str] = if arguments.no_report { &["csv"] } else { &["csv", "html"] };
    let of_stem = |stem: String| endings.iter().map(move |ending| format!("{stem}.{ending}"));
    let mut names: Vec<String> = experiments.iter().filter_map(Experiment::stem).flat_map(of_stem).collect();
    names.push("reproduce.json".to_owned());
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let folder = arguments.written.folder(&names)?;
    let reproduction = run_all(&experiments, folder.as_ref(), !arguments.no_report)?;
    if let Some(folder) = &folder {
        folder.write("reproduce.json", |out| Ok(serde_json::to_writer_pretty(out, &reproduction)?))?;
    }
    output.show(&reproduction)?;
    Ok(if reproduction.is_within_bounds() { Exit::Done } else { Exit::CheckFailed })
}

fn write_page(page: &Path, force: bool, output: &mut Output) -> Result<Exit, Failure> {
    let text = paper_page()?;
    let file = page.display().to_string();
    write_whole(page, force, |out| out.write_all(text.as_bytes()))
        .map_err(|e| Failure::new(Exit::File, e.to_string()).in_file(&file))?;
    if output.wants_json() {
        output.json(&serde_json::json!({ "page": file }))?;
    } else {
        output.report(&format!("Written to {file}.\n"))?;
    }
    Ok(Exit::Done)
}

fn run_all(
    experiments: &[Experiment],
    folder: Option<&Folder>,
    pages: bool,
) -> Result<Reproduction, Failure> {
    let mut planners = Vec::new();
    for experiment in experiments {
        planners.push(experiment.scenario()?.planner(FormulaTable::builtin(), None)?);
    }
    let mut progress = Progress::new(planners.iter().map(kinstep::planner::Planner::steps).sum());
    let mut outcomes = Vec::new();
    for (experiment, planner) in experiments.iter().zip(planners) {
        let plan = planner.run_with(|done, _| progress.step(done));
        progress.next(plan.steps);
        if let (Some(folder), Some(stem)) = (folder, experiment.stem()) {
            experiment.write(&plan, folder, &stem, pages)?;
        }
        outcomes.push(experiment.outcome(&plan));
    }
    Ok(Reproduction { decades: decades(&outcomes), experiments: outcomes })
}

fn decades(outcomes: &[Outcome]) -> Vec<Decade> {
    let finer = |coarse: &Outcome| {
        let same = |fine: &&Outcome| {
            (fine.id, fine.formula, fine.h) == (coarse.id, coarse.formula, coarse.h)
                && (coarse.sigma / fine.sigma - 10.0).abs() < 1e-6
        };
        outcomes.iter().find(same)
    };
    let mut found = Vec::new();
    for coarse in outcomes {
        let Some(fine) = finer(coarse) else { continue };
        found.extend(coarse.arms.iter().zip(&fine.arms).map(|(coarse_arm, fine_arm)| Decade {
            id: coarse.id,
            formula: coarse.formula,
            h: coarse.h,
            arm: coarse_arm.name.clone(),
            ratio: coarse_arm.max_error_component / fine_arm.max_error_component,
        }));
    }
    found
}

impl Reproduction {
    fn is_within_bounds(&self) -> bool {
        let completed = self.experiments.iter().all(|outcome| outcome.status == "completed");
        completed
            && self
                .experiments
                .iter()
                .flat_map(|outcome| &outcome.arms)
                .all(|arm| arm.within_bound != Some(false))
    }

    fn experiments_table(&self) -> Table {
        let mut table =
            Table::new(["experiment", "formula", "sigma [s]", "arm", "max |component| [m]", "the paper", ""]);
        for outcome in self.experiments.iter().filter(|outcome| outcome.id != GRID) {
            for arm in &outcome.arms {
                let stated = match (arm.paper_bound, arm.paper_order_of_magnitude) {
                    (Some(bound), _) => format!("< {bound:.1e}"),
                    (None, Some(size)) => format!("~ {size:.0e}"),
                    (None, None) => String::new(),
                };
                let verdict = match arm.within_bound {
                    Some(true) => "kept",
                    Some(false) => "MISSED",
                    None if outcome.status == "completed" => "",
                    None => outcome.status,
                };
                let error = format!("{:.3e}", arm.max_error_component);
                let cells =
                    [outcome.id, outcome.formula, &short(outcome.sigma), &arm.name, &error, &stated, verdict];
                table.row(cells.map(str::to_owned));
            }
        }
        table
    }

    /// Table 1: a row per sigma and arm, a column per h.
    fn grid_table(&self) -> Table {
        let heading =
            ["sigma [s]", "arm"].map(str::to_owned).into_iter().chain(GRID_H.map(|h| format!("h = {h}")));
        let mut table = Table::new(heading);
        let cells: Vec<&Outcome> = self.experiments.iter().filter(|outcome| outcome.id == GRID).collect();
        for row in cells.chunks(GRID_H.len()) {
            let Some(first) = row.first() else { continue };
            for (index, arm) in first.arms.iter().enumerate() {
                let errors = row.iter().filter_map(|outcome| outcome.arms.get(index));
                let errors = errors.map(|arm| format!("{:.2e}", arm.max_error_component));
                table.row([short(first.sigma), arm.name.clone()].into_iter().chain(errors));
            }
        }
        table
    }
}

impl Show for Reproduction {
    fn text(&self) -> String {
        let mut text = format!(
            "T. Wang, D. Guo, IEEE Access 8 (2020), at h = {H}; largest error component of each arm.\n\n{}\n\
             Tenfold smaller sigma makes the error smaller by:\n",
            self.experiments_table()
        );
        for decade in self.decades.iter().filter(|decade| decade.id != GRID) {
            let Decade { id, formula, arm, ratio, .. } = decade;
            // Writing to a String can not fail.
            let _ = writeln!(text, "  {id} {formula}, {arm}: {ratio:.0} (10^{:.2})", ratio.log10());
        }
        let _ = writeln!(text, "\nTable 1, the scenario of A.2 with {DTSMP}:\n\n{}", self.grid_table());
        let verdict = if self.is_within_bounds() {
            "Every bound of the paper is kept."
        } else {
            "A bound of the paper is MISSED."
        };
        let _ = writeln!(text, "{verdict}");
        text
    }
}
