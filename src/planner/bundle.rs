//! Arms that move in the same way, evaluated together: one in each lane.

use super::board::{Board, WriteUp};
use super::glance::{Found, Glance, Look, OnCourse};
use super::runtime::ArmRuntime;
use super::{Arm, ArmState};
use crate::law::{Resolution, least_norm};
use crate::math::{Kernel, LaneArray, Lanes, with_instructions};
use crate::robot::{SideBySide, SideBySideScratch};
use crate::task::{Reference, TaskKind, place_of_sample, pose_error};
use fearless_simd::{Level, Simd};
use std::sync::Arc;

/// Arms whose states lie joint by joint, all arms of each joint side by side.
pub(super) trait Together: Send {
    /// How many lanes there are for each joint.
    fn width(&self) -> usize;

    /// Evaluates all arms at time `t` with the gain `gain`; returns whether all of them are clearly on their paths and far
    /// from singularities.
    fn evaluate(
        &mut self,
        level: Level,
        at: (f64, f64),
        arms: &mut [ArmRuntime],
        x: &[f64],
        out: [&mut [f64]; 2],
    ) -> bool;

    /// Takes down states, errors, limits and conditioning of a sample in which all arms are on course.
    fn watch(&mut self, level: Level, t: f64, arms: &mut [ArmRuntime], sample: &Sample<'_>);

    /// The arm of a lane at the sample that was watched or told last.
    fn arm(&self, lane: usize) -> ArmState<'_>;

    /// Tells every arm what is known of it.
    fn tell(&mut self, level: Level, arms: &mut [ArmRuntime], sample: &Sample<'_>);

    /// Tells the monitors where the arms were one sample ago.
    fn remind(&self, arms: &mut [ArmRuntime], previous: &[f64]);

    /// Gives the monitors what has been watched.
    fn hand_over(&self, arms: &mut [ArmRuntime]);
}

/// What a stepper knows of a sample.
#[derive(Clone, Copy)]
pub(super) struct Sample<'a> {
    /// Joint positions [rad or m].
    pub(super) positions: &'a [f64],
    /// Joint positions one sample ago, the same at the start.
    pub(super) previous: &'a [f64],
    /// Feedforward joint velocities [rad/s or m/s].
    pub(super) velocities: &'a [f64],
}

/// Up to `A::WIDTH` arms with chains of one shape, tasks of one kind and the plain least-norm law. The last arm fills the
/// lanes that are left.
pub(super) struct Bundle<A: LaneArray> {
    /// Their indices.
    members: Vec<usize>,
    task: TaskKind,
    chains: SideBySide<A>,
    scratch: SideBySideScratch<A>,
    recorded: Option<Recorded>,
    /// The references of an instant that is not recorded.
    computed: Vec<Reference>,
    found: Found<A>,
    on_course: OnCourse<A>,
    is_on_course: bool,
    /// The lanes that their law damped.
    damped: Vec<bool>,
    glance: Glance<A>,
    board: Board<A>,
}

/// References that were sampled beforehand, with the same gap in all lanes.
struct Recorded {
    lanes: Vec<Arc<[Reference]>>,
    sigma: f64,
}

impl Recorded {
    /// `None` unless the motions of all arms are of that kind.
    fn new(arms: &[&ArmRuntime], width: usize) -> Option<Self> {
        let lane = |lane: usize| arms[lane.min(arms.len() - 1)].arm.motion.samples();
        let (_, sigma) = lane(0)?;
        let of_lane =
            |i: usize| lane(i).filter(|(_, gap)| *gap == sigma).map(|(samples, _)| Arc::clone(samples));
        Some(Self { lanes: (0..width).map(of_lane).collect::<Option<_>>()?, sigma })
    }

    /// The references at time `t`, unless one of the lanes has come to its end.
    fn at<A: LaneArray>(&self, t: f64) -> Option<A::Of<&Reference>> {
        let place = place_of_sample(t, self.sigma)?;
        let covers = |lane: &Arc<[Reference]>| place < lane.len();
        self.lanes.iter().all(covers).then(|| A::each(|lane| &self.lanes[lane][place]))
    }
}

/// Whether arms can be lanes of one bundle of any width.
pub(super) fn are_alike(arms: &[&Arm]) -> bool {
    let fits = |arm: &&Arm| arm.task == arms[0].task && arm.law.least_norm_threshold().is_some();
    let chains: Vec<_> = arms.iter().map(|arm| &arm.chain).collect();
    arms.iter().all(fits) && SideBySide::<[f64; 4]>::new(&chains).is_some()
}

impl<A: LaneArray> Bundle<A> {
    /// `None` unless the arms of these indices are alike enough; see [`Bundle`].
    pub(super) fn new(arms: &[ArmRuntime], members: &[usize]) -> Option<Self> {
        let own: Vec<_> = members.iter().map(|&member| &arms[member]).collect();
        if !are_alike(&own.iter().map(|runtime| &runtime.arm).collect::<Vec<_>>()) {
            return None;
        }
        let chains = SideBySide::<A>::new(&own.iter().map(|runtime| &runtime.arm.chain).collect::<Vec<_>>())?;
        Some(Self {
            members: members.to_vec(),
            task: own.first()?.arm.task,
            scratch: chains.scratch(),
            recorded: Recorded::new(&own, A::WIDTH),
            computed: vec![Reference::REST; A::WIDTH],
            found: Found::NOTHING,
            on_course: OnCourse::new(&own),
            is_on_course: false,
            damped: vec![false; A::WIDTH],
            glance: Glance::new(&own),
            board: Board::new(chains.dof()),
            chains,
        })
    }

    /// Resolves the arm of a lane that may be near a singularity by its law, and gives it the answer.
    #[cold]
    fn resolve_by_law(
        &mut self,
        lane: usize,
        runtime: &mut ArmRuntime,
        (t, gain): (f64, f64),
        x: &[f64],
        [f, g]: [&mut [f64]; 2],
    ) {
        copy_lane::<A>(lane, x, &mut runtime.positions);
        runtime.evaluate(t, gain);
        let found = runtime.velocities.iter().zip(&runtime.feedback).enumerate();
        for (joint, (&forward, &back)) in found {
            f[joint * A::WIDTH + lane] = forward;
            g[joint * A::WIDTH + lane] = back;
        }
        self.found.bound.as_mut()[lane] = runtime.resolution.smallest_singular_value;
        self.damped[lane] = runtime.resolution.damped;
    }

    /// Whether the answer of a lane means something and is that of its law.
    fn is_regular(&self, lane: usize, runtime: &ArmRuntime) -> bool {
        let at = |array: &A| array.as_ref()[lane];
        at(&self.found.smallest_pivot) > 0.0 && at(&self.found.bound) > runtime.arm.law.threshold()
    }
}

/// Copies the entries of a lane.
#[inline(always)]
fn copy_lane<A: LaneArray>(lane: usize, from: &[f64], to: &mut [f64]) {
    for (to, from) in to.iter_mut().zip(A::arrays(from)) {
        *to = from.as_ref()[lane];
    }
}

/// Copies the last of the first `used` lanes to those that are left.
fn fill_lanes<A: LaneArray>(used: usize, entries: &mut [f64]) {
    for entries in entries.chunks_exact_mut(A::WIDTH) {
        let last = entries[used - 1];
        entries[used..].fill(last);
    }
}

impl<A: LaneArray> Together for Bundle<A> {
    fn width(&self) -> usize {
        A::WIDTH
    }

    fn evaluate(
        &mut self,
        level: Level,
        at: (f64, f64),
        arms: &mut [ArmRuntime],
        x: &[f64],
        [f, g]: [&mut [f64]; 2],
    ) -> bool {
        let recorded = self.recorded.as_ref().and_then(|recorded| recorded.at::<A>(at.0));
        let references = recorded.unwrap_or_else(|| {
            for (lane, computed) in self.computed.iter_mut().enumerate() {
                let member = self.members[lane.min(self.members.len() - 1)];
                *computed = arms[member].arm.motion.at(at.0);
            }
            A::each(|lane| &self.computed[lane])
        });
        let evaluation = Evaluation {
            chains: &self.chains,
            scratch: &mut self.scratch,
            on_course: &self.on_course,
            references: &references,
            x,
            f: &mut *f,
            g: &mut *g,
            gain: at.1,
            found: &mut self.found,
        };
        self.is_on_course = match self.task {
            TaskKind::PositionXy => with_instructions(level, Rows::<_, 2>(evaluation)),
            TaskKind::Position => with_instructions(level, Rows::<_, 3>(evaluation)),
            TaskKind::Pose => with_instructions(level, Rows::<_, 6>(evaluation)),
        };
        if self.is_on_course {
            return true;
        }
        for lane in 0..self.members.len() {
            let runtime = &mut arms[self.members[lane]];
            self.damped[lane] = false;
            if !self.is_regular(lane, runtime) {
                self.resolve_by_law(lane, runtime, at, x, [&mut *f, &mut *g]);
            }
        }
        fill_lanes::<A>(self.members.len(), f);
        fill_lanes::<A>(self.members.len(), g);
        false
    }

    fn watch(&mut self, level: Level, t: f64, arms: &mut [ArmRuntime], sample: &Sample<'_>) {
        let look = Look { glance: &mut self.glance, board: &mut self.board, found: &self.found, t, sample };
        if !with_instructions(level, look) {
            self.remind(arms, sample.previous);
            for (lane, &member) in self.members.iter().enumerate() {
                let state = self.arm(lane);
                arms[member].monitor.look_closely(t, state.positions, state.velocities);
            }
        }
    }

    fn arm(&self, lane: usize) -> ArmState<'_> {
        self.board.arm(lane, !self.is_on_course && self.damped[lane])
    }

    fn tell(&mut self, level: Level, arms: &mut [ArmRuntime], sample: &Sample<'_>) {
        with_instructions(level, WriteUp { board: &mut self.board, found: &self.found, sample });
        for (lane, &member) in self.members.iter().enumerate() {
            let (state, runtime) = (self.arm(lane), &mut arms[member]);
            runtime.positions.copy_from_slice(state.positions);
            runtime.velocities.copy_from_slice(state.velocities);
            runtime.error = state.error;
            runtime.resolution =
                Resolution { smallest_singular_value: self.found.bound.as_ref()[lane], damped: state.damped };
        }
    }

    fn remind(&self, arms: &mut [ArmRuntime], previous: &[f64]) {
        for (lane, &member) in self.members.iter().enumerate() {
            copy_lane::<A>(lane, previous, &mut arms[member].monitor.previous);
        }
    }

    fn hand_over(&self, arms: &mut [ArmRuntime]) {
        for (lane, &member) in self.members.iter().enumerate() {
            self.glance.hand_over(lane, &mut arms[member].monitor);
        }
    }
}

/// Kinematics, task errors and both parts of the joint velocities of all lanes.
struct Evaluation<'a, A: LaneArray> {
    chains: &'a SideBySide<A>,
    scratch: &'a mut SideBySideScratch<A>,
    on_course: &'a OnCourse<A>,
    references: &'a A::Of<&'a Reference>,
    x: &'a [f64],
    f: &'a mut [f64],
    g: &'a mut [f64],
    gain: f64,
    found: &'a mut Found<A>,
}

/// A number of the reference of each lane.
#[inline(always)]
fn gather<S: Simd, A: LaneArray>(
    simd: S,
    references: &[&Reference],
    pick: impl Fn(&Reference) -> f64,
) -> A::Vector<S> {
    <A::Vector<S> as Lanes>::gather(
        simd,
        #[inline(always)]
        |lane| pick(references[lane]),
    )
}

/// One number for each lane.
#[inline(always)]
fn load<S: Simd, A: LaneArray>(simd: S, array: &A) -> A::Vector<S> {
    <A::Vector<S> as Lanes>::load(simd, array)
}

/// The same for tasks of `M` rows.
struct Rows<'a, A: LaneArray, const M: usize>(Evaluation<'a, A>);

impl<A: LaneArray, const M: usize> Kernel for Rows<'_, A, M> {
    /// Whether all arms are clearly on course.
    type Output = bool;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> bool {
        let Evaluation { chains, scratch, on_course, references, x, f, g, gain, found } = self.0;
        let references = *references;
        let references = references.as_ref();
        let tips = chains.run(simd, x, scratch);
        let mut rotation = [tips.position; 3];
        for (j, column) in rotation.iter_mut().enumerate() {
            for (i, entry) in column.iter_mut().enumerate() {
                *entry = gather::<S, A>(simd, references, |r| r.rotation.matrix()[(i, j)]);
            }
        }
        let mut position = tips.position;
        for (i, entry) in position.iter_mut().enumerate() {
            *entry = gather::<S, A>(simd, references, |r| r.position[i]);
        }
        let error: [_; M] = pose_error((&tips.position, &tips.rotation), (&position, &rotation), simd);
        for row in 0..M {
            error[row].store(&mut found.error[row]);
        }
        chains.complete_columns(simd, &tips.position, scratch);
        let deviation = squares(&error, load(simd, &A::ZERO));
        deviation[0].store(&mut found.deviation[0]);
        deviation[1].store(&mut found.deviation[1]);
        let mut out = f.chunks_exact_mut(A::WIDTH).zip(g.chunks_exact_mut(A::WIDTH));
        let resolved = least_norm(
            simd,
            &scratch.columns,
            #[inline(always)]
            |column: &[A; 6], row| load(simd, &column[row]),
            #[inline(always)]
            || {
                let gain = <A::Vector<S> as Lanes>::splat(simd, -gain);
                let (mut feedforward, mut feedback) = (error, error);
                for row in 0..M {
                    feedforward[row] = gather::<S, A>(simd, references, |r| r.twist[row]);
                    feedback[row] = error[row] * gain;
                }
                [feedforward, feedback]
            },
            #[inline(always)]
            |_, forward, back| {
                if let Some((f, g)) = out.next() {
                    forward.store_slice(f);
                    back.store_slice(g);
                }
            },
        );
        resolved.bound.store(&mut found.bound);
        resolved.smallest_pivot.store(&mut found.smallest_pivot);
        on_course.holds(simd, (resolved.bound, resolved.smallest_pivot), &deviation)
    }
}

/// The squared lengths of the position error and of the orientation error.
#[inline(always)]
fn squares<V: Lanes, const M: usize>(error: &[V; M], zero: V) -> [V; 2] {
    let square = |rows: std::ops::Range<usize>| {
        let mut sum = zero;
        for row in rows {
            sum = sum + error[row] * error[row];
        }
        sum
    };
    [square(0..M.min(3)), square(M.min(3)..M)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::embedded;
    use crate::task::{Circle, Motion, Planar, Sin2};
    use nalgebra::IsometryMatrix3;

    fn arm(task: TaskKind, turned: f64) -> ArmRuntime {
        let chain = embedded::get("panda").unwrap().chain("panda_link0", "panda_link8").unwrap();
        let q0 = vec![0.1 + turned, -0.4, 0.2, -2.1, 0.3, 1.8, 0.6];
        let start = chain.forward(&q0, &mut chain.scratch()).pose();
        let start = start * IsometryMatrix3::rotation(nalgebra::Vector3::new(0.0, turned, 0.0));
        let motion = Motion::from_pose(Planar::whole(Circle { radius: 0.1 }), Sin2, 2.0, &start);
        ArmRuntime::new(Arm::new("arm", chain, q0, task, motion), 1e-3)
    }

    /// Whether all arms are on course, and everything that was found.
    fn answer<A: LaneArray>(level: Level, arms: &mut [ArmRuntime]) -> (bool, Vec<f64>) {
        let members: Vec<_> = (0..arms.len()).collect();
        let mut bundle = Bundle::<A>::new(arms, &members).unwrap();
        let mut x = Vec::new();
        for joint in 0..7 {
            x.extend((0..A::WIDTH).map(|lane| arms[lane.min(arms.len() - 1)].arm.q0[joint]));
        }
        x.resize(x.len().next_multiple_of(4), 0.0);
        let (mut f, mut g) = (vec![0.0; x.len()], vec![0.0; x.len()]);
        let is_on_course = bundle.evaluate(level, (0.7, 20.0), arms, &x, [&mut f, &mut g]);
        let Found { error, deviation, bound, smallest_pivot } = bundle.found;
        let found = error.into_iter().chain(deviation).chain([bound, smallest_pivot]);
        let found = found.flat_map(|lanes| lanes.as_ref().to_vec());
        (is_on_course, found.chain(f).chain(g).collect())
    }

    fn check<A: LaneArray>(arms: &mut [ArmRuntime]) {
        let [wide, base] = [Level::new(), Level::baseline()].map(|level| answer::<A>(level, arms));
        assert_eq!(wide.0, base.0);
        for (wide, base) in wide.1.into_iter().zip(base.1) {
            assert!((wide - base).abs() <= 1e-13 * (1.0 + base.abs()), "{wide} {base}");
        }
    }

    #[test]
    fn every_set_of_instructions_gives_the_same_but_for_rounding() {
        for task in TaskKind::ALL {
            // Small orientation errors, and one that the series does not reach.
            let mut arms = [arm(task, 0.0), arm(task, 0.02), arm(task, 0.5)];
            for count in [1, 2] {
                check::<[f64; 2]>(&mut arms[..count]);
            }
            check::<[f64; 4]>(&mut arms);
        }
    }
}
