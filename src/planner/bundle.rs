//! Arms that move in the same way, evaluated together: one in each lane.

use super::Arm;
use super::field::ArmRuntime;
use crate::law::{Resolution, least_norm};
use crate::math::{Kernel, LaneArray, Lanes, with_instructions};
use crate::robot::{SideBySide, SideBySideScratch};
use crate::task::{Reference, TaskKind, pose_error};
use fearless_simd::{Level, Simd};
use nalgebra::Vector6;

/// Up to `A::WIDTH` arms with chains of one shape, tasks of one kind and the plain least-norm law.
pub(super) struct Bundle<A: LaneArray> {
    task: TaskKind,
    chains: SideBySide<A>,
    scratch: SideBySideScratch<A>,
    /// The references that were not recorded beforehand.
    computed: A::Of<Reference>,
    found: Found<A>,
    velocities: Vec<[A; 2]>,
}

/// What an evaluation found in all lanes.
#[derive(Clone, Copy)]
struct Found<A> {
    error: [A; 6],
    bound: A,
    smallest_pivot: A,
}

/// An arm and where it is evaluated.
pub(super) type Lane<'a> = (&'a Arm, &'a [f64]);

impl<A: LaneArray> Bundle<A> {
    /// `None` unless the arms are alike enough; see [`Bundle`].
    pub(super) fn new(arms: &[&Arm]) -> Option<Self> {
        let task = arms.first()?.task;
        let fits = |arm: &&Arm| arm.task == task && arm.law.least_norm_threshold().is_some();
        if !arms.iter().all(fits) {
            return None;
        }
        let chains: Vec<_> = arms.iter().map(|arm| &arm.chain).collect();
        let chains = SideBySide::<A>::new(&chains)?;
        Some(Self {
            task,
            scratch: chains.scratch(),
            computed: A::each(|_| Reference::REST),
            found: Found { error: [A::ZERO; 6], bound: A::ZERO, smallest_pivot: A::ZERO },
            velocities: vec![[A::ZERO; 2]; chains.dof()],
            chains,
        })
    }

    /// Evaluates the arms of all lanes; the answers are [delivered](Self::deliver) one by one.
    pub(super) fn evaluate<'a>(
        &mut self,
        level: Level,
        (t, gain): (f64, f64),
        lane: impl Fn(usize) -> Lane<'a>,
    ) {
        let lanes = A::each(lane);
        let lanes = lanes.as_ref();
        let recorded = A::each(|lane| lanes[lane].0.motion.recorded(t));
        let recorded = recorded.as_ref();
        for (lane, computed) in self.computed.as_mut().iter_mut().enumerate() {
            if recorded[lane].is_none() {
                *computed = lanes[lane].0.motion.at(t);
            }
        }
        let computed = self.computed.as_ref();
        let references = A::each(|lane| recorded[lane].unwrap_or(&computed[lane]));
        let evaluation = Evaluation {
            chains: &self.chains,
            scratch: &mut self.scratch,
            references: &references,
            q: &A::each(|lane| lanes[lane].1),
            velocities: &mut self.velocities,
            gain,
        };
        self.found = match self.task {
            TaskKind::PositionXy => with_instructions(level, Rows::<_, 2>(evaluation)),
            TaskKind::Position => with_instructions(level, Rows::<_, 3>(evaluation)),
            TaskKind::Pose => with_instructions(level, Rows::<_, 6>(evaluation)),
        };
    }

    /// Gives the arm of a lane its answer: the same as [`ArmRuntime::evaluate`], to the last bit. A lane that may be near a
    /// singularity is left to that.
    pub(super) fn deliver(
        &self,
        lane: usize,
        runtime: &mut ArmRuntime,
        (t, gain): (f64, f64),
        q: &[f64],
        [f, g]: [&mut [f64]; 2],
    ) {
        let found = &self.found;
        let bound = found.bound.as_ref()[lane];
        if !(found.smallest_pivot.as_ref()[lane] > 0.0 && bound > runtime.arm.law.threshold()) {
            runtime.evaluate(t, gain, q, f, g);
            return;
        }
        runtime.error = Vector6::from_fn(|row, _| found.error[row].as_ref()[lane]);
        runtime.resolution = Resolution { smallest_singular_value: bound, damped: false };
        for ((velocity, f), g) in self.velocities.iter().zip(f).zip(g) {
            (*f, *g) = (velocity[0].as_ref()[lane], velocity[1].as_ref()[lane]);
        }
    }
}

/// Kinematics, task errors and both parts of the joint velocities of all lanes.
struct Evaluation<'a, A: LaneArray> {
    chains: &'a SideBySide<A>,
    scratch: &'a mut SideBySideScratch<A>,
    references: &'a A::Of<&'a Reference>,
    q: &'a A::Of<&'a [f64]>,
    velocities: &'a mut [[A; 2]],
    gain: f64,
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
    type Output = Found<A>;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Found<A> {
        let Evaluation { chains, scratch, references, q, velocities, gain } = self.0;
        let references = references.as_ref();
        let tips = chains.run(simd, q, scratch);
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
            feedforward[row] = gather::<S, A>(simd, references, |r| r.twist[row]);
            feedback[row] = error[row] * gain;
        }
        let columns = &scratch.columns;
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::embedded;
    use crate::task::{Circle, Motion, Planar, Sin2};
    use nalgebra::IsometryMatrix3;

    fn arm(task: TaskKind, turned: f64) -> Arm {
        let chain = embedded::get("panda").unwrap().chain("panda_link0", "panda_link8").unwrap();
        let q0 = vec![0.1 + turned, -0.4, 0.2, -2.1, 0.3, 1.8, 0.6];
        let start = chain.forward(&q0, &mut chain.scratch()).pose();
        let start = start * IsometryMatrix3::rotation(nalgebra::Vector3::new(0.0, turned, 0.0));
        let motion = Motion::from_pose(Planar::whole(Circle { radius: 0.1 }), Sin2, 2.0, &start);
        let mut arm = Arm::new("arm", chain, q0, task, motion);
        arm.law.prepare(task.rows(), 7, 1.0);
        arm
    }

    fn answer<A: LaneArray>(level: Level, arms: &[Arm]) -> String {
        let mut bundle = Bundle::<A>::new(&arms.iter().collect::<Vec<_>>()).unwrap();
        bundle.evaluate(level, (0.7, 20.0), |lane| {
            let arm = &arms[lane.min(arms.len() - 1)];
            (arm, &arm.q0)
        });
        let Found { error, bound, smallest_pivot } = &bundle.found;
        format!("{error:?} {bound:?} {smallest_pivot:?} {:?}", bundle.velocities)
    }

    #[test]
    fn every_set_of_instructions_gives_the_same_bits() {
        for task in TaskKind::ALL {
            // Small orientation errors, and one that the series does not reach.
            let arms = [arm(task, 0.0), arm(task, 0.02), arm(task, 0.5)];
            for few in [&arms[..1], &arms[..2]] {
                let [wide, base] =
                    [Level::new(), Level::baseline()].map(|level| answer::<[f64; 2]>(level, few));
                assert_eq!(wide, base);
            }
            let [wide, base] =
                [Level::new(), Level::baseline()].map(|level| answer::<[f64; 4]>(level, &arms));
            assert_eq!(wide, base);
        }
    }
}
