//! The formats that trajectories are written in: chosen by name, their files known before anything is computed.

use std::borrow::Cow;
use std::collections::HashSet;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use super::failure::{Exit, Failure};
use super::folder::Folder;
use kinstep_files::scenario::{Place, suggestion};
use kinstep_files::trajectory::{
    Export, ExportFile, ReadOptions, Reading, Recording, Stage, Trajectory, TrajectoryError,
    TrajectoryErrorKind,
};

/// The word for all formats.
const ALL: &str = "all";

/// Files to be written, each with the format that it belongs to.
pub(super) struct Exports {
    files: Vec<(Export, ExportFile)>,
    append_stop: bool,
}

/// Returns the formats that are named, in the order of the listing; `first` is always among them.
pub(super) fn formats(names: &[String], first: &[Export]) -> Result<Vec<Export>, Failure> {
    let mut chosen: Vec<Export> = first.to_vec();
    for name in names.iter().map(|name| name.trim()).filter(|name| *name != ALL) {
        let format = Export::ALL.iter().find(|format| format.name() == name);
        let format = format.ok_or_else(|| unknown(name))?;
        chosen.push(*format);
    }
    let all = names.iter().any(|name| name.trim() == ALL);
    Ok(Export::ALL.iter().copied().filter(|format| all || chosen.contains(format)).collect())
}

/// The refusal of a format that this program does not have.
fn unknown(name: &str) -> Failure {
    if !cfg!(feature = "parquet") && name == "parquet" {
        let remedy = "build it with --features parquet, or take csv or npz";
        return Failure::usage(format!(
            "--format parquet: this program was built without the feature parquet; {remedy}"
        ));
    }
    let known = Export::ALL.iter().map(|format| format.name());
    let hint = suggestion(name, known.chain([ALL]));
    Failure::usage(format!("--format: there is no format \"{name}\"; {hint}"))
}

impl Exports {
    /// Returns the files of the formats, for these machines.
    pub(super) fn new(formats: &[Export], machines: &[String], append_stop: bool) -> Result<Self, Failure> {
        let of = |&format: &Export| format.files(machines).into_iter().map(move |file| (format, file));
        let files: Vec<(Export, ExportFile)> = formats.iter().flat_map(of).collect();
        let mut names = HashSet::new();
        match files.iter().find(|(_, file)| !names.insert(file.name.clone())) {
            Some((_, file)) => {
                let name = &file.name;
                Err(Failure::usage(format!("two machines would both be written to {name}; rename an arm")))
            }
            None => Ok(Self { files, append_stop }),
        }
    }

    pub(super) fn names(&self) -> impl Iterator<Item = &str> {
        self.files.iter().map(|(_, file)| file.name.as_str())
    }

    /// Leaves out the files that the trajectory can not be written to, and returns why.
    pub(super) fn keep_possible(&mut self, recording: Recording<'_>) -> Vec<String> {
        let mut reasons = Vec::new();
        let append_stop = self.append_stop;
        self.files.retain(|(format, file)| match refusal(*format, file, recording, append_stop) {
            None => true,
            Some(reason) => {
                reasons.push(reason);
                false
            }
        });
        reasons
    }

    /// Writes all files, or none where one of the formats can not hold the trajectory.
    pub(super) fn write(&self, folder: &Folder, recording: Recording<'_>) -> Result<(), Failure> {
        let refused =
            |(format, file): &(Export, ExportFile)| refusal(*format, file, recording, self.append_stop);
        if let Some(reason) = self.files.iter().find_map(refused) {
            return Err(Failure::usage(reason));
        }
        let stopped = self.stopped(recording)?;
        for (format, file) in &self.files {
            let trajectory =
                if format.is_for_controllers() { stopped.as_ref() } else { recording.trajectory };
            let recording = Recording { trajectory, stage: recording.stage };
            folder.write(&file.name, |out| file.format.write(recording, out))?;
        }
        Ok(())
    }

    fn stopped<'t>(&self, recording: Recording<'t>) -> Result<Cow<'t, Trajectory>, Failure> {
        let is_asked = self.append_stop && self.files.iter().any(|(format, _)| format.is_for_controllers());
        stopped(recording, is_asked).map_err(Failure::usage)
    }
}

fn stopped(recording: Recording<'_>, append_stop: bool) -> Result<Cow<'_, Trajectory>, String> {
    if !append_stop {
        return Ok(Cow::Borrowed(recording.trajectory));
    }
    recording.trajectory.with_stop(recording.stage).map(Cow::Owned).map_err(|e| e.to_string())
}

fn refusal(format: Export, file: &ExportFile, recording: Recording<'_>, append_stop: bool) -> Option<String> {
    let checked = stopped(recording, append_stop && format.is_for_controllers()).and_then(|trajectory| {
        let recording = Recording { trajectory: &trajectory, stage: recording.stage };
        file.format.check(recording).map_err(|e| e.to_string())
    });
    checked.err().map(|reason| format!("--format {}: {reason}", format.name()))
}

/// Reads a trajectory, with the place of what is wrong in it.
pub(super) fn read(path: &std::path::Path, options: &ReadOptions) -> Result<Reading, Failure> {
    Trajectory::read_with(path, options).map_err(|e| unreadable(&e))
}

fn unreadable(error: &TrajectoryError) -> Failure {
    let file = error.path.display().to_string();
    let (exit, place) = match error.kind {
        TrajectoryErrorKind::File => (Exit::File, None),
        TrajectoryErrorKind::Content => (Exit::Usage, error.place.clone()),
    };
    let place = place.map(|place| {
        let (line, column, source_line) = (place.line, place.column, place.source_line);
        Box::new(Place { file: Some(file.clone()), line, column, source_line })
    });
    Failure { place, ..Failure::new(exit, error.message.clone()).in_file(&file) }
}

/// The names of a stage's machines, which are known before anything moves.
pub(super) fn machines(stage: &Stage) -> Vec<String> {
    stage.machines.iter().map(|machine| machine.name.clone()).collect()
}

/// Whether the user has asked to stop, from now on: what is being written is then given up and taken away.
pub(super) fn interruption() -> Arc<AtomicBool> {
    let interrupted = Arc::new(AtomicBool::new(false));
    let handler = Arc::clone(&interrupted);
    // Where a handler can not be set, an interrupt ends the program at once, as it did before.
    let _ = ctrlc::set_handler(move || handler.store(true, Ordering::Relaxed));
    interrupted
}
