//! The fast path: plain arms that are alike, evaluated together in the lanes of registers.
//!
//! Everything here is an equal of `system::System` for arms whose tips track motions by the least-norm law, to the last bit.
//! Laws and tasks of other kinds never come here, and adding one needs nothing of it.

mod arm_group;
mod group_result;
mod lane_group;
mod lane_monitor;
mod sample;
mod transpose;

pub(super) use arm_group::{ArmGroup, GroupMembers};
pub(super) use lane_group::{LaneGroup, LaneMember, are_alike};
pub(super) use sample::Sample;
