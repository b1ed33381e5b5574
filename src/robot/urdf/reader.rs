//! What reading one joint needs everywhere: its element, what is known of it so far, and the report.

use roxmltree::{Attribute, Node};

use super::element::{self, Known};
use super::raw_joint::RawJoint;
use super::version::Version;
use super::{UrdfOptions, number};
use crate::robot::report::Report;
use crate::robot::unbelievable;

/// Reads one joint.
pub(super) struct Reader<'r, 'a, 'i, 't> {
    pub(super) node: Node<'a, 'i>,
    pub(super) version: Version,
    pub(super) options: &'r UrdfOptions,
    pub(super) report: &'r mut Report<'t>,
    pub(super) joint: RawJoint,
}

impl<'r, 'a, 'i, 't> Reader<'r, 'a, 'i, 't> {
    pub(super) fn new(
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
            acceleration: f64::INFINITY,
            jerk: f64::INFINITY,
            values: String::new(),
            read: None,
            defect: None,
        };
        Reader { node, version, options, report, joint }
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

    /// As [`Self::vector`], of lengths or angles that an arm may have.
    pub(super) fn sizes(&mut self, element: &str, attribute: &Attribute<'a, 'i>) -> Option<String> {
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
    pub(super) fn vector<const N: usize>(
        &mut self,
        element: &str,
        attribute: &Attribute<'a, 'i>,
    ) -> Option<String> {
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
    pub(super) fn scalar(&mut self, element: &str, node: Node<'a, 'i>, name: &str) -> Option<String> {
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
