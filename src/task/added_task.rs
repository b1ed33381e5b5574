use super::Task;
use crate::kind::{Kind, Parameters};
use nalgebra::IsometryMatrix3;

/// A task beside those of the arms that files can name.
pub type AddedTaskKind = Kind<MakeTask>;

/// A task, or why there is none, as the end of a sentence that begins with the task's key.
pub type MadeTask = Result<Box<dyn Task>, String>;

/// How a task over the tips of arms is made of its parameters.
#[derive(Clone, Copy, Debug)]
pub struct MakeTask {
    /// How many tips it is about.
    pub tips: usize,
    /// Makes it, or says why it can not be.
    pub make: fn(&Parameters, &TaskStart<'_>) -> MadeTask,
}

/// What a task begins with.
#[derive(Clone, Copy, Debug)]
pub struct TaskStart<'a> {
    /// The poses of its tips in the world, in the order in which it was given their arms.
    pub tips: &'a [IsometryMatrix3<f64>],
    /// How long the motion takes \[s\].
    pub duration: f64,
}
