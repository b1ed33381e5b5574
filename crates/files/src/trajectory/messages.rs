//! What documents of messages hold: joint trajectories within whatever wraps them, joint states one after another, or tables.

use super::csv_layout::{ONLY_ARM, listed};
use super::error::Problem;
use super::node::Node;
use super::points::{POINTS, Points};
use super::states::{State, StateTime, States};
use super::tables::{Records, columns_of};
use super::{ReadOptions, Reading, Trajectory};

/// The keys of what controllers publish of themselves: what they measure, in either distribution of the Robot Operating System.
const MEASURED: [&str; 2] = ["feedback", "actual"];

/// What was found so far in the documents of a file.
pub(super) struct Messages<'o> {
    options: &'o ReadOptions,
    commands: Vec<Command>,
    states: States,
    records: Option<Records>,
    table: Option<Trajectory>,
    notes: Vec<String>,
    /// Where a joint trajectory without points stands.
    empty: Option<usize>,
    /// What was not recognised: its keys, and where it stands.
    other: Option<(String, usize)>,
}

/// A joint trajectory.
struct Command {
    at: usize,
    joints: Vec<String>,
    points: Box<Points>,
}

impl<'o> Messages<'o> {
    pub(super) fn new(options: &'o ReadOptions) -> Self {
        let (commands, notes) = (Vec::new(), Vec::new());
        Self {
            options,
            commands,
            states: States::default(),
            records: None,
            table: None,
            notes,
            empty: None,
            other: None,
        }
    }

    /// Takes a document.
    pub(super) fn take(&mut self, document: Node<'_>) -> Result<(), Problem> {
        if let Node::List(items, _) = document {
            return items.into_iter().try_for_each(|item| self.take(item));
        }
        // Messages of rosbridge without content ask for something.
        if document.get("op").is_some() && document.get("msg").is_none() {
            return Ok(());
        }
        let at = document.at();
        let keys = listed(&document.keys()).unwrap_or_default();
        let is_empty = document.text().is_ok_and(str::is_empty);
        if is_empty || self.message(document)? {
            return Ok(());
        }
        self.other.get_or_insert((keys, at));
        Ok(())
    }

    /// Takes what a document is, and returns whether it was recognised.
    fn message(&mut self, document: Node<'_>) -> Result<bool, Problem> {
        if let Some(state) = state_of(&document)?.or(measured_of(&document)?) {
            self.states.push(&state, self.options)?;
            return Ok(true);
        }
        let goes_on = self.records.is_some() && matches!(document, Node::Map(..));
        if goes_on || Records::are_like(&document) {
            let records = match &mut self.records {
                Some(records) => records,
                none => none.insert(Records::begin(&document, self.options, &mut self.notes)?),
            };
            records.push(&document)?;
            return Ok(true);
        }
        if self.table.is_none()
            && let Some(table) = columns_of(&document, self.options, &mut self.notes)?
        {
            self.table = Some(table);
            return Ok(true);
        }
        let before = self.commands.len();
        let mut states = Vec::new();
        self.within(document, &mut states)?;
        let is_command = self.commands.len() > before;
        let is_state = !states.is_empty();
        // The state at the start of a display trajectory is not one of its samples, and has no time.
        for state in states.into_iter().filter(|_| !is_command) {
            self.states.push(&state?, self.options)?;
        }
        Ok(is_command || is_state)
    }

    /// Finds joint trajectories within goals, results, robots' and display trajectories, and joint states within anything.
    fn within(&mut self, node: Node<'_>, states: &mut Vec<Result<State, Problem>>) -> Result<(), Problem> {
        let found = state_of(&node).and_then(|state| Ok(state.or(measured_of(&node)?)));
        if let Some(state) = found.transpose() {
            states.push(state);
            return Ok(());
        }
        let at = node.at();
        match node {
            Node::List(items, _) => items.into_iter().try_for_each(|item| self.within(item, states)),
            Node::Map(mut entries, _) => {
                let place = |key: &str| entries.iter().position(|(known, _)| known == key);
                if let (Some(names), Some(points)) = (place("joint_names"), place(POINTS)) {
                    let joints = texts(&entries[names].1)?;
                    return self.command(at, joints, entries.swap_remove(points).1);
                }
                entries.into_iter().try_for_each(|(_, inner)| self.within(inner, states))
            }
            Node::Scalar(..) | Node::Points(..) => Ok(()),
        }
    }

    fn command(&mut self, at: usize, joints: Vec<String>, points: Node<'_>) -> Result<(), Problem> {
        match points {
            Node::Points(points, _) if !points.is_empty() => {
                self.commands.push(Command { at, joints, points });
                Ok(())
            }
            // Joints of several degrees of freedom are such empty lists beside the others.
            Node::Points(_, at) => {
                self.empty.get_or_insert(at);
                Ok(())
            }
            Node::List(items, at) if items.is_empty() => {
                self.empty.get_or_insert(at);
                Ok(())
            }
            other => Err(Problem::at(other.at(), "expected a list of points")),
        }
    }

    /// Returns what was found, which has to be one trajectory; its arm is called so.
    pub(super) fn finish(mut self, name: Option<&str>) -> Result<Reading, Problem> {
        let (options, mut notes) = (self.options, self.notes);
        let name = name.unwrap_or(ONLY_ARM);
        if let Some(other) = self.commands.get(1) {
            let count = self.commands.len();
            let message = format!(
                "expected one joint trajectory (`joint_names` with `points`), here are {count}; keep one of them"
            );
            return Err(Problem::at(other.at, message));
        }
        let trajectory = if let Some(command) = self.commands.pop() {
            if !self.states.is_empty() {
                notes.push("joint states beside the joint trajectory are left out".to_owned());
            }
            command.points.finish(name, command.joints, &mut notes)?
        } else if !self.states.is_empty() {
            self.states.finish(name, options, &mut notes)?
        } else if let Some(records) = self.records {
            records.finish(&mut notes)?
        } else if let Some(table) = self.table {
            table
        } else if let Some(at) = self.empty {
            return Err(Problem::at(at, "this is a joint trajectory, and it has no points"));
        } else {
            return Err(nothing(self.other));
        };
        Ok(Reading { trajectory, notes })
    }
}

fn nothing(other: Option<(String, usize)>) -> Problem {
    let wanted = "expected one joint trajectory (`joint_names` with `points`), joint states (`name` with `position`), or a table \
                  (`t` with a list for each joint, or a list of records)";
    match other {
        Some((keys, at)) if !keys.is_empty() => {
            Problem::at(at, format!("{wanted}; here are the keys {keys}"))
        }
        Some((_, at)) => Problem::at(at, format!("{wanted}; here is something else")),
        None => Problem::at(0, format!("{wanted}; here is nothing")),
    }
}

/// The texts of a list.
pub(super) fn texts(node: &Node<'_>) -> Result<Vec<String>, Problem> {
    let items = node.list("a list of names")?;
    items.iter().map(|name| name.text().map(str::to_owned)).collect()
}

/// The numbers of a list, those that are none among them; nothing where there is no list.
fn reals(node: Option<&Node<'_>>) -> Result<Vec<f64>, Problem> {
    node.and_then(Node::items).into_iter().flatten().map(Node::real).collect()
}

/// A message that names joints and has their positions.
fn state_of(node: &Node<'_>) -> Result<Option<State>, Problem> {
    let is_list = |key: &str| node.get(key).is_some_and(|list| list.items().is_some());
    if !is_list("name") || !is_list("position") {
        return Ok(None);
    }
    let positions = node.need("position")?;
    let mut values = Vec::new();
    positions.numbers_of(&mut values)?;
    let velocities = reals(node.get("velocity"))?;
    let (at, names) = (Some(node.at()), texts(node.need("name")?)?);
    Ok(Some(State { at, time: time_of(node)?, names, positions: values, velocities }))
}

/// A message of a controller: what it measures of its joints.
fn measured_of(node: &Node<'_>) -> Result<Option<State>, Problem> {
    let Some(measured) =
        MEASURED.iter().find_map(|key| node.get(key)).filter(|_| node.get("joint_names").is_some())
    else {
        return Ok(None);
    };
    let mut positions = Vec::new();
    measured.need("positions")?.numbers_of(&mut positions)?;
    let velocities = reals(measured.get("velocities"))?;
    let (at, names) = (Some(node.at()), texts(node.need("joint_names")?)?);
    Ok(Some(State { at, time: time_of(node)?, names, positions, velocities }))
}

fn time_of(node: &Node<'_>) -> Result<StateTime, Problem> {
    let stamp = node.get("header").and_then(|header| header.get("stamp"));
    let stamp = stamp.or_else(|| ["stamp", "t", "time", "timestamp"].iter().find_map(|key| node.get(key)));
    let Some(stamp) = stamp else {
        let message =
            "this is a joint state without `header: {stamp: {sec, nanosec}}`: it does not say when it is";
        return Err(Problem::at(node.at(), message));
    };
    match stamp.nanoseconds()? {
        Some(nanoseconds) => Ok(StateTime::Nanoseconds(nanoseconds)),
        None => Ok(StateTime::Written(stamp.text()?.to_owned())),
    }
}
