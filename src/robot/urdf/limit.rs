//! `<limit>`: what the file says, what the standard says when the file does not, and what is nonsense.

use std::fmt::Write;

use roxmltree::Node;

use super::element::{self, Known};
use super::number;
use super::reader::Reader;
use super::version::Version;
use crate::robot::JointKind;
use crate::robot::names::quote;
use crate::robot::{degrees_suspected, millimetres_suspected};

/// From this size on a limit is taken as "unlimited": real files write 1e16 or 1e308.
const UNLIMITED: f64 = 1e12;

/// Reads the limits of a joint and writes them down for urdf-rs.
///
/// A revolute or prismatic joint needs `<limit>`. Before URDF 1.2, one missing bound is 0, as the standard
/// says; with both missing the range is unknown. From 1.2 on a missing bound is infinite.
pub(super) fn read(reader: &mut Reader<'_, '_, '_, '_>) {
    let is_bounded = matches!(reader.joint.kind, Some(JointKind::Revolute | JointKind::Prismatic));
    let Some(node) = reader.child(Known::LIMIT) else {
        if is_bounded {
            missing(reader);
        }
        return write(reader, f64::NEG_INFINITY, f64::INFINITY, f64::INFINITY);
    };
    if !reader.joint.is_movable() {
        return;
    }
    let [velocity, acceleration, jerk] = ["velocity", "acceleration", "jerk"]
        .map(|name| magnitude(reader, node, name).unwrap_or(f64::INFINITY));
    (reader.joint.acceleration, reader.joint.jerk) = (acceleration, jerk);
    let _ = magnitude(reader, node, "effort");
    if magnitude(reader, node, "deceleration").is_some() {
        let cause = "its `deceleration` limit is not checked: `acceleration` counts in both directions";
        reader.note(element::offset(node), cause);
    }
    let (lower, upper) = if is_bounded { bounds(reader, node) } else { unbounded(reader, node) };
    question_units(reader, node, [lower, upper]);
    warn_of_missing(reader, node, is_bounded);
    for (name, value) in [("velocity", velocity), ("acceleration", acceleration), ("jerk", jerk)] {
        if value == 0.0 {
            let cause = format!("its {name} limit is 0: this joint can never move");
            reader.warn(element::offset(node), &cause);
        }
    }
    write(reader, lower, upper, velocity);
}

fn write(reader: &mut Reader<'_, '_, '_, '_>, lower: f64, upper: f64, velocity: f64) {
    let _ = write!(
        reader.joint.values,
        "<limit lower=\"{lower:?}\" upper=\"{upper:?}\" effort=\"0\" velocity=\"{velocity:?}\"/>"
    );
}

fn missing(reader: &mut Reader<'_, '_, '_, '_>) {
    let offset = reader.joint.offset;
    let kind = reader.joint.kind.map_or("", JointKind::as_str);
    if reader.options.assume_unlimited {
        reader.warn(offset, &format!("it is {kind} and has no `<limit>`; taken as unlimited"));
    } else {
        let cause = format!(
            "it is {kind} and has no `<limit>`; add `<limit lower=\"...\" upper=\"...\" effort=\"...\" \
             velocity=\"...\"/>`, or take it as unlimited \
             (`--assume-unlimited`, in a scenario `assume_unlimited = true`)"
        );
        reader.fail(offset, cause);
    }
}

fn bounds(reader: &mut Reader<'_, '_, '_, '_>, node: Node<'_, '_>) -> (f64, f64) {
    let lower = value(reader, node, "lower");
    let upper = value(reader, node, "upper");
    let is_given = |name| element::attribute(node, name).is_some();
    let place = element::offset(node);
    let one_is_missing = reader.version < Version::V1_2 && is_given("lower") != is_given("upper");
    let missing = |infinite: f64| if one_is_missing { 0.0 } else { infinite };
    let (lower, upper) =
        (lower.unwrap_or(missing(f64::NEG_INFINITY)), upper.unwrap_or(missing(f64::INFINITY)));
    if lower > upper {
        reader.fail(place, format!("its lower limit {lower} is greater than its upper limit {upper}"));
    } else if lower == upper {
        reader.warn(place, &format!("its lower and upper limits are both {lower}: the joint can not move"));
    }
    (lower, upper)
}

/// A continuous joint turns on and on, whatever its limits say.
fn unbounded(reader: &mut Reader<'_, '_, '_, '_>, node: Node<'_, '_>) -> (f64, f64) {
    let given = ["lower", "upper"].into_iter().filter_map(|name| element::attribute(node, name));
    let given: Vec<String> = given.map(|limit| format!("{}=\"{}\"", limit.name(), limit.value())).collect();
    if !given.is_empty() {
        let given = given.join(" ");
        let cause = format!(
            "it is continuous: its limits {} are not applied; make it revolute if they are meant",
            quote(&given)
        );
        reader.note(element::offset(node), &cause);
    }
    (f64::NEG_INFINITY, f64::INFINITY)
}

/// Says what a `<safety_controller>` asks for: nothing of it is applied.
pub(super) fn note_soft_limits(reader: &mut Reader<'_, '_, '_, '_>) {
    let Some(node) = element::children_named(reader.node, "safety_controller").next() else { return };
    let end = |name| element::attribute(node, name).map_or("-", |limit| limit.value());
    let (lower, upper) = (end("soft_lower_limit"), end("soft_upper_limit"));
    if (lower, upper) != ("-", "-") {
        let cause = format!(
            "the soft limits {} to {} of its `<safety_controller>` are not applied: those of `<limit>` count",
            quote(lower),
            quote(upper)
        );
        reader.note(element::offset(node), &cause);
    }
}

/// Questions position limits that are likely to be in another unit.
fn question_units(reader: &mut Reader<'_, '_, '_, '_>, node: Node<'_, '_>, ends: [f64; 2]) {
    let doubt = if reader.joint.kind.is_some_and(JointKind::is_rotation) {
        degrees_suspected(&ends)
    } else {
        millimetres_suspected(&ends)
    };
    if let Some(doubt) = doubt {
        reader.warn(element::offset(node), &format!("a position limit of {doubt}"));
    }
}

/// Says how absent limits are understood; of a joint that is defective anyway nobody needs to know.
fn warn_of_missing(reader: &mut Reader<'_, '_, '_, '_>, node: Node<'_, '_>, is_bounded: bool) {
    if reader.version >= Version::V1_2 || reader.joint.defect.is_some() {
        return;
    }
    let place = element::offset(node);
    let is_given = |name| element::attribute(node, name).is_some();
    match (is_given("lower"), is_given("upper")) {
        _ if !is_bounded => {}
        (false, false) => {
            reader.warn(
                place,
                "it has neither `lower` nor `upper` limit: its range is unknown and not checked",
            );
        }
        (false, true) => reader.warn(place, "it has no `lower` limit; the standard takes it as 0"),
        (true, false) => reader.warn(place, "it has no `upper` limit; the standard takes it as 0"),
        (true, true) => {}
    }
    if !is_given("velocity") {
        reader.warn(place, "it has no `velocity` limit: its speed is not checked");
    }
}

/// Returns a limit in either direction, not negative.
fn magnitude(reader: &mut Reader<'_, '_, '_, '_>, node: Node<'_, '_>, name: &str) -> Option<f64> {
    let value = value(reader, node, name)?;
    if value < 0.0 {
        let place = element::attribute(node, name).map_or(element::offset(node), |found| found.range().start);
        reader.fail(place, format!("its {name} limit {value} is negative"));
    }
    Some(value)
}

/// Returns one value of `<limit>`, infinite when it is too large to mean anything.
fn value(reader: &mut Reader<'_, '_, '_, '_>, node: Node<'_, '_>, name: &str) -> Option<f64> {
    let attribute = element::attribute(node, name)?;
    let place = attribute.range().start;
    match number::number(attribute.value()) {
        Ok(value) if value.abs() < UNLIMITED => Some(value),
        Ok(value) => {
            if name != "effort" {
                reader.note(
                    place,
                    &format!("its {name} limit {} is taken as unlimited", quote(attribute.value())),
                );
            }
            Some(f64::INFINITY.copysign(value))
        }
        Err(cause) => {
            reader.fail(place, format!("`{name}` of `<limit>`: {cause}"));
            None
        }
    }
}
