//! The table of rooms in DESIGN.md.

use std::collections::BTreeSet;

/// A row of the table.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Room {
    /// The room's name.
    pub(super) name: String,
    /// The rooms that it imports from.
    pub(super) imports: BTreeSet<String>,
}

/// Returns the rows of the table in the section "Rooms", from the top down.
pub(super) fn rooms(design: &str) -> Vec<Room> {
    let lines = design.lines().skip_while(|line| *line != "## Rooms").skip(1);
    let section = lines.take_while(|line| !line.starts_with("## "));
    section.filter(|line| line.starts_with("| `")).filter_map(room).collect()
}

/// A row: the room in the first column, in the last one the rooms that it imports from, each between backticks.
fn room(line: &str) -> Option<Room> {
    let columns: Vec<&str> = line.trim().trim_matches('|').split('|').collect();
    let names =
        |column: &str| -> Vec<String> { column.split('`').skip(1).step_by(2).map(str::to_owned).collect() };
    let name = names(columns.first()?).into_iter().next()?;
    Some(Room { name, imports: names(columns.last()?).into_iter().collect() })
}
