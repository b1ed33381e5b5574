//! The layering, read from the sources: which room imports which, exactly as the table in DESIGN.md says, and no circle
//! of rooms or of files.

mod graph;
mod made_up;
mod module;
mod rules;
mod sources;
mod table;
mod tokens;

use std::fs;
use std::path::Path;

use sources::Sources;
use table::Room;

/// The rooms that are free of circles of files, and have to stay so.
const ROOMS_WITHOUT_CIRCLES: [&str; 10] =
    ["math", "formula", "integrate", "robot", "collision", "task", "law", "inverse", "planner", "scheme"];

/// The sources as they are, and the table of DESIGN.md.
fn as_they_are() -> (Sources, Vec<Room>) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let design = fs::read_to_string(root.join("DESIGN.md")).expect("DESIGN.md is beside the manifest");
    let table = table::rooms(&design);
    let names = table.iter().map(|room| room.name.clone()).collect();
    (Sources::new(&sources::files_on_disk(root), &names), table)
}

/// Asks that nothing was found.
fn nothing_of(found: &[String]) {
    assert!(found.is_empty(), "{}", found.join("\n"));
}

#[test]
fn rooms_import_what_the_table_says_and_nothing_else() {
    let (sources, table) = as_they_are();
    nothing_of(&rules::against_table(&sources, &table));
}

#[test]
fn no_rooms_import_each_other_in_a_circle() {
    nothing_of(&rules::circles_of_rooms(&as_they_are().0));
}

#[test]
fn no_files_of_a_room_name_each_other_in_a_circle() {
    let (sources, _) = as_they_are();
    let found: Vec<String> =
        ROOMS_WITHOUT_CIRCLES.iter().flat_map(|room| rules::circles_of_files(&sources, room)).collect();
    nothing_of(&found);
}
