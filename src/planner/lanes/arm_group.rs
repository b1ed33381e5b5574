use super::Sample;
use crate::planner::system::{ArmRuntime, ArmState, Moment, System};
use fearless_simd::Level;

/// What a group reaches its arms by: everybody's, of which some are its own.
pub(in crate::planner) struct GroupMembers<'a> {
    pub(in crate::planner) arms: &'a mut [ArmRuntime],
    /// The system of each arm.
    pub(in crate::planner) systems: &'a mut [System],
    pub(in crate::planner) level: Level,
}

/// Arms whose states lie joint by joint, all arms of each joint side by side.
pub(in crate::planner) trait ArmGroup: Send {
    /// How many lanes there are for each joint.
    fn width(&self) -> usize;

    /// Evaluates all arms; returns whether none of them needs a closer look, by its stop criteria.
    fn evaluate(
        &mut self,
        members: &mut GroupMembers<'_>,
        moment: Moment,
        x: &[f64],
        out: [&mut [f64]; 2],
    ) -> bool;

    /// Takes down states, errors, limits and conditioning of a sample in which no arm needs a closer look.
    fn observe(&mut self, members: &mut GroupMembers<'_>, t: f64, sample: &Sample<'_>);

    /// The arm of a lane at the sample that was observed or scattered last.
    fn arm(&self, lane: usize) -> ArmState<'_>;

    /// Gives every arm what is known of it.
    fn scatter_to_arms(&mut self, members: &mut GroupMembers<'_>, sample: &Sample<'_>);

    /// Sets where the monitors have the arms one sample ago.
    fn set_previous(&self, arms: &mut [ArmRuntime], previous: &[f64]);

    /// Gives the monitors what was observed at a glance.
    fn flush_to_monitor(&self, arms: &mut [ArmRuntime]);
}
