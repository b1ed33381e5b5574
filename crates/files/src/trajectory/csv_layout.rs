//! What the columns of a table of samples hold, by their names.

use std::collections::HashSet;

use super::csv_dialects::{array_parts, mapped_parts, plain_parts, slash_parts, time_named};
use super::error::Problem;
use super::quantity::Quantity;
use super::{ArmTrajectory, ReadOptions, TimeUnit};

/// The name of the arm where columns name none.
pub(super) const ONLY_ARM: &str = "arm";

/// What a column holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Role {
    Time,
    /// Whole nanoseconds beside a time of whole seconds.
    Nanoseconds,
    Joint {
        quantity: Quantity,
        arm: usize,
        joint: usize,
    },
    Error {
        arm: usize,
    },
    /// Something that is left out.
    Other,
}

/// A column's name, taken apart: of a joint the arm and its own name.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Part {
    Time,
    Nanoseconds,
    Joint(Quantity, String, String),
    Error(String),
    Other,
}

/// The roles of all columns, and the arms that they make, without samples.
#[derive(Clone, Debug)]
pub(super) struct Layout {
    pub(super) roles: Vec<Role>,
    pub(super) arms: Vec<ArmTrajectory>,
    /// Whether rows may leave all joints empty: those of other things in the same table.
    pub(super) has_gaps: bool,
    /// The unit that the name of the column of times says.
    pub(super) unit: Option<TimeUnit>,
}

/// The first lines of a table.
#[derive(Clone, Copy, Debug)]
pub(super) struct Head<'h> {
    /// The names of the columns.
    pub(super) names: &'h [&'h str],
    /// The first sample as it is written, where it is text: joints may be named there.
    pub(super) first: &'h [&'h str],
}

/// Why columns can not be used, and which of them.
pub(super) type Refused = (usize, String);

impl Layout {
    /// Returns what the columns hold. Where no rules say so: `t`; of every arm `ARM.JOINT`, `ARM.JOINT.velocity`,
    /// `ARM.JOINT.acceleration` and `ARM.error`; plain names of the joints of one arm; names of messages' entries, as
    /// `/joint_states/JOINT/position` and `position.0` have them. `place` says at which byte a column's name stands, where it
    /// does.
    pub(super) fn of(
        head: Head<'_>,
        place: impl Fn(usize) -> Option<usize>,
        options: &ReadOptions,
        notes: &mut Vec<String>,
    ) -> Result<Self, Problem> {
        let refuse = |(column, message): Refused| Problem { message, at: place(column) };
        check_names(head).map_err(refuse)?;
        let parts = if !options.map.is_empty() {
            Some(mapped_parts(head.names, options, notes).map_err(refuse)?)
        } else if let Some(parts) = slash_parts(head.names) {
            Some(parts)
        } else {
            array_parts(head, options, notes).map_err(refuse)?
        };
        let has_gaps = parts.is_some();
        let parts = match parts {
            Some(parts) => parts,
            None => plain_parts(head.names).map_err(refuse)?,
        };
        let time = parts.iter().position(|part| *part == Part::Time);
        let time = time.ok_or_else(|| refuse(no_times()))?;
        let unit = time_named(head.names[time]).and_then(|column| column.unit);
        let mut layout = Self { roles: Vec::new(), arms: Vec::new(), has_gaps, unit };
        for (column, part) in parts.iter().enumerate() {
            if let Part::Joint(Quantity::Position, arm, joint) = part {
                layout.add_joint(arm, joint).map_err(|message| refuse((column, message)))?;
            }
        }
        for (column, part) in parts.iter().enumerate() {
            let role = layout.role(part, head.names).map_err(|message| refuse((column, message)))?;
            layout.roles.push(role);
        }
        layout.check_complete()?;
        layout.note_others(head.names, notes);
        Ok(layout)
    }

    fn add_joint(&mut self, arm: &str, joint: &str) -> Result<(), String> {
        let index = self.arm(arm).unwrap_or_else(|| {
            self.arms.push(ArmTrajectory::empty(arm));
            self.arms.len() - 1
        });
        if self.has_gaps && self.arms[index].joints.iter().any(|known| known == joint) {
            let remedy = "--map COLUMN=JOINT takes some columns and leaves out the others";
            return Err(format!("two columns have positions of `{joint}`; {remedy}"));
        }
        self.arms[index].joints.push(joint.to_owned());
        Ok(())
    }

    fn arm(&self, name: &str) -> Option<usize> {
        self.arms.iter().position(|arm| arm.name == name)
    }

    fn role(&self, part: &Part, names: &[&str]) -> Result<Role, String> {
        Ok(match part {
            Part::Time => Role::Time,
            Part::Nanoseconds => Role::Nanoseconds,
            Part::Other => Role::Other,
            Part::Joint(quantity, arm, joint) => {
                let place = self.arm(arm).and_then(|index| {
                    Some((index, self.arms[index].joints.iter().position(|known| known == joint)?))
                });
                let (arm, joint) = place.ok_or_else(|| {
                    let known = quantity.plural();
                    let is_plain = arm == ONLY_ARM && !names.iter().any(|name| name.starts_with("arm."));
                    let name = if is_plain { joint.clone() } else { format!("{arm}.{joint}") };
                    format!("there are {known} of `{name}` but no positions; it needs a column `{name}`")
                })?;
                Role::Joint { quantity: *quantity, arm, joint }
            }
            Part::Error(arm) => {
                let arm = self.arm(arm).ok_or_else(|| format!("no joint of an arm `{arm}` has a column"))?;
                Role::Error { arm }
            }
        })
    }

    /// A quantity is known of all joints of an arm or of none.
    fn check_complete(&self) -> Result<(), Problem> {
        for quantity in Quantity::ALL {
            for (index, arm) in self.arms.iter().enumerate() {
                let known = |joint| self.roles.contains(&Role::Joint { quantity, arm: index, joint });
                let has: Vec<bool> = (0..arm.joints.len()).map(known).collect();
                let missing = has.iter().position(|has| !has).filter(|_| has.contains(&true));
                if let Some(place) = missing {
                    let (joint, known) = (&arm.joints[place], quantity.plural());
                    return Err(Problem::at(0, format!("some joints have {known} and `{joint}` has none")));
                }
            }
        }
        Ok(())
    }

    fn note_others(&self, names: &[&str], notes: &mut Vec<String>) {
        let others = names.iter().zip(&self.roles).filter(|(_, role)| **role == Role::Other);
        let others: Vec<&str> = others.map(|(name, _)| *name).collect();
        if let Some(list) = listed(&others) {
            let count = others.len();
            notes.push(match count {
                1 => format!("one column is left out: {list}"),
                _ => format!("{count} columns are left out: {list}"),
            });
        }
    }
}

/// The refusal of columns none of which has times.
pub(super) fn no_times() -> Refused {
    let message = "no column has times; it is called t, time, timestamp, __time or header.stamp, or named by --map COLUMN=t";
    (0, message.to_owned())
}

/// The first few names, with a word for the rest; nothing where there are none.
pub(super) fn listed<'n>(names: &[&'n str]) -> Option<String> {
    const SHOWN: usize = 6;
    let shown = |name: &&'n str| if name.is_empty() { "one without a name" } else { *name };
    let shown: Vec<&str> = names.iter().map(shown).take(SHOWN).collect();
    let rest = if names.len() > SHOWN { ", ..." } else { "" };
    (!shown.is_empty()).then(|| format!("{}{rest}", shown.join(", ")))
}

fn check_names(Head { names, first }: Head<'_>) -> Result<(), Refused> {
    let mut known: HashSet<&str> = HashSet::new();
    for (column, name) in names.iter().enumerate() {
        // Tables of pandas begin with a column that counts the rows and has no name; lines of others end with a comma.
        let ends = column + 1 == names.len() && first.len() == names.len() && first[column].is_empty();
        if name.is_empty() && ends {
            continue;
        }
        if name.is_empty() && (column > 0 || names.len() < 3) {
            return Err((column, "this column has no name".to_owned()));
        }
        if !known.insert(name) {
            return Err((column, format!("there are two columns `{name}`")));
        }
    }
    Ok(())
}
