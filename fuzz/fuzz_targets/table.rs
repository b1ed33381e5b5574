//! Any text as a Denavit-Hartenberg table and as a calibration: a value or an error.
#![no_main]

use kinstep::robot::{Calibration, DhTable, Robot, embedded};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    if let Ok(Ok(robot)) = DhTable::from_toml(text).map(|table| Robot::from_dh(&table)) {
        let written = robot.to_urdf().expect("a table has no defects");
        Robot::from_urdf(&written).expect("what is written reads");
    }
    if let Ok(calibration) = Calibration::from_toml(text) {
        let panda = embedded::get("panda").expect("an embedded robot reads");
        let _ = panda.with_calibration(&calibration);
    }
});
