//! Text for people: aligned columns, short numbers, curves in a line of text.

use std::fmt;

use kinstep::robot::names::printable;

/// Rows of text in aligned columns: the first column to the left, numbers to the right.
///
/// ```
/// let mut table = kinstep_report::Table::new(["arm", "error"]);
/// table.row(["left", "3.3e-7"]);
/// assert_eq!(table.to_string(), "arm    error\nleft  3.3e-7\n");
/// ```
#[derive(Clone, Debug, Default)]
pub struct Table {
    rows: Vec<Vec<String>>,
}

impl Table {
    /// Returns a table with its heading.
    pub fn new<S: Into<String>>(heading: impl IntoIterator<Item = S>) -> Self {
        let mut table = Self::default();
        table.row(heading);
        table
    }

    /// Adds a row. What a terminal would obey, a name with a line's end in it for one, is written by its number.
    pub fn row<S: Into<String>>(&mut self, cells: impl IntoIterator<Item = S>) -> &mut Self {
        let shown = |cell: S| printable(&cell.into()).into_owned();
        self.rows.push(cells.into_iter().map(shown).collect());
        self
    }

    fn widths(&self) -> Vec<usize> {
        let columns = self.rows.iter().map(Vec::len).max().unwrap_or(0);
        let width = |column: usize| {
            self.rows.iter().filter_map(|row| row.get(column)).map(|cell| cell.chars().count()).max()
        };
        (0..columns).map(|column| width(column).unwrap_or(0)).collect()
    }

    /// A column of numbers is set to the right, with its heading.
    fn is_numeric(&self, column: usize) -> bool {
        let mut cells =
            self.rows.iter().skip(1).filter_map(|row| row.get(column)).filter(|cell| !cell.is_empty());
        let numeric = |cell: &String| cell.starts_with(|c: char| c.is_ascii_digit() || "-+<(".contains(c));
        column > 0 && cells.all(numeric)
    }
}

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let widths = self.widths();
        let numeric: Vec<bool> = (0..widths.len()).map(|column| self.is_numeric(column)).collect();
        for row in &self.rows {
            let mut line = String::new();
            for ((cell, &width), &right) in row.iter().zip(&widths).zip(&numeric) {
                let blank = " ".repeat(width - cell.chars().count());
                let gap = if line.is_empty() { "" } else { "  " };
                line = if right {
                    format!("{line}{gap}{blank}{cell}")
                } else {
                    format!("{line}{gap}{cell}{blank}")
                };
            }
            writeln!(f, "{}", line.trim_end())?;
        }
        Ok(())
    }
}

/// Returns a number in at most about eight characters: plain where that is short, else with an exponent.
pub fn short(value: f64) -> String {
    let size = value.abs();
    if value == 0.0 {
        return "0".to_owned();
    }
    if !value.is_finite() {
        return format!("{value}");
    }
    if (1e-3..1e5).contains(&size) {
        let text = format!("{value:.4}");
        return text.trim_end_matches('0').trim_end_matches('.').to_owned();
    }
    format!("{value:.1e}")
}

/// Returns positive values as a line of bars on a logarithmic scale, `width` bars at most, each the largest of its
/// share of the values; a value that is not finite stands as `!`.
///
/// The lowest bar is 1e-6 of the largest value, or the smallest value if that is larger.
pub fn sparkline(values: &[f64], width: usize) -> String {
    const BARS: [char; 8] = ['▁', '▂', '▃', '▄', '▅', '▆', '▇', '█'];
    let finite = |v: &&f64| v.is_finite() && **v > 0.0;
    let top = values.iter().filter(finite).fold(0.0_f64, |a, &b| a.max(b));
    let least = values.iter().filter(finite).fold(top, |a, &b| a.min(b)).max(top * 1e-6);
    let decades = (top / least).log10().max(1.0);
    let share = values.len().div_ceil(width.max(1)).max(1);
    let bar = |chunk: &[f64]| {
        let largest =
            chunk.iter().fold(0.0_f64, |a, &b| if b.is_nan() || a.is_nan() { f64::NAN } else { a.max(b) });
        if !largest.is_finite() {
            return '!';
        }
        let height = if largest > 0.0 { 1.0 + (largest / top).log10() / decades } else { 0.0 };
        BARS[((height * 7.0).round().clamp(0.0, 7.0)) as usize]
    };
    values.chunks(share).map(bar).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_keep_their_size() {
        for (value, text) in [
            (0.0, "0"),
            (0.4, "0.4"),
            (-12.5, "-12.5"),
            (3.31e-7, "3.3e-7"),
            (1e300, "1.0e300"),
            (2.0, "2"),
            (f64::INFINITY, "inf"),
        ] {
            assert_eq!(short(value), text);
        }
    }

    #[test]
    fn a_sparkline_rises_with_its_values_and_marks_what_is_not_finite() {
        assert_eq!(sparkline(&[1e-8, 1e-6, 1e-4], 10), "▁▅█");
        assert_eq!(sparkline(&[0.0, 0.0], 10), "▁▁");
        assert_eq!(sparkline(&[1.0, f64::NAN, f64::INFINITY], 10), "█!!");
        assert_eq!(sparkline(&[], 10), "");
        assert_eq!(sparkline(&vec![1.0; 1000], 40).chars().count(), 40);
    }

    #[test]
    fn columns_align_whatever_they_hold() {
        let mut table = Table::new(["a", "π", "name"]);
        table.row(["long", "1", "x"]).row(["é", "-10", ""]);
        assert_eq!(table.to_string(), "a       π  name\nlong    1  x\né     -10\n");
    }
}
