//! The rules of the layering, each as the list of what breaks it.

use std::collections::BTreeSet;

use super::graph::Graph;
use super::sources::{Place, Source, Sources, Target};
use super::table::Room;

/// What breaks the table: rooms that it lacks or has too many, imports that it lacks or has too many, imports downwards.
pub(super) fn against_table(sources: &Sources, table: &[Room]) -> Vec<String> {
    let (imports, mut found) = imports_of_rooms(sources);
    let real: BTreeSet<&str> = sources.iter().filter_map(|(place, _)| sources.room(place)).collect();
    let listed: BTreeSet<&str> = table.iter().map(|room| room.name.as_str()).collect();
    found.extend(real.difference(&listed).map(|room| format!("the table has no room `{room}`")));
    found.extend(
        listed.difference(&real).map(|room| format!("the table has a room `{room}` that is not there")),
    );
    for (row, room) in table.iter().enumerate() {
        let real = imports.named_by(&room.name);
        let above: BTreeSet<&str> = table[..row].iter().map(|room| room.name.as_str()).collect();
        for other in real.difference(&room.imports) {
            let names = imports.names(&room.name, other);
            found.push(format!(
                "`{}` imports {names} from `{other}`, which the table does not say",
                room.name
            ));
        }
        for other in room.imports.difference(&real) {
            found.push(format!("`{}` imports nothing from `{other}`, though the table says so", room.name));
        }
        for other in real.iter().filter(|other| !above.contains(other.as_str())) {
            found.push(format!(
                "`{}` imports from `{other}`, which does not stand above it in the table",
                room.name
            ));
        }
    }
    found
}

/// The circles of rooms.
pub(super) fn circles_of_rooms(sources: &Sources) -> Vec<String> {
    imports_of_rooms(sources).0.circles()
}

/// The circles of files inside one room.
pub(super) fn circles_of_files(sources: &Sources, room: &str) -> Vec<String> {
    let mut names = Graph::default();
    let mut found = Vec::new();
    let in_room = |place: &Place| sources.room(place) == Some(room);
    for (place, source) in sources.iter().filter(|(place, _)| in_room(place)) {
        found.extend(not_followed(sources, place, source));
        for path in paths(source, Uses::OwnCode) {
            let Some(target) = sources.absolute(place, path) else { continue };
            if let Target::Module(to, name) = sources.find(&target) {
                let is_member = !sources.source(&to).module.is_index() && !source.module.is_index();
                if is_member && to != *place && in_room(&to) {
                    names.add(&source.file, &sources.source(&to).file, &name);
                }
            }
        }
    }
    found.extend(names.circles());
    found
}

/// What the reader can not follow: modules inside a file, and all names of an index at once.
fn not_followed(sources: &Sources, place: &Place, source: &Source) -> Vec<String> {
    let file = &source.file;
    let inline = source.module.inline.iter();
    let inline = inline.map(|name| format!("{file}: the module `{name}` has no file of its own"));
    let whole = source.module.imports.iter().filter(|import| import.name == "*" && !source.module.is_index());
    let of_index = whole.filter_map(|import| match sources.find(&sources.absolute(place, &import.path)?) {
        Target::Module(to, _) if sources.source(&to).module.is_index() => {
            Some(format!("{file}: `{}::*` does not say which files it names", import.path.join("::")))
        }
        _ => None,
    });
    inline.chain(of_index).collect()
}

/// What rooms name of each other, and the paths that lead nowhere.
fn imports_of_rooms(sources: &Sources) -> (Graph, Vec<String>) {
    let mut imports = Graph::default();
    let mut lost = Vec::new();
    for (place, source) in sources.iter() {
        let Some(own) = sources.room(place) else { continue };
        for path in paths(source, Uses::All) {
            let Some(target) = sources.absolute(place, path) else { continue };
            // Names at the root of a crate may come from elsewhere; below a room it is the room that is named.
            let (found, name) = match sources.find(&target) {
                Target::Foreign => continue,
                Target::Nothing => {
                    lost.push(format!("{}: nothing was found at `{}`", source.file, path.join("::")));
                    continue;
                }
                Target::Module(found, name) => (found, name),
            };
            let other = sources.room(sources.module_of(&target)).or_else(|| sources.room(&found));
            if let Some(other) = other.filter(|other| *other != own) {
                imports.add(own, other, &name);
            }
        }
    }
    (imports, lost)
}

/// Which paths of a file count.
#[derive(Clone, Copy, PartialEq)]
enum Uses {
    /// Also what is only passed on.
    All,
    /// What the file's own code needs: a name that an index passes on counts where its code has it too.
    OwnCode,
}

fn paths(source: &Source, uses: Uses) -> impl Iterator<Item = &Vec<String>> {
    let module = &source.module;
    let is_index = source.file.ends_with("/mod.rs") || source.file.ends_with("/lib.rs");
    let counts = move |name: &str, is_passed_on: bool| {
        uses == Uses::All || !is_index || !is_passed_on || module.words.contains(name)
    };
    let imports = module.imports.iter().filter(move |import| counts(&import.name, import.is_passed_on));
    imports.map(|import| &import.path).chain(&module.paths)
}
