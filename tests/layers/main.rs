//! The rooms of the design import what its table says, read from the sources: nothing more, nothing less, and nothing below.

#![allow(clippy::unwrap_used, reason = "a test that can not go on stops")]

use std::collections::BTreeSet;
use std::fs;
use std::path::{Path, PathBuf};

type Names = BTreeSet<String>;

/// One line of the table "Rooms" in DESIGN.md.
struct Room {
    name: String,
    may_import: Names,
}

impl Room {
    /// Where its sources are.
    fn folder(&self) -> PathBuf {
        let places = ["src/NAME", "crates/NAME/src", "crates/files/src/NAME"];
        let mut places = places.map(|place| repository().join(place.replace("NAME", &self.name))).into_iter();
        places.find(|place| place.is_dir()).unwrap_or_else(|| panic!("room `{}` has no folder", self.name))
    }
}

fn repository() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The words of a text that stand between backticks.
fn words(text: &str) -> Names {
    text.split('`').skip(1).step_by(2).map(str::to_owned).collect()
}

fn rooms() -> Vec<Room> {
    let design = fs::read_to_string(repository().join("DESIGN.md")).unwrap();
    let (_, rest) = design.split_once("| room |").expect("DESIGN.md has the table of rooms");
    let lines = rest.lines().skip(2).take_while(|line| line.starts_with('|'));
    let room = |line: &str| {
        let cells: Vec<&str> = line.split('|').collect();
        Room { name: words(cells[1]).pop_first().unwrap(), may_import: words(cells[3]) }
    };
    lines.map(room).collect()
}

/// The files of Rust in a folder and all below it.
fn sources(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let of_entry = |path: PathBuf| match path.is_dir() {
        true => sources(&path),
        false
            if path.extension().is_some_and(|extension| extension == "rs") && !path.ends_with("tests.rs") =>
        {
            vec![path]
        }
        false => Vec::new(),
    };
    entries.flat_map(of_entry).collect()
}

/// The code of a file: neither its comments nor its tests, which may use any room.
fn code(file: &Path) -> String {
    let text = fs::read_to_string(file).unwrap();
    let code = text.split("mod tests {").next().unwrap_or_default();
    code.lines().filter(|line| !line.trim_start().starts_with("//")).collect::<Vec<_>>().join("\n")
}

/// The first word of each path that begins with `root::`, also of a list in braces.
fn after<'c>(code: &'c str, root: &str) -> Vec<&'c str> {
    let word =
        |text: &'c str| text.split(|c: char| !c.is_alphanumeric() && c != '_').next().unwrap_or_default();
    let is_part = |c: char| c.is_alphanumeric() || c == '_' || c == '$';
    let whole = code.match_indices(root).filter(|(at, _)| !code[..*at].ends_with(is_part));
    let rests = whole.filter_map(|(at, _)| code[at + root.len()..].strip_prefix("::"));
    let listed = |rest: &'c str| match rest.strip_prefix('{') {
        Some(list) => {
            list[..list.find('}').unwrap_or(list.len())].split(',').map(|part| word(part.trim())).collect()
        }
        None => vec![word(rest)],
    };
    rests.flat_map(listed).collect()
}

/// The rooms that a room's code names.
fn imports(room: &Room, known: &Names) -> Names {
    let mut found = Names::new();
    for file in sources(&room.folder()) {
        let code = code(&file);
        let inner = ["crate", "kinstep", "kinstep_files"].into_iter().flat_map(|root| after(&code, root));
        found.extend(inner.map(str::to_owned));
        let whole = |room: &&String| code.contains(&format!("kinstep_{room}::"));
        found.extend(known.iter().filter(whole).cloned());
    }
    found.retain(|name| known.contains(name) && *name != room.name);
    found
}

#[test]
fn every_room_imports_what_the_design_says() {
    let rooms = rooms();
    let known: Names = rooms.iter().map(|room| room.name.clone()).collect();
    assert!(known.len() > 12, "{known:?}");
    for room in &rooms {
        assert_eq!(
            imports(room, &known),
            room.may_import,
            "what `{}` imports (left: the sources)",
            room.name
        );
    }
}

#[test]
fn imports_point_up_the_table() {
    let mut above = Names::new();
    for room in rooms() {
        let below: Vec<_> = room.may_import.difference(&above).collect();
        assert!(below.is_empty(), "`{}` imports {below:?}, which do not stand above it", room.name);
        above.insert(room.name);
    }
}

#[test]
fn every_folder_of_the_heart_is_a_room() {
    let known: Names = rooms().into_iter().map(|room| room.name).collect();
    for entry in fs::read_dir(repository().join("src")).unwrap() {
        let path = entry.unwrap().path();
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        assert!(!path.is_dir() || known.contains(&name), "src/{name} is not in the table of rooms");
    }
}
