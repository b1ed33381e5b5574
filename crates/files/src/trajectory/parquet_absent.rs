//! Tables of Apache Parquet where the program was built without them.

use super::error::Problem;
use super::read::{Source, TrajectoryReader};
use super::{ReadOptions, Reading};

/// Knows such files and says what it takes to read them.
pub(super) struct ParquetAbsent;

impl TrajectoryReader for ParquetAbsent {
    fn knows(&self, source: Source<'_>) -> bool {
        source.bytes.starts_with(b"PAR1") || source.has_extension(&["parquet"])
    }

    fn read(&self, _: Source<'_>, _: &ReadOptions) -> Result<Reading, Problem> {
        let message = "this program was built without the feature parquet; build it with --features parquet, or save \
                       the table as csv or npz";
        Err(Problem::new(message))
    }
}
