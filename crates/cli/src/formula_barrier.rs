//! `kinstep formula barrier`: which orders look-ahead formulas can have.

use serde::Serialize;

use super::arguments::FormulaBarrier;
use super::failure::{Exit, Failure};
use super::output::{Output, Show};
use kinstep::formula::Coefficients;
use kinstep::formula::derive::{Barrier, BarrierProof, barrier};
use kinstep_report::Table;

pub(super) fn run(arguments: &FormulaBarrier, output: &mut Output) -> Result<Exit, Failure> {
    let most = usize::try_from(arguments.steps).unwrap_or(usize::MAX);
    let lines = (1..=most).map_while(barrier).map(|found| Line::new(&found)).collect();
    output.show(&Lines { barrier: lines })?;
    Ok(Exit::Done)
}

#[derive(Serialize)]
struct Lines {
    barrier: Vec<Line>,
}

#[derive(Serialize)]
struct Line {
    steps: usize,
    /// The highest order with only z = 1 on the unit circle.
    order: usize,
    /// Which coefficient of R(zeta) forbids the next order, if one does.
    index: Option<usize>,
    /// Its value, which is not positive.
    value: Option<String>,
    /// Why there is no formula of the next order.
    reason: String,
    /// A formula of that order: numerators, newest sample first, and their denominator.
    difference: Vec<String>,
    denominator: Option<String>,
}

impl Line {
    fn new(found: &Barrier) -> Self {
        let (index, value) = match &found.beyond {
            BarrierProof::Sign { index, value } => (Some(*index), Some(value.to_string())),
            _ => (None, None),
        };
        let reason = match &found.beyond {
            BarrierProof::Sign { index, value } => format!("r_{index} = {value}"),
            BarrierProof::TooFewSteps => "too few steps".to_owned(),
            BarrierProof::Witness(_) | BarrierProof::Open => "not decided".to_owned(),
        };
        let (difference, denominator) = match found.witness.coefficients() {
            Coefficients::Difference { numerators, denominator } => {
                (numerators.iter().map(ToString::to_string).collect(), Some(denominator.to_string()))
            }
            Coefficients::General { .. } => (Vec::new(), None),
        };
        Self { steps: found.steps, order: found.order, index, value, reason, difference, denominator }
    }
}

impl Show for Lines {
    fn text(&self) -> String {
        let mut table = Table::new(["steps", "order", "forbids the next"]);
        for line in &self.barrier {
            table.row([line.steps.to_string(), line.order.to_string(), line.reason.clone()]);
        }
        format!(
            "Highest order of look-ahead formulas with only z = 1 on the unit circle, and the coefficient of R(zeta),\n\
             zeta = (z - 1)/(z + 1), that the next order fixes although it must be positive:\n\n{table}\n\
             --json has a formula of each order.\n"
        )
    }
}
