//! The noise that a plan suffers.

use serde::{Deserialize, Serialize};

use super::error::{ErrorKind, ScenarioError};
use super::key_path::KeyPath;
use kinstep::kind::Real;
use kinstep::planner::Noise;

/// The largest seed: from here on not every whole number is a double.
const LARGEST_SEED: f64 = 9_007_199_254_740_992.0;

/// White noise in what the loop measures and in what it is told, drawn anew at every sample. Every number but the seed is
/// the standard deviation of one component. Default: none.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, expecting = "a table such as { position = 1e-4, seed = 1 }")]
pub struct NoiseSpec {
    /// What the draws depend on, a whole number. Default: 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub seed: Option<Real>,
    /// Of the measured position error in m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub position: Option<Real>,
    /// Of the measured orientation error in rad.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub orientation: Option<Real>,
    /// Of the linear velocity of the reference, as it is streamed to the loop, in m/s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub linear_velocity: Option<Real>,
    /// Of the angular velocity of the reference in rad/s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub angular_velocity: Option<Real>,
    /// Of the measured joint positions, of which the formula makes the next ones, in rad or m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub joints: Option<Real>,
}

impl NoiseSpec {
    /// The noise as the planner takes it.
    pub fn noise(&self) -> Noise {
        let value = |number: &Option<Real>| number.as_ref().map_or(0.0, Real::value);
        Noise {
            seed: self.seed.as_ref().map_or(1.0, Real::value) as u64,
            position: value(&self.position),
            orientation: value(&self.orientation),
            linear_velocity: value(&self.linear_velocity),
            angular_velocity: value(&self.angular_velocity),
            joints: value(&self.joints),
        }
    }

    pub(super) fn check(&self) -> Result<(), ScenarioError> {
        let at = KeyPath::dotted("noise");
        let refuse =
            |key: &str, problem: String| Err(ScenarioError::at(ErrorKind::Scenario, &at.key(key), problem));
        if let Some(seed) = &self.seed {
            let number = seed.value();
            if !((0.0..=LARGEST_SEED).contains(&number) && number.fract() == 0.0) {
                return refuse("seed", format!("{seed} is not a seed; give a whole number such as 1"));
            }
        }
        let given = [
            ("position", "m", &self.position),
            ("orientation", "rad", &self.orientation),
            ("linear_velocity", "m/s", &self.linear_velocity),
            ("angular_velocity", "rad/s", &self.angular_velocity),
            ("joints", "rad or m", &self.joints),
        ];
        for (key, unit, number) in given {
            let Some(number) = number else { continue };
            if !(number.value() >= 0.0 && number.value().is_finite()) {
                let problem = format!("{number} {unit} is not a standard deviation; it is positive or zero");
                return refuse(key, problem);
            }
        }
        Ok(())
    }
}
