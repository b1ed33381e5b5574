//! SRDF, MoveIt's file beside a URDF: the pairs of links whose collisions are not checked.

use roxmltree::{Document, Node};

use super::element::{self, Known};
use super::{MAX_BYTES, UrdfError, document, outline};
use crate::robot::names::{quote, short_list};
use crate::robot::report::Report;
use crate::robot::{Diagnostic, Robot};

const PAIR: Known = Known { element: "disable_collisions", attributes: &["link1", "link2", "reason"] };
const ENABLED: Known = Known { element: "enable_collisions", attributes: &["link1", "link2", "reason"] };
const DEFAULT: Known = Known { element: "disable_default_collisions", attributes: &["link"] };
/// What else an SRDF may hold.
const OTHERS: [&str; 9] = [
    "group",
    "group_state",
    "end_effector",
    "virtual_joint",
    "passive_joint",
    "link_sphere_approximation",
    "joint_property",
    "allowed_collision_pair",
    "description",
];

/// Two links whose collisions are not checked.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DisabledPair {
    /// The names of the links, as the file has them.
    pub links: [String; 2],
    /// Why they are not checked, as the file says (`Adjacent`, `Never`, `Default`, ...).
    pub reason: Option<String>,
}

/// What an SRDF says about collisions.
///
/// ```
/// use kinstep::robot::{Srdf, embedded};
/// let panda = embedded::get("panda")?;
/// let srdf = Srdf::from_text(
///     r#"<robot name="panda">
///          <disable_collisions link1="panda_link5" link2="panda_link7" reason="Default"/>
///        </robot>"#,
///     &panda,
/// )?;
/// assert_eq!(srdf.pairs[0].links, ["panda_link5", "panda_link7"]);
/// let error = Srdf::from_text(
///     r#"<robot name="panda"> <disable_collisions link1="panda_link5" link2="panda_lnik7"/> </robot>"#,
///     &panda,
/// )
/// .unwrap_err();
/// assert!(error.to_string().contains("no link `panda_lnik7`; did you mean `panda_link7`"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq, Eq, Default)]
#[non_exhaustive]
pub struct Srdf {
    /// The pairs of links that are not checked.
    pub pairs: Vec<DisabledPair>,
    /// What is doubtful in the file, by place.
    pub diagnostics: Vec<Diagnostic>,
}

impl Srdf {
    /// Returns what an SRDF text says of the collisions of a robot: `<disable_collisions link1 link2 reason>`, and of newer files
    /// `<disable_default_collisions link>` (with every other link) and `<enable_collisions link1 link2>` (all the same).
    ///
    /// # Errors
    /// Every finding with its place: the text is not XML or not SRDF, or a pair names a link that the robot does not have (with
    /// the nearest names), one link twice, or only one link.
    pub fn from_text(text: &str, robot: &Robot) -> Result<Srdf, UrdfError> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        if text.len() > MAX_BYTES {
            return Err(UrdfError::whole_file(format!("the text has more than {MAX_BYTES} bytes (64 MiB)")));
        }
        let mut report = Report::new(text);
        let pairs = read(text, robot, &mut report).unwrap_or_default();
        let diagnostics = report.finish();
        match crate::robot::diagnostic::first_error(&diagnostics) {
            Some(_) => Err(UrdfError::new(diagnostics)),
            None => Ok(Srdf { pairs, diagnostics }),
        }
    }
}

fn read(text: &str, robot: &Robot, report: &mut Report<'_>) -> Option<Vec<DisabledPair>> {
    if text.trim_ascii().is_empty() {
        report.error(
            0,
            "the file is empty: expected an SRDF, `<robot name=\"...\">` with `<disable_collisions>`",
        );
        return None;
    }
    let outline = outline::outline(text);
    if let Some(offset) = outline.xacro {
        report.error(
            offset,
            "this is xacro that has not been expanded; run `xacro FILE.srdf.xacro > FILE.srdf`",
        );
        return None;
    }
    if let Some((offset, message)) = document::refused(text, &outline) {
        report.error(offset, message);
        return None;
    }
    match Document::parse(&outline.mended(text)) {
        Ok(document) => read_root(document.root_element(), robot, report),
        Err(error) => {
            let (offset, message) = document::malformed(text, &outline, &error, report);
            report.error(offset, message);
            None
        }
    }
}

fn read_root(root: Node<'_, '_>, robot: &Robot, report: &mut Report<'_>) -> Option<Vec<DisabledPair>> {
    let place = element::offset(root);
    if root.tag_name().name() != "robot" {
        let name = quote(&format!("<{}>", root.tag_name().name()));
        report.error(place, format!("the root element is {name}: an SRDF begins with `<robot name=...>`"));
        return None;
    }
    let has = |name: &str| element::children_named(root, name).next().is_some();
    if has("joint") && has("link") {
        report.error(
            place,
            "this is a URDF; the SRDF is the file beside it that MoveIt's setup assistant wrote",
        );
        return None;
    }
    if let Some(name) = root.attribute("name").filter(|name| *name != robot.name()) {
        let cause =
            format!("the file is about a robot {}, this one is called {}", quote(name), quote(robot.name()));
        report.warning(place, cause);
    }
    let mut pairs = Vec::new();
    for node in element::children(root) {
        match node.tag_name().name() {
            "disable_default_collisions" => pairs.extend(with_all_others(node, robot, report)),
            "disable_collisions" => pairs.extend(pair(node, PAIR, robot, report)),
            "enable_collisions" => {}
            other => question(other, node, report),
        }
    }
    for node in element::children_named(root, "enable_collisions") {
        if let Some(enabled) = pair(node, ENABLED, robot, report) {
            pairs.retain(|pair| !is_same(&pair.links, &enabled.links));
        }
    }
    Some(pairs)
}

fn is_same(pair: &[String; 2], other: &[String; 2]) -> bool {
    pair == other || (pair[0] == other[1] && pair[1] == other[0])
}

/// Warns of an element that no SRDF has.
fn question(name: &str, node: Node<'_, '_>, report: &mut Report<'_>) {
    if OTHERS.contains(&name) {
        return;
    }
    let known = [PAIR.element, ENABLED.element, DEFAULT.element].into_iter().chain(OTHERS);
    let suggestion = report.suggestion(name, known);
    report.warning(element::offset(node), format!("{} is ignored{suggestion}", quote(&format!("<{name}>"))));
}

fn pair(node: Node<'_, '_>, known: Known, robot: &Robot, report: &mut Report<'_>) -> Option<DisabledPair> {
    let misspelt = element::check_attributes(node, known, false, report);
    if !misspelt.is_empty() {
        for (place, cause) in misspelt {
            report.error(place, cause);
        }
        return None;
    }
    let [one, other] = ["link1", "link2"].map(|name| link(node, known.element, name, robot, report));
    let links = [one?, other?];
    if links[0] == links[1] {
        let cause = format!("`<{}>` names {} twice; a pair has two links", known.element, quote(&links[0]));
        report.error(element::offset(node), cause);
        return None;
    }
    let reason = element::attribute(node, "reason").map(|reason| reason.value().to_owned());
    Some(DisabledPair { links, reason })
}

fn with_all_others(node: Node<'_, '_>, robot: &Robot, report: &mut Report<'_>) -> Vec<DisabledPair> {
    let Some(own) = link(node, DEFAULT.element, "link", robot, report) else { return Vec::new() };
    let others = robot.links().iter().filter(|other| other.name != own);
    let pair = |other: &crate::robot::Link| DisabledPair {
        links: [own.clone(), other.name.clone()],
        reason: Some("Default".to_owned()),
    };
    others.map(pair).collect()
}

/// The link that an attribute names, which the robot must have.
fn link(
    node: Node<'_, '_>,
    element: &str,
    name: &str,
    robot: &Robot,
    report: &mut Report<'_>,
) -> Option<String> {
    let Some(attribute) = element::attribute(node, name) else {
        report.error(element::offset(node), format!("`<{element}>` has no `{name}`; it names a link"));
        return None;
    };
    let link = attribute.value().trim();
    if robot.link(link).is_some() {
        return Some(link.to_owned());
    }
    let all: Vec<&str> = robot.links().iter().map(|link| link.name.as_str()).collect();
    let suggestion = report.suggestion(link, all.iter().copied());
    let hint = if suggestion.is_empty() {
        format!("; its links are {}", short_list(&all, "and"))
    } else {
        suggestion
    };
    report.error(attribute.range().start, format!("the robot has no link {}{hint}", quote(link)));
    None
}
