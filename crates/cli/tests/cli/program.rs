//! The program, run as people and scripts run it.

#![allow(clippy::unwrap_used, reason = "a test that can not go on stops")]

use std::path::{Path, PathBuf};

use serde_json::Value;

/// What a run of the program left.
pub(crate) struct Run {
    pub(crate) code: i32,
    pub(crate) out: String,
    pub(crate) err: String,
}

impl Run {
    /// The one JSON document on standard output.
    pub(crate) fn json(&self) -> Value {
        serde_json::from_str(&self.out)
            .unwrap_or_else(|e| panic!("not one JSON document, {e}:\n{}", self.out))
    }

    /// The refusal of a run with `--json`, after checking that its code is the exit code.
    pub(crate) fn error(&self) -> Value {
        let error = self.json()["error"].clone();
        assert_eq!(error["code"], self.code, "{}", self.out);
        assert!(error["message"].as_str().is_some_and(|message| !message.is_empty()), "{}", self.out);
        for key in ["file", "line", "column"] {
            assert!(error.get(key).is_some(), "{key} is missing in {}", self.out);
        }
        error
    }

    #[track_caller]
    pub(crate) fn expect(self, code: i32) -> Self {
        assert_eq!(self.code, code, "\n--- out\n{}\n--- err\n{}", self.out, self.err);
        self
    }
}

/// The repository's folder, from the folder of this package.
pub(crate) const REPOSITORY: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");

/// Runs the program in the repository's folder.
pub(crate) fn kinstep(arguments: &[&str]) -> Run {
    kinstep_in(Path::new(REPOSITORY), arguments)
}

/// Runs the program in a folder.
pub(crate) fn kinstep_in(folder: &Path, arguments: &[&str]) -> Run {
    let mut command = assert_cmd::Command::cargo_bin("kinstep").unwrap();
    let output = command.current_dir(folder).env("NO_COLOR", "1").args(arguments).output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    let code = output.status.code().expect("the program should end by itself");
    let run = Run { code, out: text(output.stdout), err: text(output.stderr) };
    assert!(!run.err.contains("panicked"), "{arguments:?} panicked:\n{}", run.err);
    run
}

/// A folder of files for one test.
pub(crate) struct Desk {
    folder: tempfile::TempDir,
}

impl Desk {
    pub(crate) fn new(files: &[(&str, &str)]) -> Self {
        let desk = Self { folder: tempfile::tempdir().unwrap() };
        for (name, text) in files {
            std::fs::write(desk.path(name), text).unwrap();
        }
        desk
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    pub(crate) fn run(&self, arguments: &[&str]) -> Run {
        kinstep_in(self.folder.path(), arguments)
    }

    /// Runs a command as it was printed, as a person does who types it again.
    #[cfg(unix)]
    pub(crate) fn shell(&self, command: &str) -> Run {
        let program = assert_cmd::cargo::cargo_bin("kinstep");
        let script = format!("kinstep() {{ \"$PROGRAM\" \"$@\"; }}; {command}");
        let mut shell = std::process::Command::new("bash");
        let shell = shell.args(["-c", &script]).env("PROGRAM", program).env("NO_COLOR", "1");
        let output = shell.current_dir(self.folder.path()).output().unwrap();
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
        Run { code: output.status.code().unwrap(), out: text(output.stdout), err: text(output.stderr) }
    }

    /// Names of everything in a folder of the desk, hidden files included.
    pub(crate) fn names(&self, folder: &str) -> Vec<String> {
        let Ok(entries) = std::fs::read_dir(self.path(folder)) else { return Vec::new() };
        let mut names: Vec<String> =
            entries.map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }
}

/// One planar arm on a circle for a second.
pub(crate) const SMALL: &str = r#"sigma = 0.01
duration = 2.0
formula = "la6-wang-guo"

[law]
h = 0.4

[[arm]]
name = "left"
robot = "planar4"
base = "base"
tip = "tip"
task = "position-xy"
q0 = ["pi/10", 0.3, 0.3, 0.3]
path = { kind = "circle", radius = 0.1 }
"#;

/// The paper's row under another id.
pub(crate) const ROW: &str = r#"[[formula]]
id = "mine"
difference = [24, -5, -12, -6, -4, 3]
denominator = 48
order = 3
error_constant = "5/16"
zero_stable = true
source = "a test"
"#;
