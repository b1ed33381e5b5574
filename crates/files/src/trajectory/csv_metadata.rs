//! What made a trajectory, beside its table.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use serde_json::{Value, json};

use super::error::Problem;
use super::{About, Recording, TrajectoryFormat};

/// What is appended to the name of a table for the name of its metadata: where readers of the standard look first.
const SUFFIX: &str = "-metadata.json";
/// The member of a note that has the entries of [`About`], as pairs.
const NOTE: &str = "kinstep";

/// Metadata of a table of samples, as the W3C's "CSV on the Web" has them: the columns with their types and units, and
/// what made the trajectory as a note. The table itself keeps its header in line 1.
#[derive(Clone, Debug)]
pub struct CsvMetadata {
    /// The table's name, in the same folder.
    pub table: String,
}

impl CsvMetadata {
    /// Returns the name of the file with the metadata.
    pub fn file_name(&self) -> String {
        format!("{}{SUFFIX}", self.table)
    }
}

impl TrajectoryFormat for CsvMetadata {
    fn write(&self, recording: Recording<'_>, out: &mut dyn Write) -> io::Result<()> {
        let columns = recording.trajectory.columns();
        let columns: Vec<Value> =
            columns.iter().enumerate().map(|(index, name)| column(index, name)).collect();
        let mut document = json!({
            "@context": "http://www.w3.org/ns/csvw",
            "url": self.table,
            "dialect": { "header": true, "delimiter": ",", "encoding": "utf-8" },
            "tableSchema": { "columns": columns },
        });
        if let Some(about) = &recording.trajectory.about {
            // Pairs and not members of an object: their order is that of the arms.
            let entries: Vec<Value> =
                about.entries().into_iter().map(|(key, value)| json!([key, value])).collect();
            document["notes"] = json!([{ NOTE: entries }]);
        }
        writeln!(out, "{document:#}")
    }
}

/// A column's short name may not have every character; its title has.
fn column(index: usize, title: &str) -> Value {
    let name = if index == 0 { "t".to_owned() } else { format!("column_{}", index + 1) };
    let description = if index == 0 {
        "time [s]"
    } else if title.strip_suffix(".velocity").is_some() {
        "joint velocity [rad/s or m/s]"
    } else if title.strip_suffix(".acceleration").is_some() {
        "joint acceleration [rad/s^2 or m/s^2]"
    } else if title.strip_suffix(".error").is_some() {
        "norm of the task error [m, rad]"
    } else {
        "joint position [rad or m]"
    };
    json!({ "name": name, "titles": title, "datatype": "double", "required": true, "dc:description": description })
}

/// Returns what the metadata beside a table say; nothing where there are none, or where they say nothing of the kind.
pub(super) fn beside(table: &Path) -> Result<Option<About>, Problem> {
    let mut name = table.file_name().unwrap_or_default().to_owned();
    name.push(SUFFIX);
    let path: PathBuf = table.with_file_name(name);
    let Ok(text) = fs::read_to_string(&path) else { return Ok(None) };
    let document: Value = serde_json::from_str(&text)
        .map_err(|e| Problem::new(format!("its metadata, {}, are not JSON: {e}", path.display())))?;
    let mut notes = document["notes"].as_array().into_iter().flatten();
    let note = notes.find_map(|note| note[NOTE].as_array());
    let entries = note.into_iter().flatten();
    let text = entries.filter_map(|pair| Some((pair[0].as_str()?, pair[1].as_str()?)));
    Ok(About::from_entries(text))
}
