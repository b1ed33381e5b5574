//! All crates of the workspace, module by module: what a path means, and in which room it is.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

use super::module::{Import, Module};

/// A module's place: its crate, then the modules down to it.
pub(super) type Place = Vec<String>;

/// A crate of the workspace.
struct Package {
    /// Its folder in the workspace; empty for the root package.
    folder: String,
    /// What paths call it.
    name: String,
}

/// A module and its file.
pub(super) struct Source {
    /// The file's path in the workspace.
    pub(super) file: String,
    /// What it holds.
    pub(super) module: Module,
}

/// What a path leads to.
#[derive(Debug, PartialEq, Eq)]
pub(super) enum Target {
    /// A name and the module that defines it; a module itself by its own name.
    Module(Place, String),
    /// Something outside the workspace.
    Foreign,
    /// Nothing that was found.
    Nothing,
}

/// The modules of all crates.
#[derive(Default)]
pub(super) struct Sources {
    modules: BTreeMap<Place, Source>,
    /// Where the macros are that a crate exports at its root.
    macros: BTreeMap<Place, Place>,
    /// Crates that are one room each, by their names.
    whole_rooms: BTreeMap<String, String>,
}

/// Every file of the workspace that matters here, with its path from the root.
pub(super) fn files_on_disk(root: &Path) -> Vec<(String, String)> {
    let mut files = Vec::new();
    gather(root, "Cargo.toml", &mut files);
    gather(root, "src", &mut files);
    gather(root, "crates", &mut files);
    files
}

fn gather(root: &Path, path: &str, files: &mut Vec<(String, String)>) {
    let whole = root.join(path);
    if let Ok(entries) = fs::read_dir(&whole) {
        for entry in entries.flatten() {
            gather(root, &format!("{path}/{}", entry.file_name().to_string_lossy()), files);
        }
    } else if path.strip_suffix(".rs").is_some() || path.rsplit('/').next() == Some("Cargo.toml") {
        let text =
            fs::read_to_string(&whole).unwrap_or_else(|error| panic!("{path} can not be read: {error}"));
        files.push((path.to_owned(), text));
    }
}

impl Sources {
    /// Reads the files of a workspace, given by path and text. A member whose folder is called after a room is that
    /// room; of the others, as of the root package, every module at the top is a room.
    pub(super) fn new(files: &[(String, String)], rooms: &BTreeSet<String>) -> Self {
        let mut sources = Self::default();
        for package in packages(files) {
            let folder =
                if package.folder.is_empty() { "src/".to_owned() } else { package.folder.clone() + "/src/" };
            let in_crate = |(path, text): &'_ (String, String)| {
                Some((path.clone(), path.strip_prefix(&folder)?.to_owned(), text.clone()))
            };
            sources.read_crate(&package.name, files.iter().filter_map(in_crate).collect());
            let own = package.folder.rsplit('/').next().unwrap_or_default();
            if rooms.contains(own) {
                sources.whole_rooms.insert(package.name, own.to_owned());
            }
        }
        sources
    }

    /// Reads the files of one crate, given by their paths in the workspace and in `src`.
    fn read_crate(&mut self, name: &str, files: Vec<(String, String, String)>) {
        let has_library = files.iter().any(|(_, path, _)| path == "lib.rs");
        for (file, path, text) in files {
            let is_program = path.starts_with("bin/") || (has_library && path == "main.rs");
            if let Some(place) = place(name, &path).filter(|_| !is_program) {
                let module = Module::read(&text);
                for exported in &module.exported_macros {
                    self.macros.insert(vec![name.to_owned(), exported.clone()], place.clone());
                }
                self.modules.insert(place, Source { file, module });
            }
        }
        self.forget_tests();
    }

    /// Leaves out the files that are declared for tests alone, and what is below them.
    fn forget_tests(&mut self) {
        let below = |(place, source): (&Place, &Source)| -> Vec<Place> {
            source
                .module
                .tests
                .iter()
                .map(|name| [place.as_slice(), std::slice::from_ref(name)].concat())
                .collect()
        };
        let tests: Vec<Place> = self.modules.iter().flat_map(below).collect();
        self.modules.retain(|place, _| !tests.iter().any(|test| place.starts_with(test)));
    }

    /// The modules, by place.
    pub(super) fn iter(&self) -> impl Iterator<Item = (&Place, &Source)> {
        self.modules.iter()
    }

    /// The module at a place.
    pub(super) fn source(&self, place: &[String]) -> &Source {
        &self.modules[place]
    }

    /// The part of a place that is a module with a file; empty where its crate is none of the workspace.
    pub(super) fn module_of<'a>(&self, place: &'a [String]) -> &'a [String] {
        let lengths = (1..=place.len()).rev();
        let known = lengths.map(|length| &place[..length]).find(|module| self.modules.contains_key(*module));
        known.unwrap_or_default()
    }

    /// The room that a module belongs to; none for the root of a crate of several rooms.
    pub(super) fn room<'a>(&'a self, place: &'a [String]) -> Option<&'a str> {
        match self.whole_rooms.get(&place[0]) {
            Some(room) => Some(room),
            None => place.get(1).map(String::as_str),
        }
    }

    /// Returns the place that a path of a file names, before anything is looked up; `None` where the path begins with
    /// something that the workspace does not have, or the file itself defines.
    pub(super) fn absolute(&self, place: &[String], path: &[String]) -> Option<Place> {
        self.absolute_within(place, path, 0)
    }

    fn absolute_within(&self, place: &[String], path: &[String], depth: usize) -> Option<Place> {
        let (first, rest) = path.split_first()?;
        let module = &self.modules[place].module;
        match first.as_str() {
            "crate" => Some([&place[..1], rest].concat()),
            "self" => Some([place, rest].concat()),
            "super" => {
                let ups = path.iter().take_while(|word| *word == "super").count();
                Some([&place[..place.len().checked_sub(ups)?], &path[ups..]].concat())
            }
            _ if module.children.contains(first) => Some([place, path].concat()),
            _ if self.modules.contains_key(std::slice::from_ref(first)) => Some(path.to_vec()),
            // A name may come from another `use` of the file; one that leads back to itself is of another crate.
            _ if depth < 8 => {
                let named = |import: &&Import| import.name == *first && import.path != path[..1];
                let import = module.imports.iter().find(named)?;
                let before = self.absolute_within(place, &import.path, depth + 1)?;
                Some([before.as_slice(), rest].concat())
            }
            _ => None,
        }
    }

    /// Returns the module that a place leads to: through what index files pass on, to the file that defines the name.
    pub(super) fn find(&self, place: &[String]) -> Target {
        self.find_within(place, 0)
    }

    fn find_within(&self, place: &[String], depth: usize) -> Target {
        let mut known = self.module_of(place).len();
        if known == 0 {
            return Target::Foreign;
        }
        // A function may have the name of the module that it is in: then the index passes the function on.
        if known == place.len() && known > 1 && self.passes_on(&place[..known - 1], &place[known - 1]) {
            known -= 1;
        }
        let (module, rest) = place.split_at(known);
        let Some(name) = rest.first() else {
            return Target::Module(module.to_vec(), module[known - 1].clone());
        };
        let source = &self.modules[module].module;
        if source.definitions.contains(name) {
            return Target::Module(module.to_vec(), name.clone());
        }
        if let Some(defined) = self.macros.get(&place[..=known]).filter(|_| known == 1) {
            return Target::Module(defined.clone(), name.clone());
        }
        let passed_on = (depth < 16).then(|| self.find_in_imports(module, rest, depth + 1)).flatten();
        match passed_on {
            Some(target) => target,
            // What a macro defines is not seen, but stands in the file that is named.
            None if !source.is_index() => Target::Module(module.to_vec(), name.clone()),
            None => Target::Nothing,
        }
    }

    /// Looks for the rest of a place in what a module brings in by `use`, by its name or with everything beside it.
    fn find_in_imports(&self, module: &[String], rest: &[String], depth: usize) -> Option<Target> {
        let (name, below) = rest.split_first()?;
        let imports = &self.modules[module].module.imports;
        if let Some(import) = imports.iter().find(|import| import.name == *name) {
            let target = self.absolute(module, &import.path);
            let found = |target: Place| self.find_within(&[target.as_slice(), below].concat(), depth);
            return Some(target.map_or(Target::Foreign, found));
        }
        let whole = imports.iter().filter(|import| import.name == "*");
        let targets = whole.filter_map(|import| self.absolute(module, &import.path));
        let mut found = targets.map(|target| self.find_within(&[target.as_slice(), rest].concat(), depth));
        found.find(|found| matches!(found, Target::Module(..)))
    }

    /// Whether an index brings in a name from deeper down.
    fn passes_on(&self, place: &[String], name: &str) -> bool {
        let deeper = |import: &Import| import.name == name && import.path.len() > 1 && import.is_passed_on;
        self.modules.get(place).is_some_and(|source| source.module.imports.iter().any(deeper))
    }
}

/// The crates: the root package and the members in `crates/`.
fn packages(files: &[(String, String)]) -> Vec<Package> {
    let package = |(path, text): &(String, String)| {
        let folder = path.strip_suffix("Cargo.toml")?.trim_end_matches('/').to_owned();
        Some(Package { folder, name: crate_name(text)? })
    };
    files.iter().filter_map(package).collect()
}

/// The name of the library, or else of the package, as paths write it.
fn crate_name(manifest: &str) -> Option<String> {
    let mut section = "";
    let mut name = None;
    for line in manifest.lines().map(str::trim) {
        if line.starts_with('[') {
            section = line;
        }
        let value = line.split_once('=').filter(|(key, _)| key.trim() == "name").map(|(_, value)| value);
        match (section, value) {
            ("[lib]", Some(value)) => name = Some(value),
            ("[package]", Some(value)) => name = name.or(Some(value)),
            _ => {}
        }
    }
    name.map(|name| name.trim().trim_matches('"').replace('-', "_"))
}

/// The place of a file of Rust by its path in `src`.
fn place(name: &str, path: &str) -> Option<Place> {
    let path = path.strip_suffix(".rs")?;
    let path = path.strip_suffix("/mod").unwrap_or(path);
    let below = path.split('/').filter(|_| !matches!(path, "lib" | "main"));
    Some(std::iter::once(name).chain(below).map(str::to_owned).collect())
}
