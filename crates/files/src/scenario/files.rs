//! Where the files are that a scenario names: beside the scenario, or else in the working directory.

use std::path::{Path, PathBuf};

use super::error::{ErrorKind, ScenarioError};
use super::model::Scenario;
use super::robots::RobotSource;
use kinstep::robot::names::shown;
use kinstep::robot::nearby;

/// Returns where a file is that is named by `reference`: tried from `folder`, and then from the working directory.
pub(super) fn find(reference: &str, folder: Option<&Path>) -> Option<PathBuf> {
    places(reference, folder).into_iter().find(|path| !reference.is_empty() && path.exists())
}

/// Returns the refusal of a reference that [`find`] does not find, with every place that was tried.
pub(super) fn missing(reference: &str, folder: Option<&Path>) -> ScenarioError {
    let named = shown(Path::new(reference));
    let message = match places(reference, folder).as_slice() {
        [beside, here] => {
            let near = Some(nearby::hint(beside)).filter(|near| near.contains('?'));
            format!(
                "{named}: there is no such file beside the scenario ({}) or in the working directory ({}){}",
                shown(beside),
                shown(here),
                near.unwrap_or_else(|| nearby::hint(here))
            )
        }
        [here] if folder.is_some() && here.is_relative() => {
            format!("{named}: there is no such file beside the scenario{}", nearby::hint(here))
        }
        _ => format!("{named}: there is no such file{}", nearby::whereabouts(Path::new(reference))),
    };
    ScenarioError::of_file(Path::new(reference), message)
}

fn places(reference: &str, folder: Option<&Path>) -> Vec<PathBuf> {
    let here = PathBuf::from(reference);
    let beside = folder.map(|folder| folder.join(&here)).filter(|beside| *beside != here);
    beside.into_iter().chain([here]).collect()
}

impl Scenario {
    /// Returns the scenario as it has to be written into the folder `into` so that the files that it names are found again:
    /// files inside that folder relative to it, so that the folder can be moved, all others by their absolute paths.
    ///
    /// References are looked up from `folder`, the place of the scenario's own file; `more_rows` is a file of formula rows
    /// that joins `formulas`, unless it is among them.
    ///
    /// # Errors
    /// [`ScenarioError`] of kind [`ErrorKind::File`] where a path is not UTF-8, which a scenario can not name.
    pub fn relocated(
        &self,
        folder: Option<&Path>,
        more_rows: Option<&Path>,
        into: &Path,
    ) -> Result<Self, ScenarioError> {
        let mut moved = self.clone();
        for path in moved.paths_mut() {
            if let Some(named) = path.parameters.text("file").map(str::to_owned) {
                let file = find(&named, folder).ok_or_else(|| missing(&named, folder))?;
                path.parameters.set("file", reference(&file, into)?.as_str());
            }
        }
        for arm in &mut moved.arm {
            if let RobotSource::File(path) = RobotSource::find(&arm.robot, folder)? {
                arm.robot = reference(&path, into)?;
            }
            if let Some(named) = &arm.calibration {
                let path = find(named, folder).ok_or_else(|| missing(named, folder))?;
                arm.calibration = Some(reference(&path, into)?);
            }
            if let Some(named) = &arm.limits {
                let path = find(named, folder).ok_or_else(|| missing(named, folder))?;
                arm.limits = Some(reference(&path, into)?);
            }
        }
        if let Some(collision) = &mut moved.collision {
            for named in [&mut collision.srdf, &mut collision.model].into_iter().flatten() {
                let path = find(named, folder).ok_or_else(|| missing(named, folder))?;
                *named = reference(&path, into)?;
            }
        }
        let mut rows: Vec<PathBuf> = Vec::new();
        let (texts, files): (Vec<&String>, Vec<&String>) =
            self.formulas.iter().partition(|named| named.trim_start().starts_with("[[formula]]"));
        for named in files {
            rows.push(find(named, folder).ok_or_else(|| missing(named, folder))?);
        }
        rows.extend(
            more_rows.filter(|more| !rows.iter().any(|row| is_same_file(row, more))).map(Path::to_owned),
        );
        let files = rows.iter().map(|row| reference(row, into)).collect::<Result<Vec<_>, _>>()?;
        moved.formulas = texts.into_iter().cloned().chain(files).collect();
        Ok(moved)
    }
}

/// Whether two paths lead to one file.
pub(super) fn is_same_file(one: &Path, other: &Path) -> bool {
    one.canonicalize().is_ok_and(|one| other.canonicalize().is_ok_and(|other| one == other))
}

/// Returns the text by which a scenario in the folder `into` names a file.
fn reference(path: &Path, into: &Path) -> Result<String, ScenarioError> {
    let inside = path.canonicalize().ok().zip(into.canonicalize().ok());
    let inside = inside.and_then(|(path, into)| path.strip_prefix(into).ok().map(Path::to_owned));
    // The dot keeps a file without an extension apart from the built-in robots.
    let named = match inside {
        Some(inside) => Path::new(".").join(inside),
        None => std::path::absolute(path).unwrap_or_else(|_| path.to_owned()),
    };
    named.to_str().map(str::to_owned).ok_or_else(|| {
        let message =
            format!("{}: a path that is not UTF-8 can not be written into a scenario", named.display());
        ScenarioError { kind: ErrorKind::File, ..ScenarioError::of_file(&named, message) }
    })
}
