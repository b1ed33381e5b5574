//! How an arm that starts off its path comes to it.

use serde::{Deserialize, Serialize};

use super::error::{ErrorKind, ScenarioError};
use super::key_path::KeyPath;
use super::model::{ArmSpec, Scenario};
use kinstep::inverse::{Search, Target};
use kinstep::planner::Arm;
use kinstep::robot::{Chain, ChainJoint};
use kinstep::task::Motion;

/// The task error [m, rad] within which an arm counts as on its path, unless the scenario says otherwise.
pub(super) const TOLERANCE: f64 = 1e-3;
/// A path that begins this near the tip [m or rad] needs no way to it.
const ON_PATH: f64 = 1e-6;
/// The share of the joints' limits that a way to the path uses.
const SHARE: f64 = 0.9;
/// The speed of joints of which no limit is known [rad/s or m/s].
const SPEED: f64 = 1.0;

/// How an arm that starts off its path comes to it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum Approach {
    /// The feedback brings the error in, while the path is already under way.
    Converge,
    /// A motion of the joints from rest to rest leads there before the path begins, within the joints' limits.
    Reach,
}

/// Where the joints of an arm begin, and how long they take to where its path does \[s\].
pub(super) struct Way {
    pub(super) q0: Vec<f64>,
    pub(super) duration: f64,
}

/// Joint positions at the beginning of the path near those given, and how long the way there takes.
pub(super) fn reach(
    at: &KeyPath,
    spec: &ArmSpec,
    (chain, held): (&Chain, &[(usize, f64)]),
    motion: &Motion,
    q0: &[f64],
) -> Result<Option<Way>, ScenarioError> {
    let beginning = motion.at(0.0);
    let tip = chain.forward(q0, &mut chain.scratch()).pose();
    if spec.task.whole().error(&tip, &beginning).norm() <= ON_PATH {
        return Ok(None);
    }
    let refuse = |problem: String| ScenarioError::at(ErrorKind::Scenario, &at.key("approach"), problem);
    let mut search = Search::new().near(q0);
    for &(joint, position) in held {
        search = search.holding(joint, position);
    }
    let target = Target::of_task(spec.task.whole(), &beginning);
    let solution = search.solve(chain, &target).map_err(|e| refuse(e.to_string()))?;
    if !solution.is_found() {
        return Err(refuse(format!(
            "no way to the path: within the joint limits its beginning is missed by {:.4} m and {:.4} rad",
            solution.position_error(),
            solution.orientation_error()
        )));
    }
    let pairs = chain.joints().iter().zip(q0.iter().zip(&solution.q));
    let duration = pairs.map(|(joint, (from, to))| duration(joint, (to - from).abs())).fold(0.0, f64::max);
    Ok(Some(Way { q0: solution.q.clone(), duration }))
}

/// How long a joint takes for a distance by a quintic from rest to rest: its velocity is at most 15/8 of the mean, its
/// acceleration `10/sqrt(3) d/T^2`, its jerk `60 d/T^3`.
fn duration(joint: &ChainJoint, distance: f64) -> f64 {
    let limits = &joint.limits;
    let is_known = [limits.velocity, limits.acceleration, limits.jerk].iter().any(|limit| limit.is_finite());
    let velocity = if is_known { SHARE * limits.velocity } else { SPEED };
    let [acceleration, jerk] = [limits.acceleration, limits.jerk].map(|limit| SHARE * limit);
    (15.0 / 8.0 * distance / velocity)
        .max((10.0 / 3.0_f64.sqrt() * distance / acceleration).sqrt())
        .max((60.0 * distance / jerk).cbrt())
}

impl Scenario {
    /// Has all arms begin their paths together, a whole number of steps after the longest of their ways there.
    pub(super) fn led_together(&self, arms: Vec<Arm>) -> Vec<Arm> {
        let longest = arms.iter().map(Arm::lead_duration).fold(0.0, f64::max);
        if longest == 0.0 {
            return arms;
        }
        let (sigma, duration) = (self.sigma.value(), self.duration.value());
        let exact = duration / sigma;
        let divides = (exact - exact.round()).abs() <= 1e-9 * exact;
        let sigma = if divides { sigma } else { duration / exact.ceil() };
        let lead = (longest / sigma).ceil() * sigma;
        arms.into_iter().map(|arm| arm.led_for(lead)).collect()
    }
}
