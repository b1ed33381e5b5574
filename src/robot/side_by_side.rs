//! Chains that move in the same way, run side by side: one in each lane.

use fearless_simd::Simd;

use super::Chain;
use super::kinematics::{Axis, Motions, forward, twist_of};
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
    axes: Vec<Axis<A>>,
    /// The geometric Jacobians, column by column.
    pub(crate) columns: Vec<[A; 6]>,
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
            axes: vec![Axis::nowhere(A::ZERO); self.dof()],
            columns: vec![[A::ZERO; 6]; self.dof()],
        }
    }

    /// Runs the kinematics at the joint positions of each lane.
    #[inline(always)]
    pub(crate) fn run<S: Simd>(
        &self,
        simd: S,
        q: &A::Of<&[f64]>,
        scratch: &mut SideBySideScratch<A>,
    ) -> Tips<A::Vector<S>> {
        let q = q.as_ref();
        scratch.motions.turn(simd, |i| q[i % A::WIDTH].get(i / A::WIDTH).copied().unwrap_or(0.0));
        let position = |k: usize| <A::Vector<S> as Lanes>::gather(simd, |lane| q[lane][k]);
        let tip = forward::<A::Vector<S>>(simd, &self.folded, &scratch.motions, position, &mut scratch.axes);
        let axes = self.folded.segments.iter().zip(&scratch.axes);
        for ((segment, axis), column) in axes.zip(&mut scratch.columns) {
            let twist = twist_of::<A::Vector<S>>(simd, axis, segment.motion, &tip.p);
            for row in 0..6 {
                twist[row].store(&mut column[row]);
            }
        }
        Tips { rotation: [tip.x, tip.y, tip.z], position: tip.p }
    }
}
