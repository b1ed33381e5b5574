//! Where arms side by side can be read arm by arm: their states are kept joint by joint.

use super::group_result::GroupResult;
use super::sample::Sample;
use crate::math::{Kernel, LaneArray};
use crate::planner::system::ArmState;
use fearless_simd::Simd;
use nalgebra::Vector6;

/// The present sample of all lanes, lane by lane, each filled up to whole arrays.
pub(in crate::planner) struct Transpose<A> {
    joints: usize,
    positions: Vec<A>,
    velocities: Vec<A>,
    errors: Vec<A>,
}

impl<A: LaneArray> Transpose<A> {
    pub(in crate::planner) fn new(joints: usize) -> Self {
        let blank = |entries: usize| vec![A::ZERO; A::WIDTH * entries.div_ceil(A::WIDTH)];
        Self { joints, positions: blank(joints), velocities: blank(joints), errors: blank(6) }
    }

    /// Writes down what was found of a sample.
    #[inline(always)]
    pub(in crate::planner) fn write<S: Simd>(
        &mut self,
        simd: S,
        sample: &Sample<'_>,
        found: &GroupResult<A>,
    ) {
        let joints = |reals| &A::arrays(reals)[..self.joints];
        A::write_lanes(simd, joints(sample.positions), &mut self.positions);
        A::write_lanes(simd, joints(sample.velocities), &mut self.velocities);
        A::write_lanes(simd, &found.error, &mut self.errors);
    }

    /// The arm of a lane.
    pub(in crate::planner) fn arm(&self, lane: usize, damped: bool) -> ArmState<'_> {
        let error = entries(&self.errors, lane, 6);
        ArmState {
            positions: entries(&self.positions, lane, self.joints),
            velocities: entries(&self.velocities, lane, self.joints),
            error: Vector6::from_column_slice(error),
            damped,
        }
    }
}

/// The entries of a lane.
fn entries<A: LaneArray>(lanes: &[A], lane: usize, count: usize) -> &[f64] {
    let arrays = lanes.len() / A::WIDTH;
    &A::reals(&lanes[lane * arrays..][..arrays])[..count]
}

/// Transposes a sample; see [`Transpose::write`].
pub(in crate::planner) struct Transposition<'a, A> {
    pub(in crate::planner) transpose: &'a mut Transpose<A>,
    pub(in crate::planner) found: &'a GroupResult<A>,
    pub(in crate::planner) sample: &'a Sample<'a>,
}

impl<A: LaneArray> Kernel for Transposition<'_, A> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        self.transpose.write(simd, self.sample, self.found);
    }
}
