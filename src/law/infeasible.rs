/// Which limit of a joint is meant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LimitKind {
    /// Lower or upper position limit [rad or m].
    Position,
    /// Velocity limit [rad/s or m/s], of the joint velocity or of the mean velocity between two samples.
    Velocity,
    /// Acceleration limit [rad/s^2 or m/s^2].
    Acceleration,
    /// Jerk limit [rad/s^3 or m/s^3].
    Jerk,
}

impl LimitKind {
    /// The word used in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Position => "position",
            Self::Velocity => "velocity",
            Self::Acceleration => "acceleration",
            Self::Jerk => "jerk",
        }
    }
}

/// One of the rows that can not all be met.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Conflict {
    /// A row of a task: what it asks for.
    Task {
        /// The place of the task among those of the [`Instant`](super::Instant).
        task: usize,
        /// The row of it.
        row: usize,
    },
    /// A limit of a joint: what it allows.
    Limit {
        /// The place of the joint among those of the system.
        joint: usize,
        /// Which of its limits.
        kind: LimitKind,
    },
    /// The distance that two bodies are kept apart.
    Distance {
        /// The number of the pair, as in [`Avoidance::contacts`](super::Avoidance::contacts).
        pair: usize,
    },
}

/// No joint velocity meets all that is asked for and allowed: the run stops there with the status `limit` and names the rows.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Infeasible {
    /// The rows in conflict. An empty list says that it is not known which they are.
    pub conflicts: Vec<Conflict>,
}
