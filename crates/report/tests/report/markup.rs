//! What a page has to be as a file.

#![allow(clippy::unwrap_used, reason = "a test that can not go on stops")]

/// Checks that every element that is opened is closed, in order.
#[track_caller]
pub(crate) fn check_nesting(html: &str) {
    const VOID: [&str; 5] = ["meta", "input", "br", "link", "img"];
    let mut open: Vec<String> = Vec::new();
    let mut rest = html.strip_prefix("<!DOCTYPE html>").unwrap();
    while let Some(begin) = rest.find('<') {
        rest = &rest[begin + 1..];
        let end = rest.find('>').unwrap();
        let (tag, after) = rest.split_at(end);
        rest = &after[1..];
        let name: String =
            tag.chars().skip_while(|c| *c == '/').take_while(char::is_ascii_alphanumeric).collect();
        assert!(!name.is_empty(), "<{tag}> is no element");
        let mut attributes = tag.split_whitespace().skip(1).filter(|word| word.contains("=\""));
        assert!(attributes.all(|word| !word.starts_with("on")), "<{tag}> has a handler");
        if tag.starts_with('/') {
            assert_eq!(open.pop().as_ref(), Some(&name), "</{tag}> closes nothing");
        } else if !tag.ends_with('/') && !VOID.contains(&name.as_str()) {
            if ["script", "style"].contains(&name.as_str()) {
                let close = format!("</{name}>");
                rest = &rest[rest.find(&close).unwrap() + close.len()..];
            } else {
                open.push(name);
            }
        }
    }
    assert!(open.is_empty(), "{open:?} stay open");
}

/// Checks that a page is whole and asks for nothing.
#[track_caller]
pub(crate) fn check(html: &str) {
    check_nesting(html);
    assert_eq!(html.matches("<script").count() - html.matches("id=\"scene\"").count(), 1);
    assert!(html.contains("default-src 'none'; script-src 'sha256-"));
    // Namespaces are names, not places.
    let without_names = html.replace("http://www.w3.org/2000/svg", "");
    for loads in ["http:", "https:", " src=", "url(//", "@import", "{{", "NaN,"] {
        assert!(!without_names.contains(loads), "{loads:?} is in the page");
    }
}
