//! The sources of the rows as BibTeX.

const REFERENCES: &str = include_str!("../../docs/references.bib");

/// Returns the BibTeX entry of a source: its first word is the key, as in `wang2020 eq. (6)`.
///
/// ```
/// let entry = kinstep::formula::bibtex("wang2020 eq. (6)").ok_or("no entry")?;
/// assert!(entry.starts_with("@article{wang2020,") && entry.ends_with('}'));
/// # Ok::<(), &str>(())
/// ```
pub fn bibtex(source: &str) -> Option<&'static str> {
    let key = source.split_whitespace().next()?;
    let begins = |at: usize| {
        REFERENCES[at..].split_once('{').is_some_and(|(_, rest)| rest.starts_with(&format!("{key},")))
    };
    let start = REFERENCES.match_indices('@').map(|(at, _)| at).find(|at| begins(*at))?;
    let mut depth = 0;
    for (offset, c) in REFERENCES[start..].char_indices() {
        match c {
            '{' => depth += 1,
            '}' if depth == 1 => return Some(&REFERENCES[start..=start + offset]),
            '}' => depth -= 1,
            _ => {}
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formula::{DerivativeRule, FormulaTable};

    #[test]
    fn every_source_has_an_entry() {
        let rows = FormulaTable::builtin().iter().map(|row| (row.id(), row.source()));
        let rules = DerivativeRule::builtin().iter().map(|rule| (rule.id(), rule.source()));
        for (id, source) in rows.chain(rules) {
            let entry = bibtex(source).unwrap_or_else(|| panic!("{id}: no entry for {source}"));
            assert_eq!(entry.matches('{').count(), entry.matches('}').count(), "{entry}");
        }
        assert_eq!(bibtex("nobody1900"), None);
        assert_eq!(bibtex(""), None);
    }
}
