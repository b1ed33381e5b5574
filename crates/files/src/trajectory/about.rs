//! What made a trajectory.

use sha2::{Digest, Sha256};
use std::fmt::Write;

use super::Stage;
use kinstep::planner::Plan;

/// What made a trajectory: enough to make it again, and to tell whether it is the same.
#[derive(Clone, Debug, PartialEq)]
pub struct About {
    /// Version of kinstep.
    pub version: String,
    /// Id of the formula.
    pub formula: String,
    /// Sampling gap \[s\].
    pub sigma: f64,
    /// Feedback step.
    pub h: f64,
    /// Name of the starter.
    pub start: String,
    /// SHA-256 of the scenario as it was run, in hexadecimal digits.
    pub scenario: String,
    /// Each arm's name with the SHA-256 of its robot, as URDF, in hexadecimal digits.
    pub robots: Vec<(String, String)>,
}

impl About {
    /// Returns what there is to say of a plan by a formula, with a sampling gap \[s\] and a feedback step, of the scenario
    /// with this text, on that stage.
    pub fn new(formula: &str, [sigma, h]: [f64; 2], start: &str, scenario: &str, stage: &Stage) -> Self {
        Self {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            formula: formula.to_owned(),
            sigma,
            h,
            start: start.to_owned(),
            scenario: fingerprint(scenario),
            robots: stage
                .arms
                .iter()
                .map(|arm| (arm.name.clone(), stage.machines[arm.machine].fingerprint()))
                .collect(),
        }
    }

    /// Returns what there is to say of a plan of the scenario with this text, on that stage.
    pub fn of(plan: &Plan, scenario: &str, stage: &Stage) -> Self {
        Self::new(&plan.formula, [plan.sigma, plan.h], plan.start, scenario, stage)
    }

    /// The entries as text, for formats that carry keys and values; numbers read back as they were.
    pub fn entries(&self) -> Vec<(String, String)> {
        let plain = [
            ("version", self.version.clone()),
            ("formula", self.formula.clone()),
            ("sigma", self.sigma.to_string()),
            ("h", self.h.to_string()),
            ("start", self.start.clone()),
            ("scenario_sha256", self.scenario.clone()),
        ];
        let plain = plain.into_iter().map(|(key, value)| (format!("kinstep.{key}"), value));
        let robot = |(arm, hash): &(String, String)| (format!("kinstep.robot_sha256.{arm}"), hash.clone());
        plain.chain(self.robots.iter().map(robot)).collect()
    }

    /// Returns what such entries say, in whatever order they come; nothing where one is missing.
    pub fn from_entries<'e>(entries: impl IntoIterator<Item = (&'e str, &'e str)>) -> Option<Self> {
        let known: Vec<(&str, &str)> = entries
            .into_iter()
            .filter_map(|(key, value)| Some((key.strip_prefix("kinstep.")?, value)))
            .collect();
        let text = |wanted: &str| Some(known.iter().find(|(key, _)| *key == wanted)?.1.to_owned());
        let number = |wanted: &str| text(wanted)?.parse().ok();
        let robot = |(key, hash): &(&str, &str)| {
            Some((key.strip_prefix("robot_sha256.")?.to_owned(), (*hash).to_owned()))
        };
        Some(Self {
            version: text("version")?,
            formula: text("formula")?,
            sigma: number("sigma")?,
            h: number("h")?,
            start: text("start")?,
            scenario: text("scenario_sha256")?,
            robots: known.iter().filter_map(robot).collect(),
        })
    }
}

/// Returns the SHA-256 of a text in hexadecimal digits.
pub(super) fn fingerprint(text: &str) -> String {
    Sha256::digest(text.as_bytes()).iter().fold(String::new(), |mut digits, byte| {
        // Writing to a String can not fail.
        let _ = write!(digits, "{byte:02x}");
        digits
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fingerprint_is_the_standard_hash() {
        // FIPS 180-4, the example of one block.
        assert_eq!(fingerprint("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    }
}
