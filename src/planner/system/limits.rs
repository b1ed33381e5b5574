//! The one rule for the limits of a joint, for one arm and for arms side by side alike.

use crate::math::Lanes;
use crate::robot::Limits;

/// The limits of one joint in all lanes, in the form in which most samples are done with at a glance.
#[derive(Clone, Copy, Debug)]
pub(in crate::planner) struct JointLimits<A> {
    pub(in crate::planner) lower: A,
    pub(in crate::planner) upper: A,
    pub(in crate::planner) velocity: A,
    /// How far the joint may go in one step, less what rounding could make of it.
    pub(in crate::planner) stride: A,
}

impl JointLimits<[f64; 1]> {
    pub(in crate::planner) fn of(limits: &Limits, sigma: f64) -> Self {
        let Limits { lower, upper, velocity, .. } = *limits;
        Self {
            lower: [lower],
            upper: [upper],
            velocity: [velocity],
            stride: [velocity * sigma * (1.0 - 1e-12)],
        }
    }
}

/// The larger of `excess` and what a joint is beyond its limits by: while it is not positive, no limit can have been
/// crossed. A NaN is no crossing.
#[inline(always)]
pub(in crate::planner) fn excess<V: Lanes>(
    token: V::Token,
    limits: &JointLimits<V::Array>,
    [q, previous, velocity]: [V; 3],
    excess: V,
) -> V {
    let load = |array| V::load(token, array);
    let excess = (q - load(&limits.upper)).greatest(excess);
    let excess = (load(&limits.lower) - q).greatest(excess);
    let excess = (velocity.abs() - load(&limits.velocity)).greatest(excess);
    ((q - previous).abs() - load(&limits.stride)).greatest(excess)
}
