//! The text of a scenario: where its keys stand, and what is laid over it from outside.

use std::fs::File;
use std::io::Read;
use std::ops::Range;
use std::path::{Path, PathBuf};

use toml_edit::{Document, Item, TableLike};

use super::error::{ErrorKind, Place, ScenarioError, not_one_of, suggestion};
use super::key_path::{KeyPath, Step};
use super::kind_reader::Misread;
use super::kinds::Kinds;
use super::model::Scenario;
use super::overrides;
use kinstep::robot::names::shown;
use kinstep::robot::nearby;

/// Longest scenario file that is read [bytes].
const MAX_BYTES: u64 = 16 << 20;

/// The text of a scenario with the positions of its keys, and the values laid over it by [`ScenarioText::set`].
///
/// Positions are always those of the text as it was read, whatever is laid over it.
#[derive(Clone, Debug)]
pub struct ScenarioText {
    file: Option<PathBuf>,
    original: Document<String>,
    edited: Document<String>,
    assignments: Vec<(KeyPath, String)>,
}

impl ScenarioText {
    /// Returns the scenario in `text`.
    ///
    /// # Errors
    /// [`ScenarioError`] with its place where the text is not TOML.
    pub fn parse(text: &str) -> Result<Self, ScenarioError> {
        Self::from_text(None, text)
    }

    /// Returns the scenario in a file; other files that it names are looked for beside it.
    ///
    /// # Errors
    /// [`ScenarioError`] of kind [`ErrorKind::File`] where it can not be read, of kind
    /// [`ErrorKind::Scenario`] where it is not TOML.
    pub fn read(file: &Path) -> Result<Self, ScenarioError> {
        Self::from_text(Some(file.to_path_buf()), &read_text(file)?)
    }

    fn from_text(file: Option<PathBuf>, text: &str) -> Result<Self, ScenarioError> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        if text.trim().is_empty() {
            let message = "the scenario is empty; `kinstep schema scenario` lists its keys";
            return Err(ScenarioError::new(ErrorKind::Scenario, message).or_placed(Some(Place::of_byte(
                file.as_deref().map(display),
                text,
                0,
            ))));
        }
        let original = Document::parse(text.to_owned()).map_err(|e| {
            let place = Place::of_byte(file.as_deref().map(display), text, e.span().map_or(0, |s| s.start));
            let message = format!("not TOML: {}", e.message().trim().replace('\n', ", "));
            ScenarioError::new(ErrorKind::Scenario, message).or_placed(Some(place))
        })?;
        Ok(Self { file, edited: original.clone(), original, assignments: Vec::new() })
    }

    /// Lays a value over the text: `law.h=0.4`, `arm.left.q0=[0.1, "pi/2"]` (arms by name). The value is read as
    /// TOML and, where it is none, as text. Setting one of `law.h` and `law.gain` takes the other away.
    ///
    /// # Errors
    /// [`ScenarioError`] where there is no `=`, no such arm, or a value where a table should be. An unknown key
    /// is refused by [`ScenarioText::scenario`].
    pub fn set(&mut self, assignment: &str) -> Result<(), ScenarioError> {
        let (path, text) = overrides::apply(&self.edited, assignment)?;
        self.edited = Document::parse(text).map_err(|e| {
            let message = format!("--set {assignment}: {}", e.message().trim());
            ScenarioError::new(ErrorKind::Scenario, message)
        })?;
        self.assignments.push((path, assignment.to_owned()));
        Ok(())
    }

    /// Returns what the text says.
    ///
    /// # Errors
    /// [`ScenarioError`] for an unknown or missing key, a value of the wrong type or out of its range, with the
    /// nearest known key and the place.
    pub fn scenario(&self) -> Result<Scenario, ScenarioError> {
        self.scenario_with(&Kinds::builtin())
    }

    /// As [`ScenarioText::scenario`], with kinds of the program's own beside the built-in ones.
    ///
    /// # Errors
    /// As [`ScenarioText::scenario`].
    pub fn scenario_with(&self, kinds: &Kinds) -> Result<Scenario, ScenarioError> {
        let mut scenario: Scenario =
            toml::from_str(self.edited.raw()).map_err(|e| self.refusal(&e, kinds))?;
        let misread = scenario.read_kinds(kinds).into_iter().map(|misread| self.of_misread(misread));
        // What can not be read is told by itself, the first of it in the file.
        let position = |error: &ScenarioError| error.place.as_ref().map(|place| (place.line, place.column));
        if let Some(first) = misread.min_by_key(position) {
            return Err(first);
        }
        scenario.check_with(kinds).map_err(|e| self.placed(e))?;
        Ok(scenario)
    }

    fn of_misread(&self, misread: Misread) -> ScenarioError {
        let Misread { mut error, is_of_key } = misread;
        if is_of_key && self.assignments.is_empty() {
            let entries = entries(&self.original);
            let entry = entries.iter().find(|entry| Some(&entry.path) == error.path.as_ref());
            let key = entry.and_then(|entry| entry.key.as_ref());
            error.place = key.map(|key| Box::new(self.place_of_byte(key.start)));
        }
        self.placed(error)
    }

    /// Returns the text with everything that was laid over it.
    pub fn raw(&self) -> &str {
        self.edited.raw()
    }

    /// Returns the folder that paths in the scenario are relative to.
    pub fn folder(&self) -> Option<&Path> {
        self.file.as_deref().and_then(Path::parent)
    }

    /// Returns the file that the text was read from.
    pub fn file(&self) -> Option<&Path> {
        self.file.as_deref()
    }

    /// Returns the error with the place of the key that it is about, or with the assignment that set it.
    #[must_use]
    pub fn placed(&self, mut error: ScenarioError) -> ScenarioError {
        error.also = std::mem::take(&mut error.also).into_iter().map(|other| self.placed(other)).collect();
        if error.place.is_some() {
            return error;
        }
        let Some(path) = error.path.clone() else { return error };
        let mut assignments = self.assignments.iter().rev();
        if let Some((_, assignment)) = assignments.find(|(set, _)| set.contains(&path) || path.contains(set))
        {
            error.message = format!("{} (--set {assignment})", error.message);
            return error;
        }
        let column = error.column.map(|column| column.get() as usize);
        let place = self.place(&path).map(|place| within(place, column));
        error.or_placed(place)
    }

    /// Returns where the value at `path` stands, or the nearest table around it.
    pub fn place(&self, path: &KeyPath) -> Option<Place> {
        let entries = entries(&self.original);
        let mut path = Some(path.clone());
        while let Some(current) = path {
            if let Some(entry) = entries.iter().find(|entry| entry.path == current) {
                let start = entry.value.as_ref().or(entry.key.as_ref())?.start;
                return Some(self.place_of_byte(start));
            }
            path = current.parent();
        }
        None
    }

    fn place_of_byte(&self, byte: usize) -> Place {
        Place::of_byte(self.file.as_deref().map(display), self.original.raw(), byte)
    }

    /// Returns the words that may stand at `path`, found out by what is said to a word that is none.
    fn words_at(&self, path: &KeyPath) -> Option<String> {
        let (_, text) = overrides::apply(&self.edited, &format!("{path}=\"\"")).ok()?;
        let error = toml::from_str::<Scenario>(&text).err()?;
        let known: Vec<&str> = error.message().split('`').skip(3).step_by(2).collect();
        Some(known.join(", ")).filter(|known| !known.is_empty())
    }

    fn refusal(&self, error: &toml::de::Error, kinds: &Kinds) -> ScenarioError {
        let span = error.span().unwrap_or(0..0);
        let entries = entries(&self.edited);
        let (path, on_key) = path_at(&entries, &span);
        let said = error.message().trim();
        let quoted: Vec<&str> = said.split('`').skip(1).step_by(2).collect();
        let (path, problem) = match quoted.split_first() {
            Some((key, known)) if said.starts_with("unknown field") => {
                let path = if on_key { path } else { path.key(key) };
                (path, format!("there is no such key; {}", suggestion(key, known.iter().copied())))
            }
            Some((key, _)) if said.starts_with("missing field") => {
                // The span is that of the table; for the scenario as a whole it is empty.
                let inside = entries.iter().any(|entry| entry.value.as_ref() == Some(&span));
                let table = if inside { path } else { KeyPath::default() };
                (table.key(key), "this key is missing".to_owned())
            }
            Some((value, known)) if said.starts_with("unknown variant") => {
                (path, format!("\"{value}\" is {}", not_one_of(value, known)))
            }
            _ if said.starts_with("invalid type") && kinds.names_at(&path).is_some() => {
                let names = kinds.names_at(&path).unwrap_or_default();
                (path, format!("expected one of {}", names.join(", ")))
            }
            _ if said.starts_with("wanted ") => {
                let problem =
                    self.words_at(&path).map_or(said.to_owned(), |words| format!("expected one of {words}"));
                (path, problem)
            }
            _ => (path, in_terms_of_toml(said)),
        };
        let mut refusal = ScenarioError::at(ErrorKind::Scenario, &path, problem);
        if self.assignments.is_empty() {
            refusal.place = Some(Box::new(self.place_of_byte(span.start)));
        }
        self.placed(refusal)
    }
}

/// The place of a character of a text that begins, with its quote, at `place`. A text with escapes or of several lines is pointed at as a whole.
fn within(mut place: Place, column: Option<usize>) -> Place {
    let inside: Vec<char> = place.source_line.chars().skip(place.column).take(column.unwrap_or(0)).collect();
    if column.is_some_and(|column| inside.len() == column) && !inside.iter().any(|c| matches!(c, '\\' | '"'))
    {
        place.column += inside.len();
    }
    place
}

/// Returns what the reader said, in the words of people who write TOML.
fn in_terms_of_toml(said: &str) -> String {
    said.replace("invalid type: sequence", "invalid type: list")
        .replace("invalid type: map", "invalid type: table")
        .replace("expected a sequence", "expected a list")
}

/// One key of a scenario and where it stands.
struct Entry {
    path: KeyPath,
    key: Option<Range<usize>>,
    value: Option<Range<usize>>,
}

fn entries(document: &Document<String>) -> Vec<Entry> {
    let mut found = Vec::new();
    collect_table(document.as_table(), &KeyPath::default(), &mut found);
    found
}

fn collect_table(table: &dyn TableLike, path: &KeyPath, found: &mut Vec<Entry>) {
    for (key, item) in table.iter() {
        // The other name of that key.
        let is_alias = key == "task" && *path == KeyPath::default();
        let path = path.key(if is_alias { "relation" } else { key });
        let key = table.get_key_value(key).and_then(|(key, _)| key.span());
        found.push(Entry { path: path.clone(), key, value: item.span() });
        collect_item(item, &path, found);
    }
}

fn collect_item(item: &Item, path: &KeyPath, found: &mut Vec<Entry>) {
    if let Some(table) = item.as_table_like() {
        collect_table(table, path, found);
    } else if let Some(tables) = item.as_array_of_tables() {
        for (index, table) in tables.iter().enumerate() {
            collect_element(table, table.span().as_ref(), path, index, found);
        }
    } else if let Some(array) = item.as_array() {
        for (index, value) in array.iter().enumerate() {
            match value.as_inline_table() {
                Some(table) => collect_element(table, value.span().as_ref(), path, index, found),
                None => found.push(Entry { path: path.index(index), key: None, value: value.span() }),
            }
        }
    }
}

/// A table of an array is found by its name, the way people speak of arms, and by its place.
fn collect_element(
    table: &dyn TableLike,
    span: Option<&Range<usize>>,
    path: &KeyPath,
    index: usize,
    found: &mut Vec<Entry>,
) {
    let name = table.get("name").and_then(Item::as_str).filter(|name| !name.is_empty());
    for path in name.map(|name| path.key(name)).into_iter().chain([path.index(index)]) {
        found.push(Entry { path: path.clone(), key: None, value: span.cloned() });
        collect_table(table, &path, found);
    }
}

/// Returns the innermost key whose text holds the span, and whether the span lies on the key rather than the value.
fn path_at(entries: &[Entry], span: &Range<usize>) -> (KeyPath, bool) {
    let holds = |range: &Option<Range<usize>>| {
        range.as_ref().filter(|r| r.start <= span.start && span.end <= r.end).map(|r| r.end - r.start)
    };
    let candidates = entries.iter().flat_map(|entry| {
        [(holds(&entry.key), entry, true), (holds(&entry.value), entry, false)]
            .into_iter()
            .filter_map(|(length, entry, on_key)| length.map(|length| (length, entry, on_key)))
    });
    // Of equal spans (an array of tables and its first table) the longer path is the inner one; of two paths of one
    // length the name stands before the place.
    let best =
        candidates.min_by_key(|(length, entry, _)| (*length, std::cmp::Reverse(entry.path.steps().len())));
    best.map_or_else(Default::default, |(_, entry, on_key)| (entry.path.clone(), on_key))
}

/// Returns the text of a file of at most as many bytes as a robot's file may have.
///
/// # Errors
/// [`ScenarioError`] with the file's name and a sentence for what stands in the way: no such file (and one whose name is
/// near), no permission, a folder, too large, no UTF-8.
pub fn read_text(file: &Path) -> Result<String, ScenarioError> {
    let refuse = |problem: String| ScenarioError::of_file(file, format!("{}: {problem}", shown(file)));
    let unreadable = |e: &std::io::Error| {
        refuse(match e.kind() {
            std::io::ErrorKind::NotFound => format!("there is no such file{}", nearby::whereabouts(file)),
            std::io::ErrorKind::PermissionDenied => "permission to read it is denied".to_owned(),
            std::io::ErrorKind::IsADirectory => "this is a folder, not a file".to_owned(),
            _ => format!("it can not be read: {e}"),
        })
    };
    let bytes = read_bounded(file, MAX_BYTES).map_err(|e| unreadable(&e))?;
    let bytes = bytes
        .ok_or_else(|| refuse(format!("more than {MAX_BYTES} bytes, which is no file that people write")))?;
    String::from_utf8(bytes).map_err(|e| {
        refuse(format!("byte {} is not UTF-8; save the file as UTF-8", e.utf8_error().valid_up_to() + 1))
    })
}

/// Returns the bytes of a file, or nothing where there are more than `most`; a device without end is no danger.
pub(super) fn read_bounded(file: &Path, most: u64) -> std::io::Result<Option<Vec<u8>>> {
    let mut bytes = Vec::new();
    File::open(file)?.take(most + 1).read_to_end(&mut bytes)?;
    Ok(Some(bytes).filter(|bytes| bytes.len() as u64 <= most))
}

fn display(file: &Path) -> String {
    file.display().to_string()
}

impl Step {
    /// Returns the key, or nothing for a place in an array.
    pub(super) fn as_key(&self) -> Option<&str> {
        match self {
            Self::Key(key) => Some(key),
            Self::Index(_) => None,
        }
    }
}
