//! `kinstep robot export`: any robot as URDF.

use std::path::Path;

use super::arguments::RobotExport;
use super::failure::{Exit, Failure};
use super::folder::write_file;
use super::output::Output;
use super::robot::read;
use kinstep::robot::names::shown;

pub(super) fn run(arguments: &RobotExport, output: &mut Output) -> Result<Exit, Failure> {
    let robot = read(&arguments.file, output)?;
    let text = robot
        .to_urdf()
        .map_err(|e| Failure::new(Exit::Robot, e.to_string()).in_file(&arguments.file.robot))?;
    match arguments.urdf.as_deref() {
        Some(path) if path != Path::new("-") => {
            write_file(path, arguments.force, &text)?;
            if output.wants_json() {
                output.json(&serde_json::json!({ "written": path.display().to_string() }))?;
            } else {
                output.aside(&format!("wrote {}", shown(path)));
            }
        }
        _ if output.wants_json() => output.json(&serde_json::json!({ "urdf": text }))?,
        _ => output.text(&text)?,
    }
    Ok(Exit::Done)
}
