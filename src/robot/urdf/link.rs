//! `<link>`: its name; what else it holds matters to kinematics only as a note.

use std::collections::HashMap;

use roxmltree::Node;

use super::element::{self, Known};
use super::{MAX_JOINTS, UrdfOptions, number};
use crate::robot::Defect;
use crate::robot::names::{LONGEST_NAME, quote};
use crate::robot::report::Report;

/// The shapes that a `<geometry>` may hold.
const SHAPES: [&str; 5] = ["box", "cylinder", "capsule", "sphere", "mesh"];

/// A link as the file names it.
pub(super) struct RawLink {
    pub(super) name: String,
    pub(super) offset: usize,
    pub(super) defect: Option<Defect>,
}

/// Reads all links; `None` when there are too many.
pub(super) fn read_links(
    root: Node<'_, '_>,
    options: &UrdfOptions,
    report: &mut Report<'_>,
) -> Option<Vec<RawLink>> {
    let count = element::children_named(root, "link").count();
    // A tree has one link more than it has joints.
    if count > MAX_JOINTS + 1 {
        let cause = format!("the robot has {count} links, more than the {} that are read", MAX_JOINTS + 1);
        report.error(element::offset(root), cause);
        return None;
    }
    let mut links: Vec<RawLink> = Vec::new();
    let mut by_name: HashMap<String, usize> = HashMap::new();
    let mut without_inertia = Vec::new();
    for node in element::children_named(root, "link") {
        let place = element::offset(node);
        for (at, cause) in element::check_attributes(node, Known::LINK, options.strict, report) {
            report.error(at, cause);
        }
        let name = match name_of(node) {
            Ok(name) => name,
            Err(cause) => {
                report.error(place, format!("a link {cause}"));
                continue;
            }
        };
        check_inertia(node, name, report, &mut without_inertia);
        check_geometry(node, name, report);
        if let Some(&first) = by_name.get(name) {
            let line = report.line(links[first].offset);
            let cause = format!("the name is used twice, first on line {line}; every link needs its own");
            report.error(place, format!("link {}: {cause}", quote(name)));
            links[first].defect.get_or_insert(report.defect(place, cause));
            continue;
        }
        by_name.insert(name.to_owned(), links.len());
        links.push(RawLink { name: name.to_owned(), offset: place, defect: None });
    }
    note_missing_inertia(&without_inertia, report);
    Some(links)
}

/// Returns the `name` of a link or joint, or what is wrong with it.
pub(super) fn name_of<'a>(node: Node<'a, '_>) -> Result<&'a str, String> {
    match element::attribute(node, "name").map(|attribute| attribute.value()) {
        None => Err("has no name; add `name=\"...\"`".to_owned()),
        Some(name) if name.trim().is_empty() => Err("has an empty name".to_owned()),
        Some(name) if name.len() > LONGEST_NAME => {
            let length = name.len();
            Err(format!("has a name of {length} bytes, more than the {LONGEST_NAME} that are read"))
        }
        Some(name) => Ok(name),
    }
}

fn check_inertia(node: Node<'_, '_>, name: &str, report: &mut Report<'_>, without: &mut Vec<usize>) {
    let Some(inertial) = element::children_named(node, "inertial").next() else {
        without.push(element::offset(node));
        return;
    };
    let mass = element::children_named(inertial, "mass").find_map(|mass| element::attribute(mass, "value"));
    if let Some(mass) = mass
        && number::number(mass.value()).is_ok_and(|value| value < 0.0)
    {
        let cause =
            format!("link {}: mass {} is negative; kinematics ignores it", quote(name), quote(mass.value()));
        report.note(mass.range().start, cause);
    }
}

fn note_missing_inertia(without: &[usize], report: &mut Report<'_>) {
    if let Some(&first) = without.first() {
        let links = if without.len() == 1 {
            "1 link has".to_owned()
        } else {
            format!("{} links have", without.len())
        };
        report.note(first, format!("{links} no `<inertial>`; kinematics does not need it"));
    }
}

fn check_geometry(node: Node<'_, '_>, name: &str, report: &mut Report<'_>) {
    let parts =
        element::children(node).filter(|part| matches!(part.tag_name().name(), "visual" | "collision"));
    for part in parts {
        let what = part.tag_name().name();
        let geometry = element::children_named(part, "geometry").next();
        let place = element::offset(geometry.unwrap_or(part));
        let shape = geometry.and_then(|geometry| element::children(geometry).next());
        let (cause, remedy) = match (geometry, shape.map(|shape| shape.tag_name().name())) {
            (None, _) => ("has no `<geometry>`".to_owned(), String::new()),
            (Some(_), None) => ("has an empty `<geometry>`".to_owned(), String::new()),
            (Some(_), Some(shape)) if SHAPES.contains(&shape) => continue,
            (Some(_), Some(shape)) => {
                (format!("has the unknown shape {}", quote(shape)), report.suggestion(shape, SHAPES))
            }
        };
        let cause = format!("link {}: its `<{what}>` {cause}, which kinematics ignores{remedy}", quote(name));
        report.warning(place, cause);
    }
}
