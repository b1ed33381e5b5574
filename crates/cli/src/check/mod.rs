//! `kinstep check`: a trajectory of whatever planner, held against a robot, itself and the path it should follow.

mod against;
mod sentences;
mod verdict;

use super::arguments::CheckArguments;
use super::failure::{Exit, Failure};
use super::output::Output;
use super::stopped::Stopped;
use against::Against;

pub(super) fn run(arguments: &CheckArguments, output: &mut Output) -> Result<Exit, Failure> {
    if !(arguments.max_error > 0.0) {
        let got = arguments.max_error;
        return Err(Failure::usage(format!("--max-error: expected a length above 0, got {got}")));
    }
    let stopped = Stopped::check(&arguments.trajectory)?;
    let mut checked = Against::of(arguments, output)?.checked(arguments.max_error);
    if let Some(stopped) = stopped {
        checked.ok = false;
        checked.failures.insert(0, stopped.sentence);
    }
    output.remarks(&checked.notes, &checked.warnings);
    output.show(&checked)?;
    Ok(if checked.ok { Exit::Done } else { Exit::CheckFailed })
}
