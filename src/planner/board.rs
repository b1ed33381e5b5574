//! Where arms side by side can be read arm by arm: their states are kept joint by joint.

use super::bundle::Sample;
use super::glance::Found;
use super::run::ArmState;
use crate::math::{Kernel, LaneArray};
use fearless_simd::Simd;
use nalgebra::Vector6;

/// The present sample of all lanes, lane by lane, each filled up to whole arrays.
pub(super) struct Board<A> {
    joints: usize,
    positions: Vec<A>,
    velocities: Vec<A>,
    errors: Vec<A>,
}

impl<A: LaneArray> Board<A> {
    pub(super) fn new(joints: usize) -> Self {
        let blank = |entries: usize| vec![A::ZERO; A::WIDTH * entries.div_ceil(A::WIDTH)];
        Self { joints, positions: blank(joints), velocities: blank(joints), errors: blank(6) }
    }

    /// Writes up what was found of a sample.
    #[inline(always)]
    pub(super) fn write<S: Simd>(&mut self, simd: S, sample: &Sample<'_>, found: &Found<A>) {
        let joints = |reals| &A::arrays(reals)[..self.joints];
        A::write_lanes(simd, joints(sample.positions), &mut self.positions);
        A::write_lanes(simd, joints(sample.velocities), &mut self.velocities);
        A::write_lanes(simd, &found.error, &mut self.errors);
    }

    /// The arm of a lane.
    pub(super) fn arm(&self, lane: usize, damped: bool) -> ArmState<'_> {
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

/// Writes up a sample; see [`Board::write`].
pub(super) struct WriteUp<'a, A> {
    pub(super) board: &'a mut Board<A>,
    pub(super) found: &'a Found<A>,
    pub(super) sample: &'a Sample<'a>,
}

impl<A: LaneArray> Kernel for WriteUp<'_, A> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        self.board.write(simd, self.sample, self.found);
    }
}
