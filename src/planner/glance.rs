//! The limits and figures of arms side by side, in the form in which most samples are done with at a glance.

use super::board::Board;
use super::bundle::Sample;
use super::lost::{Bounds, NEAR};
use super::monitor::Monitor;
use super::runtime::ArmRuntime;
use crate::math::{Kernel, LaneArray, Lanes};
use fearless_simd::Simd;

/// What is compared with the limits of one joint of all lanes.
#[derive(Clone, Copy, Debug)]
struct JointLimits<A> {
    lower: A,
    upper: A,
    velocity: A,
    /// How far a joint may go in one step, less what rounding could make of it.
    stride: A,
}

/// What tells that every lane is on its path, far from singularities.
#[derive(Clone, Copy, Debug)]
pub(super) struct OnCourse<A> {
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

/// What an evaluation found in all lanes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Found<A> {
    pub(super) error: [A; 6],
    /// The squares of the position error and of the orientation error.
    pub(super) deviation: [A; 2],
    /// The lower bound of the smallest singular value, where nothing else was found out.
    pub(super) bound: A,
    pub(super) smallest_pivot: A,
}

impl<A: LaneArray> Found<A> {
    pub(super) const NOTHING: Self =
        Self { error: [A::ZERO; 6], deviation: [A::ZERO; 2], bound: A::ZERO, smallest_pivot: A::ZERO };
}

/// Joint limits and extremes of all lanes.
pub(super) struct Glance<A> {
    joints: Vec<JointLimits<A>>,
    extremes: Extremes<A>,
}

/// One real per arm; the last arm fills the lanes that are left.
pub(super) fn of_lanes<A: LaneArray>(arms: &[&ArmRuntime], pick: impl Fn(&ArmRuntime) -> f64) -> A {
    let mut array = A::ZERO;
    for (lane, entry) in array.as_mut().iter_mut().enumerate() {
        *entry = pick(arms[lane.min(arms.len() - 1)]);
    }
    array
}

impl<A: LaneArray> OnCourse<A> {
    pub(super) fn new(arms: &[&ArmRuntime]) -> Self {
        let largest = |arm: &ArmRuntime| Bounds::largest(&arm.bounds, 1.0);
        Self {
            conditioning: of_lanes(arms, |arm| NEAR * arm.arm.law.threshold()),
            deviation: [
                of_lanes(arms, |arm| largest(arm).position),
                of_lanes(arms, |arm| largest(arm).orientation),
            ],
        }
    }

    /// Whether all lanes are; not so with a NaN.
    #[inline(always)]
    pub(super) fn holds<V: Lanes<Array = A>>(
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

impl<A: LaneArray> Glance<A> {
    pub(super) fn new(arms: &[&ArmRuntime]) -> Self {
        let joint = |i: usize| {
            let limit = |pick: fn(&crate::planner::monitor::Limit) -> f64| {
                of_lanes(arms, |arm| pick(&arm.monitor.limits()[i]))
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

    /// Gives the monitor of an arm what was seen in its lane.
    pub(super) fn hand_over(&self, lane: usize, monitor: &mut Monitor) {
        let at = |array: &A| array.as_ref()[lane];
        let seen = &self.extremes;
        monitor.observe_extremes(
            [at(&seen.position), at(&seen.orientation), at(&seen.sum)],
            at(&seen.component),
            (at(&seen.smallest_singular_value), at(&seen.smallest_at)),
        );
    }
}

/// A look at a sample in which all arms are on their paths.
pub(super) struct Look<'a, A> {
    pub(super) glance: &'a mut Glance<A>,
    pub(super) board: &'a mut Board<A>,
    pub(super) found: &'a Found<A>,
    pub(super) t: f64,
    pub(super) sample: &'a Sample<'a>,
}

impl<A: LaneArray> Kernel for Look<'_, A> {
    /// Whether no joint limit can have been crossed.
    type Output = bool;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> bool {
        let load = |array: &A| <A::Vector<S> as Lanes>::load(simd, array);
        self.board.write(simd, self.sample, self.found);
        note_extremes(simd, &mut self.glance.extremes, self.found, self.t);
        let zero = load(&A::ZERO);
        let mut excess = zero;
        let Sample { positions, previous, velocities } = *self.sample;
        let joints = self.glance.joints.iter().zip(positions.chunks_exact(A::WIDTH));
        let motion = previous.chunks_exact(A::WIDTH).zip(velocities.chunks_exact(A::WIDTH));
        for ((limits, q), (previous, velocity)) in joints.zip(motion) {
            let read = |values: &[f64]| <A::Vector<S> as Lanes>::load_slice(simd, values);
            let (q, previous, velocity) = (read(q), read(previous), read(velocity));
            // A NaN is no crossing.
            excess = (q - load(&limits.upper)).greatest(excess);
            excess = (load(&limits.lower) - q).greatest(excess);
            excess = (velocity.abs() - load(&limits.velocity)).greatest(excess);
            excess = ((q - previous).abs() - load(&limits.stride)).greatest(excess);
        }
        zero.all_at_least(excess)
    }
}

#[inline(always)]
fn note_extremes<S: Simd, A: LaneArray>(simd: S, extremes: &mut Extremes<A>, found: &Found<A>, t: f64) {
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
