//! Files of robots, whatever they hold: URDF, or a Denavit-Hartenberg table in TOML.

use std::path::Path;

use super::{DhTable, ReadError, Robot, UrdfOptions, urdf};

impl Robot {
    /// Returns the robot in a file: a URDF ([`Robot::from_urdf_file`]), or a table ([`DhTable::from_toml`]), which is
    /// known by its content, or by the extension `.toml`. A robot without a name is called after the file.
    ///
    /// # Errors
    /// [`ReadError`]: the file can not be read, or no robot can be made of it.
    pub fn from_file(path: impl AsRef<Path>, options: &UrdfOptions) -> Result<Robot, ReadError> {
        let path = path.as_ref();
        let bytes = urdf::bytes_of(path)?;
        match table_text(path, &bytes) {
            None => urdf::read_named_bytes(path, &bytes, options),
            Some(text) => robot_of_table(path, text, options),
        }
    }
}

fn robot_of_table(path: &Path, text: &str, options: &UrdfOptions) -> Result<Robot, ReadError> {
    let refuse = |error| ReadError::Dh { path: path.to_owned(), error };
    let mut table = DhTable::from_toml(text).map_err(refuse)?;
    if table.name.is_empty() {
        let stem = path.file_stem().map(|stem| stem.to_string_lossy().into_owned());
        table.name = options.name.clone().or(stem).unwrap_or_default();
    }
    Robot::from_dh(&table).map_err(refuse)
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
