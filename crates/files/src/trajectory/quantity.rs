//! What is known of a joint at a sample.

/// A quantity of joints.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Quantity {
    Position,
    Velocity,
    Acceleration,
}

impl Quantity {
    /// All of them, in the order of a table's columns.
    pub(super) const ALL: [Self; 3] = [Self::Position, Self::Velocity, Self::Acceleration];

    /// The word for it.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::Position => "position",
            Self::Velocity => "velocity",
            Self::Acceleration => "acceleration",
        }
    }

    /// The word for several.
    pub(super) fn plural(self) -> &'static str {
        match self {
            Self::Position => "positions",
            Self::Velocity => "velocities",
            Self::Acceleration => "accelerations",
        }
    }

    /// What a column's name has behind that of the joint.
    pub(super) fn suffix(self) -> &'static str {
        match self {
            Self::Position => "",
            Self::Velocity => ".velocity",
            Self::Acceleration => ".acceleration",
        }
    }
}
