//! Damaged files: whatever happens to a URDF or a table, reading it and using what was read never panics.
//!
//! Two kinds of damage are done, the same ones in every run: to the bytes, and to the structure (elements dropped,
//! doubled and moved, names and numbers exchanged), which reaches further into the reader. `fuzz/` has the same targets
//! for a fuzzer that goes on for as long as one likes.
#![allow(clippy::unwrap_used, reason = "a test that can not go on stops")]

use kinstep::nalgebra::{IsometryMatrix3, Vector6};
use kinstep::robot::{Calibration, DhTable, Robot, UrdfOptions, embedded};
use proptest::prelude::*;
use proptest::test_runner::RngSeed;

const SOUND: &str = include_str!("../data/two_fingers.urdf");
const TABLE: &str = include_str!("../../examples/dh/panda.toml");

/// One piece of damage at a place (both as fractions of the length).
#[derive(Debug, Clone)]
enum Damage {
    Cut(f64, f64),
    Repeat(f64, f64),
    Swap(f64, f64),
    Byte(f64, u8),
    Insert(f64, &'static str),
}

fn damage() -> impl Strategy<Value = Damage> {
    let place = || 0.0..1.0;
    let piece = prop::sample::select(vec![
        "<",
        ">",
        "\"",
        "/",
        "&",
        "<!--",
        "-->",
        "<![CDATA[",
        "]]>",
        "<?",
        "${",
        "xmlns:a=\"b\"",
        "a:",
        "NaN",
        "1e999",
        "<joint name=\"turn\" type=\"planar\">",
        "</joint>",
        "<link name=\"palm\"/>",
        "[[joint]]\n",
        "[joint.a]",
        "= inf\n",
        "\u{feff}",
        "é",
        "手",
    ]);
    prop_oneof![
        (place(), 0.0..0.1).prop_map(|(at, length)| Damage::Cut(at, length)),
        (place(), 0.0..0.3).prop_map(|(at, length)| Damage::Repeat(at, length)),
        (place(), place()).prop_map(|(a, b)| Damage::Swap(a, b)),
        (place(), any::<u8>()).prop_map(|(at, byte)| Damage::Byte(at, byte)),
        (place(), piece).prop_map(|(at, piece)| Damage::Insert(at, piece)),
    ]
}

impl Damage {
    fn apply(&self, bytes: &mut Vec<u8>) {
        let last = bytes.len().saturating_sub(1);
        let at = |fraction: f64| (fraction * last as f64) as usize;
        let range = |from: f64, length: f64| at(from)..(at(from) + at(length)).min(last);
        match *self {
            _ if bytes.is_empty() => {}
            Damage::Cut(from, length) => drop(bytes.drain(range(from, length))),
            Damage::Repeat(from, length) => {
                let piece = bytes[range(from, length)].to_vec();
                bytes.splice(at(from)..at(from), piece);
            }
            Damage::Swap(a, b) => bytes.swap(at(a), at(b)),
            Damage::Byte(place, byte) => bytes[at(place)] = byte,
            Damage::Insert(place, piece) => drop(bytes.splice(at(place)..at(place), piece.bytes())),
        }
    }
}

/// One change of what a file means, at an element or a value (as fractions of their number).
#[derive(Debug, Clone)]
enum Change {
    Drop(f64),
    Double(f64),
    Move(f64, f64),
    Exchange(f64, f64),
    Set(f64, &'static str),
}

fn change() -> impl Strategy<Value = Change> {
    let place = || 0.0..1.0;
    let value = prop::sample::select(vec![
        "",
        "0",
        "-1",
        "1e999",
        "nan",
        "inf",
        "1e308",
        "-1e-320",
        "0 0 0",
        "0 0 1e-200",
        "1e200 1e200 0",
        "1 2",
        "fixed",
        "floating",
        "planar",
        "prismatic",
        "continuous",
        "spherical",
        "1.1",
        "1.2",
        "9.9",
        "palm",
        "\u{1F916}",
    ]);
    prop_oneof![
        2 => place().prop_map(Change::Drop),
        2 => place().prop_map(Change::Double),
        2 => (place(), place()).prop_map(|(from, to)| Change::Move(from, to)),
        3 => (place(), place()).prop_map(|(a, b)| Change::Exchange(a, b)),
        5 => (place(), value).prop_map(|(at, value)| Change::Set(at, value)),
    ]
}

impl Change {
    fn apply(&self, text: &str) -> String {
        let document = roxmltree::Document::parse(text);
        let Ok(document) = document else { return text.to_owned() };
        let inner = document.descendants().filter(roxmltree::Node::is_element).skip(1);
        let elements: Vec<_> = inner.map(|node| node.range()).collect();
        let attributes = document.descendants().flat_map(|node| node.attributes());
        let values: Vec<_> = attributes.map(|attribute| attribute.range_value()).collect();
        let pick = |fraction: f64, count: usize| (fraction * count as f64) as usize;
        let element = |fraction: f64| elements.get(pick(fraction, elements.len())).cloned();
        let value = |fraction: f64| values.get(pick(fraction, values.len())).cloned();
        let mut changed = text.to_owned();
        match *self {
            Change::Drop(at) => {
                if let Some(range) = element(at) {
                    changed.replace_range(range, "");
                }
            }
            Change::Double(at) => {
                if let Some(range) = element(at) {
                    changed.insert_str(range.end, &text[range]);
                }
            }
            Change::Move(from, to) => {
                if let (Some(from), Some(to)) = (element(from), element(to)) {
                    changed.insert_str(to.start, &text[from]);
                }
            }
            Change::Exchange(a, b) => {
                if let (Some(a), Some(b)) = (value(a), value(b)) {
                    let (first, second) = if a.start < b.start { (a, b) } else { (b, a) };
                    changed.replace_range(second.clone(), &text[first.clone()]);
                    changed.replace_range(first, &text[second]);
                }
            }
            Change::Set(at, new) => {
                if let Some(range) = value(at) {
                    changed.replace_range(range, new);
                }
            }
        }
        changed
    }
}

/// Holds whatever was read to what is promised of every robot; where its numbers are tame, so are its Jacobians.
fn use_it(robot: &Robot, is_tame: bool) -> Result<(), TestCaseError> {
    prop_assert!(robot.joints().iter().all(|joint| joint.parent < joint.child));
    prop_assert_eq!(robot.tree().count(), robot.links().len());
    prop_assert_eq!(robot.link_poses(&vec![0.1; robot.joints().len()]).len(), robot.links().len());
    for base in robot.links() {
        for tip in robot.links() {
            let Ok(chain) = robot.chain(&base.name, &tip.name) else { continue };
            let mut columns = vec![Vector6::zeros(); chain.dof()];
            let mut scratch = chain.scratch();
            let posed = chain.forward(&vec![0.1; chain.dof()], &mut scratch);
            posed.geometric_jacobian(&mut columns);
            let numbers = || columns.iter().flat_map(|column| column.iter());
            prop_assert!(!is_tame || numbers().all(|entry| entry.is_finite()));
        }
    }
    if let Ok(text) = robot.to_urdf() {
        let again = Robot::from_urdf(&text);
        prop_assert!(again.is_ok_and(|again| is_same(robot, &again)), "{}", text);
    }
    for joint in robot.joints() {
        if let Ok(locked) = robot.with_locked(&joint.name, &[0.0]) {
            prop_assert!(!locked.joint(&joint.name).unwrap().kind.is_movable());
        }
    }
    for link in robot.links() {
        let tooled = robot.with_tool(&link.name, "a tool", &IsometryMatrix3::identity());
        prop_assert!(tooled.is_err() || tooled.unwrap().links().len() == robot.links().len() + 1);
    }
    Ok(())
}

/// Whether two robots differ by nothing but the last places of rotations.
fn is_same(one: &Robot, other: &Robot) -> bool {
    let origins = |one: &IsometryMatrix3<f64>, other: &IsometryMatrix3<f64>| {
        one.translation == other.translation
            && (one.rotation.matrix() - other.rotation.matrix()).amax() < 1e-14
    };
    let alike = one.joints().iter().zip(other.joints()).all(|(one, other)| {
        (&one.name, one.kind, one.limits, one.mimic) == (&other.name, other.kind, other.limits, other.mimic)
            && one.axis == other.axis
            && origins(&one.origin, &other.origin)
    });
    alike && one.links() == other.links() && one.joints().len() == other.joints().len()
}

/// So many cases, the same in every run.
fn cases(cases: u32) -> ProptestConfig {
    ProptestConfig {
        cases,
        rng_seed: RngSeed::Fixed(20_240_229),
        failure_persistence: None,
        ..ProptestConfig::default()
    }
}

proptest! {
    #![proptest_config(cases(2_000))]
    #[test]
    fn reading_a_damaged_file_gives_a_robot_or_an_error(damages in prop::collection::vec(damage(), 1..6)) {
        let mut bytes = SOUND.as_bytes().to_vec();
        for damage in &damages {
            damage.apply(&mut bytes);
        }
        if let Ok(robot) = Robot::from_urdf_bytes(&bytes, &UrdfOptions::default()) {
            use_it(&robot, true)?;
        }
    }

    #[test]
    fn reading_a_file_that_means_something_else_gives_a_robot_or_an_error(
        changes in prop::collection::vec(change(), 1..8), strict in prop::bool::ANY,
    ) {
        let text = changes.iter().fold(SOUND.to_owned(), |text, change| change.apply(&text));
        let options = UrdfOptions { strict, assume_unlimited: !strict, ..UrdfOptions::default() };
        if let Ok(robot) = Robot::from_urdf_with(&text, &options) {
            use_it(&robot, false)?;
        }
    }

    #[test]
    fn reading_a_damaged_table_or_calibration_gives_a_value_or_an_error(damages in prop::collection::vec(damage(), 1..6)) {
        let mut bytes = TABLE.as_bytes().to_vec();
        for damage in &damages {
            damage.apply(&mut bytes);
        }
        let text = String::from_utf8_lossy(&bytes);
        if let Ok(Ok(robot)) = DhTable::from_toml(&text).map(|table| Robot::from_dh(&table)) {
            use_it(&robot, true)?;
        }
        let calibration = Calibration::from_toml(&text.replace("[[joint]]\nname = ", "[joint.panda_joint1]\nzero = 1 # "));
        if let Ok(calibration) = calibration {
            let _ = embedded::get("panda").unwrap().with_calibration(&calibration);
        }
    }
}
