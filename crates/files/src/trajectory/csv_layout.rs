//! What the columns of a table of samples hold, by their names.

use std::collections::HashSet;

use super::ArmTrajectory;
use super::error::Problem;
use super::quantity::Quantity;

/// The name of the arm where columns name none.
const ONLY_ARM: &str = "arm";
/// What a column of times may be called.
const TIMES: [&str; 3] = ["t", "time", "timestamp"];

/// What a column holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Role {
    Time,
    Joint { quantity: Quantity, arm: usize, joint: usize },
    Error { arm: usize },
}

/// The roles of all columns, and the arms that they make, without samples.
#[derive(Clone, Debug)]
pub(super) struct Layout {
    pub(super) roles: Vec<Role>,
    pub(super) arms: Vec<ArmTrajectory>,
}

/// A column's name, taken apart.
enum Part<'n> {
    Time,
    Joint(Quantity, &'n str),
    Error(&'n str),
}

impl Layout {
    /// Returns what columns of these names hold: `t`; of every arm `ARM.JOINT`, `ARM.JOINT.velocity` and `ARM.error`; or
    /// plain names of the joints of one arm, `JOINT` and `JOINT.velocity`; accelerations as velocities. `place` says at which byte a column's name
    /// stands, where it does.
    pub(super) fn of(names: &[&str], place: impl Fn(usize) -> Option<usize>) -> Result<Self, Problem> {
        let refuse = |column: usize, message: String| Problem { message, at: place(column) };
        let mut known: HashSet<&str> = HashSet::new();
        for (column, name) in names.iter().enumerate() {
            if name.is_empty() {
                return Err(refuse(column, "this column has no name".to_owned()));
            }
            if !known.insert(name) {
                return Err(refuse(column, format!("there are two columns `{name}`")));
            }
        }
        let time = time_column(names)
            .ok_or_else(|| refuse(0, format!("no column has times; it is called {}", TIMES.join(", "))))?;
        let parts: Vec<Part<'_>> = names
            .iter()
            .enumerate()
            .map(|(column, name)| if column == time { Part::Time } else { part(name, &known) })
            .collect();
        let is_plain = !parts
            .iter()
            .any(|part| matches!(part, Part::Joint(Quantity::Position, name) if name.contains('.')));
        let mut layout = Self { roles: Vec::new(), arms: Vec::new() };
        for (column, part) in parts.iter().enumerate() {
            if let Part::Joint(Quantity::Position, name) = part {
                layout.add_joint(name, is_plain).map_err(|message| refuse(column, message))?;
            }
        }
        for (column, part) in parts.iter().enumerate() {
            let role = layout.role(part, is_plain).map_err(|message| refuse(column, message))?;
            layout.roles.push(role);
        }
        layout.check_complete()?;
        Ok(layout)
    }

    fn add_joint(&mut self, name: &str, is_plain: bool) -> Result<(), String> {
        let (arm, joint) = split(name, is_plain)?;
        let index = self.arm(arm).unwrap_or_else(|| {
            self.arms.push(ArmTrajectory::empty(arm));
            self.arms.len() - 1
        });
        self.arms[index].joints.push(joint.to_owned());
        Ok(())
    }

    fn arm(&self, name: &str) -> Option<usize> {
        self.arms.iter().position(|arm| arm.name == name)
    }

    fn role(&self, part: &Part<'_>, is_plain: bool) -> Result<Role, String> {
        let joint = |quantity: Quantity, name: &str| -> Result<(usize, usize), String> {
            let (arm, joint) = split(name, is_plain)?;
            let place = self.arm(arm).and_then(|index| {
                Some((index, self.arms[index].joints.iter().position(|known| known == joint)?))
            });
            place.ok_or_else(|| {
                let known = quantity.plural();
                format!("there are {known} of `{name}` but no positions; it needs a column `{name}`")
            })
        };
        Ok(match part {
            Part::Time => Role::Time,
            Part::Joint(quantity, name) => {
                joint(*quantity, name).map(|(arm, joint)| Role::Joint { quantity: *quantity, arm, joint })?
            }
            Part::Error(arm) => {
                let name = if is_plain { ONLY_ARM } else { arm };
                let arm = self.arm(name).ok_or_else(|| format!("no joint of an arm `{arm}` has a column"))?;
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
}

fn time_column(names: &[&str]) -> Option<usize> {
    TIMES.iter().find_map(|time| names.iter().position(|name| name.eq_ignore_ascii_case(time)))
}

fn part<'n>(name: &'n str, known: &HashSet<&str>) -> Part<'n> {
    let rates = [Quantity::Velocity, Quantity::Acceleration];
    for quantity in rates {
        if let Some(joint) = name.strip_suffix(quantity.suffix()) {
            return Part::Joint(quantity, joint);
        }
    }
    let is_error = name == "error" || name.strip_suffix(".error").is_some();
    let has_rate = |quantity: Quantity| known.contains(format!("{name}{}", quantity.suffix()).as_str());
    if is_error && !rates.into_iter().any(has_rate) {
        return Part::Error(name.strip_suffix(".error").unwrap_or_default());
    }
    Part::Joint(Quantity::Position, name)
}

/// Returns the arm and the joint that a name means. Arms' names have no dot in them, joints' may.
fn split(name: &str, is_plain: bool) -> Result<(&str, &str), String> {
    if is_plain {
        return Ok((ONLY_ARM, name));
    }
    name.split_once('.')
        .ok_or_else(|| format!("`{name}` names no arm although other columns do; call it ARM.{name}"))
}
