//! `<joint>`, strictly: every finding kept with its place, and what is sound written down for urdf-rs.

use std::fmt::Write;

use nalgebra::{Quaternion, UnitQuaternion};
use roxmltree::{Attribute, Node};

use super::element::{self, Known};
use super::limit;
use super::link::name_of;
use super::raw_joint::{RawJoint, Reference};
use super::reader::Reader;
use super::version::Version;
use super::{MAX_JOINTS, UrdfOptions, number};
use crate::math::number_text;
use crate::robot::names::{list, quote};
use crate::robot::report::Report;
use crate::robot::{JointKind, degrees_suspected, millimetres_suspected};

/// How far a vector's length may be from one before that is worth a note.
const UNIT_TOLERANCE: f64 = 1e-3;

/// The child elements that URDF gives a joint.
const CHILDREN: [&str; 9] =
    ["origin", "parent", "child", "axis", "limit", "mimic", "calibration", "dynamics", "safety_controller"];

/// Reads all joints; `None` when there are too many.
pub(super) fn read_joints(
    root: Node<'_, '_>,
    version: Version,
    options: &UrdfOptions,
    report: &mut Report<'_>,
) -> Option<Vec<RawJoint>> {
    let count = element::children_named(root, "joint").count();
    if count > MAX_JOINTS {
        let cause = format!("the robot has {count} joints, more than the {MAX_JOINTS} that are read");
        report.error(element::offset(root), cause);
        return None;
    }
    let joints = element::children_named(root, "joint");
    Some(joints.map(|node| Reader::new(node, version, options, report).read()).collect())
}

impl<'a, 'i> Reader<'_, 'a, 'i, '_> {
    fn read(mut self) -> RawJoint {
        match name_of(self.node) {
            Ok(name) => name.clone_into(&mut self.joint.name),
            Err(cause) => self.fail(self.joint.offset, format!("it {cause}")),
        }
        self.known_attributes(self.node, Known::JOINT);
        self.misspelt_children();
        self.joint.kind = self.kind();
        self.joint.parent = self.link(Known::PARENT);
        self.joint.child = self.link(Known::CHILD);
        self.origin();
        self.axis();
        limit::read(&mut self);
        limit::note_soft_limits(&mut self);
        self.mimic();
        if matches!(self.joint.kind, Some(JointKind::Floating | JointKind::Planar | JointKind::Spherical)) {
            let kind = self.joint.kind.map_or("", JointKind::as_str);
            self.note(
                self.joint.offset,
                &format!("it is {kind}: no chain can pass through it, unless it is locked"),
            );
        }
        self.joint
    }

    fn misspelt_children(&mut self) {
        for child in element::children(self.node) {
            let name = child.tag_name().name();
            if CHILDREN.contains(&name) {
                continue;
            }
            let absent = |known: &&str| element::children_named(self.node, known).next().is_none();
            let meant =
                CHILDREN.into_iter().filter(absent).find(|known| element::is_misspelling(name, known));
            if let Some(meant) = meant {
                let cause = format!("{} is no element of a joint; did you mean `<{meant}>`?", quote(name));
                self.fail(element::offset(child), cause);
            }
        }
    }

    fn kind(&mut self) -> Option<JointKind> {
        let Some(attribute) = element::attribute(self.node, "type") else {
            self.fail(self.joint.offset, format!("it has no type; the types are {}", kinds()));
            return None;
        };
        let name = attribute.value();
        let kind = JointKind::ALL.into_iter().find(|kind| kind.as_str() == name);
        if kind.is_none() {
            let suggestion = self.report.suggestion(name, JointKind::ALL.map(JointKind::as_str));
            let cause =
                format!("{} is not a joint type{suggestion} (the types are {})", quote(name), kinds());
            self.fail(attribute.range().start, cause);
        }
        kind
    }

    fn link(&mut self, known: Known) -> Option<Reference> {
        let mut found = element::children_named(self.node, known.element);
        let (first, second) = (found.next(), found.next());
        let Some(first) = first else {
            self.fail(self.joint.offset, format!("it has no `<{} link=\"...\"/>`", known.element));
            return None;
        };
        if let Some(second) = second {
            let line = self.report.line(element::offset(first));
            let cause = format!(
                "it has two `<{}>` elements, the first on line {line}; a joint has one",
                known.element
            );
            self.fail(element::offset(second), cause);
        }
        self.known_attributes(first, known);
        let place = element::offset(first);
        match element::attribute(first, "link").map(|attribute| attribute.value()) {
            None => {
                self.fail(place, format!("its `<{}>` names no link; write `link=\"...\"`", known.element));
            }
            Some(name) if name.trim().is_empty() => {
                self.fail(place, format!("its `<{}>` has an empty link name", known.element));
            }
            Some(name) => return Some(Reference { name: name.to_owned(), offset: place }),
        }
        None
    }

    fn origin(&mut self) {
        let Some(node) = self.child(Known::ORIGIN) else { return };
        let xyz = element::attribute(node, "xyz").and_then(|xyz| self.sizes("origin", &xyz));
        let rpy = element::attribute(node, "rpy");
        let quaternion = element::attribute(node, "quat_xyzw");
        match (rpy, quaternion) {
            (Some(_), Some(quaternion)) if self.version >= Version::V1_1 => {
                let cause = "its `<origin>` has both `rpy` and `quat_xyzw`; keep one of them";
                self.fail(quaternion.range().start, cause);
            }
            (None, Some(quaternion)) if self.version >= Version::V1_1 => self.quaternion(&quaternion),
            (_, Some(quaternion)) => {
                let cause =
                    "`quat_xyzw` is ignored before URDF 1.1; declare `<robot version=\"1.1\">` to use it";
                self.warn(quaternion.range().start, cause);
            }
            (_, None) => {}
        }
        let rpy = rpy.and_then(|rpy| self.sizes("origin", &rpy));
        let numbers =
            |text: &Option<String>| number::vector::<3>(text.as_deref().unwrap_or("")).unwrap_or_default();
        let doubts =
            [("rpy", degrees_suspected(&numbers(&rpy))), ("xyz", millimetres_suspected(&numbers(&xyz)))];
        for (name, doubt) in doubts.into_iter().filter_map(|(name, doubt)| Some((name, doubt?))) {
            let place =
                element::attribute(node, name).map_or(element::offset(node), |found| found.range().start);
            self.warn(place, &format!("`{name}` of `<origin>`: {doubt}"));
        }
        let xyz = xyz.unwrap_or_else(|| "0 0 0".to_owned());
        let rpy = rpy.unwrap_or_else(|| "0 0 0".to_owned());
        let _ = write!(self.joint.values, "<origin xyz=\"{xyz}\" rpy=\"{rpy}\"/>");
    }

    fn quaternion(&mut self, attribute: &Attribute<'a, 'i>) {
        let place = attribute.range().start;
        let [x, y, z, w] = match number::vector::<4>(attribute.value()) {
            Ok(values) => values,
            Err(cause) => return self.fail(place, format!("`quat_xyzw` of `<origin>`: {cause}")),
        };
        let length = x.hypot(y).hypot(z.hypot(w));
        if length == 0.0 || !length.is_finite() {
            return self.fail(place, "`quat_xyzw` of `<origin>` has length zero: it is no orientation");
        }
        if (length - 1.0).abs() > UNIT_TOLERANCE {
            self.note(place, &format!("`quat_xyzw` of `<origin>` has length {length}; normalised"));
        }
        let quaternion = Quaternion::new(w / length, x / length, y / length, z / length);
        self.joint.quaternion = Some(UnitQuaternion::from_quaternion(quaternion));
    }

    fn axis(&mut self) {
        let Some(node) = self.child(Known::AXIS) else { return };
        if !self.joint.is_movable() {
            return self.normal(node);
        }
        let Some(attribute) = element::attribute(node, "xyz") else {
            return self.fail(element::offset(node), "its `<axis>` has no `xyz`");
        };
        let Some(text) = self.vector::<3>("axis", &attribute) else { return };
        let place = attribute.range().start;
        let [x, y, z] = number::vector::<3>(attribute.value()).unwrap_or_default();
        let length = x.hypot(y).hypot(z);
        if length == 0.0 || !length.is_finite() {
            return self.fail(place, format!("its axis {} has no direction", quote(attribute.value())));
        }
        if (length - 1.0).abs() > UNIT_TOLERANCE {
            self.note(
                place,
                &format!(
                    "its axis {} has length {}; normalised",
                    quote(attribute.value()),
                    number_text(length)
                ),
            );
        }
        let _ = write!(self.joint.values, "<axis xyz=\"{text}\"/>");
    }

    /// The axis of a planar joint is the plane's normal. No chain needs it, so that a bad one spoils nothing.
    fn normal(&mut self, node: Node<'a, 'i>) {
        let normal = element::attribute(node, "xyz").and_then(|xyz| number::vector::<3>(xyz.value()).ok());
        if let Some([x, y, z]) = normal.filter(|_| self.joint.kind == Some(JointKind::Planar)) {
            let _ = write!(self.joint.values, "<axis xyz=\"{x:?} {y:?} {z:?}\"/>");
        }
    }

    fn mimic(&mut self) {
        let Some(node) = self.child(Known::MIMIC) else { return };
        let place = element::offset(node);
        if !self.joint.is_movable() {
            return self.note(place, "its `<mimic>` is ignored, because the joint has no single motion");
        }
        let Some(target) = element::attribute(node, "joint") else {
            return self.fail(place, "its `<mimic>` names no joint; write `joint=\"...\"`");
        };
        let multiplier = self.scalar("mimic", node, "multiplier").unwrap_or_else(|| "1".to_owned());
        let offset = self.scalar("mimic", node, "offset").unwrap_or_else(|| "0".to_owned());
        let values = format!("<mimic joint=\"driver\" multiplier=\"{multiplier}\" offset=\"{offset}\"/>");
        self.joint.values.push_str(&values);
        self.joint.mimic = Some(Reference { name: target.value().to_owned(), offset: target.range().start });
    }
}

fn kinds() -> String {
    list(&JointKind::ALL.map(JointKind::as_str), "and")
}
