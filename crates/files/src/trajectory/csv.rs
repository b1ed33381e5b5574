//! A trajectory as comma-separated values.

use std::io::{self, Write};

use super::csv_layout::{Layout, Role};
use super::csv_records::{Field, Records, quoted};
use super::digits::push_full;
use super::error::Problem;
use super::read::{Source, TrajectoryReader, not_later};
use super::{Recording, Trajectory, TrajectoryFormat, csv_metadata};

/// A row per sample: `t`, then of each arm `ARM.JOINT` [rad or m] joint by joint, `ARM.JOINT.velocity` [rad/s or m/s],
/// `ARM.JOINT.acceleration` [rad/s^2 or m/s^2], and `ARM.error`, the norm of its task error; what is not known has no
/// columns. 17 significant digits, so that every value reads back as it was. What made it stands beside it: [`CsvMetadata`](super::CsvMetadata).
///
/// Read are such files and those of others: columns in any order, byte order marks, lines that end in CR LF, quoted
/// fields, a header behind `#`, and plain names of joints where there is one arm, which is then called `arm`.
#[derive(Clone, Copy, Debug, Default)]
pub struct Csv;

impl TrajectoryFormat for Csv {
    fn write(&self, recording: Recording<'_>, out: &mut dyn Write) -> io::Result<()> {
        let trajectory = recording.trajectory;
        let names = trajectory.columns();
        let header: Vec<_> = names.iter().map(|name| quoted(name)).collect();
        writeln!(out, "{}", header.join(","))?;
        let mut line = Vec::new();
        for (sample, time) in trajectory.times.iter().enumerate() {
            line.clear();
            push_full(&mut line, *time);
            for value in trajectory.values(sample) {
                line.push(b',');
                push_full(&mut line, value);
            }
            line.push(b'\n');
            out.write_all(&line)?;
        }
        Ok(())
    }
}

impl TrajectoryReader for Csv {
    fn knows(&self, _: Source<'_>) -> bool {
        true
    }

    fn read(&self, source: Source<'_>) -> Result<Trajectory, Problem> {
        let text = source.text()?;
        let (mut records, mut fields) = (Records::new(text), Vec::new());
        if !records.read(&mut fields)? {
            return Err(Problem::at(
                0,
                "the file is empty; its first line names the columns, as in t,arm.joint1",
            ));
        }
        let layout = layout(text, &fields)?;
        let mut samples = Samples::new(layout);
        while records.read(&mut fields)? {
            samples.push(&fields, records.end())?;
        }
        let mut trajectory = samples.finish(text)?;
        trajectory.about = csv_metadata::beside(source.path)?;
        Ok(trajectory)
    }
}

/// The header, without the `#` that some programs put in front.
fn layout(text: &str, header: &[Field<'_>]) -> Result<Layout, Problem> {
    let names: Vec<&str> = header.iter().map(|field| field.text.trim_start_matches('#').trim()).collect();
    check_separator(text, header)?;
    if names.iter().all(|name| name.parse::<f64>().is_ok()) {
        let message = "the first line has to name the columns, as in t,arm.joint1; here are numbers";
        return Err(Problem::at(header[0].at, message));
    }
    Layout::of(&names, |column| header.get(column).map(|field| field.at))
}

/// One column with another separator in it is a file of another dialect.
fn check_separator(text: &str, header: &[Field<'_>]) -> Result<(), Problem> {
    let [only] = header else { return Ok(()) };
    let Some(byte) = text[only.at..].find([';', '\t', '\n']).map(|offset| only.at + offset) else {
        return Ok(());
    };
    let separator = match text.as_bytes()[byte] {
        b';' => "semicolons",
        b'\t' => "tabs",
        _ => return Ok(()),
    };
    let message =
        format!("fields are separated by {separator}; write commas between them, and points in numbers");
    Err(Problem::at(byte, message))
}

/// The samples while they are read.
struct Samples {
    layout: Layout,
    times: Vec<f64>,
    names: Vec<String>,
}

impl Samples {
    fn new(layout: Layout) -> Self {
        let name = |role: &Role| {
            let joint = |arm: usize, joint: usize| layout.arms[arm].joints[joint].clone();
            match *role {
                Role::Time => "time".to_owned(),
                Role::Joint { quantity, arm, joint: place } => {
                    format!("{} of `{}`", quantity.name(), joint(arm, place))
                }
                Role::Error { arm } => format!("error of `{}`", layout.arms[arm].name),
            }
        };
        Self { names: layout.roles.iter().map(name).collect(), layout, times: Vec::new() }
    }

    fn push(&mut self, fields: &[Field<'_>], end: usize) -> Result<(), Problem> {
        let expected = self.layout.roles.len();
        if fields.len() != expected {
            let at = fields.get(expected).map_or(end, |field| field.at);
            let got = fields.len();
            return Err(Problem::at(
                at,
                format!("expected {expected} fields as in the first line, got {got}"),
            ));
        }
        let Layout { roles, arms } = &mut self.layout;
        let row = self.times.len();
        for ((field, role), name) in fields.iter().zip(roles).zip(&self.names) {
            let value = number(field, name)?;
            match *role {
                Role::Time => push_time(&mut self.times, value, field.at)?,
                Role::Joint { quantity, arm, joint } => {
                    let joints = arms[arm].joints.len();
                    let values = arms[arm].of_mut(quantity);
                    values.resize((row + 1) * joints, 0.0);
                    values[row * joints + joint] = value;
                }
                Role::Error { arm } => arms[arm].errors.push(value),
            }
        }
        Ok(())
    }

    fn finish(self, text: &str) -> Result<Trajectory, Problem> {
        if self.times.len() < 2 {
            let (at, count) = (text.trim_end().len(), self.times.len());
            let message =
                format!("a trajectory needs two samples at least, and here the file ends after {count}");
            return Err(Problem::at(at, message));
        }
        Ok(Trajectory { about: None, times: self.times, arms: self.layout.arms })
    }
}

fn push_time(times: &mut Vec<f64>, time: f64, at: usize) -> Result<(), Problem> {
    match times.last() {
        Some(&before) if time <= before => Err(Problem::at(at, not_later(before, time))),
        _ => {
            times.push(time);
            Ok(())
        }
    }
}

fn number(field: &Field<'_>, name: &str) -> Result<f64, Problem> {
    let text = field.text.trim();
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() => Ok(value),
        Ok(value) => {
            Err(Problem::at(field.at, format!("the {name} is {value}, which is not a finite number")))
        }
        Err(_) if text.is_empty() => Err(Problem::at(field.at, format!("a gap: the {name} is missing"))),
        Err(_) => {
            let shown: String = text.chars().take(40).collect();
            Err(Problem::at(field.at, format!("the {name} is not a number: `{}`", shown.escape_debug())))
        }
    }
}
