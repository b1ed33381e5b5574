//! Files that are not there: from where they were looked up, and what is there instead.

use std::path::Path;

use super::names::{self, quote, shown};

/// Returns what follows "there is no file PATH" in a message: ` (looked up from FOLDER)` for a relative path, and the [hint].
pub fn whereabouts(path: &Path) -> String {
    let directory = path.is_relative().then(|| std::env::current_dir().ok()).flatten();
    let seen = directory.map(|directory| format!(" (looked up from {})", shown(&directory)));
    seen.unwrap_or_default() + &hint(path)
}

/// Returns `; did you mean ...?` with files whose names look like that of a file that is not there, or says which folder is
/// not there either; nothing where neither helps.
pub fn hint(path: &Path) -> String {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty());
    match folder {
        Some(folder) if !folder.is_dir() => {
            format!("; there is no folder {}", quote(&folder.to_string_lossy()))
        }
        _ => names::suggestion(&files_like(path, folder)),
    }
}

/// The files beside a path whose names look like it, as the path names them, nearest first.
fn files_like(path: &Path, folder: Option<&Path>) -> Vec<String> {
    /// A folder with more entries is not looked through to its end.
    const MOST: usize = 10_000;
    let Some(name) = path.file_name().map(|name| name.to_string_lossy()) else { return Vec::new() };
    let Ok(entries) = std::fs::read_dir(folder.unwrap_or(Path::new("."))) else { return Vec::new() };
    let mut there: Vec<String> =
        entries.take(MOST).flatten().map(|entry| entry.file_name().to_string_lossy().into_owned()).collect();
    // Folders come in any order.
    there.sort();
    let near = names::nearest(&name, there.iter().map(String::as_str));
    let named = |near: &str| {
        folder.map_or_else(|| near.to_owned(), |folder| folder.join(near).to_string_lossy().into_owned())
    };
    near.into_iter().map(named).collect()
}
