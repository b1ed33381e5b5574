//! Elements and attributes: which are known, which are misspelt, which stand twice.

use roxmltree::{Attribute, Node};

use crate::robot::names::{list, quote};
use crate::robot::report::Report;

/// An element and the attributes that URDF gives it.
#[derive(Clone, Copy)]
pub(super) struct Known {
    pub(super) element: &'static str,
    pub(super) attributes: &'static [&'static str],
}

impl Known {
    pub(super) const ROBOT: Known = Known { element: "robot", attributes: &["name", "version"] };
    pub(super) const LINK: Known = Known { element: "link", attributes: &["name", "type"] };
    pub(super) const JOINT: Known = Known { element: "joint", attributes: &["name", "type"] };
    pub(super) const ORIGIN: Known = Known { element: "origin", attributes: &["xyz", "rpy", "quat_xyzw"] };
    pub(super) const PARENT: Known = Known { element: "parent", attributes: &["link"] };
    pub(super) const CHILD: Known = Known { element: "child", attributes: &["link"] };
    pub(super) const AXIS: Known = Known { element: "axis", attributes: &["xyz"] };
    pub(super) const LIMIT: Known = Known {
        element: "limit",
        attributes: &["lower", "upper", "effort", "velocity", "acceleration", "deceleration", "jerk"],
    };
    pub(super) const MIMIC: Known =
        Known { element: "mimic", attributes: &["joint", "multiplier", "offset"] };
}

/// Byte offset of an element.
pub(super) fn offset(node: Node<'_, '_>) -> usize {
    node.range().start
}

/// Whether the element is written without a prefix.
pub(super) fn is_plain(node: Node<'_, '_>) -> bool {
    let source = &node.document().input_text()[node.range()];
    source.get(1..).is_some_and(|source| source.starts_with(node.tag_name().name()))
}

/// The child elements that are written without a prefix.
pub(super) fn children<'a, 'i>(node: Node<'a, 'i>) -> impl Iterator<Item = Node<'a, 'i>> {
    node.children().filter(|child| child.is_element() && is_plain(*child))
}

/// The child elements of that name.
pub(super) fn children_named<'a, 'i>(node: Node<'a, 'i>, name: &str) -> impl Iterator<Item = Node<'a, 'i>> {
    children(node).filter(move |child| child.tag_name().name() == name)
}

/// The attribute of that name, written without a prefix.
pub(super) fn attribute<'a, 'i>(node: Node<'a, 'i>, name: &str) -> Option<Attribute<'a, 'i>> {
    node.attributes().find(|attribute| attribute.namespace().is_none() && attribute.name() == name)
}

/// Whether `name` is a slip of the pen for `known`: other case, or a few letters off.
pub(super) fn is_misspelling(name: &str, known: &str) -> bool {
    let most = if known.len() <= 3 { 1 } else { 2 };
    name != known
        && name.len() <= 2 * known.len()
        && (name.eq_ignore_ascii_case(known) || strsim::osa_distance(name, known) <= most)
}

/// Reports attributes that URDF does not know, and returns those that are errors with their messages: a slip
/// for a known attribute that is absent, or any at all when `strict`.
pub(super) fn check_attributes(
    node: Node<'_, '_>,
    known: Known,
    strict: bool,
    report: &mut Report<'_>,
) -> Vec<(usize, String)> {
    let mut errors = Vec::new();
    for attribute in node.attributes().filter(|attribute| attribute.namespace().is_none()) {
        let name = attribute.name();
        let place = attribute.range().start;
        if known.attributes.contains(&name) || report.written_name(place).contains(':') {
            continue;
        }
        let mut absent = known.attributes.iter().filter(|known| self::attribute(node, known).is_none());
        let meant = absent.find(|known| is_misspelling(name, known));
        let cause = format!("`<{}>` has no attribute {}", known.element, quote(name));
        match meant {
            Some(meant) => errors.push((place, format!("{cause}; did you mean `{meant}`?"))),
            None if strict => {
                errors.push((place, format!("{cause}; it has {}", list(known.attributes, "and"))));
            }
            None => report.warning(place, format!("{cause}; it is ignored")),
        }
    }
    errors
}
