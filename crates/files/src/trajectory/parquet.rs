//! A trajectory as a table of Apache Parquet.

use std::io::{self, Write};
use std::ops::Range;
use std::sync::Arc;

use bytes::Bytes;
use parquet::basic::{Compression, Repetition, Type as Physical};
use parquet::column::reader::{ColumnReader, ColumnReaderImpl};
use parquet::data_type::{DataType, DoubleType};
use parquet::errors::ParquetError;
use parquet::file::metadata::{ColumnChunkMetaData, KeyValue, ParquetMetaData, RowGroupMetaData};
use parquet::file::properties::{EnabledStatistics, WriterProperties};
use parquet::file::reader::{FileReader, RowGroupReader, SerializedFileReader};
use parquet::file::writer::SerializedFileWriter;
use parquet::schema::types::{ColumnDescriptor, Type, TypePtr};

use super::csv_layout::{Head, Layout, Role};
use super::error::Problem;
use super::read::{Source, TrajectoryReader};
use super::times::Times;
use super::{About, ReadOptions, Reading, Recording, Trajectory, TrajectoryFormat};

/// What every file begins and ends with.
pub(super) const MAGIC: &[u8] = b"PAR1";
/// The most values of a row group, 8 MiB of them: what is held in memory while a file is written.
const GROUP: usize = 1 << 20;
/// The most values that are read, 4 GiB of them: runs of one value are stored in no space, and files may lie.
const MOST: u64 = 1 << 29;
/// The most rows that are read at once.
const BATCH: usize = 1 << 16;

/// A row per sample and columns as in the table of comma-separated values ([`Csv`](super::Csv)), all of them doubles; what
/// made the trajectory as keys and values of the footer. Row groups have eight mebibytes at most. Nothing is compressed, and
/// the same trajectory gives the same bytes.
///
/// Read are such files and those of others, with doubles or single-precision numbers, uncompressed or compressed by Snappy.
#[derive(Clone, Copy, Debug, Default)]
pub struct Parquet;

impl TrajectoryFormat for Parquet {
    fn write(&self, recording: Recording<'_>, out: &mut dyn Write) -> io::Result<()> {
        let trajectory = recording.trajectory;
        let columns = Column::all(trajectory);
        let properties = Arc::new(properties(trajectory.about.as_ref()));
        let mut writer = SerializedFileWriter::new(Vec::new(), schema(&trajectory.columns())?, properties)?;
        let (samples, rows) = (trajectory.samples(), (GROUP / columns.len()).max(1));
        let mut values = Vec::with_capacity(rows.min(samples));
        for first in (0..samples).step_by(rows) {
            let mut group = writer.next_row_group()?;
            let mut columns = columns.iter();
            while let (Some(mut chunk), Some(column)) = (group.next_column()?, columns.next()) {
                values.clear();
                values.extend(column.rows(first..samples.min(first + rows)));
                chunk.typed::<DoubleType>().write_batch(&values, None, None)?;
                chunk.close()?;
            }
            group.close()?;
            writer.flush()?;
            out.write_all(writer.inner())?;
            writer.inner_mut().clear();
        }
        writer.finish()?;
        out.write_all(writer.inner())
    }
}

/// A column of the table, within entries that stand sample after sample.
struct Column<'a> {
    entries: &'a [f64],
    place: usize,
    stride: usize,
}

impl<'a> Column<'a> {
    /// The columns in the order of [`Trajectory::columns`].
    fn all(trajectory: &'a Trajectory) -> Vec<Self> {
        let all =
            |entries: &'a [f64], stride: usize| (0..stride).map(move |place| Self { entries, place, stride });
        let known =
            |entries: &'a [f64], stride: usize| all(entries, if entries.is_empty() { 0 } else { stride });
        let mut columns: Vec<Self> = all(&trajectory.times, 1).collect();
        for arm in &trajectory.arms {
            let joints = arm.joints.len();
            columns.extend(arm.known().flat_map(|(_, values)| all(values, joints)));
            columns.extend(known(&arm.errors, 1));
        }
        columns
    }

    fn rows(&self, rows: Range<usize>) -> impl Iterator<Item = f64> {
        rows.map(|row| self.entries[row * self.stride + self.place])
    }
}

fn schema(names: &[String]) -> Result<TypePtr, ParquetError> {
    let column = |name: &String| {
        let column = Type::primitive_type_builder(name, Physical::DOUBLE);
        column.with_repetition(Repetition::REQUIRED).build().map(Arc::new)
    };
    let columns = names.iter().map(column).collect::<Result<_, _>>()?;
    Type::group_type_builder("trajectory").with_fields(columns).build().map(Arc::new)
}

/// Plain doubles: joints seldom take a value twice, so a dictionary of values would only be tried and given up.
fn properties(about: Option<&About>) -> WriterProperties {
    let entries = about.map(About::entries);
    let entries =
        entries.map(|entries| entries.into_iter().map(|(key, value)| KeyValue::new(key, value)).collect());
    WriterProperties::builder()
        .set_created_by(concat!("kinstep version ", env!("CARGO_PKG_VERSION")).to_owned())
        .set_dictionary_enabled(false)
        .set_statistics_enabled(EnabledStatistics::Chunk)
        .set_offset_index_disabled(true)
        .set_key_value_metadata(entries)
        .build()
}

impl TrajectoryReader for Parquet {
    fn knows(&self, source: Source<'_>) -> bool {
        source.bytes.starts_with(MAGIC) || source.has_extension(&["parquet"])
    }

    fn read(&self, source: Source<'_>, options: &ReadOptions) -> Result<Reading, Problem> {
        // The crate trusts some of what damaged files say, and panics where it lies; what is known of it is checked before.
        let read = std::panic::catch_unwind(|| Self::reading(source, options));
        read.unwrap_or_else(|_| Err(Problem::new("it can not be read as Parquet: the file is damaged")))
    }
}

impl Parquet {
    fn reading(source: Source<'_>, options: &ReadOptions) -> Result<Reading, Problem> {
        let file = SerializedFileReader::new(Bytes::copy_from_slice(source.bytes)).map_err(unreadable)?;
        let metadata = file.metadata();
        let schema = metadata.file_metadata().schema_descr();
        let names: Vec<&str> = schema.columns().iter().map(|column| column.name()).collect();
        let mut notes = Vec::new();
        let head = Head { names: &names, first: &[] };
        let layout = Layout::of(head, |_| None, options, &mut notes)?;
        let own = schema.columns().iter().zip(&layout.roles).filter(|(_, role)| **role != Role::Other);
        own.into_iter().try_for_each(|(column, role)| check_column(column, *role))?;
        check_groups(metadata, names.len())?;
        check_places(metadata, source.bytes.len())?;
        let mut columns = vec![Values::default(); names.len()];
        for index in 0..metadata.num_row_groups() {
            let group = file.get_row_group(index).map_err(unreadable)?;
            let own = columns.iter_mut().enumerate().filter(|(place, _)| layout.roles[*place] != Role::Other);
            for (place, column) in own {
                let name = names[place];
                read_column(&*group, place, name, column)?;
            }
        }
        let mut times = Times::new(options.time_unit.or(layout.unit));
        let place = layout.roles.iter().position(|role| *role == Role::Time).unwrap_or_default();
        let clock = std::mem::take(&mut columns[place]);
        clock.times(&mut times).map_err(Problem::new)?;
        let times = times.finish(&mut notes);
        Ok(Reading { trajectory: assembled(layout, times, columns, about(metadata)), notes })
    }
}

#[expect(clippy::needless_pass_by_value, reason = "it stands where results are mapped")]
fn unreadable(error: ParquetError) -> Problem {
    Problem::new(format!("it can not be read as Parquet: {error}"))
}

fn check_column(column: &ColumnDescriptor, role: Role) -> Result<(), Problem> {
    let name = column.path().string();
    if column.path().parts().len() != 1 || column.max_rep_level() > 0 {
        return Err(Problem::new(format!("the column `{name}` is nested; a column has one number per row")));
    }
    match column.physical_type() {
        Physical::DOUBLE | Physical::FLOAT => Ok(()),
        Physical::INT64 | Physical::INT32 if role == Role::Time => Ok(()),
        other => {
            let message =
                format!("the column `{name}` is of the type {other}; convert it to doubles, or drop it");
            Err(Problem::new(message))
        }
    }
}

/// Holds the row groups against what is read.
fn check_groups(metadata: &ParquetMetaData, columns: usize) -> Result<(), Problem> {
    let mut rows = 0_u64;
    for group in metadata.row_groups() {
        let own = u64::try_from(group.num_rows());
        let own = own.map_err(|_| Problem::new("a row group has less than no rows; the file is damaged"))?;
        rows = rows.saturating_add(own);
        if group.columns().len() != columns {
            return Err(Problem::new("a row group lacks columns; the file is damaged"));
        }
        let codecs = group.columns().iter().map(ColumnChunkMetaData::compression);
        let known = |codec: &Compression| matches!(codec, Compression::UNCOMPRESSED | Compression::SNAPPY);
        if let Some(codec) = codecs.into_iter().find(|codec| !known(codec)) {
            let message = format!("its columns are compressed ({codec}); write it with snappy, or without");
            return Err(Problem::new(message));
        }
    }
    if rows.saturating_mul(columns as u64) > MOST {
        let message =
            format!("{rows} rows of {columns} columns are more than the {MOST} values that are read");
        return Err(Problem::new(message));
    }
    Ok(())
}

/// Holds the places where columns are against the file.
fn check_places(metadata: &ParquetMetaData, length: usize) -> Result<(), Problem> {
    let natural = |number: i64| u64::try_from(number).ok();
    let end = |column: &ColumnChunkMetaData| {
        let (data, dictionary) = (column.data_page_offset(), column.dictionary_page_offset());
        natural(data).and(natural(column.num_values()))?;
        natural(dictionary.unwrap_or(data))?.checked_add(natural(column.compressed_size())?)
    };
    let is_within = |column: &ColumnChunkMetaData| end(column).is_some_and(|end| end <= length as u64);
    let mut columns = metadata.row_groups().iter().flat_map(RowGroupMetaData::columns);
    match columns.find(|column| !is_within(column)) {
        None => Ok(()),
        Some(column) => {
            let name = column.column_path().string();
            let message =
                format!("it can not be read as Parquet: the column `{name}` is not within the file");
            Err(Problem::new(message))
        }
    }
}

/// Adds a row group's values of a column.
fn read_column(
    group: &dyn RowGroupReader,
    place: usize,
    name: &str,
    values: &mut Values,
) -> Result<(), Problem> {
    let rows = group.metadata().num_rows() as usize;
    let nullable = group.metadata().schema_descr().column(place).max_def_level() > 0;
    let read = match group.get_column_reader(place).map_err(unreadable)? {
        ColumnReader::DoubleColumnReader(reader) => numbers(reader, rows, nullable, &mut values.reals),
        ColumnReader::FloatColumnReader(reader) => numbers(reader, rows, nullable, &mut values.reals),
        ColumnReader::Int64ColumnReader(reader) => numbers(reader, rows, nullable, &mut values.whole),
        ColumnReader::Int32ColumnReader(reader) => numbers(reader, rows, nullable, &mut values.whole),
        _ => return Err(Problem::new(format!("the column `{name}` has no numbers"))),
    };
    match read.map_err(unreadable)? {
        read if read == rows => Ok(()),
        read => {
            let message =
                format!("a gap in the column `{name}`: a row group has {rows} rows and here {read} values");
            Err(Problem::new(message))
        }
    }
}

/// Adds so many values, or those that there are, and returns how many.
fn numbers<N, T: DataType<T: Into<N>>>(
    mut reader: ColumnReaderImpl<T>,
    rows: usize,
    nullable: bool,
    values: &mut Vec<N>,
) -> Result<usize, ParquetError> {
    let (mut batch, mut levels, mut rest, mut count) = (Vec::new(), Vec::new(), rows, 0);
    while rest > 0 {
        batch.clear();
        levels.clear();
        let levels = nullable.then_some(&mut levels);
        let (records, _, _) = reader.read_records(rest.min(BATCH), levels, None, &mut batch)?;
        if records == 0 {
            break;
        }
        rest = rest.saturating_sub(records);
        count += batch.len();
        values.extend(batch.drain(..).map(Into::into));
    }
    Ok(count)
}

/// The values of a column: times may be whole numbers.
#[derive(Clone, Debug, Default)]
struct Values {
    reals: Vec<f64>,
    whole: Vec<i64>,
}

impl Values {
    fn times(self, times: &mut Times) -> Result<(), String> {
        self.reals.into_iter().try_for_each(|time| times.push_real(time))?;
        self.whole.into_iter().try_for_each(|time| times.push(&time.to_string()))
    }
}

/// Returns the trajectory of columns that are equally long.
fn assembled(layout: Layout, times: Vec<f64>, columns: Vec<Values>, about: Option<About>) -> Trajectory {
    let Layout { roles, mut arms, .. } = layout;
    let samples = times.len();
    for (Values { reals: column, .. }, role) in columns.into_iter().zip(roles) {
        match role {
            Role::Time | Role::Nanoseconds | Role::Other => {}
            Role::Error { arm } => arms[arm].errors = column,
            Role::Joint { quantity, arm, joint } => {
                let joints = arms[arm].joints.len();
                let values = arms[arm].of_mut(quantity);
                values.resize(samples * joints, 0.0);
                spread(&column, joint, joints, values);
            }
        }
    }
    Trajectory { about, times, arms }
}

fn spread(column: &[f64], place: usize, stride: usize, entries: &mut [f64]) {
    let places = entries.iter_mut().skip(place).step_by(stride);
    places.zip(column).for_each(|(entry, value)| *entry = *value);
}

fn about(metadata: &ParquetMetaData) -> Option<About> {
    let entries = metadata.file_metadata().key_value_metadata()?;
    About::from_entries(
        entries.iter().filter_map(|entry| Some((entry.key.as_str(), entry.value.as_deref()?))),
    )
}
