//! Every file of tests/bad_input/scenario/ is refused with the exit code and the text beside it.

#![allow(clippy::unwrap_used, reason = "a test that can not go on stops")]

use std::path::Path;

use crate::program::kinstep_in;

#[test]
fn every_bad_scenario_is_refused_in_the_words_beside_it() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/bad_input/scenario");
    let mut count = 0;
    let mut wrong = Vec::new();
    for entry in std::fs::read_dir(&folder).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|extension| extension != "toml") {
            continue;
        }
        count += 1;
        let name = path.file_name().unwrap().to_str().unwrap();
        let run = kinstep_in(&folder, &["plan", name]);
        // Where a file was looked for differs from place to place.
        let err = run.err.replace(&format!("{}", folder.display()), "HERE");
        let said = format!("exit {}\n{err}", run.code);
        let expected = std::fs::read_to_string(path.with_extension("expected")).unwrap_or_else(|_| {
            panic!("write {} beside {name}:\n{said}", path.with_extension("expected").display())
        });
        assert_ne!(run.code, 0, "{name} should be refused");
        assert_eq!(run.out, "", "{name}: a refusal goes to standard error");
        if said != expected {
            wrong.push(format!("--- {name}, expected\n{expected}\n--- got\n{said}"));
        }
        let json = kinstep_in(&folder, &["plan", name, "--json"]);
        assert_eq!(json.code, run.code, "{name}");
        json.error();
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(count > 50, "only {count} files were found");
}
