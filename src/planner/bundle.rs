//! Arms that move in the same way, evaluated together: one in each lane.

use super::field::ArmRuntime;
use crate::law::{Resolution, least_norm};
use crate::math::{Kernel, LaneArray, Lanes, with_instructions};
use crate::robot::{SideBySide, SideBySideScratch};
use crate::task::{Reference, TaskKind, pose_error};
use fearless_simd::{Level, Simd};
use nalgebra::Vector6;

/// Up to `A::WIDTH` arms with chains of one shape, tasks of one kind and the plain least-norm law.
pub(super) struct Bundle<A> {
    /// The arms by index, each with the place of its first joint in the state; repeated to fill all lanes.
    members: Vec<Member>,
    /// How many of them are not repetitions.
    count: usize,
    task: TaskKind,
    chains: SideBySide<A>,
    scratch: SideBySideScratch<A>,
    wanted: Wanted<A>,
    velocities: Vec<[A; 2]>,
}

/// One arm of a bundle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Member {
    pub(super) arm: usize,
    /// Index of its first joint in the state.
    pub(super) from: usize,
}

/// The references of all lanes.
#[derive(Clone, Copy)]
struct Wanted<A> {
    position: [A; 3],
    /// The columns of the rotation matrices.
    rotation: [[A; 3]; 3],
    twist: [A; 6],
}

/// What an evaluation found in all lanes.
struct Found<A> {
    error: [A; 6],
    bound: A,
    smallest_pivot: A,
}

impl<A: LaneArray> Bundle<A> {
    /// `None` unless the arms are alike enough; see [`Bundle`].
    pub(super) fn new(arms: &[ArmRuntime], members: &[Member]) -> Option<Self> {
        let own = |member: &Member| &arms[member.arm].arm;
        let task = own(members.first()?).task;
        let fits =
            |member: &Member| own(member).task == task && own(member).law.least_norm_threshold().is_some();
        if !members.iter().all(fits) {
            return None;
        }
        let chains: Vec<_> = members.iter().map(|member| &own(member).chain).collect();
        let chains = SideBySide::<A>::new(&chains)?;
        let last = *members.last()?;
        let lanes = members.iter().copied().chain(std::iter::repeat(last)).take(A::WIDTH);
        Some(Self {
            count: members.len(),
            members: lanes.collect(),
            task,
            scratch: chains.scratch(),
            wanted: Wanted { position: [A::ZERO; 3], rotation: [[A::ZERO; 3]; 3], twist: [A::ZERO; 6] },
            velocities: vec![[A::ZERO; 2]; chains.dof()],
            chains,
        })
    }

    /// The same as [`ArmRuntime::evaluate`] for every member, to the last bit.
    pub(super) fn evaluate(
        &mut self,
        level: Level,
        arms: &mut [ArmRuntime],
        (t, gain): (f64, f64),
        x: &[f64],
        [f, g]: [&mut [f64]; 2],
    ) {
        let joints = self.chains.dof();
        for (lane, member) in self.members.iter().enumerate() {
            self.wanted.set(lane, &arms[member.arm].arm.motion.at(t));
            self.scratch.set_positions(lane, &x[member.from..member.from + joints]);
        }
        let found = match self.task {
            TaskKind::PositionXy => with_instructions(level, self.evaluation::<2>(gain)),
            TaskKind::Position => with_instructions(level, self.evaluation::<3>(gain)),
            TaskKind::Pose => with_instructions(level, self.evaluation::<6>(gain)),
        };
        for (lane, member) in self.members[..self.count].iter().enumerate() {
            let range = member.from..member.from + joints;
            let (f, g) = (&mut f[range.clone()], &mut g[range.clone()]);
            let runtime = &mut arms[member.arm];
            let bound = found.bound.as_ref()[lane];
            let threshold = runtime.arm.law.threshold();
            if !(found.smallest_pivot.as_ref()[lane] > 0.0 && bound > threshold) {
                runtime.evaluate(t, gain, &x[range], f, g);
                continue;
            }
            runtime.error = Vector6::from_fn(|row, _| found.error[row].as_ref()[lane]);
            runtime.resolution = Resolution { smallest_singular_value: bound, damped: false };
            for ((velocity, f), g) in self.velocities.iter().zip(f).zip(g) {
                (*f, *g) = (velocity[0].as_ref()[lane], velocity[1].as_ref()[lane]);
            }
        }
    }

    fn evaluation<const M: usize>(&mut self, gain: f64) -> Evaluation<'_, A, M> {
        Evaluation {
            chains: &self.chains,
            scratch: &mut self.scratch,
            wanted: &self.wanted,
            velocities: &mut self.velocities,
            gain,
        }
    }
}

impl<A: LaneArray> Wanted<A> {
    #[inline]
    fn set(&mut self, lane: usize, reference: &Reference) {
        let write = |to: &mut [A], from: &[f64]| {
            for (to, &from) in to.iter_mut().zip(from) {
                to.as_mut()[lane] = from;
            }
        };
        write(&mut self.position, reference.position.as_slice());
        write(self.rotation.as_flattened_mut(), reference.rotation.matrix().as_slice());
        write(&mut self.twist, reference.twist.as_slice());
    }
}

/// Kinematics, task errors and both parts of the joint velocities of all lanes, for tasks of `M` rows.
struct Evaluation<'a, A, const M: usize> {
    chains: &'a SideBySide<A>,
    scratch: &'a mut SideBySideScratch<A>,
    wanted: &'a Wanted<A>,
    velocities: &'a mut [[A; 2]],
    gain: f64,
}

/// One number for each lane.
#[inline(always)]
fn load<S: Simd, A: LaneArray>(simd: S, array: &A) -> A::Vector<S> {
    <A::Vector<S> as Lanes>::load(simd, array)
}

impl<A: LaneArray, const M: usize> Kernel for Evaluation<'_, A, M> {
    type Output = Found<A>;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Found<A> {
        let tips = self.chains.run(simd, self.scratch);
        let wanted = self.wanted;
        let mut rotation = [tips.position; 3];
        for (column, wanted) in rotation.iter_mut().zip(&wanted.rotation) {
            *column = [load(simd, &wanted[0]), load(simd, &wanted[1]), load(simd, &wanted[2])];
        }
        let position = [
            load(simd, &wanted.position[0]),
            load(simd, &wanted.position[1]),
            load(simd, &wanted.position[2]),
        ];
        let error: [_; M] = pose_error((&tips.position, &tips.rotation), (&position, &rotation), simd);
        let gain = <A::Vector<S> as Lanes>::splat(simd, -self.gain);
        let (mut feedforward, mut feedback) = (error, error);
        for row in 0..M {
            feedforward[row] = load(simd, &wanted.twist[row]);
            feedback[row] = error[row] * gain;
        }
        let columns = &self.scratch.columns;
        let velocities = self.velocities;
        let found = least_norm(
            simd,
            columns.len(),
            #[inline(always)]
            |column, row| load(simd, &columns[column][row]),
            [&feedforward, &feedback],
            #[inline(always)]
            |column, forward, back| {
                forward.store(&mut velocities[column][0]);
                back.store(&mut velocities[column][1]);
            },
        );
        let mut errors = [A::ZERO; 6];
        for row in 0..M {
            error[row].store(&mut errors[row]);
        }
        Found {
            error: errors,
            bound: found.bound.to_array(),
            smallest_pivot: found.smallest_pivot.to_array(),
        }
    }
}
