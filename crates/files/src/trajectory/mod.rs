//! Joint trajectories after a run: with the robots that move and with where they come from, as they are handed on.
//!
//! [`Trajectory`] holds the samples of all arms on one clock, [`About`] says what made it, [`Stage`] has the robots. A
//! [`TrajectoryFormat`] writes a [`Recording`] of the three; every format is a file with one implementation.
//! [`Trajectory::read`] reads what was written, and what other programs write.

mod about;
mod adjust;
mod blocks;
mod cdr;
mod clock;
mod column_map;
mod controller;
mod csv;
mod csv_dialects;
mod csv_layout;
mod csv_metadata;
pub mod csv_records;
mod csv_samples;
mod digits;
mod error;
mod foreign;
mod format;
mod formats;
mod group;
mod hint;
mod inspect;
mod json;
mod limits_file;
mod lines;
mod long_file;
mod long_points;
mod mcap;
mod mcap_records;
mod messages;
mod node;
mod npy;
mod npz;
mod options;
#[cfg(feature = "parquet")]
mod parquet;
#[cfg(not(feature = "parquet"))]
mod parquet_absent;
mod points;
mod quantity;
mod quick_yaml;
mod read;
mod ros2_schema;
mod ros2_yaml;
mod stage;
mod states;
mod tables;
mod times;
#[expect(clippy::module_inception, reason = "the file is named after the type that it holds")]
mod trajectory;
pub mod units;
mod yaml;

pub use self::mcap::Mcap;
#[cfg(feature = "parquet")]
pub use self::parquet::Parquet;
pub use about::About;
pub use adjust::Turn;
pub use column_map::ColumnMap;
pub use controller::Refusal;
pub use csv::Csv;
pub use csv_metadata::CsvMetadata;
pub use error::{Problem, TextPlace, TrajectoryError, TrajectoryErrorKind};
pub use format::{Recording, TrajectoryFormat};
pub use formats::{Export, ExportFile};
pub use inspect::{
    Course, Crossing, Disagreement, Interpolation, JointFigures, Jump, Met, Rest, Straying, TimeFigures,
};
pub use json::Json;
pub use limits_file::LimitsFile;
pub use long_file::LongFile;
pub use npz::Npz;
pub use options::{KnownJoint, ReadOptions, Reading};
pub use read::{Source, TrajectoryReader};
pub use ros2_yaml::{MoveItYaml, Ros2Yaml};
#[cfg(test)]
pub(crate) use stage::tests::assert_tips_stand_where_the_chains_have_them;
pub use stage::{Machine, Stage, StagedArm};
pub use times::TimeUnit;
pub use trajectory::{ArmTrajectory, Trajectory};
