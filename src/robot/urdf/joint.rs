//! `<joint>`, strictly: every finding kept with its place, and what is sound written down for urdf-rs.

use std::fmt::Write;

use nalgebra::{Quaternion, UnitQuaternion};
use roxmltree::{Attribute, Node};

use super::document::Version;
use super::element::{self, Known};
use super::limit;
use super::link::name_of;
use super::report::Report;
use super::{MAX_JOINTS, UrdfOptions, number};
use crate::math::number_text;
use crate::robot::names::{list, quote};
use crate::robot::{Defect, JointKind, unbelievable};

/// How far a vector's length may be from one before that is worth a note.
const UNIT_TOLERANCE: f64 = 1e-3;

/// The child elements that URDF gives a joint.
const CHILDREN: [&str; 9] =
    ["origin", "parent", "child", "axis", "limit", "mimic", "calibration", "dynamics", "safety_controller"];

/// A name that the file uses, and where.
pub(super) struct Reference {
    pub(super) name: String,
    pub(super) offset: usize,
}

/// A joint as the file gives it.
pub(super) struct RawJoint {
    /// Empty when the file gives none.
    pub(super) name: String,
    pub(super) offset: usize,
    pub(super) kind: Option<JointKind>,
    pub(super) parent: Option<Reference>,
    pub(super) child: Option<Reference>,
    pub(super) mimic: Option<Reference>,
    /// The orientation, when it is given as a quaternion: urdf-rs turns one into angles and loses up to
    /// 4.5e-3 rad near a pitch of 90 degrees, so it is kept from it.
    pub(super) quaternion: Option<UnitQuaternion<f64>>,
    /// The elements that carry values, written for urdf-rs.
    pub(super) values: String,
    /// What urdf-rs read.
    pub(super) read: Option<urdf_rs::Joint>,
    pub(super) defect: Option<Defect>,
}

impl RawJoint {
    /// How messages call it.
    pub(super) fn label(&self) -> String {
        if self.name.is_empty() { "a joint".to_owned() } else { format!("joint {}", quote(&self.name)) }
    }

    /// Reports an error, which makes the joint defective.
    pub(super) fn fail(&mut self, offset: usize, reason: String, report: &mut Report<'_>) {
        report.error(offset, format!("{}: {reason}", self.label()));
        self.defect.get_or_insert_with(|| report.defect(offset, reason));
    }

    pub(super) fn warn(&self, offset: usize, reason: &str, report: &mut Report<'_>) {
        report.warning(offset, format!("{}: {reason}", self.label()));
    }

    pub(super) fn note(&self, offset: usize, reason: &str, report: &mut Report<'_>) {
        report.note(offset, format!("{}: {reason}", self.label()));
    }

    pub(super) fn is_movable(&self) -> bool {
        self.kind.is_some_and(JointKind::is_movable)
    }
}

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

/// Reads one joint.
pub(super) struct Reader<'r, 'a, 'i, 't> {
    node: Node<'a, 'i>,
    pub(super) version: Version,
    pub(super) options: &'r UrdfOptions,
    pub(super) report: &'r mut Report<'t>,
    pub(super) joint: RawJoint,
}

impl<'r, 'a, 'i, 't> Reader<'r, 'a, 'i, 't> {
    fn new(
        node: Node<'a, 'i>,
        version: Version,
        options: &'r UrdfOptions,
        report: &'r mut Report<'t>,
    ) -> Reader<'r, 'a, 'i, 't> {
        let joint = RawJoint {
            name: String::new(),
            offset: element::offset(node),
            kind: None,
            parent: None,
            child: None,
            mimic: None,
            quaternion: None,
            values: String::new(),
            read: None,
            defect: None,
        };
        Reader { node, version, options, report, joint }
    }

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

    pub(super) fn fail(&mut self, offset: usize, reason: impl Into<String>) {
        self.joint.fail(offset, reason.into(), self.report);
    }

    pub(super) fn warn(&mut self, offset: usize, reason: &str) {
        self.joint.warn(offset, reason, self.report);
    }

    pub(super) fn note(&mut self, offset: usize, reason: &str) {
        self.joint.note(offset, reason, self.report);
    }

    pub(super) fn known_attributes(&mut self, node: Node<'a, 'i>, known: Known) {
        for (place, cause) in element::check_attributes(node, known, self.options.strict, self.report) {
            self.fail(place, cause);
        }
    }

    /// The first child element of that name; a second one is reported and ignored, as urdfdom does.
    pub(super) fn child(&mut self, known: Known) -> Option<Node<'a, 'i>> {
        let mut found = element::children_named(self.node, known.element);
        let (first, second) = (found.next()?, found.next());
        if let Some(second) = second {
            let line = self.report.line(element::offset(first));
            let cause = format!("it has a second `<{}>`; the first one (line {line}) is used", known.element);
            self.warn(element::offset(second), &cause);
        }
        self.known_attributes(first, known);
        Some(first)
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

    /// As [`Self::vector`], of lengths or angles that an arm may have.
    fn sizes(&mut self, element: &str, attribute: &Attribute<'a, 'i>) -> Option<String> {
        let text = self.vector::<3>(element, attribute)?;
        let values = number::vector::<3>(&text).unwrap_or_default();
        if let Some(cause) = values.into_iter().find_map(unbelievable) {
            let cause = format!("`{}` of `<{element}>`: {cause}", attribute.name());
            self.fail(attribute.range().start, cause);
            return None;
        }
        Some(text)
    }

    /// Returns the checked tokens of a vector, separated by single blanks.
    fn vector<const N: usize>(&mut self, element: &str, attribute: &Attribute<'a, 'i>) -> Option<String> {
        match number::vector::<N>(attribute.value()) {
            Ok(_) => Some(number::tokens(attribute.value()).collect::<Vec<_>>().join(" ")),
            Err(cause) => {
                let cause = format!("`{}` of `<{element}>`: {cause}", attribute.name());
                self.fail(attribute.range().start, cause);
                None
            }
        }
    }

    /// Returns the checked token of a finite number, when the attribute is there.
    fn scalar(&mut self, element: &str, node: Node<'a, 'i>, name: &str) -> Option<String> {
        let attribute = element::attribute(node, name)?;
        match number::finite(attribute.value()) {
            Ok(_) => Some(attribute.value().trim().to_owned()),
            Err(cause) => {
                self.fail(attribute.range().start, format!("`{name}` of `<{element}>`: {cause}"));
                None
            }
        }
    }
}

fn kinds() -> String {
    list(&JointKind::ALL.map(JointKind::as_str), "and")
}
