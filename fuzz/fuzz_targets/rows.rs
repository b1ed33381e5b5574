//! Any text as rows of formulas: a table of formulas whose figures can be asked for, or an error.
#![no_main]

use kinstep::formula::FormulaTable;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    let table = match FormulaTable::from_toml(text) {
        Ok(table) => table,
        Err(error) => {
            assert!(!error.to_string().is_empty(), "a refusal without a word");
            return;
        }
    };
    for formula in table.iter() {
        assert!(formula.order() >= 1 && formula.steps() >= 1);
        let optimum = formula.optimum().map_or(0.5, |optimum| optimum.h);
        if formula.feedback_range().contains(optimum) {
            assert!(formula.noise_gain(optimum).is_none_or(|gain| gain.residual >= 0.0));
        }
    }
});
