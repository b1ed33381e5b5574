//! Commands that are printed to be typed again: their words as a shell takes them.

use std::fmt::Write;

use kinstep::robot::names::is_odd;

/// Returns a word as a shell takes it: as it is, in quotes where it holds anything that means something to a shell, and with
/// control characters by their numbers (`$'\x1b'`, as bash and zsh read it).
pub(super) fn quoted(word: &str) -> String {
    let plain = |c: char| c.is_alphanumeric() || "_-./:+@%,".contains(c);
    // At the beginning of a word zsh takes `=` for the place of a command.
    let is_plain = |(place, c): (usize, char)| plain(c) || (c == '=' && place > 0);
    if !word.is_empty() && word.char_indices().all(is_plain) {
        word.to_owned()
    } else if word.contains(is_odd) {
        escaped(word)
    } else {
        format!("'{}'", word.replace('\'', r"'\''"))
    }
}

fn escaped(word: &str) -> String {
    let mut text = "$'".to_owned();
    for c in word.chars() {
        // Writing to a String can not fail.
        let _ = match c {
            '\'' | '\\' => write!(text, "\\{c}"),
            c if c.is_ascii_control() => write!(text, "\\x{:02x}", u32::from(c)),
            c if is_odd(c) => write!(text, "\\u{:04x}", u32::from(c)),
            c => write!(text, "{c}"),
        };
    }
    text + "'"
}

/// Returns ` --name value` as a shell and the parser of arguments take it: a value that begins with a dash is no option.
pub(super) fn option(name: &str, value: &str) -> String {
    let between = if value.starts_with('-') { '=' } else { ' ' };
    format!(" {name}{between}{}", quoted(value))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn plain_words_stay_as_they_are() {
        for word in ["panda_link0", "robots/arm.urdf", "--q=0.1,-2", "j2=0.4", "größe"] {
            assert_eq!(quoted(word), word);
        }
        assert_eq!(option("--base", "left hand"), " --base 'left hand'");
        assert_eq!(option("--base", "-1"), " --base=-1");
    }

    #[test]
    fn control_characters_are_written_by_their_numbers() {
        assert_eq!(quoted("a\u{1b}[31m'\\\u{9b}\n"), r"$'a\x1b[31m\'\\\u009b\x0a'");
    }

    #[cfg(unix)]
    #[test]
    fn a_shell_reads_back_every_word() {
        for word in [
            "", "a b", "it's", "$HOME", "`id`", "a\"b\\c", "*", "=ls", "~", "#x", "a;b&c|d", "{a,b}", "(x)",
            "!!",
        ] {
            let script = format!("printf %s {}", quoted(word));
            let run = std::process::Command::new("sh").args(["-c", &script]).output().unwrap();
            assert_eq!(String::from_utf8(run.stdout).unwrap(), word, "{script}");
        }
    }
}
