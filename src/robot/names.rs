//! Names in messages: the nearest known ones, and long ones cut short.

/// Longest name, in characters, that a comparison is worth.
const LONGEST: usize = 64;
/// Longest name of a link or joint that is read, in bytes.
pub(super) const LONGEST_NAME: usize = 1024;
/// How many known names a message offers at most.
const OFFERED: usize = 3;
/// How many characters of a name or value a message shows.
const SHOWN: usize = 60;

/// Returns up to three of `known` that look like `name`, nearest first.
pub(super) fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Vec<&'a str> {
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
pub(super) fn suggestion(nearest: &[impl AsRef<str>]) -> String {
    if nearest.is_empty() { String::new() } else { format!("; did you mean {}?", list(nearest, "or")) }
}

/// Returns names as a list in words: `` `a`, `b` or `c` ``.
pub(super) fn list(names: &[impl AsRef<str>], conjunction: &str) -> String {
    let quoted: Vec<String> = names.iter().map(|name| quote(name.as_ref())).collect();
    match quoted.split_last() {
        None => String::new(),
        Some((last, [])) => last.clone(),
        Some((last, rest)) => format!("{} {conjunction} {last}", rest.join(", ")),
    }
}

/// As [`list`], with at most ten names written out.
pub(super) fn short_list(names: &[impl AsRef<str>], conjunction: &str) -> String {
    const MOST: usize = 10;
    if names.len() <= MOST + 1 {
        return list(names, conjunction);
    }
    let first: Vec<String> = names[..MOST].iter().map(|name| quote(name.as_ref())).collect();
    format!("{} and {} more", first.join(", "), names.len() - MOST)
}

/// Returns a name between backticks, control characters escaped, cut after sixty characters.
pub(crate) fn quote(name: &str) -> String {
    let mut quoted = String::from("`");
    for (count, c) in name.chars().enumerate() {
        if count == SHOWN {
            quoted.push('…');
            break;
        }
        if c.is_control() { quoted.extend(c.escape_default()) } else { quoted.push(c) }
    }
    quoted.push('`');
    quoted
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
    fn lists_read_as_sentences() {
        assert_eq!(list(&["a"], "or"), "`a`");
        assert_eq!(list(&["a", "b", "c"], "or"), "`a`, `b` or `c`");
        assert_eq!(suggestion(&["a", "b"]), "; did you mean `a` or `b`?");
    }
}
