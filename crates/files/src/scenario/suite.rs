//! The initial value problems that come with the library: the files of `problems/`, by name.

use include_dir::{Dir, include_dir};

static PROBLEMS: Dir<'_> = include_dir!("$CARGO_MANIFEST_DIR/../../problems");

/// Returns the names of the embedded problems, in alphabetical order.
pub fn names() -> Vec<&'static str> {
    let mut names: Vec<&str> = files().map(|(name, _)| name).collect();
    names.sort_unstable();
    names
}

/// Returns the scenario text of the problem of that name.
pub fn text(name: &str) -> Option<&'static str> {
    files().find(|(known, _)| *known == name).map(|(_, text)| text)
}

fn files() -> impl Iterator<Item = (&'static str, &'static str)> {
    PROBLEMS.files().filter_map(|file| {
        let path = file.path();
        let name = path.file_stem()?.to_str()?;
        (path.extension()? == "toml").then(|| file.contents_utf8().map(|text| (name, text)))?
    })
}
