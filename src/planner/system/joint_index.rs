/// What a component of the state is: a joint of an arm.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(in crate::planner) struct JointIndex {
    /// The arm.
    pub(in crate::planner) arm: usize,
    /// Its joint.
    pub(in crate::planner) joint: usize,
}
