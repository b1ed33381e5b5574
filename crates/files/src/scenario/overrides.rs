//! Values laid over a scenario from outside: `arm.left.path.radius=0.1`.

use toml_edit::{Document, InlineTable, Item, Key, TableLike, Value};

use super::error::{ErrorKind, ScenarioError, suggestion};
use super::key_path::KeyPath;

/// Two keys of which a scenario may have one: setting either takes the other away.
const EXCLUSIVE: [(&str, &str); 2] = [("law.h", "law.gain"), ("law.gain", "law.h")];

/// Returns the path that an assignment sets, and the document's text with the value in its place.
pub(super) fn apply(
    document: &Document<String>,
    assignment: &str,
) -> Result<(KeyPath, String), ScenarioError> {
    let refuse =
        |problem: String| ScenarioError::new(ErrorKind::Scenario, format!("--set {assignment}: {problem}"));
    let (target, value) = assignment
        .split_once('=')
        .ok_or_else(|| refuse("write key.path=value, for example law.h=0.4".to_owned()))?;
    let (target, entry) = split_entry(target.trim());
    let keys = Key::parse(target)
        .map_err(|_| refuse(format!("\"{target}\" is not a key path such as arm.left.q0")))?;
    let path = keys.iter().fold(KeyPath::default(), |path, key| path.key(key.get()));
    let value = value.trim().parse::<Value>().unwrap_or_else(|_| Value::from(value.trim()));

    let mut edited = document.clone().into_mut();
    let dotted = path.to_string();
    if let Some((_, other)) = EXCLUSIVE.iter().find(|(set, _)| *set == dotted) {
        remove(edited.as_table_mut(), other);
    }
    insert(edited.as_table_mut(), &path, entry, value).map_err(refuse)?;
    let path = entry.map_or_else(|| path.clone(), |entry| path.index(entry));
    Ok((path, edited.to_string()))
}

/// Splits `arm.left.q0[2]` into the list and the place in it.
fn split_entry(target: &str) -> (&str, Option<usize>) {
    let inside = target.strip_suffix(']').and_then(|rest| rest.rsplit_once('['));
    match inside.and_then(|(list, place)| Some((list, place.trim().parse().ok()?))) {
        Some((list, place)) => (list, Some(place)),
        None => (target, None),
    }
}

/// Replaces one entry of a list.
fn replace_entry(item: Option<&mut Item>, place: usize, value: Value) -> Result<(), String> {
    let list = item.and_then(Item::as_array_mut).ok_or("there is no such list, so it has no entries")?;
    let entries = list.len();
    let entry = list.get_mut(place);
    *entry.ok_or_else(|| format!("the list has {entries} entries, counted from 0"))? = value;
    Ok(())
}

fn remove(table: &mut dyn TableLike, dotted: &str) {
    if let Some((outer, inner)) = dotted.split_once('.') {
        if let Some(table) = table.get_mut(outer).and_then(Item::as_table_like_mut) {
            remove(table, inner);
        }
    } else {
        table.remove(dotted);
    }
}

fn insert(
    root: &mut dyn TableLike,
    path: &KeyPath,
    entry: Option<usize>,
    value: Value,
) -> Result<(), String> {
    let keys: Vec<&str> = path.steps().iter().filter_map(super::key_path::Step::as_key).collect();
    let Some((last, outer)) = keys.split_last() else { return Err("the key path is empty".to_owned()) };
    let mut table = root;
    let mut reached = KeyPath::default();
    let mut outer = outer.iter();
    while let Some(key) = outer.next() {
        reached = reached.key(key);
        let item = table.entry(key).or_insert_with(|| Item::Value(InlineTable::new().into()));
        table = if item.is_array() || item.is_array_of_tables() {
            let Some(name) = outer.next() else { return replaced_whole(&reached, last, item, value) };
            reached = reached.key(name);
            element(item, name)?
        } else {
            item.as_table_like_mut().ok_or_else(|| format!("{reached} is a value, it has no keys inside"))?
        };
    }
    if let Some(place) = entry {
        return replace_entry(table.get_mut(last), place, value);
    }
    if let Some(item) = table.get_mut(last) {
        *item = Item::Value(value);
    } else {
        table.insert(last, Item::Value(value));
    }
    Ok(())
}

/// `arm.left=...` would replace an arm as a whole, which a value on a command line is too small for.
fn replaced_whole(reached: &KeyPath, last: &str, item: &mut Item, _: Value) -> Result<(), String> {
    element(item, last)?;
    Err(format!("name a key of {reached}.{last}, for example {reached}.{last}.q0"))
}

fn element<'a>(item: &'a mut Item, name: &str) -> Result<&'a mut dyn TableLike, String> {
    let named = |table: &dyn TableLike| table.get("name").and_then(Item::as_str).map(str::to_owned);
    let names: Vec<Option<String>> = match (item.as_array_of_tables(), item.as_array()) {
        (Some(tables), _) => tables.iter().map(|t| named(t)).collect(),
        (_, Some(array)) => array.iter().map(|v| v.as_inline_table().and_then(|t| named(t))).collect(),
        _ => Vec::new(),
    };
    let Some(index) = names.iter().position(|n| n.as_deref() == Some(name)) else {
        let hint = suggestion(name, names.iter().flatten().map(String::as_str));
        return Err(format!("there is no arm \"{name}\"; {hint}"));
    };
    let table: Option<&mut dyn TableLike> = match item {
        Item::ArrayOfTables(tables) => tables.get_mut(index).map(|t| t as &mut dyn TableLike),
        Item::Value(Value::Array(array)) => {
            array.get_mut(index).and_then(Value::as_inline_table_mut).map(|t| t as &mut dyn TableLike)
        }
        _ => None,
    };
    table.ok_or_else(|| format!("\"{name}\" is not a table"))
}
