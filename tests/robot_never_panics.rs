//! Damaged files: whatever happens to the bytes of a URDF, reading it and asking for chains never panics.
#![cfg(feature = "proptest")]

use kinstep::nalgebra::Vector6;
use kinstep::robot::{Robot, UrdfOptions};
use proptest::prelude::*;

const SOUND: &str = include_str!("data/two_fingers.urdf");

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

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2_000))]
    #[test]
    fn reading_a_damaged_file_gives_a_robot_or_an_error(damages in prop::collection::vec(damage(), 1..6)) {
        let mut bytes = SOUND.as_bytes().to_vec();
        for damage in &damages {
            damage.apply(&mut bytes);
        }
        let Ok(robot) = Robot::from_urdf_bytes(&bytes, &UrdfOptions::default()) else { return Ok(()) };
        prop_assert!(robot.joints().iter().all(|joint| joint.parent < joint.child));
        for base in robot.links() {
            for tip in robot.links() {
                let Ok(chain) = robot.chain(&base.name, &tip.name) else { continue };
                let mut columns = vec![Vector6::zeros(); chain.dof()];
                let mut scratch = chain.scratch();
                let posed = chain.forward(&vec![0.1; chain.dof()], &mut scratch);
                posed.geometric_jacobian(&mut columns);
                prop_assert!(columns.iter().flat_map(|column| column.iter()).all(|entry| entry.is_finite()));
            }
        }
    }
}
