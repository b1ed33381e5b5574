use super::Arm;
use super::bundle::Bundle;
use super::noise::Disturbance;
use super::shared::{self, SharedArms};
use crate::integrate::{Field, Parts};
use crate::law::{Demand, Resolution};
use crate::math::LaneArray;
use crate::robot::ChainScratch;
use fearless_simd::Level;
use nalgebra::Vector6;

/// An arm with its scratch memory and what the last evaluation found.
pub(super) struct ArmRuntime {
    pub(super) arm: Arm,
    /// The chain's reach, or a metre where that is infinite.
    pub(super) length: f64,
    scratch: ChainScratch,
    pub(super) columns: Vec<Vector6<f64>>,
    pub(super) error: Vector6<f64>,
    pub(super) resolution: Resolution,
    /// What the loop sees in place of the truth; nothing but the truth without noise.
    pub(super) disturbance: Option<Disturbance>,
    /// Whether it shares joints with other arms.
    pub(super) is_shared: bool,
    /// Whether there are fewer joints than task components, its own or those of all arms that it shares joints with.
    pub(super) has_too_few_joints: bool,
}

impl ArmRuntime {
    pub(super) fn new(mut arm: Arm) -> Self {
        let joints = arm.chain.dof();
        let reach = arm.chain.reach();
        let length = if reach.is_finite() { reach } else { 1.0 };
        arm.law.prepare(arm.task.rows(), joints, length);
        Self {
            scratch: arm.chain.scratch(),
            columns: vec![Vector6::zeros(); joints],
            error: Vector6::zeros(),
            resolution: Resolution { smallest_singular_value: f64::INFINITY, damped: false },
            disturbance: None,
            is_shared: false,
            has_too_few_joints: joints < arm.task.rows(),
            arm,
            length,
        }
    }

    /// Forward kinematics, task error and both parts of the joint velocity at time `t`.
    pub(super) fn evaluate(&mut self, t: f64, gain: f64, q: &[f64], f: &mut [f64], g: &mut [f64]) {
        let twist = self.look(t, q);
        let (twist, error) = self.measured(twist);
        let demand = Demand {
            rows: self.arm.task.rows(),
            jacobian: &self.columns,
            q,
            feedforward: &twist,
            feedback: &(error * -gain),
        };
        self.resolution = self.arm.law.resolve(&demand, f, g);
    }

    /// The twist of the reference and the task error as the loop sees them.
    pub(super) fn measured(&self, twist: Vector6<f64>) -> (Vector6<f64>, Vector6<f64>) {
        match &self.disturbance {
            None => (twist, self.error),
            Some(noise) => (twist + noise.twist, self.error + noise.error),
        }
    }

    /// Forward kinematics, Jacobian and task error at time `t`; returns the twist of the reference.
    pub(super) fn look(&mut self, t: f64, q: &[f64]) -> Vector6<f64> {
        let posed = self.arm.chain.forward(q, &mut self.scratch);
        posed.geometric_jacobian(&mut self.columns);
        let reference = self.arm.motion.at(t);
        self.error = self.arm.task.error(&posed.pose(), &reference);
        reference.twist
    }
}

/// The right-hand side of all arms together: `f = J^+ phi'` (and the null-space part), `g = -k J^+ e`, block by block.
pub(super) struct SynchronousField {
    pub(super) arms: Vec<ArmRuntime>,
    pub(super) gain: f64,
    pub(super) dimension: usize,
    /// Where the joints of each arm are found.
    places: Vec<Place>,
    groups: Vec<Group>,
    pub(super) shared: Vec<SharedArms>,
    level: Level,
}

/// Where the joints of an arm stand.
#[derive(Clone, Copy, Debug)]
enum Place {
    /// In the state, from here on.
    From(usize),
    /// With a member of a set of arms that share joints.
    Shared { set: usize, member: usize },
}

/// An arm that shares no joints.
#[derive(Clone, Copy, Debug)]
struct Member {
    arm: usize,
    /// Index of its first joint in the state.
    from: usize,
}

/// Arms that share no joints and are evaluated together.
struct Group {
    members: Vec<Member>,
    lanes: Lanes,
}

/// How the arms of a group are evaluated.
enum Lanes {
    /// A single arm whose law or chain is of no common kind.
    None,
    /// Side by side.
    Two(Box<Bundle<[f64; 2]>>),
    Four(Box<Bundle<[f64; 4]>>),
}

impl SynchronousField {
    pub(super) fn new(arms: Vec<Arm>, gain: f64) -> Self {
        let sets = shared::sets(&arms);
        let arms: Vec<_> = arms.into_iter().map(ArmRuntime::new).collect();
        let places = vec![Place::From(0); arms.len()];
        let mut field = Self {
            arms,
            gain,
            dimension: 0,
            places,
            groups: Vec::new(),
            shared: Vec::new(),
            level: Level::new(),
        };
        let mut apart = Vec::new();
        for arm in 0..field.arms.len() {
            match sets.iter().find(|set| set.contains(&arm)) {
                Some(set) if set[0] == arm => field.add_shared(set),
                Some(_) => {}
                None => {
                    field.places[arm] = Place::From(field.dimension);
                    apart.push(Member { arm, from: field.dimension });
                    field.dimension += field.arms[arm].arm.chain.dof();
                }
            }
        }
        field.groups = grouped(&field.arms, apart);
        field
    }

    fn add_shared(&mut self, arms: &[usize]) {
        let shared = SharedArms::new(&self.arms, arms, self.dimension);
        self.dimension = shared.range().end;
        for (member, &arm) in arms.iter().enumerate() {
            self.places[arm] = Place::Shared { set: self.shared.len(), member };
            self.arms[arm].is_shared = true;
            self.arms[arm].has_too_few_joints |= shared.has_too_few_joints();
        }
        self.shared.push(shared);
    }

    /// The same with every arm evaluated by itself.
    pub(super) fn one_by_one(mut self) -> Self {
        let members = self.groups.into_iter().flat_map(|group| group.members);
        self.groups = members.map(|member| Group { members: vec![member], lanes: Lanes::None }).collect();
        self
    }

    /// Finds the task errors of all arms at other joint positions than those that were evaluated.
    pub(super) fn look(&mut self, t: f64, x: &[f64]) {
        for Member { arm, from } in self.groups.iter().flat_map(|group| &group.members) {
            let runtime = &mut self.arms[*arm];
            let joints = runtime.arm.chain.dof();
            runtime.look(t, &x[*from..from + joints]);
        }
        for shared in &mut self.shared {
            shared.look(&mut self.arms, t, x);
        }
    }

    /// The joint positions of all arms at the start, as a state.
    pub(super) fn initial(&self) -> Vec<f64> {
        let mut x = vec![0.0; self.dimension];
        for (runtime, place) in self.arms.iter().zip(&self.places) {
            if let Place::From(from) = *place {
                x[from..from + runtime.arm.q0.len()].copy_from_slice(&runtime.arm.q0);
            }
        }
        for shared in &self.shared {
            x[shared.range()].copy_from_slice(&shared.initial(&self.arms));
        }
        x
    }

    /// The positions and velocities of an arm's own joints in a state and its derivative, which were evaluated last.
    pub(super) fn joints_of<'a>(
        &'a self,
        arm: usize,
        state: &'a [f64],
        derivative: &'a [f64],
    ) -> [&'a [f64]; 2] {
        match self.places[arm] {
            Place::From(from) => {
                let range = from..from + self.arms[arm].arm.chain.dof();
                [&state[range.clone()], &derivative[range]]
            }
            Place::Shared { set, member } => {
                let member = &self.shared[set].members()[member];
                [&member.positions, &member.velocities]
            }
        }
    }
}

/// Puts arms that fit together into groups, in the order of their first members.
fn grouped(arms: &[ArmRuntime], mut rest: Vec<Member>) -> Vec<Group> {
    let own = |members: &[Member]| members.iter().map(|member| &arms[member.arm].arm).collect::<Vec<_>>();
    let mut groups = Vec::new();
    while let Some(&first) = rest.first() {
        let mut members = vec![first];
        for &member in &rest[1..] {
            members.push(member);
            if Bundle::<[f64; 4]>::new(&own(&members)).is_none() {
                members.pop();
            }
        }
        rest.retain(|member| members.iter().all(|taken| taken.arm != member.arm));
        let two = || Bundle::new(&own(&members)).map(|bundle| Lanes::Two(Box::new(bundle)));
        let four = || Bundle::new(&own(&members)).map(|bundle| Lanes::Four(Box::new(bundle)));
        let lanes = two().or_else(four).unwrap_or(Lanes::None);
        groups.push(Group { members, lanes });
    }
    groups
}

impl Group {
    fn evaluate(
        &mut self,
        level: Level,
        arms: &mut [ArmRuntime],
        at: (f64, f64),
        x: &[f64],
        out: [&mut [f64]; 2],
    ) {
        let members = &self.members;
        match &mut self.lanes {
            Lanes::None => {
                let Member { arm, from } = members[0];
                let range = from..from + arms[arm].arm.chain.dof();
                let [f, g] = out;
                let (f, g) = (&mut f[range.clone()], &mut g[range.clone()]);
                arms[arm].evaluate(at.0, at.1, &x[range], f, g);
            }
            Lanes::Two(bundle) => evaluate_bundle(bundle, members, level, arms, at, x, out),
            Lanes::Four(bundle) => evaluate_bundle(bundle, members, level, arms, at, x, out),
        }
    }
}

fn evaluate_bundle<A: LaneArray>(
    bundle: &mut Bundle<A>,
    members: &[Member],
    level: Level,
    arms: &mut [ArmRuntime],
    at: (f64, f64),
    x: &[f64],
    [f, g]: [&mut [f64]; 2],
) {
    // The last arm fills the lanes that are left.
    let joints = arms[members[0].arm].arm.chain.dof();
    bundle.evaluate(level, at, |lane| {
        let member = members[lane.min(members.len() - 1)];
        (&arms[member.arm].arm, &x[member.from..member.from + joints])
    });
    for (lane, member) in members.iter().enumerate() {
        let range = member.from..member.from + joints;
        let out = [&mut f[range.clone()], &mut g[range.clone()]];
        bundle.deliver(lane, &mut arms[member.arm], at, &x[range], out);
    }
}

impl Field<f64> for SynchronousField {
    fn dimension(&self) -> usize {
        self.dimension
    }

    fn parts(&self) -> Parts {
        Parts::Feedback
    }

    fn evaluate(&mut self, t: f64, x: &[f64], f: &mut [f64], g: &mut [f64]) {
        for group in &mut self.groups {
            group.evaluate(self.level, &mut self.arms, (t, self.gain), x, [&mut *f, &mut *g]);
        }
        for shared in &mut self.shared {
            shared.evaluate(&mut self.arms, (t, self.gain), x, [&mut *f, &mut *g]);
        }
    }
}
