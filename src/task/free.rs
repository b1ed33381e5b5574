use super::{Task, TaskInstant, TaskRows};

/// No task of an arm's own: it is left to the tasks that it has together with others.
#[derive(Clone, Copy, Debug)]
pub struct Free;

impl Task for Free {
    fn name(&self) -> &'static str {
        "none"
    }

    fn rows(&self) -> usize {
        0
    }

    fn evaluate(&self, _at: &TaskInstant<'_>, _out: &mut TaskRows) {}
}
