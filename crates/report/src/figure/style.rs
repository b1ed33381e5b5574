//! What all figures share: colours, sizes, widths of text.

/// Okabe and Ito's palette without its yellow, which is too light for lines on white.
pub(super) const COLOURS: [&str; 7] =
    ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#222222"];
/// Dashes that go with the colours, so that lines can be told apart in grey.
const DASHES: [&str; 7] = ["", "7 4", "2 3", "9 3 2 3", "12 4", "4 2", "1 2"];

pub(super) const PAPER: &str = "#ffffff";
pub(super) const TEXT: &str = "#222222";
pub(super) const GRID: &str = "#e3e3e3";
pub(super) const GUIDE: &str = "#8a8a8a";
pub(super) const FONT: &str = "Helvetica, Arial, sans-serif";
pub(super) const FONT_SIZE: f64 = 13.0;
pub(super) const TITLE_SIZE: f64 = 15.0;
pub(super) const CAPTION_SIZE: f64 = 11.5;

/// The longer side of a plot [px].
pub(super) const PLOT: f64 = 460.0;
/// The height of a plot whose axes have different units [px].
pub(super) const PLOT_HEIGHT: f64 = 330.0;

pub(super) fn colour(index: usize) -> &'static str {
    COLOURS[index % COLOURS.len()]
}

/// Beyond the seventh the colours come again with other dashes: 49 lines can be told apart.
pub(super) fn dash(index: usize) -> &'static str {
    DASHES[(index + index / COLOURS.len()) % DASHES.len()]
}

/// About how wide a text is set [px]: a little generous, as fonts differ from place to place.
pub(super) fn text_width(text: &str, size: f64) -> f64 {
    0.58 * size * text.chars().count() as f64
}

/// A text broken into lines of at most this width; a word that is wider is broken too.
pub(super) fn wrapped(text: &str, width: f64, size: f64) -> Vec<String> {
    let most = ((width / text_width("x", size)) as usize).max(8);
    let mut lines: Vec<String> = Vec::new();
    // Blanks that do not break are none here.
    for word in text.split(' ').filter(|word| !word.is_empty()) {
        let fits = |line: &&mut String| line.chars().count() + 1 + word.chars().count() <= most;
        match lines.last_mut().filter(fits) {
            Some(line) => *line = format!("{line} {word}"),
            None => lines.extend(pieces(word, most)),
        }
    }
    lines
}

fn pieces(word: &str, most: usize) -> impl Iterator<Item = String> {
    let letters: Vec<char> = word.chars().collect();
    letters.chunks(most).map(|piece| piece.iter().collect()).collect::<Vec<String>>().into_iter()
}

/// A text of at most so many characters: a longer one loses its middle, as the ends of names tell more.
pub(super) fn shortened(text: &str, most: usize) -> String {
    let letters: Vec<char> = text.chars().collect();
    if letters.len() <= most.max(3) {
        return text.to_owned();
    }
    let (head, tail) = (most.max(3) / 2, (most.max(3) - 1) / 2);
    let (head, tail) = (&letters[..head], &letters[letters.len() - tail..]);
    head.iter().chain(&['\u{2026}']).chain(tail).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forty_nine_lines_can_be_told_apart() {
        let mut looks: Vec<_> = (0..49).map(|k| (colour(k), dash(k))).collect();
        looks.sort_unstable();
        looks.dedup();
        assert_eq!(looks.len(), 49);
    }

    #[test]
    fn texts_are_broken_and_shortened_without_loss_of_their_ends() {
        assert_eq!(wrapped("one two three", text_width("one two!", 10.0), 10.0), ["one two", "three"]);
        assert_eq!(wrapped("", 100.0, 10.0), Vec::<String>::new());
        assert_eq!(wrapped("abcdefghijkl", 1.0, 10.0), ["abcdefgh", "ijkl"]);
        assert_eq!(shortened("shoulder_left", 7), "sho\u{2026}eft");
        assert_eq!(shortened("elbow", 7), "elbow");
    }
}
