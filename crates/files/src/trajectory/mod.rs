//! Joint trajectories after a run: with the robots that move and with where they come from, as they are handed on.
//!
//! [`Trajectory`] holds the samples of all arms on one clock, [`About`] says what made it, [`Stage`] has the robots. A
//! [`TrajectoryFormat`] writes a [`Recording`] of the three; every format is a file with one implementation.
//! [`Trajectory::read`] reads what was written, and what other programs write.

mod about;
mod cdr;
mod clock;
mod controller;
mod csv;
mod csv_layout;
mod csv_metadata;
pub mod csv_records;
mod digits;
mod error;
mod format;
mod formats;
mod group;
mod inspect;
mod limits_file;
mod mcap;
mod mcap_records;
mod npy;
mod npz;
#[cfg(feature = "parquet")]
mod parquet;
#[cfg(not(feature = "parquet"))]
mod parquet_absent;
mod quantity;
mod read;
mod ros2_schema;
mod ros2_yaml;
mod stage;
#[expect(clippy::module_inception, reason = "the file is named after the type that it holds")]
mod trajectory;
mod yaml;

pub use self::mcap::Mcap;
#[cfg(feature = "parquet")]
pub use self::parquet::Parquet;
pub use about::About;
pub use controller::Refusal;
pub use csv::Csv;
pub use csv_metadata::CsvMetadata;
pub use error::{Problem, TextPlace, TrajectoryError, TrajectoryErrorKind};
pub use format::{Recording, TrajectoryFormat};
pub use formats::{Export, ExportFile};
pub use inspect::{
    Course, Crossing, Disagreement, Interpolation, JointFigures, Jump, Met, Rest, Straying, TimeFigures,
};
pub use limits_file::LimitsFile;
pub use npz::Npz;
pub use read::{Source, TrajectoryReader};
pub use ros2_yaml::{MoveItYaml, Ros2Yaml};
#[cfg(test)]
pub(crate) use stage::tests::assert_tips_stand_where_the_chains_have_them;
pub use stage::{Machine, Stage, StagedArm};
pub use trajectory::{ArmTrajectory, Trajectory};
