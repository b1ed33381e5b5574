//! By which number the errors of a run are summed up.

/// A functional of the errors along a run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Measure {
    /// The largest over the whole run, start-up included.
    #[default]
    Maximum,
    /// The largest over the second half of the run, where the start is forgotten.
    Steady,
    /// The error of the last sample. Errors of opposite sign may have met there, and a path at rest hides its own.
    EndPoint,
    /// The root of the mean square over the run.
    MeanSquare,
}

impl Measure {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Maximum, Self::Steady, Self::EndPoint, Self::MeanSquare];

    /// The word used in scenarios.
    pub fn name(self) -> &'static str {
        match self {
            Self::Maximum => "maximum",
            Self::Steady => "steady",
            Self::EndPoint => "end-point",
            Self::MeanSquare => "mean-square",
        }
    }
}
