//! How far a longer run has come, on standard error of a terminal.

use std::io::{self, IsTerminal};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

/// A run shorter than this shows no bar.
const PATIENCE: Duration = Duration::from_secs(1);
/// The clock is looked at once in so many steps.
const STRIDE: usize = 256;

/// A bar that appears when a run takes longer than a second.
pub(super) struct Progress {
    started: Instant,
    total: usize,
    done_before: usize,
    bar: Option<ProgressBar>,
    shows: bool,
    things: &'static str,
}

impl Progress {
    /// Returns the progress of `total` steps in all.
    pub(super) fn new(total: usize) -> Self {
        Self::of(total, "steps")
    }

    /// Returns the progress of `total` things in all.
    pub(super) fn of(total: usize, things: &'static str) -> Self {
        let shows = io::stderr().is_terminal();
        Self { started: Instant::now(), total, done_before: 0, bar: None, shows, things }
    }

    /// Says that the present run has done `done` of its steps.
    pub(super) fn step(&mut self, done: usize) {
        if !self.shows || !done.is_multiple_of(STRIDE) || self.started.elapsed() < PATIENCE {
            return;
        }
        let (total, started, things) = (self.total as u64, self.started, self.things);
        let bar = self.bar.get_or_insert_with(|| bar(total, started, things));
        bar.set_position((self.done_before + done) as u64);
    }

    /// Says that a run of `steps` steps is over and the next begins.
    pub(super) fn next(&mut self, steps: usize) {
        self.done_before += steps;
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

fn bar(total: u64, started: Instant, things: &str) -> ProgressBar {
    let style = ProgressStyle::with_template(&format!("{{wide_bar}} {{pos}}/{{len}} {things}, {{eta}} left"))
        .unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::with_draw_target(Some(total), ProgressDrawTarget::stderr())
        .with_style(style)
        .with_elapsed(started.elapsed())
}
