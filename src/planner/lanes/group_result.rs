use crate::math::LaneArray;

/// What an evaluation found in all lanes.
#[derive(Clone, Copy, Debug)]
pub(in crate::planner) struct GroupResult<A> {
    pub(in crate::planner) error: [A; 6],
    /// The squares of the position error and of the orientation error.
    pub(in crate::planner) deviation: [A; 2],
    /// The lower bound of the smallest singular value, where nothing else was found out.
    pub(in crate::planner) bound: A,
    pub(in crate::planner) smallest_pivot: A,
}

impl<A: LaneArray> GroupResult<A> {
    pub(in crate::planner) const NOTHING: Self =
        Self { error: [A::ZERO; 6], deviation: [A::ZERO; 2], bound: A::ZERO, smallest_pivot: A::ZERO };
}
