//! Which columns of a table are taken, and for what.

use std::str::FromStr;

use super::quantity::Quantity;

/// A rule for columns: `COLUMNS` or `COLUMNS=TARGET`.
///
/// `COLUMNS` is the name of a column, or a pattern with one `*` that stands for any text. `TARGET` is
///
/// - nothing, `position`, `velocity` or `acceleration`, for a pattern: what `*` stands for is the joint, by its name, or by its number
///   where all of them are numbers that count from 0 or 1: then they are the robot's joints in their order;
/// - `t`: the column has the times;
/// - the name of a joint, perhaps with `*` for what it stands for in `COLUMNS`, and perhaps with `.position`, `.velocity` or
///   `.acceleration` behind it.
///
/// ```
/// use kinstep_files::trajectory::ColumnMap;
/// let map: ColumnMap = "/states/*_joint/speed=left_*.velocity".parse().unwrap();
/// assert_eq!(map.to_string(), "/states/*_joint/speed=left_*.velocity");
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ColumnMap {
    text: String,
    columns: String,
    pub(super) target: Target,
}

/// What columns are taken for.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Target {
    Time,
    /// The joint that `*` stands for.
    Starred(Quantity),
    /// The joint of this name, in which `*` may stand.
    Joint(Quantity, String),
}

impl std::fmt::Display for ColumnMap {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.text)
    }
}

impl FromStr for ColumnMap {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (columns, target) = text.rsplit_once('=').unwrap_or((text, ""));
        let stars = columns.matches('*').count();
        if columns.is_empty() || stars > 1 {
            return Err(format!("\"{text}\": expected the name of a column, or a pattern with one *"));
        }
        let target = match target {
            "t" => Target::Time,
            "" | "position" if stars == 1 => Target::Starred(Quantity::Position),
            "velocity" if stars == 1 => Target::Starred(Quantity::Velocity),
            "acceleration" if stars == 1 => Target::Starred(Quantity::Acceleration),
            "" => {
                return Err(format!(
                    "\"{text}\": say what the column is, as in {text}=JOINT or {text}=JOINT.velocity"
                ));
            }
            joint => of_joint(joint),
        };
        if let Target::Joint(_, joint) = &target
            && joint.matches('*').count() != stars
        {
            return Err(format!(
                "\"{text}\": * has to stand on both sides, or for the joint as in \"{columns}=position\""
            ));
        }
        Ok(Self { text: text.to_owned(), columns: columns.to_owned(), target })
    }
}

/// A joint's name, with the quantity behind it.
fn of_joint(name: &str) -> Target {
    let quantity = |quantity: &Quantity| {
        let joint = name.strip_suffix(quantity.name())?.strip_suffix('.')?;
        Some(Target::Joint(*quantity, joint.to_owned()))
    };
    let found = Quantity::ALL.iter().find_map(quantity);
    found.unwrap_or_else(|| Target::Joint(Quantity::Position, name.to_owned()))
}

impl ColumnMap {
    /// Returns what `*` stands for in a column's name, where the name is meant; nothing stands for it in a plain name.
    pub(super) fn meant<'c>(&self, column: &'c str) -> Option<&'c str> {
        let Some((before, after)) = self.columns.split_once('*') else {
            return (self.columns == column).then_some("");
        };
        column.strip_prefix(before)?.strip_suffix(after).filter(|star| !star.is_empty())
    }

    /// The joint's name, with what `*` stands for.
    pub(super) fn joint(name: &str, star: &str) -> String {
        name.replacen('*', star, 1)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rules_say_what_they_mean_or_why_they_can_not() {
        let map = |text: &str| text.parse::<ColumnMap>().unwrap();
        assert_eq!(map("actual_q_*").meant("actual_q_0"), Some("0"));
        assert_eq!(map("actual_q_*").meant("actual_qd_0"), None);
        assert_eq!(map("a*b").meant("ab"), None);
        assert_eq!(map("q0=elbow").target, Target::Joint(Quantity::Position, "elbow".to_owned()));
        assert_eq!(map("q0=elbow.velocity").target, Target::Joint(Quantity::Velocity, "elbow".to_owned()));
        assert_eq!(map("stamp=t").target, Target::Time);
        assert_eq!(map("*/p=position").target, Target::Starred(Quantity::Position));
        for bad in ["", "=t", "a*b*", "q0", "q*=elbow", "q0=j*"] {
            assert!(bad.parse::<ColumnMap>().is_err(), "{bad}");
        }
    }
}
