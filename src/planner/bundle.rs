//! Arms that move in the same way, evaluated together: one in each lane.

use super::Arm;
use super::glance::{Found, Glance, Look, OnCourse};
use super::runtime::ArmRuntime;
use crate::law::{Resolution, least_norm};
use crate::math::{Kernel, LaneArray, Lanes, with_instructions};
use crate::robot::{SideBySide, SideBySideScratch};
use crate::task::{Reference, TaskKind, pose_error};
use fearless_simd::{Level, Simd};
use nalgebra::Vector6;

/// Arms whose states lie joint by joint, all arms of each joint side by side.
pub(super) trait Together: Send {
    /// How many lanes there are for each joint.
    fn width(&self) -> usize;

    /// Evaluates all arms at time `t` with the gain `gain`.
    fn evaluate(
        &mut self,
        level: Level,
        at: (f64, f64),
        arms: &mut [ArmRuntime],
        x: &[f64],
        out: [&mut [f64]; 2],
    );

    /// Whether all arms are clearly on their paths and far from singularities.
    fn is_on_course(&self) -> bool;

    /// Takes down errors, limits and conditioning of a sample in which all arms are on course, as it was told to them.
    fn watch(&mut self, level: Level, t: f64, arms: &mut [ArmRuntime], sample: &Sample<'_>);

    /// Tells every arm what is known of it.
    fn tell(&self, arms: &mut [ArmRuntime], sample: &Sample<'_>);

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
    /// The references that were not recorded beforehand.
    computed: Vec<Reference>,
    found: Found<A>,
    on_course: OnCourse<A>,
    is_on_course: bool,
    /// The lanes that their law damped.
    damped: Vec<bool>,
    glance: Glance<A>,
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
            computed: vec![Reference::REST; A::WIDTH],
            found: Found::NOTHING,
            on_course: OnCourse::new(&own),
            is_on_course: false,
            damped: vec![false; A::WIDTH],
            glance: Glance::new(&own),
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
    ) {
        let arm = |lane: usize| &arms[self.members[lane.min(self.members.len() - 1)]].arm;
        let recorded = A::each(|lane| arm(lane).motion.recorded(at.0));
        let recorded = recorded.as_ref();
        for (lane, computed) in self.computed.iter_mut().enumerate() {
            if recorded[lane].is_none() {
                *computed = arm(lane).motion.at(at.0);
            }
        }
        let computed = &self.computed;
        let references = A::each(|lane| recorded[lane].unwrap_or(&computed[lane]));
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
            return;
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
    }

    fn is_on_course(&self) -> bool {
        self.is_on_course
    }

    fn watch(&mut self, level: Level, t: f64, arms: &mut [ArmRuntime], sample: &Sample<'_>) {
        let look = Look { glance: &mut self.glance, found: &self.found, t, sample };
        if !with_instructions(level, look) {
            self.remind(arms, sample.previous);
            for &member in &self.members {
                let ArmRuntime { monitor, positions, velocities, .. } = &mut arms[member];
                monitor.look_closely(t, positions, velocities);
            }
        }
    }

    fn tell(&self, arms: &mut [ArmRuntime], sample: &Sample<'_>) {
        // The lanes are counted by a constant, so that no index has to be checked.
        for lane in 0..A::WIDTH {
            let Some(&member) = self.members.get(lane) else { break };
            let runtime = &mut arms[member];
            copy_lane::<A>(lane, sample.positions, &mut runtime.positions);
            copy_lane::<A>(lane, sample.velocities, &mut runtime.velocities);
            runtime.error = Vector6::from_fn(|row, _| self.found.error[row].as_ref()[lane]);
            runtime.resolution = Resolution {
                smallest_singular_value: self.found.bound.as_ref()[lane],
                damped: !self.is_on_course && self.damped[lane],
            };
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
        let gain = <A::Vector<S> as Lanes>::splat(simd, -gain);
        let (mut feedforward, mut feedback) = (error, error);
        for row in 0..M {
            error[row].store(&mut found.error[row]);
            feedforward[row] = gather::<S, A>(simd, references, |r| r.twist[row]);
            feedback[row] = error[row] * gain;
        }
        let deviation = squares(&error, load(simd, &A::ZERO));
        deviation[0].store(&mut found.deviation[0]);
        deviation[1].store(&mut found.deviation[1]);
        let mut out = f.chunks_exact_mut(A::WIDTH).zip(g.chunks_exact_mut(A::WIDTH));
        let resolved = least_norm(
            simd,
            &scratch.columns,
            #[inline(always)]
            |column: &[A; 6], row| load(simd, &column[row]),
            [&feedforward, &feedback],
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

    fn answer<A: LaneArray>(level: Level, arms: &mut [ArmRuntime]) -> String {
        let members: Vec<_> = (0..arms.len()).collect();
        let mut bundle = Bundle::<A>::new(arms, &members).unwrap();
        let mut x = Vec::new();
        for joint in 0..7 {
            x.extend((0..A::WIDTH).map(|lane| arms[lane.min(arms.len() - 1)].arm.q0[joint]));
        }
        x.resize(x.len().next_multiple_of(4), 0.0);
        let (mut f, mut g) = (vec![0.0; x.len()], vec![0.0; x.len()]);
        bundle.evaluate(level, (0.7, 20.0), arms, &x, [&mut f, &mut g]);
        format!("{:?} {} {f:?} {g:?}", bundle.found, bundle.is_on_course)
    }

    #[test]
    fn every_set_of_instructions_gives_the_same_bits() {
        for task in TaskKind::ALL {
            // Small orientation errors, and one that the series does not reach.
            let mut arms = [arm(task, 0.0), arm(task, 0.02), arm(task, 0.5)];
            for count in [1, 2] {
                let [wide, base] = [Level::new(), Level::baseline()]
                    .map(|level| answer::<[f64; 2]>(level, &mut arms[..count]));
                assert_eq!(wide, base);
            }
            let [wide, base] =
                [Level::new(), Level::baseline()].map(|level| answer::<[f64; 4]>(level, &mut arms));
            assert_eq!(wide, base);
        }
    }
}
