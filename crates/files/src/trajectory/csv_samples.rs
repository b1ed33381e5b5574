//! The samples of a table while they are read.

use super::csv_layout::{Layout, Role};
use super::csv_records::Field;
use super::error::{Problem, excerpt};
use super::quantity::Quantity;
use super::times::Times;
use super::{ReadOptions, Trajectory};

/// The samples of a table, row by row.
pub(super) struct Samples {
    layout: Layout,
    times: Times,
    names: Vec<String>,
    /// Where the whole seconds stand, and the nanoseconds beside them.
    split_time: Option<[usize; 2]>,
    may_have_commas: bool,
    has_commas: bool,
    left_out: usize,
    /// Whether the joints of each quantity stand in their order, in a table that has no rows of others.
    is_in_order: bool,
    /// The values of a row that are not left out, and the place of the time among them.
    row: Vec<f64>,
    time: usize,
}

impl Samples {
    /// No samples yet. Numbers may have decimal commas where those do not separate fields.
    pub(super) fn new(layout: Layout, options: &ReadOptions, may_have_commas: bool) -> Self {
        let name = |role: &Role| {
            let joint = |arm: usize, joint: usize| layout.arms[arm].joints[joint].clone();
            match *role {
                Role::Time | Role::Nanoseconds => "time".to_owned(),
                Role::Joint { quantity, arm, joint: place } => {
                    format!("{} of `{}`", quantity.name(), joint(arm, place))
                }
                Role::Error { arm } => format!("error of `{}`", layout.arms[arm].name),
                Role::Other => String::new(),
            }
        };
        let mut known = layout.roles.iter().filter(|role| **role != Role::Other);
        let place = |wanted: Role| layout.roles.iter().position(|role| *role == wanted);
        Self {
            names: layout.roles.iter().map(name).collect(),
            times: Times::new(options.time_unit.or(layout.unit)),
            split_time: place(Role::Nanoseconds).and_then(|rest| Some([place(Role::Time)?, rest])),
            is_in_order: is_in_order(&layout),
            row: Vec::new(),
            time: known.position(|role| *role == Role::Time).unwrap_or_default(),
            layout,
            may_have_commas,
            has_commas: false,
            left_out: 0,
        }
    }

    /// Makes room for so many samples.
    pub(super) fn reserve(&mut self, samples: usize) {
        self.times.reserve(samples);
        for role in &self.layout.roles {
            match *role {
                Role::Joint { quantity, arm, joint: 0 } => {
                    let arm = &mut self.layout.arms[arm];
                    let joints = arm.joints.len();
                    arm.of_mut(quantity).reserve_exact(samples * joints);
                }
                Role::Error { arm } => self.layout.arms[arm].errors.reserve_exact(samples),
                _ => {}
            }
        }
    }

    /// Adds a row of nothing but numbers, and returns whether it was one; nothing is added where it was not.
    pub(super) fn push_numbers<'f>(&mut self, mut fields: impl Iterator<Item = &'f str>) -> bool {
        if !self.is_in_order || self.times.len() == 0 {
            return false;
        }
        self.row.clear();
        for role in &self.layout.roles {
            let Some(field) = fields.next() else { return false };
            if *role == Role::Other {
                continue;
            }
            match field.parse::<f64>() {
                Ok(value) if value.is_finite() => self.row.push(value),
                _ => return false,
            }
        }
        if fields.next().is_some() || !self.times.push_seconds(self.row[self.time]) {
            return false;
        }
        let known = self.layout.roles.iter().filter(|role| **role != Role::Other);
        for (role, &value) in known.zip(&self.row) {
            match *role {
                Role::Joint { quantity, arm, .. } => self.layout.arms[arm].of_mut(quantity).push(value),
                Role::Error { arm } => self.layout.arms[arm].errors.push(value),
                Role::Time | Role::Nanoseconds | Role::Other => {}
            }
        }
        true
    }

    /// Adds a row, which ends at a byte of the text.
    pub(super) fn push(&mut self, fields: &[Field<'_>], end: usize) -> Result<(), Problem> {
        let expected = self.layout.roles.len();
        if fields.len() != expected {
            let at = fields.get(expected).map_or(end, |field| field.at);
            let got = fields.len();
            return Err(Problem::at(
                at,
                format!("expected {expected} fields as in the first line, got {got}"),
            ));
        }
        if self.layout.has_gaps && self.is_of_others(fields) {
            self.left_out += 1;
            return Ok(());
        }
        self.push_time(fields)?;
        let row = self.times.len() - 1;
        let Layout { roles, arms, .. } = &mut self.layout;
        for ((field, role), name) in fields.iter().zip(roles).zip(&self.names) {
            let mut value = || number(field, name, self.may_have_commas, &mut self.has_commas);
            match *role {
                Role::Time | Role::Nanoseconds | Role::Other => {}
                Role::Joint { quantity, arm, joint } => {
                    let joints = arms[arm].joints.len();
                    let values = arms[arm].of_mut(quantity);
                    if values.len() <= row * joints {
                        values.resize((row + 1) * joints, 0.0);
                    }
                    values[row * joints + joint] = value()?;
                }
                Role::Error { arm } => arms[arm].errors.push(value()?),
            }
        }
        Ok(())
    }

    /// Whether a row has nothing to say of any joint.
    fn is_of_others(&self, fields: &[Field<'_>]) -> bool {
        let mut joints =
            fields.iter().zip(&self.layout.roles).filter(|(_, role)| matches!(role, Role::Joint { .. }));
        joints.all(|(field, _)| field.text.trim().is_empty())
    }

    fn push_time(&mut self, fields: &[Field<'_>]) -> Result<(), Problem> {
        if let Some([seconds, rest]) = self.split_time {
            let whole = |place: usize| -> Result<i128, Problem> {
                let field: &Field<'_> = &fields[place];
                let whole = field.text.trim().parse::<i64>().map(i128::from);
                whole.map_err(|_| {
                    Problem::at(field.at, "expected a whole number of seconds and one of nanoseconds")
                })
            };
            let all = whole(seconds)? * 1_000_000_000 + whole(rest)?;
            return self
                .times
                .push_nanoseconds(all)
                .map_err(|message| Problem::at(fields[seconds].at, message));
        }
        let time = fields.iter().zip(&self.layout.roles).find(|(_, role)| **role == Role::Time);
        let Some((field, _)) = time else { return Ok(()) };
        let text = field.text.trim();
        let pushed = if self.may_have_commas && text.contains(',') {
            self.times.push(&text.replacen(',', ".", 1))
        } else {
            self.times.push(text)
        };
        pushed.map_err(|message| Problem::at(field.at, message))
    }

    /// Returns the trajectory of a text that ends at a byte, and adds what there is to say of it.
    pub(super) fn finish(self, end: usize, notes: &mut Vec<String>) -> Result<Trajectory, Problem> {
        if self.times.len() < 2 {
            let count = self.times.len();
            let message =
                format!("a trajectory needs two samples at least, and here the file ends after {count}");
            return Err(Problem::at(end, message));
        }
        if self.has_commas {
            notes.push("numbers have decimal commas".to_owned());
        }
        if self.left_out > 0 {
            let (left_out, all) = (self.left_out, self.left_out + self.times.len());
            notes.push(format!("{left_out} of {all} rows have no joint in them and are left out"));
        }
        Ok(Trajectory { about: None, times: self.times.finish(notes), arms: self.layout.arms })
    }
}

fn is_in_order(layout: &Layout) -> bool {
    let mut next = vec![[0; Quantity::ALL.len()]; layout.arms.len()];
    let mut is_next = |role: &Role| match *role {
        Role::Joint { quantity, arm, joint } => {
            next[arm][quantity as usize] += 1;
            next[arm][quantity as usize] == joint + 1
        }
        Role::Nanoseconds => false,
        Role::Time | Role::Error { .. } | Role::Other => true,
    };
    !layout.has_gaps && layout.roles.iter().all(&mut is_next)
}

fn number(
    field: &Field<'_>,
    name: &str,
    may_have_commas: bool,
    has_commas: &mut bool,
) -> Result<f64, Problem> {
    let text = field.text.trim();
    let parsed = text.parse::<f64>().or_else(|e| {
        let is_decimal = may_have_commas && text.matches(',').count() == 1 && !text.contains('.');
        let value = if is_decimal { text.replacen(',', ".", 1).parse() } else { Err(e) };
        *has_commas |= value.is_ok();
        value
    });
    match parsed {
        Ok(value) if value.is_finite() => Ok(value),
        Ok(value) => {
            Err(Problem::at(field.at, format!("the {name} is {value}, which is not a finite number")))
        }
        Err(_) if text.is_empty() => Err(Problem::at(field.at, format!("a gap: the {name} is missing"))),
        Err(_) => {
            let hint = if text.starts_with(['[', '(']) { "; a cell has one number" } else { "" };
            let shown = excerpt(text);
            Err(Problem::at(field.at, format!("the {name} is not a number: `{shown}`{hint}")))
        }
    }
}
