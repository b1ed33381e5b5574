//! Byte offsets to lines and columns.

/// Distance between two remembered character counts, in bytes.
const STRIDE: usize = 1024;

/// Finds the line and column of any byte offset in constant time (binary search over lines).
pub(super) struct Places<'a> {
    text: &'a str,
    line_starts: Vec<usize>,
    /// Number of characters that begin before each multiple of [`STRIDE`].
    counts: Vec<usize>,
}

impl<'a> Places<'a> {
    pub(super) fn new(text: &'a str) -> Places<'a> {
        let ends = text.bytes().enumerate().filter(|&(_, byte)| byte == b'\n').map(|(index, _)| index + 1);
        let line_starts = std::iter::once(0).chain(ends).collect();
        let mut counts = vec![0];
        let mut count = 0;
        for chunk in text.as_bytes().chunks(STRIDE) {
            count += begun_characters(chunk);
            counts.push(count);
        }
        Places { text, line_starts, counts }
    }

    /// Returns line and column, both counted from 1, the column in characters.
    pub(super) fn at(&self, offset: usize) -> (usize, usize) {
        let offset = offset.min(self.text.len());
        let line = self.line_starts.partition_point(|&start| start <= offset);
        let start = self.line_starts[line - 1];
        (line, self.characters_before(offset) - self.characters_before(start) + 1)
    }

    pub(super) fn line(&self, offset: usize) -> usize {
        self.at(offset).0
    }

    fn characters_before(&self, offset: usize) -> usize {
        let block = offset / STRIDE;
        self.counts[block] + begun_characters(&self.text.as_bytes()[block * STRIDE..offset])
    }
}

fn begun_characters(bytes: &[u8]) -> usize {
    bytes.iter().filter(|&&byte| byte & 0xC0 != 0x80).count()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_lines_and_characters_from_one() {
        let text = "ab\nçd\r\n\nx";
        let places = Places::new(text);
        assert_eq!(places.at(0), (1, 1));
        assert_eq!(places.at(text.find('d').unwrap()), (2, 2));
        assert_eq!(places.at(text.find('x').unwrap()), (4, 1));
        assert_eq!(places.at(1_000), (4, 2));
    }

    #[test]
    fn counts_characters_across_long_lines() {
        let text = "é".repeat(3_000);
        let places = Places::new(&text);
        for column in [0, 511, 512, 513, 1_024, 2_999] {
            assert_eq!(places.at(2 * column), (1, column + 1));
        }
    }
}
