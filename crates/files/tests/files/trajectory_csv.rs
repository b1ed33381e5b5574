//! Trajectories as comma-separated values: written and read back, and what is refused.

#![allow(clippy::unwrap_used, reason = "a test that can not go on stops")]

use std::fs;

use crate::trajectories::{assert_same_bits, trajectories};
use kinstep_files::trajectory::{
    Csv, CsvMetadata, Recording, Stage, TextPlace, Trajectory, TrajectoryError, TrajectoryErrorKind,
    TrajectoryFormat,
};
use proptest::prelude::*;

proptest! {
    #[test]
    fn a_table_reads_back_as_it_was(trajectory in trajectories(), crlf in any::<bool>(), mark in any::<bool>()) {
        let folder = tempfile::tempdir().unwrap();
        let recording = Recording { trajectory: &trajectory, stage: &Stage::default() };
        let mut text = Vec::new();
        Csv.write(recording, &mut text).unwrap();
        let text = String::from_utf8(text).unwrap();
        let text = if crlf { text.replace('\n', "\r\n") } else { text };
        let path = folder.path().join("a.csv");
        fs::write(&path, format!("{}{text}", if mark { "\u{feff}" } else { "" })).unwrap();
        let metadata = CsvMetadata { table: "a.csv".to_owned() };
        let mut document = Vec::new();
        metadata.write(recording, &mut document).unwrap();
        fs::write(folder.path().join(metadata.file_name()), document).unwrap();
        assert_same_bits(&Trajectory::read(&path).unwrap(), &trajectory);
    }

    #[test]
    fn no_text_makes_the_reader_panic(text in "[t,a.;\"\n\r0-9 \\-eE]{0,60}") {
        let _ = Trajectory::from_bytes("a.csv".as_ref(), text.as_bytes());
    }
}

fn read(text: &str) -> Result<Trajectory, TrajectoryError> {
    Trajectory::from_bytes("a.csv".as_ref(), text.as_bytes())
}

#[test]
fn bad_tables_are_refused_with_their_place() {
    for (text, line, column, word) in [
        ("", 1, 1, "empty"),
        ("t,l.a\n0,1\n", 2, 4, "ends after 1"),
        ("t,l.a\n", 1, 6, "ends after 0"),
        ("t,l.a\n0,1\n1,2\n0.5,3\n", 4, 1, "does not come after 1 s"),
        ("t,l.a\n0,1\n0,2\n", 3, 1, "does not come after"),
        ("t,l.a\n0,1\n1,\n", 3, 3, "gap"),
        ("t,l.a\n0,1\n1,NaN\n", 3, 3, "not a finite number"),
        ("t,l.a\n0,1\n1,-inf\n", 3, 3, "not a finite number"),
        ("t,l.a\n0,1\n1,1e999\n", 3, 3, "not a finite number"),
        ("t,l.\u{e9},l.b\n0,1,2\n1,2,x\n", 3, 5, "`x`"),
        ("t,l.a\n0,1\n1\n", 3, 2, "expected 2 fields"),
        ("t,l.a\r\n0,1\r\n1,2,3\r\n", 3, 5, "expected 2 fields"),
        ("t;l.a,l.b\n0;1\n1;2\n", 1, 1, "both commas and semicolons"),
        ("t;l.a\n0;1\n1;1.000,5\n", 3, 3, "not a number: `1.000,5`"),
        ("0,1\n1,2\n", 1, 1, "here are numbers"),
        ("x,l.a\n0,1\n1,2\n", 1, 1, "no column has times"),
        ("t,l.a,l.a\n0,1,1\n1,2,2\n", 1, 7, "two columns"),
        ("t,l.a,\n0,1,1\n1,2,2\n", 1, 7, "no name"),
        ("t,l.a,b\n0,1,1\n1,2,2\n", 1, 7, "names no arm"),
        ("t,l.a,l.b.velocity\n0,1,1\n1,2,2\n", 1, 7, "no positions"),
        ("t,l.a,r.error\n0,1,1\n1,2,2\n", 1, 7, "arm `r`"),
        ("t,a,b,a.velocity\n0,1,1,1\n1,2,2,1\n", 1, 1, "`b` has none"),
        ("t,\"l.a\n0,1\n1,2\n", 1, 3, "not closed"),
    ] {
        let error = read(text).unwrap_err();
        let place = error.place.clone().unwrap_or_else(|| panic!("{text:?}: {error}"));
        assert_eq!((place.line, place.column), (line, column), "{text:?}: {error}");
        assert!(error.message.contains(word), "{text:?}: {error}");
        assert!(error.to_string().starts_with(&format!("a.csv:{line}:{column}: ")), "{error}");
        assert_eq!(error.kind, TrajectoryErrorKind::Content);
    }
    let TextPlace { source_line, .. } = read("t,l.a\n0,1\n1,x\n").unwrap_err().place.unwrap();
    assert_eq!(source_line, "1,x");
    assert!(read("t\n0\n1\n").unwrap_err().message.contains("no joint"));
    let error = Trajectory::from_bytes("a.csv".as_ref(), b"t,\xff\n").unwrap_err();
    assert!(error.message.contains("byte 3 is not UTF-8"), "{error}");
}

#[test]
fn tables_of_others_are_read() {
    let plain = read(
        "# time,shoulder,shoulder.velocity,elbow,elbow.velocity,error\r\n0,1,2,3,4,5\r\n1,6,7,8,9,10\r\n\r\n",
    );
    let plain = plain.unwrap();
    let arm = &plain.arms[0];
    assert_eq!((arm.name.as_str(), arm.joints.join(" ")), ("arm", "shoulder elbow".to_owned()));
    assert_eq!((arm.position(1), arm.velocity(1).unwrap()), (&[6.0, 8.0][..], &[7.0, 9.0][..]));
    assert_eq!((arm.errors.as_slice(), plain.times.as_slice()), (&[5.0, 10.0][..], &[0.0, 1.0][..]));

    let mixed = read("r.b,t,l.a,r.a,r.error,r.error.velocity,r.a.velocity,r.b.velocity\n1,0,2,3,4,5,6,7\n8,1,9,10,11,12,13,14\n").unwrap();
    assert_eq!(mixed.arms[0].joints, ["b", "a", "error"]);
    assert_eq!(mixed.arms[0].velocity(1).unwrap(), [14.0, 13.0, 12.0]);
    assert_eq!((mixed.arms[1].position(1), mixed.arms[1].velocity(1)), (&[9.0][..], None));
}

#[test]
fn files_that_are_not_there_are_told_from_bad_ones() {
    let folder = tempfile::tempdir().unwrap();
    for path in [folder.path().join("none.csv"), folder.path().to_owned()] {
        assert_eq!(Trajectory::read(path).unwrap_err().kind, TrajectoryErrorKind::File);
    }
    let path = folder.path().join("a.csv");
    fs::write(&path, "t,a\n0,1\n1,2\n").unwrap();
    assert_eq!(Trajectory::read(&path).unwrap().about, None);
    fs::write(folder.path().join("a.csv-metadata.json"), "{").unwrap();
    assert!(Trajectory::read(&path).unwrap_err().message.contains("a.csv-metadata.json"));
}
