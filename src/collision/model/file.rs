//! Files of capsules: links, their capsules and spheres, and pairs that are not checked.

use std::path::Path;

use nalgebra::Vector3;

use super::{CollisionError, CollisionModel};
use crate::collision::{Capsule, ShapeError};
use crate::robot::names::{quote, short_list};
use crate::robot::{Entries, Report, Robot, embedded, read_toml, wrong_type};

const KEYS: [&str; 3] = ["capsule", "sphere", "allowed"];
const CAPSULE: [&str; 4] = ["link", "from", "to", "radius"];
const SPHERE: [&str; 3] = ["link", "center", "radius"];
const ALLOWED: [&str; 2] = ["links", "reason"];

impl CollisionModel {
    /// Returns the model that a file of capsules describes: `[[capsule]]` with `link`, `from`, `to` \[m\] and `radius` \[m\];
    /// `[[sphere]]` with `link`, `center` and `radius`, both in the link's own axes; `[[allowed]]` with `links`, two that are
    /// not checked against each other, and `reason`.
    ///
    /// ```
    /// use kinstep::collision::CollisionModel;
    /// use kinstep::robot::embedded;
    /// let model = CollisionModel::from_toml(
    ///     &embedded::get("planar4")?,
    ///     r#"
    ///     [[capsule]]
    ///     link = "link1"
    ///     from = [0, 0, 0]
    ///     to = [1, 0, 0]
    ///     radius = 0.05
    ///     "#,
    /// )?;
    /// assert_eq!(model.capsules().len(), 1);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`CollisionError::Text`] with everything that is wrong, by place.
    pub fn from_toml(robot: &Robot, text: &str) -> Result<CollisionModel, CollisionError> {
        let (model, found) = read_toml(text, |file, report| read(robot, file, report));
        model.ok_or(CollisionError::Text(found))
    }

    /// Returns the model that a file describes, as [`CollisionModel::from_toml`] reads its text.
    ///
    /// # Errors
    /// [`CollisionError`]: the file can not be read, or is wrong.
    pub fn from_file(robot: &Robot, path: &Path) -> Result<CollisionModel, CollisionError> {
        let text = std::fs::read_to_string(path).map_err(|error| {
            let is_lost = error.kind() == std::io::ErrorKind::NotFound;
            let hint = if is_lost { crate::robot::nearby::whereabouts(path) } else { String::new() };
            let reason = if is_lost { "there is no such file".to_owned() } else { error.to_string() };
            CollisionError::File { path: path.to_owned(), reason: reason + &hint }
        })?;
        CollisionModel::from_toml(robot, &text)
    }

    /// Returns the capsules that come with an embedded robot, conservative ones whose source is in `robots/SOURCES.md`.
    ///
    /// # Errors
    /// [`CollisionError::NoCapsules`] where none do.
    pub fn embedded(name: &str) -> Result<CollisionModel, CollisionError> {
        let none = || CollisionError::NoCapsules { name: name.to_owned() };
        let robot = embedded::get(name).map_err(|_| none())?;
        CollisionModel::from_toml(&robot, embedded::collision_text(name).ok_or_else(none)?)
    }
}

fn read(robot: &Robot, file: &Entries<'_, '_>, report: &mut Report<'_>) -> Option<CollisionModel> {
    file.check_keys("a file of capsules", &KEYS, report);
    if file.table.is_empty() {
        report.error(0, "there is nothing in this file: write [[capsule]] with link, from, to and radius");
        return None;
    }
    let mut model = CollisionModel::new(robot);
    for (entry, kind) in ["capsule", "sphere"]
        .into_iter()
        .flat_map(|kind| entries(file, kind, report).into_iter().map(move |entry| (entry, kind)))
        .collect::<Vec<_>>()
    {
        if let (Some(link), Some(capsule)) = (link(robot, &entry, report), capsule(&entry, kind, report)) {
            model = model.with_capsule(link, capsule).ok()?;
        }
    }
    for entry in entries(file, "allowed", report) {
        if let Some([one, other]) = pair(robot, &entry, report) {
            model = model.with_allowed(&one, &other).ok()?;
        }
    }
    Some(model)
}

/// The tables of a list.
fn entries<'a, 'i>(file: &Entries<'a, 'i>, kind: &str, report: &mut Report<'_>) -> Vec<Entries<'a, 'i>> {
    let Some(value) = file.value(kind) else { return Vec::new() };
    let Some(list) = value.get_ref().as_array() else {
        wrong_type(kind, &format!("a list of tables, each begun by a line [[{kind}]]"), value, report);
        return Vec::new();
    };
    let mut entries = Vec::new();
    for entry in list {
        match entry.get_ref().as_table() {
            Some(table) => entries.push(Entries { table, offset: entry.span().start }),
            None => wrong_type(kind, "tables", entry, report),
        }
    }
    entries
}

/// The capsule of an entry, from a segment or from a centre.
fn capsule(entry: &Entries<'_, '_>, kind: &str, report: &mut Report<'_>) -> Option<Capsule> {
    let known: &[&str] = if kind == "sphere" { &SPHERE } else { &CAPSULE };
    entry.check_keys(&format!("a {kind}"), known, report);
    let mut is_whole = true;
    for key in known.iter().filter(|key| **key != "link" && entry.value(key).is_none()) {
        report.error(entry.offset, format!("a {kind} needs `{key}`: it has {}", short_list(known, "and")));
        is_whole = false;
    }
    let radius = entry.number("radius", report);
    let mut point = |key: &str| Vector3::from(entry.vector(key, report));
    let made: Result<Capsule, ShapeError> = if kind == "sphere" {
        Capsule::sphere(point("center"), radius)
    } else {
        Capsule::new(point("from"), point("to"), radius)
    };
    match made {
        Ok(capsule) => is_whole.then_some(capsule),
        Err(error) => {
            report.error(entry.place("radius"), error.to_string());
            None
        }
    }
}

fn link<'a>(robot: &Robot, entry: &Entries<'a, '_>, report: &mut Report<'_>) -> Option<&'a str> {
    if entry.value("link").is_none() {
        report.error(entry.offset, "the key `link` is missing: it names the link that the shape stands for");
        return None;
    }
    let name = entry.text("link", report)?;
    known(robot, name, entry.place("link"), report).then_some(name)
}

/// Whether the robot has a link; reported where not.
fn known(robot: &Robot, name: &str, place: usize, report: &mut Report<'_>) -> bool {
    if robot.link(name).is_some() {
        return true;
    }
    let all: Vec<&str> = robot.links().iter().map(|link| link.name.as_str()).collect();
    let suggestion = report.suggestion(name, all.iter().copied());
    let hint = if suggestion.is_empty() {
        format!("; its links are {}", short_list(&all, "and"))
    } else {
        suggestion
    };
    report.error(place, format!("the robot has no link {}{hint}", quote(name)));
    false
}

fn pair(robot: &Robot, entry: &Entries<'_, '_>, report: &mut Report<'_>) -> Option<[String; 2]> {
    entry.check_keys("an allowed pair", &ALLOWED, report);
    let _ = entry.text("reason", report);
    let names: Option<Vec<&str>> = entry
        .value("links")
        .and_then(|value| value.get_ref().as_array())
        .and_then(|names| names.iter().map(|name| name.get_ref().as_str()).collect());
    let Some([one, other]) = names.as_deref() else {
        let cause = "`links`: expected the names of two links, such as [\"link3\", \"link5\"]";
        report.error(entry.place("links"), cause);
        return None;
    };
    let place = entry.place("links");
    let are_known = [one, other].map(|name| known(robot, name, place, report));
    if one == other {
        report.error(place, format!("`links` names {} twice; a pair has two links", quote(one)));
        return None;
    }
    are_known.into_iter().all(|known| known).then(|| [(*one).to_owned(), (*other).to_owned()])
}
