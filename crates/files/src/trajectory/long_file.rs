//! A file whose text is too long to be held as a whole.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::Path;

use super::blocks::{BLOCK, Blocks, line_end};
use super::read::Source;

/// A file that is longer than a block: its beginning, and what reads the rest.
pub struct LongFile<'p> {
    path: &'p Path,
    rest: Box<dyn ReadSeek + 'p>,
    length: u64,
    beginning: Vec<u8>,
    block: usize,
}

trait ReadSeek: Read + Seek {}

impl<S: Read + Seek> ReadSeek for S {}

impl<'p> LongFile<'p> {
    /// The file at a path; `None` where it is none, can not be read, or is short.
    pub(super) fn open(path: &'p Path) -> Option<Self> {
        let file = File::open(path).ok()?;
        let metadata = file.metadata().ok().filter(std::fs::Metadata::is_file)?;
        Self::of(path, Box::new(file), metadata.len(), BLOCK)
    }

    fn of(path: &'p Path, mut rest: Box<dyn ReadSeek + 'p>, length: u64, block: usize) -> Option<Self> {
        let mut beginning = Vec::new();
        rest.by_ref().take(block as u64).read_to_end(&mut beginning).ok()?;
        (length > block as u64).then_some(Self { path, rest, length, beginning, block })
    }

    /// Its path, and the bytes that it begins with.
    pub(super) fn source(&self) -> Source<'_> {
        Source { path: self.path, bytes: &self.beginning }
    }

    /// Its path.
    pub(super) fn path(&self) -> &'p Path {
        self.path
    }

    /// How many bytes it has.
    pub(super) fn length(&self) -> usize {
        usize::try_from(self.length).unwrap_or(usize::MAX)
    }

    /// The whole lines that it begins with, and the byte at which they begin: behind a byte order mark.
    pub(super) fn head(&self) -> Option<(String, usize)> {
        let lines = &self.beginning[..line_end(&self.beginning)?];
        let text = Source { path: self.path, bytes: lines }.text().ok()?;
        Some((text.to_owned(), lines.len() - text.len()))
    }

    /// Its blocks from a byte on, each ending where it may be cut.
    pub(super) fn blocks<C: Fn(&[u8]) -> Option<usize>>(
        &mut self,
        from: usize,
        cut: C,
    ) -> Option<Blocks<'_, C>> {
        self.rest.seek(SeekFrom::Start(from as u64)).ok()?;
        Some(Blocks::new(&mut self.rest, self.block, cut))
    }
}

impl std::fmt::Debug for LongFile<'_> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("LongFile")
            .field("path", &self.path)
            .field("length", &self.length)
            .finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trajectory::{
        ArmTrajectory, Csv, MoveItYaml, ReadOptions, Reading, Recording, Ros2Yaml, Stage, Trajectory,
        TrajectoryFormat,
    };
    use proptest::prelude::*;
    use std::io::Cursor;

    /// An arm of three joints that starts and ends at rest.
    fn trajectory(values: &[f64], gap: f64) -> Trajectory {
        let samples = values.len() / 3;
        let mut velocities: Vec<f64> = values[..3 * samples].iter().map(|value| value / 3.0).collect();
        velocities[..3].fill(0.0);
        velocities[3 * samples - 3..].fill(0.0);
        let arm = ArmTrajectory {
            joints: ["a", "b", "c"].map(str::to_owned).to_vec(),
            positions: values[..3 * samples].to_vec(),
            velocities,
            ..ArmTrajectory::empty("arm")
        };
        Trajectory { about: None, times: (0..samples).map(|n| n as f64 * gap).collect(), arms: vec![arm] }
    }

    fn written(format: &dyn TrajectoryFormat, trajectory: &Trajectory) -> Vec<u8> {
        let stage = Stage::default();
        let mut text = Vec::new();
        format.write(Recording { trajectory, stage: &stage }, &mut text).unwrap();
        text
    }

    fn in_blocks(path: &Path, bytes: &[u8], block: usize) -> Option<Reading> {
        let file = LongFile::of(path, Box::new(Cursor::new(bytes)), bytes.len() as u64, block)?;
        Trajectory::in_blocks(file, &ReadOptions::default())
    }

    fn files(trajectory: &Trajectory) -> Vec<(&'static str, Vec<u8>)> {
        let machine = || "arm".to_owned();
        vec![
            ("a.csv", written(&Csv, trajectory)),
            ("a.yaml", written(&Ros2Yaml { machine: machine() }, trajectory)),
            ("a.moveit.yaml", written(&MoveItYaml { machine: machine() }, trajectory)),
        ]
    }

    proptest! {
        #[test]
        fn a_file_in_blocks_is_read_like_the_whole_of_it(
            values in proptest::collection::vec(-3.0..3.0_f64, 60..300), gap in 1e-3..0.1_f64, block in 700..2000_usize,
        ) {
            for (name, bytes) in files(&trajectory(&values, gap)) {
                let whole = Trajectory::from_bytes(name.as_ref(), &bytes).unwrap();
                let read = in_blocks(name.as_ref(), &bytes, block);
                prop_assert_eq!(read.map(|reading| reading.trajectory), Some(whole), "{}", name);
            }
        }

        /// What blocks can not tell they leave to the reader of the whole.
        #[test]
        fn a_file_that_was_spoilt_is_not_read_otherwise_in_blocks(
            values in proptest::collection::vec(-3.0..3.0_f64, 60..200), block in 700..1500_usize,
            place in 0.0..1.0_f64, spoilt in "[-0-9,.\"\n :#a\\[\\]{}e]{0,3}", cut in 0_usize..40,
        ) {
            for (name, mut bytes) in files(&trajectory(&values, 0.01)) {
                let at = (place * (bytes.len() - cut) as f64) as usize;
                bytes.splice(at..at + cut, spoilt.bytes());
                let whole = Trajectory::from_bytes_with(name.as_ref(), &bytes, &ReadOptions::default());
                if let Some(read) = in_blocks(name.as_ref(), &bytes, block) {
                    prop_assert_eq!(Some(read.trajectory), whole.ok().map(|reading| reading.trajectory), "{}", name);
                }
            }
        }
    }
}
