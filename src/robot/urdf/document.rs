//! The document as a whole: markup, root element, version, and the order in which its parts are read.

use roxmltree::{Document, Error, Namespace, Node};

use super::element::{self, Known};
use super::outline::{self, Outline, Stop, Tag};
use super::version::Version;
use super::{MAX_DEPTH, UrdfOptions, encoding, graph, joint, link, values};
use crate::robot::Robot;
use crate::robot::names::quote;
use crate::robot::report::Report;

/// Reads a robot, or reports at least one error.
pub(super) fn read(text: &str, options: &UrdfOptions, report: &mut Report<'_>) -> Option<Robot> {
    if text.trim_ascii().is_empty() {
        report.error(0, "the file is empty: expected a URDF, `<robot name=\"...\">` with links and joints");
        return None;
    }
    if let Some(offset) = text.find('\0') {
        let cause = "the file holds a NUL byte: it is binary, or encoded as UTF-16; save it as UTF-8 text";
        report.error(offset, cause);
        return None;
    }
    let outline = outline::outline(text);
    if let Some((offset, message)) = refused(text, &outline) {
        report.error(offset, message);
        return None;
    }
    let mended = outline.mended(text);
    match Document::parse(&mended) {
        Ok(document) => {
            report_mending(&outline, report);
            read_document(&document, text, options, report)
        }
        Err(error) => {
            let (offset, message) = malformed(text, &outline, &error, report);
            report.error(offset, message);
            None
        }
    }
}

/// What is refused whatever else the text holds: DTDs, excess, xacro.
pub(super) fn refused(text: &str, outline: &Outline<'_>) -> Option<(usize, String)> {
    match outline.stop {
        Some(Stop::Dtd(offset)) if is_web_page(text, offset) => {
            Some((offset, "this is a web page, not URDF; fetch the file itself".to_owned()))
        }
        Some(Stop::Dtd(offset)) => Some((
            offset,
            "a DTD (`<!DOCTYPE ...>`) is not allowed: entities are never expanded and no file is fetched; \
             remove it"
                .to_owned(),
        )),
        Some(Stop::TooDeep(tag)) => Some((
            tag.offset,
            format!(
                "{} is nested deeper than {MAX_DEPTH} elements; a URDF needs no more than about ten",
                element_name(tag.name)
            ),
        )),
        Some(Stop::TooMany { offset, what, most }) => {
            Some((offset, format!("the file has more than {most} {what}, the most that are read")))
        }
        _ => outline.xacro.map(|offset| {
            let cause = "this is xacro that has not been expanded; run `xacro FILE.xacro > FILE.urdf` (with ROS 2: \
                         `ros2 run xacro xacro FILE.xacro > FILE.urdf`) and read the result";
            (offset, cause.to_owned())
        }),
    }
}

fn is_web_page(text: &str, doctype: usize) -> bool {
    let head = text.get(doctype..doctype + 14).unwrap_or_default();
    head.eq_ignore_ascii_case("<!doctype html")
}

fn element_name(name: &str) -> String {
    quote(&format!("<{}>", &name[..name.floor_char_boundary(40)]))
}

fn report_mending(outline: &Outline<'_>, report: &mut Report<'_>) {
    if let Some(first) = outline.dashed_comments.first() {
        let more = match outline.dashed_comments.len() {
            1 => String::new(),
            n => format!(" (and {} more)", n - 1),
        };
        report.warning(
            first.start,
            format!("a comment holds `--`, which XML forbids{more}; read all the same"),
        );
    }
    if let Some(&first) = outline.leftovers.first() {
        let more = match outline.leftovers.len() {
            1 => String::new(),
            n => format!(" (and {} more)", n - 1),
        };
        let cause = format!(
            "xacro was left here unexpanded{more}, in a part that kinematics does not read; whatever it stands for is missing"
        );
        report.warning(first, cause);
    }
    for (offset, prefix) in outline.undeclared() {
        let cause = format!(
            "the namespace prefix {} is declared nowhere (`xmlns:{prefix}`); what carries it is ignored",
            quote(prefix)
        );
        report.warning(offset - prefix.len(), cause);
    }
}

/// Says why a text is not well-formed, and where.
pub(super) fn malformed(
    text: &str,
    outline: &Outline<'_>,
    error: &Error,
    report: &Report<'_>,
) -> (usize, String) {
    let start = text.len() - text.trim_ascii_start().len();
    if !text[start..].starts_with('<') {
        let line = text[start..].lines().next().unwrap_or_default();
        if line.starts_with("version https://git-lfs") {
            let cause = "this is a pointer of Git LFS and not the file itself; run `git lfs pull`";
            return (start, cause.to_owned());
        }
        return (
            start,
            format!("this is not XML: it begins with {}, expected `<robot name=...>`", quote(line)),
        );
    }
    if start > 0 && text[start..].starts_with("<?xml") {
        return (
            start,
            format!(
                "the XML declaration `<?xml ...?>` must be the very first thing in the file; remove the {start} blank \
                 characters before it"
            ),
        );
    }
    match error {
        Error::InvalidAttributeValue(_) => (
            offset_of(text, error),
            "`<` inside an attribute's value: is the closing quote missing?".to_owned(),
        ),
        Error::DuplicatedAttribute(name, _) => {
            duplicate_attribute(text, name, offset_of(text, error), report)
        }
        _ => torn(text, outline, report).unwrap_or_else(|| {
            let place = format!(" at {}", error.pos());
            (
                offset_of(text, error),
                format!("not well-formed XML: {}", error.to_string().replace(&place, "")),
            )
        }),
    }
}

/// Returns the byte offset of an XML error.
fn offset_of(text: &str, error: &Error) -> usize {
    let place = error.pos();
    let lines = text.split_inclusive('\n').take(place.row.saturating_sub(1) as usize);
    let line: usize = lines.map(str::len).sum();
    let column = text[line..].char_indices().nth(place.col.saturating_sub(1) as usize);
    column.map_or(text.len(), |(offset, _)| line + offset)
}

fn duplicate_attribute(text: &str, name: &str, second: usize, report: &Report<'_>) -> (usize, String) {
    let tag = text[..second].rfind('<').unwrap_or(0);
    let named = |(offset, _): &(usize, &str)| {
        let rest = text[tag + offset + name.len()..].trim_ascii_start();
        rest.starts_with('=') && text[..tag + offset].ends_with(|c: char| c.is_ascii_whitespace())
    };
    let first = text[tag..second].match_indices(name).find(named).map_or(tag, |(offset, _)| tag + offset);
    let line = report.line(first);
    (
        second,
        format!("attribute {} stands twice in one element, first on line {line}; remove one", quote(name)),
    )
}

/// Says where a text ends too early, or which tags do not fit.
fn torn(text: &str, outline: &Outline<'_>, report: &Report<'_>) -> Option<(usize, String)> {
    let opened =
        |tag: &Tag<'_>| format!("{} (opened on line {})", element_name(tag.name), report.line(tag.offset));
    match outline.stop {
        Some(Stop::Torn { offset, inside }) => Some((
            text.len(),
            format!(
                "the file ends inside {inside} that begins on line {}: it is cut off, or an end mark (a quote, `>`) is \
                 missing there",
                report.line(offset)
            ),
        )),
        Some(Stop::Mismatch { open, close }) => {
            Some((close.offset, format!("{} closes {}", quote(&format!("</{}>", close.name)), opened(&open))))
        }
        Some(Stop::NothingOpen(close)) => {
            let name = quote(&format!("</{}>", close.name));
            Some((close.offset, format!("{name} closes nothing: no element is open here")))
        }
        Some(Stop::AfterRoot(offset)) => Some((
            offset,
            "something stands after the root element is closed; a URDF is one `<robot>` and nothing else"
                .to_owned(),
        )),
        _ => outline.open.last().map(|open| {
            (text.len(), format!("the file ends while {} is still open: it is cut off", opened(open)))
        }),
    }
}

fn read_document(
    document: &Document<'_>,
    text: &str,
    options: &UrdfOptions,
    report: &mut Report<'_>,
) -> Option<Robot> {
    let root = document.root_element();
    if !check_root(root, report) {
        return None;
    }
    if let Some(name) = encoding::declared(text) {
        let cause = format!("the file declares encoding {} but is UTF-8; read as UTF-8", quote(name));
        report.warning(0, cause);
    }
    for (offset, cause) in element::check_attributes(root, Known::ROBOT, options.strict, report) {
        report.error(offset, cause);
    }
    let name = robot_name(root, options, report);
    let version = version(root, report);
    let links = link::read_links(root, options, report);
    let joints = joint::read_joints(root, version.unwrap_or(Version::V1_0), options, report);
    note_ignored(root, report);
    let (links, mut joints, _) = (links?, joints?, version?);
    if links.is_empty() {
        if element::children_named(root, "link").next().is_none() {
            let is_srdf = ["group", "disable_collisions", "virtual_joint"]
                .into_iter()
                .any(|name| element::children_named(root, name).next().is_some());
            let is_xacro =
                |space: &Namespace<'_>| space.name() == Some("xacro") || space.uri().ends_with("/xacro");
            let cause = if is_srdf {
                "the robot has no link: this is an SRDF (MoveIt's groups and poses); name the URDF that it belongs to"
            } else if root.namespaces().any(is_xacro) {
                "the robot has no link, and declares xacro's namespace: this is a part for other files to include, or xacro \
                 that has not been expanded; run `xacro` on the file that includes it, and read the result"
            } else {
                "the robot has no link: there is nothing to move"
            };
            report.error(element::offset(root), cause);
        }
        return None;
    }
    values::read_values(&mut joints, report);
    Some(graph::assemble(name, &links, joints, element::offset(root), report))
}

/// Checks that the root is `<robot>`, and names what else it is.
fn check_root(root: Node<'_, '_>, report: &mut Report<'_>) -> bool {
    let name = root.tag_name().name();
    let written = report.written_name(element::offset(root) + 1);
    let cause = match name {
        "robot" if element::is_plain(root) => return true,
        "robot" => {
            let space = root.tag_name().namespace().unwrap_or_default();
            let cause = format!(
                "the root element is {}, of the namespace {}: the elements of a URDF have no prefix; write `<robot>`",
                element_name(written),
                quote(space)
            );
            report.error(element::offset(root), cause);
            return false;
        }
        "sdf" | "gazebo" | "world" => {
            "this is SDF, not URDF; use the URDF that it was made from, or convert it (ROS 2 has `sdformat_urdf` \
             for this)"
        }
        "mujoco" | "mujocoinclude" => {
            "this is MJCF (MuJoCo), not URDF; look for the robot's URDF, from which MJCF files are usually made"
        }
        "html" => "this is a web page; fetch the file itself",
        "COLLADA" => "this is a COLLADA mesh, not URDF; name the .urdf file",
        _ if name.eq_ignore_ascii_case("robot") => "write `<robot>`, in lower case",
        _ => "a URDF begins with `<robot>`",
    };
    let cause = format!("the root element is {}: {cause}", element_name(name));
    report.error(element::offset(root), cause);
    false
}

fn robot_name(root: Node<'_, '_>, options: &UrdfOptions, report: &mut Report<'_>) -> String {
    let given = root.attribute("name").map(str::trim).filter(|name| !name.is_empty());
    given.map_or_else(
        || {
            let name = options.name.clone().unwrap_or_else(|| "robot".to_owned());
            let cause = format!("the robot has no name; it is called {}", quote(&name));
            report.warning(element::offset(root), cause);
            name
        },
        str::to_owned,
    )
}

fn version(root: Node<'_, '_>, report: &mut Report<'_>) -> Option<Version> {
    let Some(attribute) = root.attribute_node("version") else { return Some(Version::V1_0) };
    let value = attribute.value().trim();
    let numbers: Option<Vec<u32>> = value.split('.').map(|part| part.parse().ok()).collect();
    let cause = match numbers.as_deref() {
        Some([1, 0]) => return Some(Version::V1_0),
        Some([1, 1]) => return Some(Version::V1_1),
        Some([1, 2]) => return Some(Version::V1_2),
        Some([_, _]) => format!("URDF version {} is not supported; 1.0, 1.1 and 1.2 are", quote(value)),
        _ => format!("the URDF version {} is malformed; write for example `version=\"1.0\"`", quote(value)),
    };
    report.error(attribute.range().start, cause);
    None
}

/// Lists the elements beside links and joints, which kinematics does not need.
fn note_ignored(root: Node<'_, '_>, report: &mut Report<'_>) {
    let mut counts: Vec<(&str, usize, usize)> = Vec::new();
    for child in root.children().filter(Node::is_element) {
        let name = child.tag_name().name();
        if element::is_plain(child) && matches!(name, "link" | "joint" | "material") {
            continue;
        }
        misspelt_element(child, name, report);
        let name = report.written_name(element::offset(child) + 1);
        match counts.iter().position(|(known, ..)| *known == name) {
            Some(index) => counts[index].1 += 1,
            None if counts.len() < 20 => counts.push((name, 1, element::offset(child))),
            None => {}
        }
    }
    if let Some(&(.., first)) = counts.first() {
        let listed: Vec<String> =
            counts.iter().map(|&(name, count, _)| format!("{} ({count})", element_name(name))).collect();
        report.note(first, format!("ignored, because kinematics does not need them: {}", listed.join(", ")));
    }
}

fn misspelt_element(child: Node<'_, '_>, name: &str, report: &mut Report<'_>) {
    if !element::is_plain(child) || !child.has_attribute("name") {
        return;
    }
    if let Some(known) = ["link", "joint"].into_iter().find(|known| element::is_misspelling(name, known)) {
        let cause = format!("{} is ignored; did you mean `<{known}>`?", element_name(name));
        report.warning(element::offset(child), cause);
    }
}
