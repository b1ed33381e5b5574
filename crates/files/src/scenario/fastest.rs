//! The least duration in which a scenario's motion keeps the limits of its joints' motion.

use std::path::Path;

use super::error::{ErrorKind, ScenarioError};
use super::key_path::KeyPath;
use super::kinds::Kinds;
use super::model::Scenario;
use kinstep::formula::FormulaTable;
use kinstep::planner::{LimitKind, Plan, Planner};

/// After so many runs the best of them has to do.
const MOST_RUNS: usize = 24;
/// Fewer steps than this do not show what a motion does.
const FEWEST_STEPS: usize = 16;
/// By so little of the duration the search may miss the least one.
const TOLERANCE: f64 = 1e-3;

/// What a search for the least duration found.
#[derive(Clone, Debug)]
pub struct Fastest {
    /// The scenario with that duration.
    pub scenario: Scenario,
    /// Its plan.
    pub plan: Plan,
    /// How many plans were made.
    pub runs: usize,
}

impl Scenario {
    /// Returns the scenario with the least duration, a whole number of its sampling gaps, in which its motion keeps the
    /// joints' limits of velocity, acceleration and jerk; `run` runs a planner to its end. Limits of positions do not depend
    /// on the duration.
    ///
    /// Each plan tells by its own scaling ([`Plan::feasible_duration`]) which duration comes next, between the longest that was too
    /// short and the shortest that was long enough. Where plans stop early at any duration, the last of them is returned.
    ///
    /// # Errors
    /// As [`Scenario::planner`], and where no joint has such a limit.
    pub fn fastest(
        &self,
        kinds: &Kinds,
        table: &FormulaTable,
        folder: Option<&Path>,
        mut run: impl FnMut(Planner) -> Plan,
    ) -> Result<Fastest, ScenarioError> {
        let sigma = self.sigma.value();
        // A duration that is refused is refused as ever.
        let mut steps = (self.duration.value() / sigma).ceil().max(1.0) as usize;
        let (mut too_short, mut best): (usize, Option<(usize, Fastest)>) = (0, None);
        let mut runs = 0;
        loop {
            let mut scenario = self.clone();
            scenario.duration = (steps as f64 * sigma).into();
            let plan = run(scenario.planner_with(kinds, table, folder)?);
            runs += 1;
            let scale = plan.feasible_duration().map(|duration| duration / plan.duration());
            let is_kept = plan.is_completed() && keeps_motion_limits(&plan);
            let next = match scale {
                None if plan.is_completed() => return Err(without_limits()),
                Some(scale) => (steps as f64 * scale).ceil() as usize,
                None => 2 * steps,
            };
            let found = Fastest { scenario, plan, runs };
            if is_kept {
                best = Some((steps, found));
            } else {
                too_short = too_short.max(steps);
                if best.is_none() && runs == MOST_RUNS / 4 && scale.is_none() {
                    return Ok(found);
                }
            }
            let longest = best.as_ref().map_or(usize::MAX, |(steps, _)| *steps);
            let next = next.clamp((too_short + 1).max(FEWEST_STEPS), longest);
            let gap = longest.saturating_sub(too_short + 1) as f64;
            let is_done = next == longest || gap < TOLERANCE * longest as f64 || runs >= MOST_RUNS;
            match best {
                Some((_, best)) if is_done => return Ok(Fastest { runs, ..best }),
                _ if runs >= MOST_RUNS => return Err(without_end(steps as f64 * sigma)),
                _ => steps = next,
            }
        }
    }
}

/// Whether the limits that depend on the duration are kept.
fn keeps_motion_limits(plan: &Plan) -> bool {
    let mut violations = plan.arms.iter().flat_map(|arm| &arm.violations);
    violations.all(|violation| violation.kind == LimitKind::Position)
}

fn without_limits() -> ScenarioError {
    let problem = "no joint has a limit of velocity, acceleration or jerk: there is no least duration; `limits` of an arm names a file of limits";
    ScenarioError::at(ErrorKind::Scenario, &KeyPath::dotted("duration"), problem)
}

fn without_end(duration: f64) -> ScenarioError {
    let problem = format!(
        "limits of velocity, acceleration or jerk are crossed at {duration} s too; noise, feedback or the way to a path can be faster than any motion"
    );
    ScenarioError::at(ErrorKind::Scenario, &KeyPath::dotted("duration"), problem)
}
