//! Every bad file under tests/bad_input/formula is refused with the sentences beside it.
//!
//! `unreadable/` holds rows that can not be read, `contradicted/` rows whose numbers contradict what they claim. Each
//! `NAME.toml` has its message in `NAME.txt`. A new case is two new files.

use std::fs;
use std::path::{Path, PathBuf};

use kinstep::formula::{FormulaTable, Strictness, TableError, read_rows};

fn cases(folder: &str) -> Vec<(PathBuf, TableError)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/bad_input/formula").join(folder);
    let mut files: Vec<PathBuf> = fs::read_dir(folder)
        .expect("the folder of cases")
        .map(|entry| entry.expect("a readable folder").path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "toml"))
        .collect();
    files.sort();
    assert!(!files.is_empty());
    let refused = |path: PathBuf| {
        let text = fs::read_to_string(&path).expect("a readable case");
        let error = FormulaTable::from_toml(&text).expect_err(&format!("{} was accepted", path.display()));
        (path, error)
    };
    files.into_iter().map(refused).collect()
}

fn assert_messages(folder: &str) {
    let mut differing = Vec::new();
    for (path, error) in cases(folder) {
        let expected = fs::read_to_string(path.with_extension("txt")).unwrap_or_default();
        if error.to_string().trim() != expected.trim() {
            differing.push(format!("{}\n{error}", path.display()));
        }
    }
    assert!(differing.is_empty(), "other messages than expected:\n{}", differing.join("\n\n"));
}

#[test]
fn unreadable_rows_are_refused_with_a_sentence() {
    assert_messages("unreadable");
    for (path, error) in cases("unreadable") {
        assert!(error.is_unreadable(), "{}", path.display());
    }
}

#[test]
fn contradicted_rows_are_refused_with_both_values() {
    assert_messages("contradicted");
    for (path, error) in cases("contradicted") {
        assert!(!error.is_unreadable(), "{}", path.display());
    }
}

#[test]
fn contradicted_rows_can_still_be_read_and_examined() {
    for (path, error) in cases("contradicted") {
        let text = fs::read_to_string(&path).expect("a readable case");
        let rows = read_rows(&text, Strictness::Finished).expect("readable rows");
        let found: usize = rows.into_iter().map(|row| row.check().contradictions().len()).sum();
        assert_eq!(found, error.defects().len(), "{}", path.display());
    }
}

#[test]
fn every_defect_has_a_place_in_the_file() {
    for (path, error) in cases("unreadable").into_iter().chain(cases("contradicted")) {
        let text = fs::read_to_string(&path).expect("a readable case");
        for defect in error.defects() {
            let line = text.lines().nth(defect.place.line.wrapping_sub(1));
            let width = line.map_or(0, |line| line.chars().count());
            assert!(line.is_some() && defect.place.column <= width + 1, "{}: {defect}", path.display());
        }
    }
}

#[test]
fn nothing_makes_the_reader_panic() {
    let nested = format!("[[formula]]\nalpha = {}{}", "[".repeat(50_000), "]".repeat(50_000));
    let row = "[[formula]]\nid = \"é\u{1F600}\"\ndifference = [1, \"½\u{0}\"]\n";
    for text in
        ["", "\u{FEFF}", "=", "[[formula]]", "formula = []", "[formula]\nid=1", &nested, row, "\r\n\r\n[["]
    {
        assert!(FormulaTable::from_toml(text).is_err(), "{text:.60}");
    }
    // Every cut and every single damaged byte of a good row gives an answer, one way or the other.
    let good = "[[formula]]\nid = \"a\"\ndifference = [1, -1]\ndenominator = 1\norder = 1\nerror_constant = \"1/2\"\n\
                zero_stable = true\nsource = \"s\"\n";
    assert!(FormulaTable::from_toml(good).is_ok());
    for cut in 0..good.len() {
        let _ = FormulaTable::from_toml(&good[..cut]);
        for damage in ["0", "\"", "-", "[", "e", ".", "\n", "é"] {
            let damaged = format!("{}{damage}{}", &good[..cut], &good[cut + 1..]);
            let _ = FormulaTable::from_toml(&damaged);
        }
    }
}
