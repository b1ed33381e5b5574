//! Files of any size are read, or refused, in bounded memory: nothing that a file says makes it grow.

#![allow(clippy::unwrap_used, reason = "a test that can not go on stops")]

use std::fmt::Write;

use crate::chains::chain_of;
use allocation_counter::measure;
use kinstep::robot::{DhTable, MAX_BYTES, MAX_DEPTH, Robot, UrdfOptions};

const MEGABYTE: u64 = 1 << 20;

/// Reads a text that is refused; returns the sentence and the most memory taken beside the text [bytes].
fn refused(text: &str) -> (String, u64) {
    let mut message = String::new();
    let counted = measure(|| message = Robot::from_urdf(text).expect_err("too much").to_string());
    (message, counted.bytes_max)
}

#[test]
fn a_hundred_thousand_joints_are_refused_in_memory_of_the_files_order() {
    let text = chain_of(100_000);
    let (message, bytes) = refused(&text);
    assert!(message.contains("the robot has 100001 links, more than the 20001 that are read"), "{message}");
    assert!(bytes < 12 * text.len() as u64, "{bytes} bytes for a file of {}", text.len());
}

#[test]
fn the_most_joints_that_are_read_take_memory_of_the_files_order() {
    let text = chain_of(20_000);
    let mut joints = 0;
    let counted = measure(|| joints = Robot::from_urdf(&text).unwrap().joints().len());
    assert_eq!(joints, 20_000);
    assert!(counted.bytes_max < 8 * 1024 * 20_000, "{} bytes, 8 kB a joint are fair", counted.bytes_max);
}

#[test]
fn two_million_nested_tags_are_refused_before_a_tree_is_built() {
    let (message, bytes) = refused(&format!("<robot name=\"deep\">{}", "<a>".repeat(2_000_000)));
    assert!(message.contains(&format!("nested deeper than {MAX_DEPTH} elements")), "{message}");
    assert!(bytes < MEGABYTE, "{bytes}");
}

#[test]
fn entities_are_neither_expanded_nor_fetched() {
    let mut entities = String::from("<!ENTITY a0 \"ha\">");
    for level in 1..30 {
        let _ = write!(entities, "<!ENTITY a{level} \"{}\">", format!("&a{};", level - 1).repeat(10));
    }
    let laughs = format!("<?xml version=\"1.0\"?><!DOCTYPE robot [{entities}]><robot name=\"&a29;\"/>");
    let (message, bytes) = refused(&laughs);
    assert!(message.contains("a DTD (`<!DOCTYPE ...>`) is not allowed"), "{message}");
    assert!(bytes < MEGABYTE, "{bytes}");
    let folder = tempfile::tempdir().unwrap();
    let secret = folder.path().join("secret.txt");
    std::fs::write(&secret, "SECRET").unwrap();
    let outside = format!(
        "<!DOCTYPE robot [<!ENTITY x SYSTEM \"file://{}\">]><robot name=\"r\">&x;</robot>",
        secret.display()
    );
    let (message, _) = refused(&outside);
    assert!(message.contains("DTD") && !message.contains("SECRET"), "{message}");
}

#[test]
fn of_a_file_of_two_gigabytes_no_more_than_the_cap_is_read() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("huge.urdf");
    let file = std::fs::File::create(&path).unwrap();
    // A hole: the file system stores nothing of it.
    if file.set_len(2 << 30).is_err() {
        return;
    }
    let mut message = String::new();
    let counted = measure(|| {
        message = Robot::from_urdf_file(&path, &UrdfOptions::default()).unwrap_err().to_string();
    });
    assert!(message.contains(&format!("more than the {MAX_BYTES} (64 MiB) that are read")), "{message}");
    assert!(counted.bytes_max < 4 * MAX_BYTES as u64, "{}", counted.bytes_max);
}

#[test]
fn a_table_of_a_hundred_thousand_rows_is_refused() {
    let text = format!("convention = \"standard\"\n{}", "[[joint]]\na = 1\n".repeat(100_000));
    let message = DhTable::from_toml(&text).unwrap_err().to_string();
    assert!(
        message.starts_with("line 20002, column 1: the table has 100000 rows, more than the 10000"),
        "{message}"
    );
    let made = Robot::from_dh(&DhTable::planar("long", &vec![1.0; 10_000])).unwrap_err().to_string();
    assert!(made.contains("the table has 10001 rows") && made.contains("at most 10000"), "{made}");
}
