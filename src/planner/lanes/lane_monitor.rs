//! The limits and figures of arms side by side, in the form in which most samples are done with at a glance.

use super::group_result::GroupResult;
use super::sample::Sample;
use super::transpose::Transpose;
use crate::math::{Kernel, LaneArray, Lanes};
use crate::planner::system::{ArmRuntime, JointLimits, Monitor, excess};
use fearless_simd::Simd;

/// What tells that every lane is on its path, far from singularities.
#[derive(Clone, Copy, Debug)]
pub(in crate::planner) struct LaneCriteria<A> {
    /// The least bound of the smallest singular value.
    conditioning: A,
    /// The largest squares of the position error \[m^2\] and of the orientation error \[rad^2\].
    deviation: [A; 2],
}

/// The largest and smallest figures since they were last handed to the monitors.
#[derive(Clone, Copy, Debug)]
struct Extremes<A> {
    sum: A,
    position: A,
    orientation: A,
    component: A,
    smallest_singular_value: A,
    smallest_at: A,
}

/// Joint limits and extremes of all lanes.
pub(in crate::planner) struct LaneMonitor<A> {
    joints: Vec<JointLimits<A>>,
    extremes: Extremes<A>,
}

/// One real per arm; the last arm fills the lanes that are left.
pub(in crate::planner) fn of_lanes<A: LaneArray>(
    arms: &[&ArmRuntime],
    pick: impl Fn(&ArmRuntime) -> f64,
) -> A {
    let mut array = A::ZERO;
    for (lane, entry) in array.as_mut().iter_mut().enumerate() {
        *entry = pick(arms[lane.min(arms.len() - 1)]);
    }
    array
}

impl<A: LaneArray> LaneCriteria<A> {
    pub(in crate::planner) fn new(arms: &[&ArmRuntime]) -> Self {
        Self {
            conditioning: of_lanes(arms, |arm| arm.stop_criteria().conditioning),
            deviation: [
                of_lanes(arms, |arm| arm.stop_criteria().deviation.position),
                of_lanes(arms, |arm| arm.stop_criteria().deviation.orientation),
            ],
        }
    }

    /// Whether no lane needs a closer look; not so with a NaN.
    #[inline(always)]
    pub(in crate::planner) fn holds<V: Lanes<Array = A>>(
        &self,
        token: V::Token,
        (bound, smallest_pivot): (V, V),
        deviation: &[V; 2],
    ) -> bool {
        bound.all_at_least(V::load(token, &self.conditioning))
            & smallest_pivot.all_at_least(V::splat(token, f64::MIN_POSITIVE))
            & V::load(token, &self.deviation[0]).all_at_least(deviation[0])
            & V::load(token, &self.deviation[1]).all_at_least(deviation[1])
    }
}

impl<A: LaneArray> Extremes<A> {
    fn none() -> Self {
        let mut infinity = A::ZERO;
        infinity.as_mut().fill(f64::INFINITY);
        Self {
            sum: A::ZERO,
            position: A::ZERO,
            orientation: A::ZERO,
            component: A::ZERO,
            smallest_singular_value: infinity,
            smallest_at: A::ZERO,
        }
    }
}

impl<A: LaneArray> LaneMonitor<A> {
    pub(in crate::planner) fn new(arms: &[&ArmRuntime]) -> Self {
        let joint = |i: usize| {
            let limit = |pick: fn(&JointLimits<[f64; 1]>) -> [f64; 1]| {
                of_lanes(arms, |arm| pick(&arm.monitor.limits()[i])[0])
            };
            JointLimits {
                lower: limit(|limit| limit.lower),
                upper: limit(|limit| limit.upper),
                velocity: limit(|limit| limit.velocity),
                stride: limit(|limit| limit.stride),
            }
        };
        let joints = arms.first().map_or(0, |arm| arm.positions.len());
        Self { joints: (0..joints).map(joint).collect(), extremes: Extremes::none() }
    }

    /// Gives the monitor of an arm what was observed in its lane.
    pub(in crate::planner) fn flush_to(&self, lane: usize, monitor: &mut Monitor) {
        let at = |array: &A| array.as_ref()[lane];
        let seen = &self.extremes;
        monitor.observe_extremes(
            [at(&seen.position), at(&seen.orientation), at(&seen.sum)],
            at(&seen.component),
            (at(&seen.smallest_singular_value), at(&seen.smallest_at)),
        );
    }
}

/// An observation of a sample in which no arm needs a closer look.
pub(in crate::planner) struct Observation<'a, A> {
    pub(in crate::planner) monitor: &'a mut LaneMonitor<A>,
    pub(in crate::planner) transpose: &'a mut Transpose<A>,
    pub(in crate::planner) found: &'a GroupResult<A>,
    pub(in crate::planner) t: f64,
    pub(in crate::planner) sample: &'a Sample<'a>,
}

impl<A: LaneArray> Kernel for Observation<'_, A> {
    /// Whether no joint limit can have been crossed.
    type Output = bool;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> bool {
        let load = |array: &A| <A::Vector<S> as Lanes>::load(simd, array);
        self.transpose.write(simd, self.sample, self.found);
        note_extremes(simd, &mut self.monitor.extremes, self.found, self.t);
        let zero = load(&A::ZERO);
        let mut most = zero;
        let Sample { positions, previous, velocities } = *self.sample;
        let joints = self.monitor.joints.iter().zip(positions.chunks_exact(A::WIDTH));
        let motion = previous.chunks_exact(A::WIDTH).zip(velocities.chunks_exact(A::WIDTH));
        for ((limits, q), (previous, velocity)) in joints.zip(motion) {
            let read = |values: &[f64]| <A::Vector<S> as Lanes>::load_slice(simd, values);
            most = excess(simd, limits, [read(q), read(previous), read(velocity)], most);
        }
        zero.all_at_least(most)
    }
}

#[inline(always)]
fn note_extremes<S: Simd, A: LaneArray>(simd: S, extremes: &mut Extremes<A>, found: &GroupResult<A>, t: f64) {
    let load = |array: &A| <A::Vector<S> as Lanes>::load(simd, array);
    let raise = |extreme: &mut A, value: A::Vector<S>| value.greatest(load(extreme)).store(extreme);
    let [position, orientation] = [load(&found.deviation[0]), load(&found.deviation[1])];
    raise(&mut extremes.position, position);
    raise(&mut extremes.orientation, orientation);
    raise(&mut extremes.sum, position + orientation);
    let mut component = load(&extremes.component);
    for entry in &found.error {
        component = load(entry).abs().greatest(component);
    }
    component.store(&mut extremes.component);
    let (bound, smallest) = (load(&found.bound), load(&extremes.smallest_singular_value));
    let now = bound.like(t);
    let at = load(&extremes.smallest_at);
    A::Vector::<S>::where_less(bound, smallest, now, at).store(&mut extremes.smallest_at);
    bound.least(smallest).store(&mut extremes.smallest_singular_value);
}
