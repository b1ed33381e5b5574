use super::Value;

/// A number for every joint, or for some of them by name.
#[derive(Clone, Debug, PartialEq)]
pub enum ByJoint {
    /// The same for all joints.
    All(f64),
    /// Each for the joint of that name.
    Named(Vec<(String, f64)>),
}

impl ByJoint {
    /// What was written, if it is of this form.
    pub fn of(value: &Value) -> Option<Self> {
        match value {
            Value::Number(number) => Some(Self::All(number.value())),
            Value::Table(entries) => {
                let entry = |(name, value): &(String, Value)| Some((name.clone(), value.number()?));
                Some(Self::Named(entries.iter().map(entry).collect::<Option<_>>()?))
            }
            _ => None,
        }
    }

    /// The number of a joint; `None` where it was not named. Where joints of several machines move together they are called
    /// `MACHINE.JOINT`: the name of the joint then means it on all machines.
    ///
    /// ```
    /// use kinstep::kind::ByJoint;
    ///
    /// let heavy = ByJoint::Named(vec![("shoulder".to_owned(), 8.0)]);
    /// assert_eq!((heavy.number("shoulder"), heavy.number("left.shoulder"), heavy.number("wrist")), (Some(8.0), Some(8.0), None));
    /// ```
    pub fn number(&self, joint: &str) -> Option<f64> {
        let is_meant = |name: &str| {
            joint == name || joint.strip_suffix(name).is_some_and(|machine| machine.ends_with('.'))
        };
        match self {
            Self::All(number) => Some(*number),
            Self::Named(entries) => {
                entries.iter().find(|(name, _)| is_meant(name)).map(|(_, number)| *number)
            }
        }
    }

    /// The names of the joints that it names.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        let entries = match self {
            Self::All(_) => &[][..],
            Self::Named(entries) => entries,
        };
        entries.iter().map(|(name, _)| name.as_str())
    }
}
