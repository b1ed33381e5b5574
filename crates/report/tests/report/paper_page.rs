//! The page about the paper says what is measured today.
#![allow(clippy::unwrap_used, reason = "a test that can not go on stops")]

#[test]
fn the_page_about_the_paper_is_what_would_be_written_today() {
    let page = kinstep_report::paper_page().unwrap();
    let kept = include_str!("../../../../docs/paper.md");
    assert_eq!(kept, page, "`kinstep reproduce --page docs/paper.md --force` writes it anew");
}
