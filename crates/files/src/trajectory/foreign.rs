//! Files of formats that are recognised and not read: what to make of them is said.

use super::error::Problem;
use super::read::{Source, TrajectoryReader};
use super::{ReadOptions, Reading};

/// What such files begin with, and what is said of them.
const KNOWN: &[(&[u8], &str)] = &[
    (
        b"\x93NUMPY",
        "this is one NumPy array, without times and names: save `t`, `positions` and `joints` together by numpy.savez",
    ),
    (
        b"#ROSBAG V",
        "this is a bag of ROS 1: convert it to MCAP (mcap convert), or print its topic of joint states as text (rostopic echo)",
    ),
    (
        b"SQLite format 3\0",
        "this is a bag of ROS 2 in SQLite: convert it to MCAP (ros2 bag convert, with storage_id: mcap)",
    ),
    (
        b"\x89HDF\r\n\x1a\n",
        "this is HDF5, which is not read: save times, positions and joints as npz or as a table",
    ),
    (
        b"MATLAB 5.0 MAT-file",
        "this is a MAT file, which is not read: save times, positions and joints as npz or as a table",
    ),
    (
        b"\x80\x04\x95",
        "this is a Python pickle, which is not read: save times, positions and joints as npz or as a table",
    ),
    (b"\x1f\x8b", "this is compressed by gzip: unpack it first"),
];

/// Knows such files and says what it takes to read them.
pub(super) struct Foreign;

impl Foreign {
    fn sentence(source: Source<'_>) -> Option<&'static str> {
        KNOWN.iter().find(|(magic, _)| source.bytes.starts_with(magic)).map(|(_, sentence)| *sentence)
    }
}

impl TrajectoryReader for Foreign {
    fn knows(&self, source: Source<'_>) -> bool {
        Self::sentence(source).is_some()
    }

    fn read(&self, source: Source<'_>, _: &ReadOptions) -> Result<Reading, Problem> {
        Err(Problem::new(Self::sentence(source).unwrap_or("this is no trajectory")))
    }
}
