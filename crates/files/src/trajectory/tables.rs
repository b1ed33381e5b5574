//! Tables of samples in documents: a list for each column, or a record for each sample.

use std::borrow::Cow;

use super::csv_dialects::time_named;
use super::csv_layout::{Head, Layout};
use super::csv_records::Field;
use super::csv_samples::Samples;
use super::error::Problem;
use super::messages::texts;
use super::node::Node;
use super::points::POINTS;
use super::{ReadOptions, Trajectory};

/// A value of a sample with the name of its column: entries of lists and of records within are named `LIST.0`, `RECORD.KEY`.
type Cell<'n> = (String, Field<'n>);

/// Records of samples while they are read.
pub(super) struct Records {
    names: Vec<String>,
    samples: Samples,
    end: usize,
}

impl Records {
    /// Whether a document is a record of a sample: numbers, one of which may be the time.
    pub(super) fn are_like(document: &Node<'_>) -> bool {
        let Node::Map(entries, _) = document else { return false };
        let is_time = |key: &str| time_named(key).is_some();
        let number = |node: &Node<'_>| matches!(node, Node::Scalar(text, _) if text.parse::<f64>().is_ok());
        entries.iter().any(|(key, node)| is_time(key) && number(node))
            && entries.len() > 1
            && document.get(POINTS).is_none()
    }

    /// Begins with the columns that the first record has.
    pub(super) fn begin(
        first: &Node<'_>,
        options: &ReadOptions,
        notes: &mut Vec<String>,
    ) -> Result<Self, Problem> {
        let cells = cells(first);
        let places: Vec<usize> = cells.iter().map(|(_, field)| field.at).collect();
        let texts: Vec<&str> = cells.iter().map(|(_, field)| field.text.as_ref()).collect();
        let names: Vec<String> = cells.iter().map(|(name, _)| name.clone()).collect();
        let samples = samples(&names, &texts, |column| places.get(column).copied(), options, notes)?;
        Ok(Self { names, samples, end: first.at() })
    }

    /// Adds a record, which may have its entries in another order.
    pub(super) fn push(&mut self, record: &Node<'_>) -> Result<(), Problem> {
        let mut own = cells(record);
        self.end = record.at();
        if own.iter().map(|(name, _)| name).ne(&self.names) {
            let mut ordered = Vec::new();
            for name in &self.names {
                let place = own.iter().position(|(known, _)| known == name);
                let place = place.ok_or_else(|| {
                    Problem::at(
                        record.at(),
                        format!("a gap: this record has no `{name}` although the first one has"),
                    )
                })?;
                ordered.push(own.swap_remove(place));
            }
            own = ordered;
        }
        let fields: Vec<Field<'_>> = own.into_iter().map(|(_, field)| field).collect();
        self.samples.push(&fields, record.at())
    }

    pub(super) fn finish(self, notes: &mut Vec<String>) -> Result<Trajectory, Problem> {
        self.samples.finish(self.end, notes)
    }
}

fn samples(
    names: &[String],
    first: &[&str],
    place: impl Fn(usize) -> Option<usize>,
    options: &ReadOptions,
    notes: &mut Vec<String>,
) -> Result<Samples, Problem> {
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let layout = Layout::of(Head { names: &names, first }, place, options, notes)?;
    Ok(Samples::new(layout, options, false))
}

/// The values of a record, and what they are called.
fn cells<'n>(record: &'n Node<'_>) -> Vec<Cell<'n>> {
    fn collect<'n>(name: &str, node: &'n Node<'_>, into: &mut Vec<Cell<'n>>) {
        let below = |key: &str| if name.is_empty() { key.to_owned() } else { format!("{name}.{key}") };
        match node {
            Node::Scalar(text, at) => {
                into.push((name.to_owned(), Field { text: Cow::Borrowed(text.as_ref()), at: *at }));
            }
            Node::List(items, _) => {
                items
                    .iter()
                    .enumerate()
                    .for_each(|(place, item)| collect(&below(&place.to_string()), item, into));
            }
            Node::Map(entries, _) => entries.iter().for_each(|(key, node)| collect(&below(key), node, into)),
            Node::Points(..) => {}
        }
    }
    let mut all = Vec::new();
    collect("", record, &mut all);
    all
}

/// A column: its name, and its values.
type Column<'n> = (String, Vec<&'n Node<'n>>);

/// Returns the trajectory of a document that has a list for each column, as `{"t": [...], "elbow": [...]}`, or lists of
/// rows beside the joints' names, as `{"t": [...], "joints": [...], "positions": [[...], ...]}`; nothing where it is neither.
pub(super) fn columns_of(
    document: &Node<'_>,
    options: &ReadOptions,
    notes: &mut Vec<String>,
) -> Result<Option<Trajectory>, Problem> {
    let Node::Map(entries, _) = document else { return Ok(None) };
    let is_time = |key: &str| time_named(key).is_some();
    let is_times = |node: &Node<'_>| {
        let items = node.items().unwrap_or_default();
        !items.is_empty() && items.iter().all(|item| matches!(item, Node::Scalar(..)))
    };
    let time = entries.iter().find(|(key, node)| is_time(key) && is_times(node));
    let Some(count) = time.and_then(|(_, node)| node.items()).map(<[_]>::len) else { return Ok(None) };
    let names = ["joints", "joint_names", "names", "name"].iter().find_map(|key| document.get(key));
    let names = names.map(texts).transpose()?;
    let mut columns: Vec<Column<'_>> = Vec::new();
    for (key, node) in entries {
        let Some(items) = node.items().filter(|items| items.len() == count) else {
            check_length(key, node, count, names.as_ref())?;
            continue;
        };
        if items.iter().all(|item| matches!(item, Node::Scalar(..))) {
            columns.push((key.to_string(), items.iter().collect()));
        } else {
            columns.extend(matrix(key, items, names.as_deref())?);
        }
    }
    let heads: Vec<String> = columns.iter().map(|(name, _)| name.clone()).collect();
    let place = |column: usize| columns.get(column).map(|(_, values)| values[0].at());
    let mut samples = samples(&heads, &[], place, options, notes)?;
    for row in 0..count {
        let fields: Result<Vec<Field<'_>>, Problem> = columns
            .iter()
            .map(|(_, values)| Ok(Field { text: Cow::Borrowed(values[row].text()?), at: values[row].at() }))
            .collect();
        samples.push(&fields?, document.at())?;
    }
    samples.finish(document.at(), notes).map(Some)
}

/// A list of numbers has to be as long as the times; names and single values need not.
fn check_length(
    key: &str,
    node: &Node<'_>,
    count: usize,
    names: Option<&Vec<String>>,
) -> Result<(), Problem> {
    let items = node.items().unwrap_or_default();
    let is_number = |item: &Node<'_>| item.real().is_ok();
    if items.is_empty()
        || !items.iter().all(is_number)
        || names.is_some_and(|names| names.len() == items.len())
    {
        return Ok(());
    }
    let got = items.len();
    Err(Problem::at(node.at(), format!("`{key}` has {got} values, and there are {count} times")))
}

/// The columns of a list of rows: of joints that are named, or `KEY.0`, `KEY.1`.
fn matrix<'n>(key: &str, rows: &'n [Node<'n>], names: Option<&[String]>) -> Result<Vec<Column<'n>>, Problem> {
    let suffix = match key {
        "positions" | "position" | "q" => "",
        "velocities" | "velocity" | "qd" => ".velocity",
        "accelerations" | "acceleration" | "qdd" => ".acceleration",
        _ => return Ok(Vec::new()),
    };
    let width = rows[0].list("a list of numbers")?.len();
    if let Some(names) = names.filter(|names| names.len() != width) {
        let named = names.len();
        return Err(Problem::at(
            rows[0].at(),
            format!("{named} joints are named, and `{key}` has {width} numbers in a row"),
        ));
    }
    let word = match suffix {
        "" => "position",
        suffix => suffix.trim_start_matches('.'),
    };
    let name = |place: usize| match names {
        Some(names) => format!("{}{suffix}", names[place]),
        None => format!("{word}.{place}"),
    };
    let mut columns: Vec<Column<'n>> = (0..width).map(|place| (name(place), Vec::new())).collect();
    for row in rows {
        let items = row.list("a list of numbers")?;
        if items.len() != width {
            let got = items.len();
            return Err(Problem::at(
                row.at(),
                format!("expected {width} numbers in a row of `{key}`, got {got}"),
            ));
        }
        columns.iter_mut().zip(items).for_each(|((_, values), item)| values.push(item));
    }
    Ok(columns)
}
