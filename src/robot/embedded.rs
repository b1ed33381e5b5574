//! The robots that come with the library: the files of `robots/`, by name.

use include_dir::{Dir, File, include_dir};
use thiserror::Error;

use super::{Robot, UrdfError, names as words};

static ROBOTS: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/robots");

/// Why an embedded robot could not be given.
#[derive(Debug, Error)]
pub enum EmbeddedError {
    /// No embedded robot has that name.
    #[error("there is no embedded robot {}{}; embedded are {}", words::quote(.name),
            words::suggestion(.nearest), words::list(.known, "and"))]
    Unknown {
        /// The name asked for.
        name: String,
        /// The names that look like it, nearest first.
        nearest: Vec<String>,
        /// The names of all embedded robots.
        known: Vec<String>,
    },
    /// The robot's file can not be read.
    #[error(transparent)]
    Urdf(#[from] UrdfError),
}

/// Returns the names of the embedded robots, in alphabetical order.
pub fn names() -> Vec<&'static str> {
    let mut names: Vec<&str> = files().map(|(name, _)| name).collect();
    names.sort_unstable();
    names
}

/// Returns the embedded robot of that name.
///
/// # Errors
/// [`EmbeddedError::Unknown`], with the nearest names.
pub fn get(name: &str) -> Result<Robot, EmbeddedError> {
    Ok(Robot::from_urdf(text(name)?)?)
}

/// Returns the URDF text of the embedded robot of that name.
///
/// # Errors
/// [`EmbeddedError::Unknown`], with the nearest names.
pub fn text(name: &str) -> Result<&'static str, EmbeddedError> {
    let found = files().find(|&(known, _)| known == name).and_then(|(_, file)| file.contents_utf8());
    found.ok_or_else(|| EmbeddedError::Unknown {
        name: name.to_owned(),
        nearest: words::nearest(name, names()).into_iter().map(str::to_owned).collect(),
        known: names().into_iter().map(str::to_owned).collect(),
    })
}

/// Returns the text of the file with the capsules of an embedded robot (`NAME.collision.toml`), which
/// `collision::CollisionModel::from_toml` reads; `None` where there is none.
pub fn collision_text(name: &str) -> Option<&'static str> {
    ROBOTS.get_file(format!("{name}.collision.toml"))?.contents_utf8()
}

fn files() -> impl Iterator<Item = (&'static str, &'static File<'static>)> {
    ROBOTS.files().filter_map(|file| {
        let path = file.path();
        let is_urdf = path.extension().is_some_and(|extension| extension == "urdf");
        is_urdf.then(|| path.file_stem()?.to_str()).flatten().map(|name| (name, file))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_embedded_robot_reads_without_error_or_warning() {
        for name in names() {
            let robot = get(name).unwrap_or_else(|error| panic!("{name}: {error}"));
            let loud: Vec<_> = robot
                .diagnostics()
                .iter()
                .filter(|found| found.severity > crate::robot::Severity::Note)
                .collect();
            assert!(loud.is_empty(), "{name}: {loud:?}");
        }
    }

    #[test]
    fn an_unknown_name_is_refused_with_the_known_ones() {
        let error = get("no such robot").unwrap_err();
        assert!(error.to_string().starts_with("there is no embedded robot `no such robot`"));
    }
}
