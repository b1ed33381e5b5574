//! A trajectory as comma-separated values.

use std::io::{self, Write};

use super::blocks::line_end;
use super::csv_layout::{Head, Layout};
use super::csv_records::{Field, Records, Separator, quoted};
use super::csv_samples::Samples;
use super::digits::push_full;
use super::error::Problem;
use super::lines::write_lines;
use super::long_file::LongFile;
use super::read::{Source, TrajectoryReader};
use super::{ReadOptions, Reading, Recording, TrajectoryFormat, csv_metadata};

/// A row per sample: `t`, then of each arm `ARM.JOINT` [rad or m] joint by joint, `ARM.JOINT.velocity` [rad/s or m/s],
/// `ARM.JOINT.acceleration` [rad/s^2 or m/s^2], and `ARM.error`, the norm of its task error; what is not known has no
/// columns. 17 significant digits, so that every value reads back as it was. What made it stands beside it: [`CsvMetadata`](super::CsvMetadata).
///
/// Read are such files and those of others: columns in any order, byte order marks, lines that end in CR LF, quoted
/// fields, a header behind `#`, and plain names of joints where there is one arm, which is then called `arm`; fields between
/// semicolons, tabs or blanks where there are no commas, and decimal commas in them; columns called after entries of joint
/// states, and those that [`ReadOptions::map`] names.
#[derive(Clone, Copy, Debug, Default)]
pub struct Csv;

impl TrajectoryFormat for Csv {
    fn write(&self, recording: Recording<'_>, out: &mut dyn Write) -> io::Result<()> {
        let trajectory = recording.trajectory;
        let names = trajectory.columns();
        let header: Vec<_> = names.iter().map(|name| quoted(name)).collect();
        writeln!(out, "{}", header.join(","))?;
        write_lines(trajectory.samples(), out, |text: &mut Vec<u8>, sample| {
            push_full(text, trajectory.times[sample]);
            for value in trajectory.values(sample) {
                text.push(b',');
                push_full(text, value);
            }
            text.push(b'\n');
        })
    }
}

impl TrajectoryReader for Csv {
    fn knows(&self, _: Source<'_>) -> bool {
        true
    }

    fn read(&self, source: Source<'_>, options: &ReadOptions) -> Result<Reading, Problem> {
        let text = source.text()?;
        let mut notes = Vec::new();
        let (mut records, mut samples) = begin(text, options, &mut notes)?;
        samples.reserve(text.bytes().filter(|&byte| byte == b'\n').count());
        let mut fields = Vec::new();
        while records.read(&mut fields)? {
            samples.push(&fields, records.end())?;
        }
        let mut trajectory = samples.finish(text.trim_end().len(), &mut notes)?;
        trajectory.about = csv_metadata::beside(source.path)?;
        Ok(Reading { trajectory, notes })
    }

    fn read_blocks(&self, file: &mut LongFile<'_>, options: &ReadOptions) -> Option<Reading> {
        let (head, start) = file.head()?;
        let mut notes = Vec::new();
        let (mut records, mut samples) = begin(&head, options, &mut notes).ok()?;
        let mut first = Vec::new();
        records.read(&mut first).ok().filter(|is_read| *is_read)?;
        samples.push(&first, records.end()).ok()?;
        let rows = samples.plain_rows(records.separator())?;
        samples.reserve(file.length() / first.iter().map(|field| field.text.len() + 1).sum::<usize>().max(1));
        let blocks = file.blocks(start + records.at(), line_end)?;
        blocks.each(|block| rows.read(block), |read| samples.push_plain(&read).then_some(()))?;
        let mut trajectory = samples.finish(0, &mut notes).ok()?;
        trajectory.about = csv_metadata::beside(file.path()).ok()?;
        Some(Reading { trajectory, notes })
    }
}

/// Reads the header of a table, and makes ready for its rows.
fn begin<'t>(
    text: &'t str,
    options: &ReadOptions,
    notes: &mut Vec<String>,
) -> Result<(Records<'t>, Samples), Problem> {
    let separator = separator(text)?;
    if separator != Separator::Comma {
        notes.push(format!("fields are separated by {}", separator.name()));
    }
    let (mut records, mut header) = (Records::separated_by(text, separator), Vec::new());
    if !records.read(&mut header)? {
        let message = "the file is empty; its first line names the columns, as in t,arm.joint1";
        return Err(Problem::at(0, message));
    }
    let first = first_record(&records)?;
    let layout = layout(&header, &first, options, notes)?;
    Ok((records, Samples::new(layout, options, separator != Separator::Comma)))
}

/// The first sample, as it is written.
fn first_record<'t>(records: &Records<'t>) -> Result<Vec<Field<'t>>, Problem> {
    let (mut ahead, mut first) = (records.clone(), Vec::new());
    ahead.read(&mut first)?;
    Ok(first)
}

/// The header, without the `#` that some programs put in front.
fn layout(
    header: &[Field<'_>],
    first: &[Field<'_>],
    options: &ReadOptions,
    notes: &mut Vec<String>,
) -> Result<Layout, Problem> {
    let plain = |field: &'_ Field<'_>| field.text.trim_start_matches('#').trim().to_owned();
    let names: Vec<String> =
        header.iter().map(plain).filter(|name| !name.is_empty() || header.len() > 1).collect();
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    if names.iter().all(|name| name.parse::<f64>().is_ok()) {
        let message = "the first line has to name the columns, as in t,arm.joint1; here are numbers";
        return Err(Problem::at(header[0].at, message));
    }
    let first: Vec<&str> = first.iter().map(|field| field.text.trim()).collect();
    let head = Head { names: &names, first: &first };
    Layout::of(head, |column| header.get(column).map(|field| field.at), options, notes)
}

/// What separates the fields, by the first line: it has to be the only candidate there, unless that is a blank.
fn separator(text: &str) -> Result<Separator, Problem> {
    let start = text.len() - text.trim_start().len();
    let line = text[start..].lines().next().unwrap_or_default();
    let mut is_quoted = false;
    let plain: String = line
        .chars()
        .map(|c| {
            is_quoted ^= c == '"';
            if is_quoted { '_' } else { c }
        })
        .collect();
    let found: Vec<Separator> = [Separator::Comma, Separator::Semicolon, Separator::Tab]
        .into_iter()
        .filter(|separator| plain.contains(separator.character()))
        .collect();
    match found[..] {
        [only] => Ok(only),
        [] if plain.trim_start_matches('#').split_whitespace().count() > 1 => Ok(Separator::Blanks),
        [] => Ok(Separator::Comma),
        [one, other, ..] => {
            let (one, other) = (one.name(), other.name());
            let message = format!(
                "the first line has both {one} and {other}: which of them separate the fields is not clear"
            );
            Err(Problem::at(start, message))
        }
    }
}
