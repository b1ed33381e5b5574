//! Chains that move in the same way, run side by side: one in each lane.

use fearless_simd::Simd;

use super::Chain;
use super::kinematics::{Axis, Motions, forward, into_twist};
use super::segment::Folded;
use crate::math::{LaneArray, Lanes};

/// The constants of up to `A::WIDTH` chains; the last chain fills the lanes that are left.
#[derive(Debug, Clone)]
pub(crate) struct SideBySide<A> {
    folded: Folded<A>,
}

/// Working memory and results of [`SideBySide::run`].
#[derive(Debug, Clone)]
pub(crate) struct SideBySideScratch<A> {
    motions: Motions,
    /// The geometric Jacobians, column by column.
    pub(crate) columns: Vec<Axis<A>>,
}

/// The tips of all lanes.
pub(crate) struct Tips<V> {
    /// The columns of the rotation matrices.
    pub(crate) rotation: [[V; 3]; 3],
    /// The positions \[m\].
    pub(crate) position: [V; 3],
}

impl<A: LaneArray> SideBySide<A> {
    /// `None` unless the chains move in the same way, with one joint for each axis.
    pub(crate) fn new(chains: &[&Chain]) -> Option<Self> {
        let is_direct = |chain: &Chain| {
            let mut places = chain.places.iter().enumerate();
            places.all(|(i, place)| place.column == i && place.multiplier == 1.0)
        };
        if !chains.iter().all(|chain| is_direct(chain)) {
            return None;
        }
        let folded: Vec<_> = chains.iter().map(|chain| &chain.folded).collect();
        Some(Self { folded: Folded::side_by_side(&folded)? })
    }

    /// The number of joints of each chain.
    pub(crate) fn dof(&self) -> usize {
        self.folded.segments.len()
    }

    pub(crate) fn scratch(&self) -> SideBySideScratch<A> {
        SideBySideScratch {
            motions: Motions::with_length(self.dof() * A::WIDTH),
            columns: vec![[A::ZERO; 6]; self.dof()],
        }
    }

    /// Runs the kinematics at joint positions that lie joint by joint, all lanes of each, filled up to whole vectors of four.
    /// The Jacobians are [completed](Self::complete_columns) later, when the rotations do not fill the registers any more.
    #[inline(always)]
    pub(crate) fn run<S: Simd>(
        &self,
        simd: S,
        q: &[f64],
        scratch: &mut SideBySideScratch<A>,
    ) -> Tips<A::Vector<S>> {
        scratch.motions.turn_to(simd, q);
        let position = |k: usize| <A::Vector<S> as Lanes>::load_slice(simd, &q[k * A::WIDTH..][..A::WIDTH]);
        let columns = &mut scratch.columns;
        let tip = forward::<A::Vector<S>>(simd, &self.folded, &scratch.motions, position, columns);
        Tips { rotation: [tip.x, tip.y, tip.z], position: tip.p }
    }

    /// Completes the geometric Jacobians of the tips at `position`, which [`run`](Self::run) found.
    #[inline(always)]
    pub(crate) fn complete_columns<S: Simd>(
        &self,
        simd: S,
        position: &[A::Vector<S>; 3],
        scratch: &mut SideBySideScratch<A>,
    ) {
        for (segment, column) in self.folded.segments.iter().zip(&mut scratch.columns) {
            into_twist::<A::Vector<S>>(simd, column, segment.motion, position);
        }
    }
}
