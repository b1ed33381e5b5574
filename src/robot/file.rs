//! Files of robots, whatever they hold: URDF, or a Denavit-Hartenberg table in TOML.

use std::fs::File;
use std::io::Read;
use std::path::Path;

use super::{DhTable, MAX_BYTES, ReadError, Robot, UrdfOptions};

impl Robot {
    /// Returns the robot in a URDF file, read as [`Robot::from_urdf_bytes`] reads its bytes; a robot without a name is
    /// called after the file.
    ///
    /// # Errors
    /// [`ReadError::File`] when the file can not be read, [`ReadError::Urdf`] as [`Robot::from_urdf`].
    pub fn from_urdf_file(path: impl AsRef<Path>, options: &UrdfOptions) -> Result<Robot, ReadError> {
        let path = path.as_ref();
        robot_of_urdf(path, &bytes_of(path)?, options)
    }

    /// Returns the robot in a file: a URDF ([`Robot::from_urdf_file`]), or a table ([`DhTable::from_toml`]), which is
    /// known by its content, or by the extension `.toml`. A robot without a name is called after the file.
    ///
    /// # Errors
    /// [`ReadError`]: the file can not be read, or no robot can be made of it.
    pub fn from_file(path: impl AsRef<Path>, options: &UrdfOptions) -> Result<Robot, ReadError> {
        let path = path.as_ref();
        let bytes = bytes_of(path)?;
        match table_text(path, &bytes) {
            None => robot_of_urdf(path, &bytes, options),
            Some(text) => robot_of_table(path, text, options),
        }
    }
}

/// Returns the bytes of a file, of which never more than the size cap and one byte is taken into memory.
fn bytes_of(path: &Path) -> Result<Vec<u8>, ReadError> {
    let file_error = |source| ReadError::file(path, source);
    let mut bytes = Vec::new();
    let file = File::open(path).map_err(file_error)?;
    file.take(MAX_BYTES as u64 + 1).read_to_end(&mut bytes).map_err(file_error)?;
    Ok(bytes)
}

fn robot_of_urdf(path: &Path, bytes: &[u8], options: &UrdfOptions) -> Result<Robot, ReadError> {
    let mut options = options.clone();
    if options.name.is_none() {
        options.name = path.file_stem().map(|stem| stem.to_string_lossy().into_owned());
    }
    Robot::from_urdf_bytes(bytes, &options).map_err(|error| ReadError::Urdf { path: path.to_owned(), error })
}

fn robot_of_table(path: &Path, text: &str, options: &UrdfOptions) -> Result<Robot, ReadError> {
    let refuse = |error| ReadError::Dh { path: path.to_owned(), error };
    let (mut table, found) = DhTable::from_toml_with_findings(text).map_err(refuse)?;
    if table.name.is_empty() {
        let stem = path.file_stem().map(|stem| stem.to_string_lossy().into_owned());
        table.name = options.name.clone().or(stem).unwrap_or_default();
    }
    let mut robot = Robot::from_dh(&table).map_err(refuse)?;
    robot.diagnostics = found;
    Ok(robot)
}

/// Returns the text where it is TOML: what begins with `<` is markup, whatever it is called.
fn table_text<'a>(path: &Path, bytes: &'a [u8]) -> Option<&'a str> {
    /// No table that people write is longer [bytes].
    const LONGEST: usize = 16 << 20;
    let text = std::str::from_utf8(bytes).ok().filter(|text| text.len() <= LONGEST)?;
    let begin = text.trim_start_matches('\u{feff}').trim_ascii_start();
    let is_named = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("toml"));
    let is_toml = || {
        !begin.is_empty() && toml::de::DeTable::parse(begin).is_ok_and(|table| !table.get_ref().is_empty())
    };
    (!begin.starts_with('<') && (is_named || is_toml())).then_some(text)
}
