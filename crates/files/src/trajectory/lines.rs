//! Long runs of lines: formatted on all processors, written in order.

use std::io::{self, Write};
use std::num::NonZero;
use std::sync::mpsc::{Receiver, sync_channel};
use std::thread;

/// How many samples are formatted at a time. What waits to be written is a few such pieces, however many samples there are.
const PIECE: usize = 2048;

/// How many threads share a piece of work.
pub(super) fn threads() -> usize {
    thread::available_parallelism().map_or(1, NonZero::get)
}

/// Writes the lines of the samples from 0 on; `push` appends those of one sample to a text.
///
/// # Errors
/// What the writer says.
pub(super) fn write_lines<T: AsRef<[u8]> + Default + Send>(
    samples: usize,
    out: &mut dyn Write,
    push: impl Fn(&mut T, usize) + Sync,
) -> io::Result<()> {
    let pieces = samples.div_ceil(PIECE);
    let threads = threads().min(pieces);
    let formatted = |piece: usize| {
        let mut text = T::default();
        (piece * PIECE..samples.min((piece + 1) * PIECE)).for_each(|sample| push(&mut text, sample));
        text
    };
    thread::scope(|scope| {
        let mut texts: Vec<Receiver<T>> = Vec::new();
        for first in 0..threads {
            let (sender, receiver) = sync_channel(1);
            // Where nobody receives any more, writing has failed.
            let work = move || {
                let _ = (first..pieces).step_by(threads).try_for_each(|piece| sender.send(formatted(piece)));
            };
            thread::Builder::new().spawn_scoped(scope, work)?;
            texts.push(receiver);
        }
        (0..pieces).try_for_each(|piece| {
            let text = texts[piece % threads].recv().map_err(io::Error::other)?;
            out.write_all(text.as_ref())
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn line(n: usize) -> Vec<u8> {
        format!("{n}\n").into_bytes()
    }

    #[test]
    fn lines_stand_in_order_however_many_there_are() {
        for samples in [0, 1, PIECE - 1, PIECE, PIECE + 1, 7 * PIECE + 3] {
            let mut written = Vec::new();
            write_lines(samples, &mut written, |text: &mut Vec<u8>, n| text.extend(line(n))).unwrap();
            let expected: Vec<u8> = (0..samples).flat_map(line).collect();
            assert!(written == expected, "{samples}");
        }
    }

    #[test]
    fn a_writer_that_fails_ends_it() {
        struct Full;
        impl Write for Full {
            fn write(&mut self, _: &[u8]) -> io::Result<usize> {
                Err(io::Error::other("full"))
            }

            fn flush(&mut self) -> io::Result<()> {
                Ok(())
            }
        }
        let written = write_lines(100 * PIECE, &mut Full, |text: &mut Vec<u8>, _| text.push(b'\n'));
        assert_eq!(written.unwrap_err().to_string(), "full");
    }
}
