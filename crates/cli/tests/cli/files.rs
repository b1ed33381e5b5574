//! Files, streams and refusals, by the table of exit codes.

#![allow(clippy::unwrap_used, reason = "a test that can not go on stops")]

use crate::program::{Desk, SMALL, kinstep};

#[test]
fn files_that_are_there_are_replaced_only_by_force() {
    let desk = Desk::new(&[("s.toml", SMALL)]);
    desk.run(&["plan", "s.toml", "--out", "o"]).expect(0);
    let before = std::fs::read(desk.path("o/trajectory.csv")).unwrap();
    let run = desk.run(&["plan", "s.toml", "--out", "o", "--set", "law.h=0.3"]).expect(6);
    assert!(run.err.contains("--force"), "{}", run.err);
    assert_eq!(std::fs::read(desk.path("o/trajectory.csv")).unwrap(), before);
    desk.run(&["plan", "s.toml", "--out", "o", "--set", "law.h=0.3", "--force"]).expect(0);
    assert_ne!(std::fs::read(desk.path("o/trajectory.csv")).unwrap(), before);
    let names =
        ["plan.json", "report.html", "scenario.toml", "trajectory.csv", "trajectory.csv-metadata.json"];
    assert_eq!(desk.names("o"), names);
}

#[test]
fn a_refused_scenario_leaves_no_folder_and_no_file() {
    let desk = Desk::new(&[("s.toml", SMALL)]);
    desk.run(&["plan", "s.toml", "--out", "o", "--set", "law.h=7"]).expect(2);
    assert_eq!(desk.names("."), ["s.toml"]);
}

#[test]
fn what_can_not_be_read_or_written_is_exit_6_with_the_file() {
    let desk = Desk::new(&[("s.toml", SMALL)]);
    for arguments in [
        &["plan", "nowhere.toml"][..],
        &["plan", "."],
        &["plan", "s.toml", "--out", "s.toml"],
        &["plan", "s.toml", "--out", "s.toml/deeper"],
        &["plan", "s.toml", "--formulas", "nowhere.toml"],
        &["plan", "s.toml", "--set", "arm.left.robot=nowhere.urdf"],
        &["formula", "check", "nowhere.toml"],
        &["formula", "list", "--formulas", "nowhere.toml"],
        &["robot", "show", "nowhere.urdf"],
        &["robot", "check", "."],
        &["robot", "fk", "nowhere.urdf", "--base", "a", "--tip", "b", "--q", "1"],
        &["reproduce", "--out", "s.toml"],
    ] {
        let error = desk.run(&[arguments, &["--json"]].concat()).expect(6).error();
        assert!(error["message"].as_str().unwrap().len() > 10, "{error}");
        let run = desk.run(arguments).expect(6);
        assert_eq!(run.out, "", "{arguments:?}");
        assert!(run.err.starts_with("error: ") || run.err.contains(": error: "), "{}", run.err);
    }
    assert_eq!(desk.names("."), ["s.toml"]);
}

#[cfg(target_os = "linux")]
#[test]
fn a_device_without_end_is_refused() {
    kinstep(&["plan", "/dev/zero"]).expect(6);
    kinstep(&["plan", "--formulas", "/dev/zero"]).expect(6);
    kinstep(&["robot", "show", "/dev/zero"]).expect(3);
}

#[cfg(target_os = "linux")]
#[test]
fn a_full_disk_is_a_sentence_and_a_closed_pipe_is_silent() {
    use std::process::{Command, Stdio};
    let program = assert_cmd::cargo::cargo_bin("kinstep");
    let full = std::fs::OpenOptions::new().write(true).open("/dev/full").unwrap();
    let output = Command::new(&program).args(["formula", "list"]).stdout(full).output().unwrap();
    assert_eq!(output.status.code(), Some(6));
    assert!(String::from_utf8_lossy(&output.stderr).contains("standard output can not be written"));

    let mut child = Command::new(&program)
        .args(["formula", "list"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert_eq!((output.status.code(), output.stderr.len()), (Some(0), 0));
}

/// Runs the program where no file may become longer than 4 KiB: writing fails in the middle, as on a full disk.
#[cfg(unix)]
fn where_little_fits(desk: &Desk, arguments: &[&str]) -> std::process::Output {
    std::process::Command::new("sh")
        .args(["-c", r#"trap "" XFSZ; ulimit -f 8; exec "$0" "$@""#])
        .arg(assert_cmd::cargo::cargo_bin("kinstep"))
        .args(arguments)
        .current_dir(desk.path("."))
        .output()
        .unwrap()
}

#[cfg(unix)]
#[test]
fn what_does_not_fit_on_the_disk_takes_nothing_with_it() {
    let desk = Desk::new(&[("s.toml", SMALL)]);
    desk.run(&["plan", "s.toml", "--out", "o"]).expect(0);
    let content = |folder: &str| -> Vec<(String, Vec<u8>)> {
        let read = |name: String| {
            let bytes = std::fs::read(desk.path(folder).join(&name)).unwrap();
            (name, bytes)
        };
        desk.names(folder).into_iter().map(read).collect()
    };
    let before = content("o");
    for (arguments, file) in [
        (&["plan", "s.toml", "--set", "law.h=0.3", "--out", "o", "--force"][..], "o/trajectory.csv"),
        (&["plan", "s.toml", "--out", "new"], "new/trajectory.csv"),
        (&["export", "o", "--format", "mcap"], "o/trajectory.mcap"),
        (&["plot", "o", "--figure", "joints", "--out", "pictures"], "pictures/joints-left.svg"),
        (&["robot", "export", "baxter", "--urdf", "b.urdf"], "b.urdf"),
    ] {
        let output = where_little_fits(&desk, arguments);
        let told = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(6), "{arguments:?}: {told}");
        assert!(told.contains(&format!("{file} can not be written: it would be larger")), "{told}");
        assert!(content("o") == before, "{arguments:?}: what was there is not as it was");
    }
    assert_eq!(desk.names("."), ["o", "s.toml"]);
}

#[cfg(unix)]
#[test]
fn a_sweep_that_filled_the_disk_goes_on_where_it_stopped() {
    let desk = Desk::new(&[("s.toml", SMALL)]);
    let sweep = |out: &'static str| {
        ["sweep", "s.toml", "--vary", "law.h=linspace(0.1, 0.6, 40)", "--set", "sigma=0.05", "--out", out]
    };
    desk.run(&sweep("whole.csv")).expect(0);
    let whole = std::fs::read(desk.path("whole.csv")).unwrap();
    assert!(whole.len() > 4096, "{} bytes would have fitted", whole.len());
    let output = where_little_fits(&desk, &sweep("grid.csv"));
    assert_eq!(output.status.code(), Some(6), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(!desk.path("grid.csv").exists());
    let journal = desk.path("grid.csv.journal");
    assert!(std::fs::read_to_string(&journal).unwrap().lines().count() > 2, "nothing was kept");
    desk.run(&sweep("grid.csv")).expect(0);
    assert!(std::fs::read(desk.path("grid.csv")).unwrap() == whole, "the table is another one");
    // A journal that did not come to the end of its first line has nothing in it, and is begun again.
    std::fs::remove_file(desk.path("grid.csv")).unwrap();
    std::fs::write(&journal, "").unwrap();
    desk.run(&sweep("grid.csv")).expect(0);
    assert!(std::fs::read(desk.path("grid.csv")).unwrap() == whole, "the table is another one");
    std::fs::write(&journal, "something else").unwrap();
    std::fs::remove_file(desk.path("grid.csv")).unwrap();
    desk.run(&sweep("grid.csv")).expect(6);
}

#[test]
fn usage_is_exit_2_in_both_forms() {
    for arguments in [&["plann"][..], &["plan", "--sett", "a=1"], &["robot", "fk"], &["schema", "arms"], &[]]
    {
        let run = kinstep(arguments).expect(2);
        assert_eq!(run.out, "");
        assert!(run.err.starts_with("error: "), "{}", run.err);
        let error = kinstep(&[arguments, &["--json"]].concat()).expect(2).error();
        assert_eq!(error["kind"], "usage");
    }
}

#[test]
fn help_and_version_are_exit_0_and_help_has_examples() {
    assert!(kinstep(&["--version"]).expect(0).out.starts_with("kinstep "));
    for arguments in [
        &["--help"][..],
        &["plan", "--help"],
        &["reproduce", "--help"],
        &["formula", "--help"],
        &["formula", "list", "--help"],
        &["formula", "show", "--help"],
        &["formula", "check", "--help"],
        &["robot", "--help"],
        &["robot", "list", "--help"],
        &["robot", "show", "--help"],
        &["robot", "check", "--help"],
        &["robot", "fk", "--help"],
        &["robot", "jacobian", "--help"],
        &["schema", "--help"],
    ] {
        let help = kinstep(arguments).expect(0).out;
        assert!(help.contains("Example"), "{arguments:?}\n{help}");
    }
}

#[test]
fn schemas_are_json_and_know_the_keys() {
    let scenario = kinstep(&["schema", "scenario"]).expect(0).json();
    assert_eq!(scenario["additionalProperties"], false);
    let required = scenario["required"].as_array().unwrap();
    for key in ["sigma", "duration"] {
        assert!(required.contains(&key.into()), "{key}");
    }
    for key in ["arm", "problem", "study"] {
        assert!(scenario["properties"][key].is_object(), "{key}");
        assert!(!required.contains(&key.into()), "a file holds arms or a problem: {key}");
    }
    assert!(!required.contains(&"formula".into()), "without one, the best general row is taken");
    assert!(scenario["properties"]["formula"].is_object());
    assert!(scenario["properties"]["sigma"]["description"].as_str().unwrap().contains("in s"));
    let text = scenario.to_string();
    for name in ["tricuspid", "sin2sin2", "pseudoinverse", "posture", "distance"] {
        assert!(text.contains(&format!("\"const\":\"{name}\"")), "{name}");
    }
    for key in ["radius", "petals", "cosines", "plane", "time_law"] {
        assert!(scenario["$defs"]["PathSpec"]["properties"][key].is_object(), "{key}");
    }
    assert_eq!(scenario["$defs"]["PathSpec"]["additionalProperties"], false);
    let formula = kinstep(&["schema", "formula", "--json"]).expect(0).json();
    assert!(formula["$defs"]["Row"]["properties"]["error_constant"].is_object());
}
