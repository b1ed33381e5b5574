//! Arms that move in the same way, evaluated together: one in each lane.

use super::arm_group::{ArmGroup, GroupMembers};
use super::group_result::GroupResult;
use super::lane_monitor::{LaneCriteria, LaneMonitor, Observation};
use super::sample::Sample;
use super::transpose::{Transpose, Transposition};
use crate::law::{Resolution, is_regular, least_norm};
use crate::math::{Kernel, LaneArray, Lanes, with_instructions};
use crate::planner::system::{ArmRuntime, ArmState, Moment, System};
use crate::robot::{SideBySide, SideBySideScratch};
use crate::task::{Motion, Reference, TaskKind, place_of_sample, pose_error};
use fearless_simd::Simd;
use std::sync::Arc;

/// Up to `A::WIDTH` arms with chains of one shape, tasks of one kind and the plain least-norm law. The last arm fills the
/// lanes that are left.
pub(in crate::planner) struct LaneGroup<A: LaneArray> {
    members: Vec<LaneMember>,
    task: TaskKind,
    chains: SideBySide<A>,
    scratch: SideBySideScratch<A>,
    recorded: Option<Recorded>,
    /// The references of an instant that is not recorded.
    computed: Vec<Reference>,
    found: GroupResult<A>,
    criteria: LaneCriteria<A>,
    is_clear: bool,
    /// The lanes that their law damped.
    damped: Vec<bool>,
    monitor: LaneMonitor<A>,
    transpose: Transpose<A>,
}

/// An arm of a group.
#[derive(Clone, Copy)]
pub(in crate::planner) struct LaneMember {
    /// The arm, and the system that it is.
    pub(in crate::planner) arm: usize,
    pub(in crate::planner) system: usize,
}

/// References that were sampled beforehand, with the same gap in all lanes.
struct Recorded {
    lanes: Vec<Arc<[Reference]>>,
    sigma: f64,
}

impl Recorded {
    /// `None` unless the motions of all arms are of that kind.
    fn new(arms: &[&ArmRuntime], width: usize) -> Option<Self> {
        let lane = |lane: usize| motion(arms[lane.min(arms.len() - 1)])?.samples();
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

/// What an arm's tip tracks, if it tracks a motion.
fn motion(runtime: &ArmRuntime) -> Option<&Motion> {
    runtime.arm.task.tracking().map(|(_, motion)| motion)
}

/// Whether arms can be lanes of one group of any width; each is given with its system.
pub(in crate::planner) fn are_alike(arms: &[(&ArmRuntime, &System)]) -> bool {
    let kind = |runtime: &ArmRuntime| runtime.arm.task.tracking().map(|(kind, _)| kind);
    let chains: Vec<_> = arms.iter().map(|(runtime, _)| &runtime.arm.chain).collect();
    arms.iter().all(|(runtime, system)| system.is_plain() && kind(runtime) == kind(arms[0].0))
        && SideBySide::<[f64; 4]>::new(&chains).is_some()
}

impl<A: LaneArray> LaneGroup<A> {
    /// `None` unless the arms are alike enough; see [`LaneGroup`].
    pub(in crate::planner) fn new(
        arms: &[ArmRuntime],
        systems: &[System],
        members: &[LaneMember],
    ) -> Option<Self> {
        let pairs: Vec<_> =
            members.iter().map(|member| (&arms[member.arm], &systems[member.system])).collect();
        if !are_alike(&pairs) {
            return None;
        }
        let own: Vec<_> = pairs.iter().map(|(runtime, _)| *runtime).collect();
        let chains = SideBySide::<A>::new(&own.iter().map(|runtime| &runtime.arm.chain).collect::<Vec<_>>())?;
        Some(Self {
            members: members.to_vec(),
            task: own.first()?.arm.task.tracking()?.0,
            scratch: chains.scratch(),
            recorded: Recorded::new(&own, A::WIDTH),
            computed: vec![Reference::REST; A::WIDTH],
            found: GroupResult::NOTHING,
            criteria: LaneCriteria::new(&own),
            is_clear: false,
            damped: vec![false; A::WIDTH],
            monitor: LaneMonitor::new(&own),
            transpose: Transpose::new(chains.dof()),
            chains,
        })
    }

    /// Resolves the arm of a lane that may be near a singularity by its law, and gives it the answer.
    #[cold]
    fn resolve_by_law(
        &mut self,
        lane: usize,
        group: &mut GroupMembers<'_>,
        moment: Moment,
        x: &[f64],
        [f, g]: [&mut [f64]; 2],
    ) {
        let LaneMember { arm, system } = self.members[lane];
        let system = &mut group.systems[system];
        copy_lane::<A>(lane, x, system.positions_mut());
        system.evaluate(group.arms, moment);
        let [forward, back] = system.velocity();
        for (joint, (&forward, &back)) in forward.iter().zip(back).enumerate() {
            f[joint * A::WIDTH + lane] = forward;
            g[joint * A::WIDTH + lane] = back;
        }
        let resolution = &group.arms[arm].resolution;
        self.found.bound.as_mut()[lane] = resolution.smallest_singular_value;
        self.damped[lane] = resolution.damped;
    }

    /// Whether the answer of a lane means something and is that of its law.
    fn is_regular(&self, lane: usize, runtime: &ArmRuntime) -> bool {
        let at = |array: &A| array.as_ref()[lane];
        is_regular(at(&self.found.bound), at(&self.found.smallest_pivot), runtime.threshold)
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

impl<A: LaneArray> ArmGroup for LaneGroup<A> {
    fn width(&self) -> usize {
        A::WIDTH
    }

    fn evaluate(
        &mut self,
        group: &mut GroupMembers<'_>,
        moment: Moment,
        x: &[f64],
        [f, g]: [&mut [f64]; 2],
    ) -> bool {
        let recorded = self.recorded.as_ref().and_then(|recorded| recorded.at::<A>(moment.t));
        let references = recorded.unwrap_or_else(|| {
            for (lane, computed) in self.computed.iter_mut().enumerate() {
                let member = self.members[lane.min(self.members.len() - 1)];
                if let Some(motion) = motion(&group.arms[member.arm]) {
                    *computed = motion.at(moment.t);
                }
            }
            A::each(|lane| &self.computed[lane])
        });
        let evaluation = Evaluation {
            chains: &self.chains,
            scratch: &mut self.scratch,
            criteria: &self.criteria,
            references: &references,
            x,
            f: &mut *f,
            g: &mut *g,
            gain: moment.gain,
            found: &mut self.found,
        };
        self.is_clear = match self.task {
            TaskKind::PositionXy => with_instructions(group.level, Rows::<_, 2>(evaluation)),
            TaskKind::Position => with_instructions(group.level, Rows::<_, 3>(evaluation)),
            TaskKind::Pose => with_instructions(group.level, Rows::<_, 6>(evaluation)),
        };
        if self.is_clear {
            return true;
        }
        for lane in 0..self.members.len() {
            self.damped[lane] = false;
            if !self.is_regular(lane, &group.arms[self.members[lane].arm]) {
                self.resolve_by_law(lane, group, moment, x, [&mut *f, &mut *g]);
            }
        }
        fill_lanes::<A>(self.members.len(), f);
        fill_lanes::<A>(self.members.len(), g);
        false
    }

    fn observe(&mut self, group: &mut GroupMembers<'_>, t: f64, sample: &Sample<'_>) {
        let observation = Observation {
            monitor: &mut self.monitor,
            transpose: &mut self.transpose,
            found: &self.found,
            t,
            sample,
        };
        if !with_instructions(group.level, observation) {
            self.set_previous(group.arms, sample.previous);
            for (lane, member) in self.members.iter().enumerate() {
                let state = self.arm(lane);
                group.arms[member.arm].monitor.look_closely(t, state.positions, state.velocities);
            }
        }
    }

    fn arm(&self, lane: usize) -> ArmState<'_> {
        self.transpose.arm(lane, !self.is_clear && self.damped[lane])
    }

    fn scatter_to_arms(&mut self, group: &mut GroupMembers<'_>, sample: &Sample<'_>) {
        let transposition = Transposition { transpose: &mut self.transpose, found: &self.found, sample };
        with_instructions(group.level, transposition);
        for (lane, member) in self.members.iter().enumerate() {
            let (state, runtime) = (self.arm(lane), &mut group.arms[member.arm]);
            runtime.positions.copy_from_slice(state.positions);
            runtime.velocities.copy_from_slice(state.velocities);
            runtime.error = state.error;
            runtime.resolution = Resolution {
                smallest_singular_value: self.found.bound.as_ref()[lane],
                damped: state.damped,
                ..Resolution::default()
            };
        }
    }

    fn set_previous(&self, arms: &mut [ArmRuntime], previous: &[f64]) {
        for (lane, member) in self.members.iter().enumerate() {
            copy_lane::<A>(lane, previous, &mut arms[member.arm].monitor.previous);
        }
    }

    fn flush_to_monitor(&self, arms: &mut [ArmRuntime]) {
        for (lane, member) in self.members.iter().enumerate() {
            self.monitor.flush_to(lane, &mut arms[member.arm].monitor);
        }
    }
}

/// Kinematics, task errors and both parts of the joint velocities of all lanes.
struct Evaluation<'a, A: LaneArray> {
    chains: &'a SideBySide<A>,
    scratch: &'a mut SideBySideScratch<A>,
    criteria: &'a LaneCriteria<A>,
    references: &'a A::Of<&'a Reference>,
    x: &'a [f64],
    f: &'a mut [f64],
    g: &'a mut [f64],
    gain: f64,
    found: &'a mut GroupResult<A>,
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
    /// Whether no arm needs a closer look.
    type Output = bool;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> bool {
        let Evaluation { chains, scratch, criteria, references, x, f, g, gain, found } = self.0;
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
        criteria.holds(simd, (resolved.bound, resolved.smallest_pivot), &deviation)
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
    use crate::planner::system::Arm;
    use crate::robot::embedded;
    use crate::task::{Circle, Motion, Planar, Sin2};
    use fearless_simd::Level;
    use nalgebra::IsometryMatrix3;

    fn arm(task: TaskKind, turned: f64) -> ArmRuntime {
        let chain = embedded::get("panda").unwrap().chain("panda_link0", "panda_link8").unwrap();
        let q0 = vec![0.1 + turned, -0.4, 0.2, -2.1, 0.3, 1.8, 0.6];
        let start = chain.forward(&q0, &mut chain.scratch()).pose();
        let start = start * IsometryMatrix3::rotation(nalgebra::Vector3::new(0.0, turned, 0.0));
        let motion = Motion::from_pose(Planar::whole(Circle { radius: 0.1 }), Sin2, 2.0, &start);
        ArmRuntime::new(Arm::new("arm", chain, q0, task, motion), 1e-3)
    }

    /// Whether no arm needs a closer look, and everything that was found.
    fn answer<A: LaneArray>(level: Level, task: TaskKind, turns: &[f64]) -> (bool, Vec<f64>) {
        let mut arms: Vec<_> = turns.iter().map(|turned| arm(task, *turned)).collect();
        let system = |arm: usize| LaneMember { arm, system: arm };
        let members: Vec<_> = (0..arms.len()).map(system).collect();
        let mut systems: Vec<_> = (0..arms.len())
            .map(|arm| System::new(&mut arms, &[arm], &[], None, 1e-3, None).unwrap())
            .collect();
        let mut lanes = LaneGroup::<A>::new(&arms, &systems, &members).unwrap();
        let mut x = Vec::new();
        for joint in 0..7 {
            x.extend((0..A::WIDTH).map(|lane| arms[lane.min(arms.len() - 1)].arm.q0[joint]));
        }
        x.resize(x.len().next_multiple_of(4), 0.0);
        let (mut f, mut g) = (vec![0.0; x.len()], vec![0.0; x.len()]);
        let moment = Moment { t: 0.7, gain: 20.0, sample: None };
        let mut group = GroupMembers { arms: &mut arms, systems: &mut systems, level };
        let is_clear = lanes.evaluate(&mut group, moment, &x, [&mut f, &mut g]);
        let GroupResult { error, deviation, bound, smallest_pivot } = lanes.found;
        let found = error.into_iter().chain(deviation).chain([bound, smallest_pivot]);
        let found = found.flat_map(|lanes| lanes.as_ref().to_vec());
        (is_clear, found.chain(f).chain(g).collect())
    }

    fn check<A: LaneArray>(task: TaskKind, turns: &[f64]) {
        let [wide, base] = [Level::new(), Level::baseline()].map(|level| answer::<A>(level, task, turns));
        assert_eq!(wide.0, base.0);
        for (wide, base) in wide.1.into_iter().zip(base.1) {
            assert!((wide - base).abs() <= 1e-13 * (1.0 + base.abs()), "{wide} {base}");
        }
    }

    #[test]
    fn every_set_of_instructions_gives_the_same_but_for_rounding() {
        for task in TaskKind::ALL {
            // Small orientation errors, and one that the series does not reach.
            let turns = [0.0, 0.02, 0.5];
            for count in [1, 2] {
                check::<[f64; 2]>(task, &turns[..count]);
            }
            check::<[f64; 4]>(task, &turns);
        }
    }
}
