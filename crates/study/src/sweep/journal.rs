//! The lines that are done, kept beside the table until it is whole.

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufRead, BufReader, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// Lines in the order of the cases after a first line that says of which sweep they are.
pub(super) struct Journal {
    path: PathBuf,
    file: File,
    /// How many cases are done.
    pub(super) done: usize,
}

impl Journal {
    /// Where the journal of a table is.
    pub(super) fn beside(table: &Path) -> PathBuf {
        let name = table.file_name().unwrap_or_default().to_string_lossy().into_owned();
        table.with_file_name(format!("{name}.journal"))
    }

    /// Goes on with the journal of a table, or begins one. Nothing where there is one of another sweep.
    pub(super) fn open(table: &Path, heading: &str, afresh: bool) -> io::Result<Option<Self>> {
        let path = Self::beside(table);
        if afresh || !path.exists() {
            let mut file = File::create(&path)?;
            writeln!(file, "{heading}")?;
            return Ok(Some(Self { path, file, done: 0 }));
        }
        let Some((done, length)) = whole_lines(&path, heading)? else { return Ok(None) };
        if length == 0 {
            return Self::open(table, heading, true);
        }
        let mut file = OpenOptions::new().write(true).open(&path)?;
        // What was cut off in the middle of a line is done again.
        file.set_len(length)?;
        file.seek(SeekFrom::End(0))?;
        Ok(Some(Self { path, file, done }))
    }

    /// Adds lines, all of them on the disk when this returns.
    pub(super) fn add(&mut self, lines: &[String]) -> io::Result<()> {
        let mut text = lines.join("\n");
        text.push('\n');
        self.file.write_all(text.as_bytes())?;
        self.file.flush()?;
        self.done += lines.len();
        Ok(())
    }

    /// The lines, one at a time.
    pub(super) fn lines(&self) -> io::Result<impl Iterator<Item = io::Result<String>> + use<>> {
        Ok(BufReader::new(File::open(&self.path)?).lines().skip(1))
    }

    /// Takes the journal away.
    pub(super) fn remove(self) -> io::Result<()> {
        fs::remove_file(&self.path)
    }
}

/// The number of whole lines after the first and the bytes up to their end, none where the first was cut off; nothing for
/// another first line.
fn whole_lines(path: &Path, heading: &str) -> io::Result<Option<(usize, u64)>> {
    let mut reader = BufReader::new(File::open(path)?);
    let first = format!("{heading}\n").into_bytes();
    let (mut line, mut count, mut length): (Vec<u8>, usize, u64) = (Vec::new(), 0, 0);
    loop {
        line.clear();
        let read = reader.read_until(b'\n', &mut line)?;
        let is_whole = line.last() == Some(&b'\n');
        if count == 0 && !(line == first || !is_whole && first.starts_with(&line)) {
            return Ok(None);
        }
        if read == 0 || !is_whole {
            return Ok(Some((count.saturating_sub(1), length)));
        }
        count += 1;
        length += read as u64;
    }
}
