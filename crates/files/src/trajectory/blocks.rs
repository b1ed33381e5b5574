//! Long files, block by block: read by one thread, worked on by all processors, handed on in order.
//!
//! Of the text there are never more than a few blocks in memory, however long the file is.

use std::collections::VecDeque;
use std::io::Read;
use std::sync::mpsc::sync_channel;
use std::thread;

use super::lines::threads;

/// How many bytes are read at a time.
pub(super) const BLOCK: usize = 1 << 20;
/// The longest block \[bytes\]: what has no place to be cut at by then is not worked on in blocks.
const LONGEST: usize = 64 * BLOCK;

/// A text in blocks that end where it may be cut.
pub(super) struct Blocks<'r, C> {
    source: &'r mut dyn Read,
    /// The last place in a text at which a block may end.
    cut: C,
    size: usize,
    /// What was read behind the last cut.
    rest: Vec<u8>,
}

impl<'r, C: Fn(&[u8]) -> Option<usize>> Blocks<'r, C> {
    /// The text that the source goes on with, cut at places that `cut` finds from the end.
    pub(super) fn new(source: &'r mut dyn Read, size: usize, cut: C) -> Self {
        Self { source, cut, size, rest: Vec::new() }
    }

    /// The next block; empty at the end. `None` where the source can not be read, is not UTF-8, or is nowhere to be cut.
    fn next(&mut self) -> Option<String> {
        let mut block = std::mem::take(&mut self.rest);
        loop {
            let wanted = self.size as u64;
            let read = Read::by_ref(&mut self.source).take(wanted).read_to_end(&mut block).ok()?;
            if (read as u64) < wanted {
                break;
            }
            if let Some(end) = (self.cut)(&block).filter(|end| *end > 0) {
                self.rest.extend_from_slice(&block[end..]);
                block.truncate(end);
                break;
            }
            if block.len() > LONGEST {
                return None;
            }
        }
        String::from_utf8(block).ok()
    }

    /// Hands what `parse` makes of every block to `take`, in order; `None` as soon as one of the two says so.
    pub(super) fn each<P: Send>(
        mut self,
        parse: impl Fn(&str) -> Option<P> + Sync,
        mut take: impl FnMut(P) -> Option<()>,
    ) -> Option<()> {
        let parse = &parse;
        thread::scope(|scope| {
            let mut workers = VecDeque::new();
            for _ in 0..threads() {
                let (blocks, work) = sync_channel::<String>(1);
                let (done, parsed) = sync_channel(1);
                // Where nobody receives any more, the work has been given up.
                let run = move || work.iter().try_for_each(|block| done.send(parse(&block)));
                thread::Builder::new().spawn_scoped(scope, run).ok()?;
                workers.push_back((blocks, parsed, false));
            }
            loop {
                let block = self.next()?;
                let is_end = block.is_empty();
                // The worker that has waited longest: what it was given before comes first.
                let (blocks, parsed, is_busy) = workers.pop_front()?;
                if is_busy {
                    take(parsed.recv().ok()??)?;
                }
                if is_end {
                    return workers
                        .iter()
                        .filter(|worker| worker.2)
                        .try_for_each(|worker| take(worker.1.recv().ok()??));
                }
                blocks.send(block).ok()?;
                workers.push_back((blocks, parsed, true));
            }
        })
    }
}

/// Where the last whole line of a text ends.
pub(super) fn line_end(text: &[u8]) -> Option<usize> {
    text.iter().rposition(|&byte| byte == b'\n').map(|at| at + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn lines(text: &str, size: usize) -> Option<Vec<String>> {
        let (mut source, mut all) = (text.as_bytes(), Vec::new());
        let parse = |block: &str| Some(block.lines().map(str::to_owned).collect::<Vec<_>>());
        Blocks::new(&mut source, size, line_end).each(parse, |lines| {
            all.extend(lines);
            Some(())
        })?;
        Some(all)
    }

    #[test]
    fn lines_come_whole_and_in_order_whatever_the_size_of_a_block() {
        let text = "some é\nmore\n\nlines\n".repeat(30);
        for end in ["", "the last one has no end"] {
            let text = text.clone() + end;
            for size in [1, 2, 7, 64, 1 << 12] {
                assert_eq!(lines(&text, size).unwrap(), text.lines().collect::<Vec<_>>(), "{size}");
            }
        }
        assert!(lines("", 8).unwrap().is_empty());
    }

    #[test]
    fn it_ends_where_somebody_gives_up() {
        let text = "a\n".repeat(1000);
        let mut source = text.as_bytes();
        let parse = |block: &str| (!block.is_empty()).then_some(());
        assert!(Blocks::new(&mut source, 16, line_end).each(parse, |()| None).is_none());
        let mut source = text.as_bytes();
        assert!(Blocks::new(&mut source, 16, line_end).each(|_| None::<()>, Some).is_none());
        let mut source: &[u8] = b"a\xff\nb\n";
        assert!(Blocks::new(&mut source, 2, line_end).each(|_| Some(()), Some).is_none());
    }
}
