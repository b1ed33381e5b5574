//! The page beside a plan.

#![allow(clippy::unwrap_used, reason = "a test that can not go on stops")]

use std::fs;

use crate::markup::check;
use crate::program::{Desk, kinstep};

#[test]
fn plans_are_written_with_their_page_unless_it_is_not_wanted() {
    let desk = Desk::new(&[]);
    let folder = desk.path("out");
    let out = folder.to_str().unwrap();
    let run =
        kinstep(&["plan", "examples/planar_dual.toml", "--set", "duration=0.2", "--out", out]).expect(0);
    assert!(run.out.contains("report.html"), "{}", run.out);
    let html = fs::read_to_string(folder.join("report.html")).unwrap();
    check(&html);
    assert!(
        html.contains("<title>planar_dual – kinstep</title>") && html.contains("--set formula=split-ab6")
    );
    let refused = kinstep(&["plan", "--out", out]).expect(6);
    assert!(refused.err.contains("already there"));
    fs::remove_dir_all(&folder).unwrap();
    kinstep(&["plan", "examples/planar_dual.toml", "--set", "duration=0.2", "--out", out, "--no-report"])
        .expect(0);
    assert!(!folder.join("report.html").exists());
    kinstep(&["plan", "--no-report"]).expect(2);
}
