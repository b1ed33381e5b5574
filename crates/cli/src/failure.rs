//! Why a command could not be done, and the exit code for it.

use kinstep_files::scenario::{ErrorKind, Place, ScenarioError};

/// Exit codes, as scripts rely on them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub(super) enum Exit {
    /// Done.
    Done = 0,
    /// Done, and a check did not hold.
    CheckFailed = 1,
    /// Usage or scenario.
    Usage = 2,
    /// Robot.
    Robot = 3,
    /// Formula.
    Formula = 4,
    /// The run stopped.
    Stopped = 5,
    /// Files.
    File = 6,
}

impl Exit {
    /// The word for the code in documents.
    pub(super) fn word(self) -> &'static str {
        match self {
            Self::Done => "done",
            Self::CheckFailed => "check_failed",
            Self::Usage => "usage",
            Self::Robot => "robot",
            Self::Formula => "formula",
            Self::Stopped => "stopped",
            Self::File => "file",
        }
    }
}

/// A command that gave no result.
#[derive(Debug)]
pub(super) struct Failure {
    pub(super) exit: Exit,
    pub(super) message: String,
    pub(super) file: Option<String>,
    pub(super) place: Option<Box<Place>>,
    /// What else is wrong, where a command lists everything.
    pub(super) also: Vec<Failure>,
}

impl Failure {
    pub(super) fn new(exit: Exit, message: impl Into<String>) -> Self {
        Self { exit, message: message.into(), file: None, place: None, also: Vec::new() }
    }

    pub(super) fn usage(message: impl Into<String>) -> Self {
        Self::new(Exit::Usage, message)
    }

    pub(super) fn in_file(mut self, file: &str) -> Self {
        self.file = Some(file.to_owned());
        self
    }
}

impl From<ScenarioError> for Failure {
    fn from(error: ScenarioError) -> Self {
        let exit = match error.kind {
            ErrorKind::Scenario => Exit::Usage,
            ErrorKind::Robot => Exit::Robot,
            ErrorKind::Formula => Exit::Formula,
            ErrorKind::File => Exit::File,
        };
        let file = error.place.as_ref().and_then(|place| place.file.clone()).or(error.file);
        let also = error.also.into_iter().map(Self::from).collect();
        Self { exit, message: error.message, file, place: error.place, also }
    }
}
