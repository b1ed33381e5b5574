//! Saved runs that stopped early: what `plan.json` beside a trajectory says of it.

use std::path::Path;

use serde_json::Value;

use super::failure::{Exit, Failure};
use super::output::moment;

/// A run that stopped before its end.
pub(super) struct Stopped {
    /// When, and why, as a sentence.
    pub(super) sentence: String,
    /// How many samples there are of it.
    samples: u64,
}

impl Stopped {
    /// Returns what the summary in a folder of results, or beside its trajectory, says; nothing where there is none, or where
    /// the run came to its end.
    pub(super) fn of(saved: &Path) -> Option<Self> {
        let is_trajectory = saved.file_name().is_some_and(|name| name == "trajectory.csv");
        let folder = if saved.is_dir() { saved } else { saved.parent().filter(|_| is_trajectory)? };
        let text = std::fs::read_to_string(folder.join("plan.json")).ok()?;
        let document: Value = serde_json::from_str(&text).ok()?;
        let (status, reason) = (document["status"].as_str()?, document["reason"].as_str()?);
        let (samples, sigma) = (document["samples"].as_u64()?, document["sigma"].as_f64()?);
        let last = moment(samples.saturating_sub(1) as f64 * sigma);
        let sentence = format!("the run stopped after t = {last} s, {status}: {reason}");
        Some(Self { sentence, samples })
    }

    /// Refuses what takes two samples of a run that stopped at its first.
    pub(super) fn check(saved: &Path) -> Result<Option<Self>, Failure> {
        match Self::of(saved) {
            Some(stopped) if stopped.samples < 2 => {
                let message = format!("{}; it has no second sample", stopped.sentence);
                Err(Failure::new(Exit::Stopped, message).in_file(&saved.display().to_string()))
            }
            stopped => Ok(stopped),
        }
    }
}
