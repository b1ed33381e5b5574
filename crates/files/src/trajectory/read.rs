//! Trajectories out of files, whatever their format.

use std::collections::HashSet;
use std::fs::File;
use std::io::Read;
use std::path::Path;

#[cfg(feature = "parquet")]
use super::Parquet;
use super::error::{Problem, TrajectoryError, TrajectoryErrorKind};
use super::foreign::Foreign;
use super::long_file::LongFile;
#[cfg(not(feature = "parquet"))]
use super::parquet_absent::ParquetAbsent;
use super::quantity::Quantity;
use super::{ArmTrajectory, Csv, Json, Mcap, Npz, ReadOptions, Reading, Ros2Yaml, Trajectory, adjust};

/// The longest file that is read [bytes].
const LONGEST: u64 = 4 << 30;
/// The longest stream that is read [bytes]: a device may have no end.
const LONGEST_STREAM: u64 = 64 << 20;

/// The content of a file, and where it is.
#[derive(Clone, Copy, Debug)]
pub struct Source<'a> {
    /// Its path.
    pub path: &'a Path,
    /// Its bytes.
    pub bytes: &'a [u8],
}

impl<'a> Source<'a> {
    /// Whether the file's name ends so; without regard to case.
    pub fn has_extension(&self, extensions: &[&str]) -> bool {
        let own = self.path.extension().map(std::ffi::OsStr::to_string_lossy);
        own.is_some_and(|own| extensions.iter().any(|known| own.eq_ignore_ascii_case(known)))
    }

    /// Returns the text of the file, without a byte order mark.
    ///
    /// # Errors
    /// The bytes are not UTF-8.
    pub fn text(&self) -> Result<&'a str, Problem> {
        let text = std::str::from_utf8(self.bytes).map_err(|e| {
            let byte = e.valid_up_to() + 1;
            Problem::new(format!("byte {byte} is not UTF-8; save the file as UTF-8"))
        })?;
        Ok(text.strip_prefix('\u{feff}').unwrap_or(text))
    }
}

/// A format that trajectories are read from. A new format is a file with one implementation, and a line in the list of
/// [`Trajectory::read`].
pub trait TrajectoryReader {
    /// Whether the file is of this format, by its first bytes or else its name.
    fn knows(&self, source: Source<'_>) -> bool;

    /// Returns the trajectory in the file, with what was recognised and assumed. What the options say of columns and times is done
    /// here, what they say of names and angles afterwards.
    ///
    /// # Errors
    /// What is wrong with it.
    fn read(&self, source: Source<'_>, options: &ReadOptions) -> Result<Reading, Problem>;

    /// Returns the same of a long file without holding its text; `None` unless the format does so, and where the file has anything in it
    /// that needs more care: then it is [read](Self::read) as a whole, which also finds the words for what is wrong.
    fn read_blocks(&self, file: &mut LongFile<'_>, options: &ReadOptions) -> Option<Reading> {
        let _ = (file, options);
        None
    }
}

/// The formats, those with unmistakable first bytes first; the last one takes everything.
const READERS: &[&dyn TrajectoryReader] = &[
    &Foreign,
    &Npz,
    &Mcap,
    #[cfg(feature = "parquet")]
    &Parquet,
    #[cfg(not(feature = "parquet"))]
    &ParquetAbsent,
    &Json,
    &Ros2Yaml { machine: String::new() },
    &Csv,
];

impl Trajectory {
    /// Returns the trajectory in a file of any format that can be read: comma-separated values, NumPy
    /// arrays, tables of Parquet (with the feature of that name), messages as YAML or JSON, recordings (MCAP).
    ///
    /// # Errors
    /// [`TrajectoryError`] with the place where the text is wrong: the file can not be read, its values are not finite,
    /// its times do not increase, or it has less than two samples.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, TrajectoryError> {
        Self::read_with(path, &ReadOptions::default()).map(|reading| reading.trajectory)
    }

    /// As [`Trajectory::read`], with options, and with what was recognised and assumed.
    ///
    /// # Errors
    /// As [`Trajectory::read`], and where the options do not fit the file.
    pub fn read_with(path: impl AsRef<Path>, options: &ReadOptions) -> Result<Reading, TrajectoryError> {
        let path = path.as_ref();
        if let Some(reading) = LongFile::open(path).and_then(|file| Self::in_blocks(file, options)) {
            return Ok(reading);
        }
        let bytes = bytes_of(path)?;
        Self::from_bytes_with(path, &bytes, options)
    }

    /// As [`Trajectory::read`], from the bytes that were read from the file at `path`.
    ///
    /// # Errors
    /// As [`Trajectory::read`].
    pub fn from_bytes(path: &Path, bytes: &[u8]) -> Result<Self, TrajectoryError> {
        Self::from_bytes_with(path, bytes, &ReadOptions::default()).map(|reading| reading.trajectory)
    }

    /// As [`Trajectory::read_with`], from the bytes that were read from the file at `path`.
    ///
    /// # Errors
    /// As [`Trajectory::read_with`].
    pub fn from_bytes_with(
        path: &Path,
        bytes: &[u8],
        options: &ReadOptions,
    ) -> Result<Reading, TrajectoryError> {
        let source = Source { path, bytes };
        let read = reader_of(source).read(source, options);
        let read = read.and_then(|reading| finished(reading, options));
        read.map_err(|problem| problem.within(path, source.text().unwrap_or_default()))
    }

    /// The trajectory in a long file, where it can be read block by block and nothing is wrong with it.
    pub(super) fn in_blocks(mut file: LongFile<'_>, options: &ReadOptions) -> Option<Reading> {
        let reading = reader_of(file.source()).read_blocks(&mut file, options)?;
        finished(reading, options).ok()
    }
}

/// What reads a file.
fn reader_of(source: Source<'_>) -> &'static dyn TrajectoryReader {
    let known = READERS.iter().find(|reader| reader.knows(source));
    *known.unwrap_or(&READERS[READERS.len() - 1])
}

/// Does to what was read what the options ask for, and checks it.
fn finished(reading: Reading, options: &ReadOptions) -> Result<Reading, Problem> {
    let reading = adjust::adjusted(reading, options)?;
    checked(&reading.trajectory)?;
    Ok(reading)
}

/// Holds what was read against what every trajectory keeps to; readers of text have said so before, with the place.
fn checked(trajectory: &Trajectory) -> Result<(), Problem> {
    if trajectory.arms.iter().all(|arm| arm.joints.is_empty()) {
        return Err(Problem::new("no joint moves here: there is no column of joint positions"));
    }
    for arm in &trajectory.arms {
        let mut names = HashSet::new();
        if let Some(joint) = arm.joints.iter().find(|joint| !names.insert(joint.as_str())) {
            return Err(Problem::new(format!("`{}` has joint `{joint}` twice", arm.name)));
        }
    }
    if trajectory.samples() < 2 {
        let count = trajectory.samples();
        return Err(Problem::new(format!("a trajectory needs two samples at least, here are {count}")));
    }
    let not_finite = |values: &[f64]| values.iter().copied().find(|value| !value.is_finite());
    let of_arm = |arm: &ArmTrajectory| {
        let quantities = Quantity::ALL.map(|quantity| arm.of(quantity));
        quantities.into_iter().chain([arm.errors.as_slice()]).find_map(not_finite)
    };
    if let Some(value) = not_finite(&trajectory.times).or_else(|| trajectory.arms.iter().find_map(of_arm)) {
        return Err(Problem::new(format!("it holds {value}, which is not a finite number")));
    }
    match trajectory.times.windows(2).position(|pair| pair[1] <= pair[0]) {
        None => Ok(()),
        Some(n) => Err(Problem::new(not_later(trajectory.times[n], trajectory.times[n + 1]))),
    }
}

/// The sentence for times that do not increase.
pub(super) fn not_later(before: f64, time: f64) -> String {
    format!("time {time} s does not come after {before} s, the time of the sample before")
}

fn bytes_of(path: &Path) -> Result<Vec<u8>, TrajectoryError> {
    let unreadable = |e: &std::io::Error| TrajectoryError::of_file(path, e);
    let file = File::open(path).map_err(|e| unreadable(&e))?;
    let is_file = file.metadata().is_ok_and(|metadata| metadata.is_file());
    let most = if is_file { LONGEST } else { LONGEST_STREAM };
    let length = file.metadata().map_or(0, |metadata| metadata.len().min(most));
    let mut bytes = Vec::with_capacity(if is_file { length as usize + 1 } else { 0 });
    file.take(most + 1).read_to_end(&mut bytes).map_err(|e| unreadable(&e))?;
    if bytes.len() as u64 <= most {
        return Ok(bytes);
    }
    let message = format!("more than {most} bytes, which is longer than what is read");
    Err(TrajectoryError { path: path.to_owned(), kind: TrajectoryErrorKind::File, message, place: None })
}
