//! Reading URDF: a strict pass with places over the XML, then urdf-rs for the values of the sound joints.
//!
//! urdf-rs alone takes most defects in silence (a missing `<limit>` reads as 0 to 0, unreadable tokens vanish,
//! loops and second parents pass). So the text is first looked over as markup ([`outline`]), parsed without DTD,
//! and read element by element with every finding kept; what is sound is handed to urdf-rs ([`values`]), and the
//! joints are joined to a tree ([`graph`]).

mod document;
mod element;
mod encoding;
mod error;
mod graph;
mod joint;
mod limit;
mod link;
mod mimic;
mod number;
mod outline;
mod places;
pub(super) mod report;
mod values;
mod visual;

use std::fs::File;
use std::io::Read;
use std::path::Path;

pub use error::{ReadError, UrdfError};

use super::Robot;
use report::Report;
pub(super) use visual::read as read_visuals;

/// Longest text that is read, in bytes (64 MiB).
pub const MAX_BYTES: usize = 64 << 20;
/// Most joints that are read; of links one more, as a tree has.
pub const MAX_JOINTS: usize = 20_000;
/// Deepest nesting of elements that is read.
pub const MAX_DEPTH: usize = 256;

/// How strictly a URDF is read.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct UrdfOptions {
    /// Take a revolute or prismatic joint without `<limit>` as unlimited (a warning) instead of as defective.
    pub assume_unlimited: bool,
    /// Take every attribute that URDF does not know as an error instead of a warning.
    pub strict: bool,
    /// The robot's name when the file gives none; `robot` when this is `None`.
    pub name: Option<String>,
}

/// Reads a robot from text.
pub(super) fn read_text(text: &str, options: &UrdfOptions) -> Result<Robot, UrdfError> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    if text.len() > MAX_BYTES {
        return Err(UrdfError::whole_file(format!(
            "the text has {} bytes, more than the {MAX_BYTES} (64 MiB) that are read",
            text.len()
        )));
    }
    let mut report = Report::new(text);
    match document::read(text, options, &mut report) {
        Some(mut robot) => {
            robot.diagnostics = report.finish();
            Ok(robot)
        }
        None => Err(UrdfError::new(report.finish())),
    }
}

/// Reads a robot from bytes.
pub(super) fn read_bytes(bytes: &[u8], options: &UrdfOptions) -> Result<Robot, UrdfError> {
    if bytes.len() > MAX_BYTES {
        return Err(UrdfError::whole_file(format!(
            "the file has {} bytes, more than the {MAX_BYTES} (64 MiB) that are read",
            bytes.len()
        )));
    }
    read_text(encoding::decode(bytes)?, options)
}

/// Reads a robot from a file.
pub(super) fn read_file(path: &Path, options: &UrdfOptions) -> Result<Robot, ReadError> {
    read_named_bytes(path, &bytes_of(path)?, options)
}

/// Returns the bytes of a file, of which never more than the size cap and one byte is taken into memory.
pub(super) fn bytes_of(path: &Path) -> Result<Vec<u8>, ReadError> {
    let file_error = |source| ReadError::file(path, source);
    let mut bytes = Vec::new();
    let file = File::open(path).map_err(file_error)?;
    file.take(MAX_BYTES as u64 + 1).read_to_end(&mut bytes).map_err(file_error)?;
    Ok(bytes)
}

/// Reads a robot from the bytes of a file.
pub(super) fn read_named_bytes(path: &Path, bytes: &[u8], options: &UrdfOptions) -> Result<Robot, ReadError> {
    let mut options = options.clone();
    if options.name.is_none() {
        options.name = path.file_stem().map(|stem| stem.to_string_lossy().into_owned());
    }
    read_bytes(bytes, &options).map_err(|error| ReadError::Urdf { path: path.to_owned(), error })
}
