//! The samples of a table while they are read.

use super::csv_layout::{Layout, Role};
use super::csv_records::{Field, Separator};
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
}

/// Reads rows of nothing but numbers, without the words for what may be wrong with them.
pub(super) struct PlainRows {
    roles: Vec<Role>,
    separator: char,
}

impl PlainRows {
    /// Returns the values of the rows of a text that belong to a column that is known, row after row; `None` where something else
    /// stands in it.
    pub(super) fn read(&self, text: &str) -> Option<Vec<f64>> {
        let mut values = Vec::with_capacity(text.len() / 16);
        for line in text.split('\n') {
            if !line.trim().is_empty() {
                self.read_row(line.trim_end_matches('\r'), &mut values)?;
            }
        }
        Some(values)
    }

    fn read_row(&self, line: &str, values: &mut Vec<f64>) -> Option<()> {
        let mut fields = line.split(self.separator);
        for role in &self.roles {
            let field = fields.next()?;
            if *role != Role::Other {
                values.push(field.parse().ok().filter(|value: &f64| value.is_finite())?);
            } else if field.contains('"') {
                return None;
            }
        }
        fields.next().is_none().then_some(())
    }
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
        let place = |wanted: Role| layout.roles.iter().position(|role| *role == wanted);
        Self {
            names: layout.roles.iter().map(name).collect(),
            times: Times::new(options.time_unit.or(layout.unit)),
            split_time: place(Role::Nanoseconds).and_then(|rest| Some([place(Role::Time)?, rest])),
            is_in_order: is_in_order(&layout),
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

    /// What reads rows of nothing but numbers; `None` where rows of this table need more care than that. One row has to be added
    /// before: it decides what the times are.
    pub(super) fn plain_rows(&self, separator: Separator) -> Option<PlainRows> {
        let is_plain = self.is_in_order && self.times.are_plain_seconds() && separator != Separator::Blanks;
        is_plain.then(|| PlainRows { roles: self.layout.roles.clone(), separator: separator.character() })
    }

    /// Adds rows that [`PlainRows`] has read, and returns whether their times increase.
    pub(super) fn push_plain(&mut self, rows: &[f64]) -> bool {
        let Layout { roles, arms, .. } = &mut self.layout;
        let known: Vec<Role> = roles.iter().filter(|role| **role != Role::Other).copied().collect();
        let time = known.iter().position(|role| *role == Role::Time).unwrap_or_default();
        rows.chunks_exact(known.len()).all(|row| {
            for (role, &value) in known.iter().zip(row) {
                match *role {
                    Role::Joint { quantity, arm, .. } => arms[arm].of_mut(quantity).push(value),
                    Role::Error { arm } => arms[arm].errors.push(value),
                    Role::Time | Role::Nanoseconds | Role::Other => {}
                }
            }
            self.times.push_seconds(row[time])
        })
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
