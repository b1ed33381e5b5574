/// How far the step from the newest state has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Phase {
    /// The state is there; what the field is at it is not known.
    Reached,
    /// The field was evaluated.
    Evaluated,
    /// There is a candidate for the next state, to be corrected.
    Predicted,
    /// The candidate can be accepted or rejected.
    Corrected,
}
