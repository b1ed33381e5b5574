//! The page about the paper: its text, and the orders as they are measured when the page is made.

use std::fmt::Write;

use kinstep_files::scenario::{FormulaRows, ScenarioError, ScenarioText};
use kinstep_study::{Convergence, RowStudy, ScenarioStudy};

const BEFORE: &str = include_str!("paper_before.md");
const AFTER: &str = include_str!("paper_after.md");
const PLANAR: &str = include_str!("../../../examples/planar_dual.toml");
/// A circle that accelerates at once, full pose, seven joints.
const SPATIAL: &str = r#"
sigma = 0.01
duration = 4.0
formula = "la6-wang-guo"
law = { h = 0.4 }
[study]
steps = [100, 200, 400, 800, 1600, 3200, 6400, 12800]
[[arm]]
name = "arm"
robot = "iiwa14"
base = "iiwa_link_0"
tip = "iiwa_link_ee"
task = "pose"
q0 = [0.2, 0.6, -0.1, -1.4, 0.1, 1.0, 0.3]
path = { kind = "circle", radius = 0.05, plane = "yz" }
"#;

/// One line of the table: what is run, and what the paper or the theory says of it.
struct Claim {
    text: &'static str,
    scenario: &'static str,
    set: &'static [&'static str],
    says: &'static str,
}

const CLAIMS: [Claim; 7] = [
    Claim {
        text: "A.1, the paper's scheme, fixed h = 0.4, Euler start at a cusp",
        scenario: PLANAR,
        set: &["study.steps=[250, 500, 1000, 2000, 4000, 8000]"],
        says: "the paper: 4",
    },
    Claim {
        text: "the same with the gain fixed at k = 20 1/s",
        scenario: PLANAR,
        set: &["law.gain=20", "study.steps=[1000, 2000, 4000, 8000, 16000]"],
        says: "3, as h shrinks with sigma",
    },
    Claim {
        text: "A.1, Euler's formula, eq. (13), fixed h = 0.4",
        scenario: PLANAR,
        set: &["formula=la2-euler", "study.steps=[250, 500, 1000, 2000, 4000, 8000]"],
        says: "the paper: 2",
    },
    Claim {
        text: "a circle that accelerates at once, Euler start",
        scenario: SPATIAL,
        set: &["start=paper"],
        says: "whole run 2, steady 4, joints 2",
    },
    Claim {
        text: "the same circle, Runge-Kutta start of order 4",
        scenario: SPATIAL,
        set: &["start=rk4"],
        says: "4, joints 3",
    },
    Claim {
        text: "the same circle, split row of order 4, h = 1",
        scenario: SPATIAL,
        set: &["formula=split-ab4", "law.h=1", "study.steps=[100, 150, 200, 300, 400, 600, 800, 1200, 1600]"],
        says: "not in the paper: 5",
    },
    Claim {
        text: "the same circle, split row of order 6, h = 1",
        scenario: SPATIAL,
        set: &["formula=split-ab6", "law.h=1", "study.steps=[60, 80, 120, 160, 240, 320, 400]"],
        says: "not in the paper: 7",
    },
];

/// Returns the page, with every order measured anew.
///
/// # Errors
/// [`ScenarioError`] where a scenario of the page is refused, which its test rules out.
pub fn paper_page() -> Result<String, ScenarioError> {
    let mut text = BEFORE.to_owned();
    text.push_str(
        "| what is run | expected | whole run | steady | joints | error at each sigma, coarse to fine |\n|---|---|---|---|---|---|\n",
    );
    for claim in &CLAIMS {
        let row = claim.row()?;
        let report = &row.report;
        let errors: Vec<String> = row.seen.errors.iter().map(|error| format!("{error:.1e}")).collect();
        // Writing to a String can not fail.
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} | {} | {} |",
            claim.text,
            claim.says,
            order(report.task_transient.as_ref()),
            order(report.task_steady.as_ref()),
            order(report.joint.as_ref()),
            errors.join(", ")
        );
    }
    text.push_str(AFTER);
    Ok(text)
}

/// The slope of the finest pair, or a dash where a study does not decide.
fn order(part: Option<&Convergence>) -> String {
    part.and_then(Convergence::order).map_or_else(|| "-".to_owned(), |order| format!("{order:.2}"))
}

impl Claim {
    fn row(&self) -> Result<RowStudy, ScenarioError> {
        let mut text = ScenarioText::parse(self.scenario)?;
        self.set.iter().try_for_each(|assignment| text.set(assignment))?;
        let study = ScenarioStudy::new(&text.scenario()?, None, &FormulaRows::default(), &[])?;
        Ok(study.run()?.remove(0))
    }
}
