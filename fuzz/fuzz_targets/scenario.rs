//! Any text as a scenario with a value laid over it: a scenario or a refusal with its place, and a scenario that can be
//! written down, read again and begun.
#![no_main]

use kinstep::formula::FormulaTable;
use kinstep::robot::embedded;
use kinstep_files::scenario::{ArmSpec, Scenario, ScenarioText};
use kinstep_study::sweep::Axis;
use libfuzzer_sys::fuzz_target;

// The first line is an assignment, or values to vary; the rest is the scenario.
fuzz_target!(|text: &str| {
    let (assignment, text) = text.split_once('\n').unwrap_or(("", text));
    if let Ok(axis) = Axis::parse(assignment) {
        let _ = (axis.value(0, 0), axis.value(axis.len() - 1, u64::MAX));
    }
    let Ok(mut text) = ScenarioText::parse(text) else { return };
    for _ in 0..2 {
        match text.scenario() {
            Ok(scenario) => use_it(&scenario),
            Err(error) => assert!(!error.message.is_empty(), "a refusal without a word"),
        }
        if text.set(assignment).is_err() {
            return;
        }
    }
});

fn use_it(scenario: &Scenario) {
    let written = scenario.to_toml();
    let again = ScenarioText::parse(&written).expect("what is written is TOML");
    assert_eq!(&again.scenario().expect("what is written is a scenario"), scenario);
    let steps = scenario.duration.value() / scenario.sigma.value();
    if !names_files(scenario) && steps < 1e4 {
        let Ok(mut planner) = scenario.planner(FormulaTable::builtin(), None) else { return };
        for _ in 0..20 {
            planner.step();
        }
    }
}

/// Whether reading it would touch the disk.
fn names_files(scenario: &Scenario) -> bool {
    let robots = embedded::names();
    let of_arm = |arm: &ArmSpec| !robots.contains(&arm.robot.as_str()) || arm.calibration.is_some();
    scenario.arm.iter().any(of_arm) || !scenario.formulas.is_empty()
}
