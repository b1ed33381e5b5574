use super::{Mask, Motion, Task};
use crate::kind::{Kind, Parameters};
use nalgebra::IsometryMatrix3;
use std::fmt::Debug;

/// A task beside those of the arms that files can name.
pub type AddedTaskKind = Kind<MakeTask>;

/// A task, or why there is none, as the end of a sentence that begins with the task's key.
pub type MadeTask = Result<Box<dyn Task>, String>;

/// How a task over the tips of arms is made of its parameters.
#[derive(Clone, Copy, Debug)]
pub struct MakeTask {
    /// How many tips it is about.
    pub tips: usize,
    /// Whether it can be about more.
    pub or_more: bool,
    /// The keys of the paths that it can be given.
    pub paths: &'static [&'static str],
    /// Whether it can be given a mask.
    pub takes_rows: bool,
    /// Whether it can be given a pose.
    pub takes_pose: bool,
    /// Makes it, or says why it can not be.
    pub make: fn(&Parameters, &TaskStart<'_>) -> MadeTask,
}

impl MakeTask {
    /// Makes tasks of parameters alone, about so many tips.
    pub const fn of(tips: usize, make: fn(&Parameters, &TaskStart<'_>) -> MadeTask) -> Self {
        Self { tips, or_more: false, paths: &[], takes_rows: false, takes_pose: false, make }
    }

    /// The same, about more tips too.
    #[must_use]
    pub const fn or_more(mut self) -> Self {
        self.or_more = true;
        self
    }

    /// The same, which can be given paths by these keys.
    #[must_use]
    pub const fn with_paths(mut self, keys: &'static [&'static str]) -> Self {
        self.paths = keys;
        self
    }

    /// The same, which can be given a mask.
    #[must_use]
    pub const fn with_rows(mut self) -> Self {
        self.takes_rows = true;
        self
    }

    /// The same, which can be given a pose.
    #[must_use]
    pub const fn with_pose(mut self) -> Self {
        self.takes_pose = true;
        self
    }
}

/// A path that was asked for, to be laid where a task has its beginning.
pub trait LayPath: Debug {
    /// The motion along the path, which begins at the pose `start` of a frame of the task's choice, in axes of that frame.
    fn laid_at(&self, start: &IsometryMatrix3<f64>) -> Motion;
}

/// What a task begins with.
#[derive(Clone, Copy, Debug)]
pub struct TaskStart<'a> {
    /// The poses of its tips in the world, in the order in which it was given their arms.
    pub tips: &'a [IsometryMatrix3<f64>],
    /// How long the motion takes \[s\].
    pub duration: f64,
    /// The paths that it was given, by their keys.
    pub paths: &'a [(&'static str, &'a dyn LayPath)],
    /// The mask that it was given.
    pub mask: Option<&'a Mask>,
    /// The pose that it was given.
    pub pose: Option<IsometryMatrix3<f64>>,
}

impl<'a> TaskStart<'a> {
    /// The beginning of a task of tips at these poses, which was given nothing else.
    pub fn new(tips: &'a [IsometryMatrix3<f64>], duration: f64) -> Self {
        Self { tips, duration, paths: &[], mask: None, pose: None }
    }

    /// The motion along the path of that key, laid to where it begins, if one was given.
    pub fn motion(&self, key: &str, start: &IsometryMatrix3<f64>) -> Option<Motion> {
        self.paths.iter().find(|(own, _)| *own == key).map(|(_, path)| path.laid_at(start))
    }

    /// The same, or the motion that stays there.
    pub fn motion_or_held(&self, key: &str, start: &IsometryMatrix3<f64>) -> Motion {
        self.motion(key, start).unwrap_or_else(|| Motion::held(start))
    }
}
