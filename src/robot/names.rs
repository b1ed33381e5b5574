//! Names in messages: the nearest known ones, and long ones cut short.

use std::borrow::Cow;
use std::path::Path;

/// Longest name, in characters, that a comparison is worth.
const LONGEST: usize = 64;
/// Longest name of a link or joint that is read, in bytes.
pub(super) const LONGEST_NAME: usize = 1024;
/// How many known names a message offers at most.
const OFFERED: usize = 3;
/// How many characters of a name or value a message shows.
const SHOWN: usize = 60;

/// Returns up to three of `known` that look like `name`, nearest first.
pub(crate) fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Vec<&'a str> {
    let length = name.chars().count();
    if length == 0 || length > LONGEST {
        return Vec::new();
    }
    let wanted = name.to_lowercase();
    let most = (length / 3).max(2).min(length - 1);
    let mut ranked: Vec<(usize, &str)> = known
        .into_iter()
        .filter(|candidate| candidate.len() <= 2 * LONGEST)
        .filter_map(|candidate| {
            let distance = strsim::osa_distance(&wanted, &candidate.to_lowercase());
            (distance <= most || is_part_of(&wanted, candidate)).then_some((distance, candidate))
        })
        .collect();
    ranked.sort_unstable();
    ranked.dedup();
    ranked.truncate(OFFERED);
    ranked.into_iter().map(|(_, candidate)| candidate).collect()
}

/// Whether a name of some substance is a piece of a longer one (`hand` of `panda_hand`).
fn is_part_of(wanted: &str, candidate: &str) -> bool {
    wanted.len() >= 3 && candidate.to_lowercase().contains(wanted)
}

/// Returns `; did you mean `a`, `b` or `c`?`, or nothing when there is nothing to offer.
pub(crate) fn suggestion(nearest: &[impl AsRef<str>]) -> String {
    if nearest.is_empty() { String::new() } else { format!("; did you mean {}?", list(nearest, "or")) }
}

/// Returns names as a list in words: `` `a`, `b` or `c` ``.
pub(crate) fn list(names: &[impl AsRef<str>], conjunction: &str) -> String {
    let quoted: Vec<String> = names.iter().map(|name| quote(name.as_ref())).collect();
    match quoted.split_last() {
        None => String::new(),
        Some((last, [])) => last.clone(),
        Some((last, rest)) => format!("{} {conjunction} {last}", rest.join(", ")),
    }
}

/// As [`list`], with at most ten names written out.
pub(crate) fn short_list(names: &[impl AsRef<str>], conjunction: &str) -> String {
    const MOST: usize = 10;
    if names.len() <= MOST + 1 {
        return list(names, conjunction);
    }
    let first: Vec<String> = names[..MOST].iter().map(|name| quote(name.as_ref())).collect();
    format!("{} and {} more", first.join(", "), names.len() - MOST)
}

/// Returns the name of a link, joint, file or key as messages show it: between backticks, odd characters escaped, cut after
/// sixty characters.
pub fn quote(name: &str) -> String {
    let end = name.char_indices().nth(SHOWN).map_or(name.len(), |(end, _)| end);
    let cut = if end < name.len() { "…" } else { "" };
    format!("`{}{cut}`", printable(&name[..end]))
}

/// Returns a text as it may be shown on a terminal: [odd](is_odd) characters are written by their numbers, `\u{1b}`, or `\n`.
pub fn printable(text: &str) -> Cow<'_, str> {
    if !text.contains(is_odd) {
        return Cow::Borrowed(text);
    }
    let mut shown = String::with_capacity(text.len() + 8);
    for c in text.chars() {
        if is_odd(c) { shown.extend(c.escape_default()) } else { shown.push(c) }
    }
    Cow::Owned(shown)
}

/// Returns the path of a file as it may be shown on a terminal; see [`printable`].
pub fn shown(path: &Path) -> String {
    printable(&path.to_string_lossy()).into_owned()
}

/// Whether a character commands a terminal, turns the direction of writing, or looks like a blank or like nothing and is
/// neither.
pub fn is_odd(c: char) -> bool {
    c.is_control()
        || (c.is_whitespace() && c != ' ')
        || matches!(c, '\u{ad}' | '\u{200b}' | '\u{200e}' | '\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2060}'..='\u{2069}' | '\u{feff}')
}

/// Says what is wrong with the name of a link or a joint; nothing where URDF can hold it.
pub(super) fn problem(name: &str) -> Option<String> {
    if name.trim().is_empty() {
        return Some("is empty".to_owned());
    }
    if name.len() > LONGEST_NAME {
        return Some(format!("has more than {LONGEST_NAME} bytes"));
    }
    let foreign = name.chars().find(|&c| !is_of_xml(c));
    foreign.map(|c| format!("holds the character {}, which no URDF can hold", quote(&c.to_string())))
}

/// Whether a character may stand in XML.
pub(super) fn is_of_xml(c: char) -> bool {
    matches!(c, '\t' | '\n' | '\r' | ' '..='\u{fffd}' | '\u{10000}'..)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn offers_misspelt_and_partial_names_nearest_first() {
        let known = ["panda_link7", "panda_link8", "panda_hand", "camera"];
        assert_eq!(nearest("panda_lnik7", known), ["panda_link7", "panda_link8"]);
        assert_eq!(nearest("hand", known), ["panda_hand"]);
        assert_eq!(nearest("Camera", known), ["camera"]);
        assert!(nearest("wheel", known).is_empty());
    }

    #[test]
    fn a_huge_name_is_neither_compared_nor_shown_whole() {
        let huge = "x".repeat(1_000_000);
        assert!(nearest(&huge, [huge.as_str()]).is_empty());
        assert!(quote(&huge).len() < 80);
    }

    #[test]
    fn what_a_terminal_would_obey_is_written_by_its_number() {
        assert_eq!(
            printable("a\u{1b}[31mb\u{9b}c\nd\u{a0}e\u{202e}f"),
            r"a\u{1b}[31mb\u{9b}c\nd\u{a0}e\u{202e}f"
        );
        assert_eq!(quote("1\u{a0}2"), r"`1\u{a0}2`");
        for plain in ["größe", "関節 1", "a\u{200d}b", "it's"] {
            assert_eq!(printable(plain), plain);
        }
    }

    #[test]
    fn names_that_urdf_can_not_hold_say_why() {
        assert_eq!(problem(" ").unwrap(), "is empty");
        assert_eq!(problem("a\u{0}").unwrap(), r"holds the character `\u{0}`, which no URDF can hold");
        assert!(problem("a\u{ffff}").is_some() && problem(&"x".repeat(1025)).is_some());
        assert_eq!(["a", "a b", "a\nb", "\u{9b}", "𝕒"].map(problem), [const { None }; 5]);
    }

    #[test]
    fn lists_read_as_sentences() {
        assert_eq!(list(&["a"], "or"), "`a`");
        assert_eq!(list(&["a", "b", "c"], "or"), "`a`, `b` or `c`");
        assert_eq!(suggestion(&["a", "b"]), "; did you mean `a` or `b`?");
    }
}
