//! Colours of a terminal for the words that tell how things went.

/// Returns a report with its verdicts painted: green where all is well, red where it stopped, yellow where to look.
pub(super) fn painted(text: &str) -> String {
    text.split_inclusive('\n').map(line).collect()
}

fn line(line: &str) -> String {
    const VERDICTS: [(&str, &str); 6] = [
        ("completed", "32"),
        ("stopped,", "1;31"),
        ("warning:", "33"),
        ("limit crossed", "33"),
        ("close to a limit:", "33"),
        ("Next:", "1"),
    ];
    match VERDICTS.iter().find(|(word, _)| line.starts_with(word)) {
        Some((word, code)) => format!("\u{1b}[{code}m{word}\u{1b}[0m{}", &line[word.len()..]),
        None => line.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paint_is_all_that_is_added() {
        let text = "2 arms\ncompleted\n\nwarning: slow\nthe warning: is inside\nNext:\n  kinstep plan";
        let coloured = painted(text);
        assert_eq!(coloured.matches("\u{1b}[0m").count(), 3);
        let plain = ["\u{1b}[32m", "\u{1b}[33m", "\u{1b}[1m", "\u{1b}[0m"];
        assert_eq!(plain.iter().fold(coloured, |text, code| text.replace(code, "")), text);
    }
}
