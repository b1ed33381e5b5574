//! A sweep run to its end, in parallel, with its table on the disk.

use super::case::{Figures, Record, Sweep};
use super::journal::Journal;
use kinstep_files::scenario::FormulaRows;
use rayon::prelude::*;
use std::fmt::Write as _;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use thiserror::Error;

/// So many cases are run at once and written down together.
const CHUNK: usize = 256;

/// So many of them are given to a thread at once: enough to fill the lanes of its registers with plans that are alike.
const TOGETHER: usize = 4;

/// Why a sweep did not come to its end.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum SweepError {
    /// There are too many cases to count.
    #[error("the lists make more cases than can be counted; take shorter ones")]
    TooMany,
    /// The journal beside the table is of another sweep.
    #[error(
        "{} is of another sweep; finish that one with its own command, or give --force to begin afresh", .path.display()
    )]
    OtherSweep {
        /// The journal.
        path: PathBuf,
    },
    /// The journal can not be written or read.
    #[error("{} can not be written: {source}", .path.display())]
    Journal {
        /// The journal.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
}

/// The format of a table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Table {
    /// Comma-separated values with a heading.
    Csv,
    /// A JSON array with an object a line.
    Json,
}

/// How far a sweep has come.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Progress {
    /// Cases done, those of earlier runs included.
    pub done: usize,
    /// Cases in all.
    pub total: usize,
    /// Cases that an earlier run had done.
    pub resumed: usize,
    /// By status, how many cases ended so; filled when the table is whole.
    pub statuses: Vec<(String, usize)>,
}

impl Progress {
    /// Whether the table is whole.
    pub fn is_whole(&self) -> bool {
        self.done == self.total
    }
}

/// A sweep that was run, to its end or until it was asked to stop.
pub struct Swept<'s> {
    sweep: &'s Sweep,
    table: Table,
    journal: Journal,
    /// How far it has come.
    pub progress: Progress,
}

/// Runs what is left of a sweep whose table is to be at `out`; `go_on(progress)` is asked between chunks.
///
/// Lines that are done are kept in a journal beside the table; `afresh` throws an older one away. A run that was ended, in whatever
/// way, goes on from there, and the table is the same, byte by byte.
///
/// # Errors
/// [`SweepError`] where the journal can not be written or is of another sweep.
pub fn run<'s>(
    sweep: &'s Sweep,
    rows: &FormulaRows,
    (out, table, afresh): (&Path, Table, bool),
    fingerprint: &str,
    mut go_on: impl FnMut(&Progress) -> bool,
) -> Result<Swept<'s>, SweepError> {
    let total = sweep.len().ok_or(SweepError::TooMany)?;
    let path = Journal::beside(out);
    let failed = |source| SweepError::Journal { path: path.clone(), source };
    let heading = format!("kinstep sweep, {total} cases, {}, {fingerprint}", table.name());
    let journal = Journal::open(out, &heading, afresh).map_err(failed)?;
    let mut journal = journal.ok_or_else(|| SweepError::OtherSweep { path: path.clone() })?;
    let mut progress = Progress { done: journal.done, total, resumed: journal.done, statuses: Vec::new() };
    while journal.done < total && go_on(&progress) {
        let chunk = journal.done..(journal.done + CHUNK).min(total);
        let indices: Vec<usize> = chunk.collect();
        let records = indices.par_chunks(TOGETHER).flat_map_iter(|some| sweep.run_all(some, rows));
        let lines: Vec<String> = records.map(|record| table.line(sweep, &record)).collect();
        journal.add(&lines).map_err(failed)?;
        progress.done = journal.done;
    }
    Ok(Swept { sweep, table, journal, progress })
}

impl Swept<'_> {
    /// Writes the table, line by line, and counts how the runs ended.
    ///
    /// # Errors
    /// What reading the journal or writing says.
    pub fn write(&mut self, out: &mut dyn Write) -> io::Result<()> {
        let mut statuses = Vec::new();
        write!(out, "{}", self.table.begin(self.sweep))?;
        for (n, line) in self.journal.lines()?.enumerate() {
            let line = line?;
            count(&mut statuses, self.table.status(&line));
            write!(out, "{}{line}", if n == 0 { "" } else { self.table.between() })?;
        }
        statuses.sort();
        self.progress.statuses = statuses;
        write!(out, "{}", self.table.end())
    }

    /// Takes the journal away, once the table is safe.
    ///
    /// # Errors
    /// What the system says.
    pub fn close(self) -> io::Result<()> {
        self.journal.remove()
    }
}

fn count(statuses: &mut Vec<(String, usize)>, status: &str) {
    match statuses.iter_mut().find(|(known, _)| known == status) {
        Some((_, count)) => *count += 1,
        None => statuses.push((status.to_owned(), 1)),
    }
}

impl Table {
    fn name(self) -> &'static str {
        match self {
            Self::Csv => "csv",
            Self::Json => "json",
        }
    }

    fn begin(self, sweep: &Sweep) -> String {
        match self {
            Self::Json => "[\n".to_owned(),
            Self::Csv => {
                let varied: Vec<String> =
                    sweep.axes.iter().map(|axis| quoted_csv(&format!("varied.{}", axis.key()))).collect();
                let mut columns = vec!["case", "status", "scenario"];
                columns.extend(varied.iter().map(String::as_str));
                columns.extend(["formula", "start", "steps"]);
                columns.extend(Figures::NAMES);
                columns.push("reason");
                columns.join(",") + "\n"
            }
        }
    }

    fn between(self) -> &'static str {
        match self {
            Self::Csv => "\n",
            Self::Json => ",\n",
        }
    }

    fn end(self) -> &'static str {
        match self {
            Self::Csv => "\n",
            Self::Json => "\n]\n",
        }
    }

    /// The status in a line: the second entry in both formats, of letters and underscores only.
    fn status(self, line: &str) -> &str {
        match self {
            Self::Csv => line.split(',').nth(1).unwrap_or_default(),
            Self::Json => line.split('"').nth(5).unwrap_or_default(),
        }
    }

    fn line(self, sweep: &Sweep, record: &Record) -> String {
        match self {
            Self::Csv => csv_line(sweep, record),
            Self::Json => json_line(sweep, record),
        }
    }
}

fn csv_line(sweep: &Sweep, record: &Record) -> String {
    let case = &record.case;
    let mut cells =
        vec![case.index.to_string(), record.status.to_owned(), quoted_csv(&sweep.scenarios[case.scenario].0)];
    cells.extend(case.values.iter().map(|value| quoted_csv(value)));
    match &record.figures {
        Some(figures) => {
            cells.extend([figures.formula.clone(), figures.start.to_owned(), figures.steps.to_string()]);
            cells.extend(figures.numbers.iter().map(|&number| plain(number)));
        }
        None => cells.extend(vec![String::new(); 3 + Figures::NAMES.len()]),
    }
    cells.push(quoted_csv(record.reason.as_deref().unwrap_or_default()));
    cells.join(",")
}

fn json_line(sweep: &Sweep, record: &Record) -> String {
    let case = &record.case;
    let mut line = format!("{{\"case\":{},\"status\":\"{}\"", case.index, record.status);
    // Writing to a String can not fail.
    let _ = write!(line, ",\"scenario\":{}", quoted_json(&sweep.scenarios[case.scenario].0));
    line.push_str(",\"varied\":{");
    for (k, (axis, value)) in sweep.axes.iter().zip(&case.values).enumerate() {
        let comma = if k == 0 { "" } else { "," };
        let _ = write!(line, "{comma}{}:{}", quoted_json(axis.key()), json_value(value));
    }
    line.push('}');
    if let Some(figures) = &record.figures {
        let (formula, start, steps) = (quoted_json(&figures.formula), figures.start, figures.steps);
        let _ = write!(line, ",\"formula\":{formula},\"start\":\"{start}\",\"steps\":{steps}");
        for (name, &number) in Figures::NAMES.iter().zip(&figures.numbers) {
            let number = if number.is_finite() { plain(number) } else { "null".to_owned() };
            let _ = write!(line, ",\"{name}\":{number}");
        }
    }
    let reason = record.reason.as_deref().map_or_else(|| "null".to_owned(), quoted_json);
    let _ = write!(line, ",\"reason\":{reason}}}");
    line
}

/// A number that reads back as the same bits.
fn plain(number: f64) -> String {
    if number == 0.0 || (1e-3..1e9).contains(&number.abs()) {
        format!("{number}")
    } else {
        format!("{number:e}")
    }
}

/// Numbers as numbers, everything else as text.
fn json_value(value: &str) -> String {
    match value.parse::<f64>() {
        Ok(number) if number.is_finite() => plain(number),
        _ => quoted_json(value),
    }
}

fn quoted_csv(text: &str) -> String {
    let text = text.replace(['\n', '\r'], " ");
    if text.contains([',', '"']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text }
}

fn quoted_json(text: &str) -> String {
    let mut quoted = String::from("\"");
    for c in text.chars() {
        match c {
            '"' => quoted.push_str("\\\""),
            '\\' => quoted.push_str("\\\\"),
            c if c.is_control() => _ = write!(quoted, "\\u{:04x}", c as u32),
            c => quoted.push(c),
        }
    }
    quoted.push('"');
    quoted
}
