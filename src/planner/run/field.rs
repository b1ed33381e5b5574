use crate::integrate::{Field, Multistep, Parts};
use crate::math::level;
use crate::planner::lanes::{ArmGroup, GroupMembers, LaneGroup, LaneMember, Sample, are_alike};
use crate::planner::system::{ArmRuntime, ArmState, JointIndex, Moment, System};
use fearless_simd::Level;

/// Vectors of four fit wherever a group begins.
const ALIGNMENT: usize = 4;

/// The right-hand side of all systems together: `f = J^+ phi'` (and the null-space part), `g = -k J^+ e`, group by group.
///
/// A group of arms side by side has its part of the state joint by joint, all arms of each joint one after the other, so that
/// the state, its history and both parts of its derivative are vectors as they lie.
pub(in crate::planner) struct SynchronousField {
    pub(in crate::planner) arms: Vec<ArmRuntime>,
    pub(in crate::planner) systems: Vec<System>,
    pub(in crate::planner) gain: f64,
    groups: Vec<Group>,
    /// What the components of the state are; some only fill up a group.
    joints: Vec<Option<JointIndex>>,
    /// The groups and lanes of the arms that have one.
    lanes: Vec<Option<(usize, usize)>>,
    /// Whether no arm needed a closer look when they were evaluated last.
    is_clear: bool,
    /// Of the sample that is evaluated next, what the two parts are multiplied by in the next state; see [`Moment`].
    sample: Option<[f64; 2]>,
    /// What the history contributes to the next state, where a law asks for it.
    known: Vec<f64>,
    needs_next_state: bool,
    level: Level,
}

/// Systems that are evaluated together.
struct Group {
    /// Where its part of the state begins.
    from: usize,
    members: Members,
}

enum Members {
    /// A single system.
    Alone(usize),
    SideBySide(Box<dyn ArmGroup>),
}

impl SynchronousField {
    /// The right-hand side of systems of `arms`, of which those of the indices `moving` move, with plain ones side by side.
    pub(in crate::planner) fn new(
        arms: Vec<ArmRuntime>,
        systems: Vec<System>,
        moving: &[usize],
        gain: f64,
    ) -> Self {
        let mut field = Self::without_groups(arms, systems, gain);
        let (coupled, single): (Vec<usize>, Vec<usize>) =
            moving.iter().partition(|&&system| field.systems[system].arms().count() > 1);
        for system in coupled {
            field.add_alone(system);
        }
        field.add_groups(single);
        field
    }

    /// The same with every system evaluated by itself.
    pub(in crate::planner) fn one_by_one(arms: Vec<ArmRuntime>, systems: Vec<System>, gain: f64) -> Self {
        let mut field = Self::without_groups(arms, systems, gain);
        let mut all: Vec<usize> = (0..field.systems.len()).collect();
        all.sort_by_key(|&system| field.systems[system].arms().count() == 1);
        for system in all {
            field.add_alone(system);
        }
        field
    }

    fn without_groups(arms: Vec<ArmRuntime>, systems: Vec<System>, gain: f64) -> Self {
        Self {
            gain,
            groups: Vec::new(),
            joints: Vec::new(),
            lanes: vec![None; arms.len()],
            is_clear: false,
            sample: None,
            known: Vec::new(),
            needs_next_state: systems.iter().any(|system| system.law().needs_next_state()),
            level: level(),
            arms,
            systems,
        }
    }

    /// Puts single arms that fit together into groups, in the order of their first members.
    fn add_groups(&mut self, mut rest: Vec<usize>) {
        let arm = |systems: &[System], system: usize| systems[system].arms().next().unwrap_or(0);
        while let Some(&first) = rest.first() {
            let mut members = vec![first];
            for &member in &rest[1..] {
                members.push(member);
                let pair = |&system: &usize| (&self.arms[arm(&self.systems, system)], &self.systems[system]);
                if !are_alike(&members.iter().map(pair).collect::<Vec<_>>()) {
                    members.pop();
                }
            }
            rest.retain(|member| !members.contains(member));
            let lane_member = |&system: &usize| LaneMember { arm: arm(&self.systems, system), system };
            self.add_group(&members.iter().map(lane_member).collect::<Vec<_>>());
        }
    }

    fn add_group(&mut self, members: &[LaneMember]) {
        let (arms, systems) = (&self.arms, &self.systems);
        let group: Option<Box<dyn ArmGroup>> = if members.len() <= 2 {
            LaneGroup::<[f64; 2]>::new(arms, systems, members).map(|group| Box::new(group) as _)
        } else {
            LaneGroup::<[f64; 4]>::new(arms, systems, members).map(|group| Box::new(group) as _)
        };
        let Some(group) = group else { return self.add_alone(members[0].system) };
        let (from, width) = (self.begin_group(), group.width());
        for joint in 0..self.arms[members[0].arm].positions.len() {
            let lanes = (0..width).map(|lane| members[lane.min(members.len() - 1)].arm);
            self.joints.extend(lanes.map(|arm| Some(JointIndex { arm, joint })));
        }
        for (lane, member) in members.iter().enumerate() {
            self.lanes[member.arm] = Some((self.groups.len(), lane));
        }
        self.end_group(Group { from, members: Members::SideBySide(group) });
    }

    fn add_alone(&mut self, system: usize) {
        let from = self.begin_group();
        self.joints.extend(self.systems[system].joints().iter().map(|joint| joint.first().copied()));
        self.end_group(Group { from, members: Members::Alone(system) });
    }

    fn begin_group(&mut self) -> usize {
        self.joints.resize(self.joints.len().next_multiple_of(ALIGNMENT), None);
        self.joints.len()
    }

    fn end_group(&mut self, group: Group) {
        self.joints.resize(self.joints.len().next_multiple_of(ALIGNMENT), None);
        self.known.resize(self.joints.len(), 0.0);
        self.groups.push(group);
    }

    /// What the components of the state are: the joints of arms, or nothing.
    pub(in crate::planner) fn joints(&self) -> &[Option<JointIndex>] {
        &self.joints
    }

    /// The state in which every arm has the joint positions that `position` gives.
    pub(in crate::planner) fn state(&self, position: impl Fn(JointIndex) -> f64) -> Vec<f64> {
        self.joints.iter().map(|joint| joint.map_or(0.0, &position)).collect()
    }

    /// An arm at the sample that was observed or scattered last.
    pub(in crate::planner) fn arm(&self, arm: usize) -> ArmState<'_> {
        let lane = self.lanes[arm].map(|(group, lane)| (&self.groups[group].members, lane));
        match lane {
            Some((Members::SideBySide(group), lane)) => group.arm(lane),
            _ => self.arms[arm].state(),
        }
    }

    /// Evaluates the present sample of a stepper, which has not been met before.
    #[inline]
    pub(in crate::planner) fn evaluate_sample(&mut self, stepper: &mut Multistep<f64>) {
        let factors = if self.needs_next_state { self.ask_for_next_state(stepper) } else { [0.0; 2] };
        self.sample = Some(factors);
        stepper.evaluate(self);
        self.sample = None;
    }

    /// Has every law that asks for it know how the next state depends on its answer.
    fn ask_for_next_state(&mut self, stepper: &Multistep<f64>) -> [f64; 2] {
        let factors = stepper.write_next_state(&mut self.known);
        for Group { from, members } in &self.groups {
            if let Members::Alone(system) = *members
                && let Some(known) = self.systems[system].known_mut()
            {
                let joints = known.len();
                known.copy_from_slice(&self.known[*from..][..joints]);
            }
        }
        factors
    }

    /// Finds the task errors of all systems, which are evaluated one by one, at other joint positions than those that were
    /// evaluated.
    pub(in crate::planner) fn look(&mut self, t: f64, x: &[f64]) {
        for Group { from, members } in &self.groups {
            if let Members::Alone(system) = *members {
                let system = &mut self.systems[system];
                let positions = system.positions_mut();
                let joints = positions.len();
                positions.copy_from_slice(&x[*from..][..joints]);
                system.look(&mut self.arms, t);
            }
        }
    }

    /// Gives the monitors what was observed at a glance.
    pub(in crate::planner) fn flush_to_monitors(&mut self) {
        for group in &self.groups {
            if let Members::SideBySide(group) = &group.members {
                group.flush_to_monitor(&mut self.arms);
            }
        }
    }

    /// Calls `act` with every group of arms side by side and where its part of the state begins.
    fn each_group(&mut self, mut act: impl FnMut(&mut dyn ArmGroup, &mut GroupMembers<'_>, usize)) {
        let mut all = GroupMembers { arms: &mut self.arms, systems: &mut self.systems, level: self.level };
        for group in &mut self.groups {
            if let Members::SideBySide(members) = &mut group.members {
                act(&mut **members, &mut all, group.from);
            }
        }
    }
}

impl Field<f64> for SynchronousField {
    fn dimension(&self) -> usize {
        self.joints.len()
    }

    fn parts(&self) -> Parts {
        Parts::Feedback
    }

    fn evaluate(&mut self, t: f64, x: &[f64], f: &mut [f64], g: &mut [f64]) {
        let moment = Moment { t, gain: self.gain, sample: self.sample };
        let mut all = GroupMembers { arms: &mut self.arms, systems: &mut self.systems, level: self.level };
        let mut is_clear = true;
        for Group { from, members } in &mut self.groups {
            let (x, out) = (&x[*from..], [&mut f[*from..], &mut g[*from..]]);
            match members {
                Members::Alone(system) => {
                    evaluate_alone(&mut all.systems[*system], all.arms, moment, x, out);
                    is_clear = false;
                }
                Members::SideBySide(group) => is_clear &= group.evaluate(&mut all, moment, x, out),
            }
        }
        self.is_clear = is_clear;
    }
}

fn evaluate_alone(
    system: &mut System,
    arms: &mut [ArmRuntime],
    moment: Moment,
    x: &[f64],
    [f, g]: [&mut [f64]; 2],
) {
    let positions = system.positions_mut();
    let joints = positions.len();
    positions.copy_from_slice(&x[..joints]);
    system.evaluate(arms, moment);
    let [forward, back] = system.velocity();
    f[..joints].copy_from_slice(forward);
    g[..joints].copy_from_slice(back);
}

/// A field that has been evaluated at the present sample of a stepper: what can be asked of its arms only then.
pub(in crate::planner) struct Evaluated<'a> {
    field: &'a mut SynchronousField,
    stepper: &'a Multistep<f64>,
}

impl<'a> Evaluated<'a> {
    /// Evaluates the present sample, which has not been met before.
    pub(in crate::planner) fn at_sample(
        stepper: &'a mut Multistep<f64>,
        field: &'a mut SynchronousField,
    ) -> Self {
        field.evaluate_sample(stepper);
        Self::of(stepper, field)
    }

    /// Evaluates the present sample a second time, after an attempt to leave it or in new company.
    pub(in crate::planner) fn again(stepper: &'a Multistep<f64>, field: &'a mut SynchronousField) -> Self {
        let (mut f, mut g) = (vec![0.0; field.dimension()], vec![0.0; field.dimension()]);
        field.evaluate(stepper.time(), stepper.state(), &mut f, &mut g);
        Self::of(stepper, field)
    }

    /// What was evaluated at the present sample.
    pub(in crate::planner) fn of(stepper: &'a Multistep<f64>, field: &'a mut SynchronousField) -> Self {
        Self { field, stepper }
    }

    /// Observes all arms at a glance if none of them needs a closer look; otherwise gives itself back.
    pub(in crate::planner) fn observed(self) -> Result<(), Self> {
        if !self.field.is_clear {
            return Err(self);
        }
        let (t, sample) = (self.stepper.time(), sample(self.stepper));
        self.field.each_group(|group, all, from| group.observe(all, t, &sample.from(from)));
        Ok(())
    }

    /// Gives every arm what is known of it, and its monitor where it was one sample ago.
    pub(in crate::planner) fn scatter_to_arms(self) {
        let sample = sample(self.stepper);
        self.field.each_group(|group, all, from| {
            let sample = sample.from(from);
            group.scatter_to_arms(all, &sample);
            group.set_previous(all.arms, sample.previous);
        });
    }
}

/// What a stepper knows of the present sample.
fn sample(stepper: &Multistep<f64>) -> Sample<'_> {
    Sample { positions: stepper.state(), previous: stepper.previous(), velocities: stepper.derivative() }
}
