use super::arm::{Arm, tip_of};
use super::arm_runtime::{ArmRuntime, Coupling};
use super::joint_index::JointIndex;
use super::joint_system::AddedTask;
use super::nearby::Nearby;
use super::surroundings::Surroundings;
use crate::law::{
    Infeasible, Instant, JointVelocity, Law, LinearityKind, NextState, Pseudoinverse, Resolution,
    SystemShape, TaskShape,
};
use crate::planner::PlannerError;
use crate::robot::Limits;
use crate::task::{Component, Task, TaskInstant, TaskRows, Tip};
use nalgebra::DMatrix;
use std::ops::Range;
use std::sync::Arc;

/// Joints that are resolved together: of one arm, or of several that share joints or that a task ties together.
///
/// The state holds the union of the joints: those of the first arm, then those of the next that are not there yet. A joint
/// in common has one column in the Jacobians, with entries in the rows of all the tasks that it moves.
pub(in crate::planner) struct System {
    members: Vec<Member>,
    tips: Vec<Tip>,
    tasks: Vec<TaskState>,
    rows: Vec<TaskRows>,
    law: Box<dyn Law>,
    shape: SystemShape,
    limits: Vec<Limits>,
    q: Vec<f64>,
    /// What was resolved last: both parts.
    velocity: [Vec<f64>; 2],
    /// Both parts together, at the sample that was resolved last and at the one before.
    latest: Vec<f64>,
    previous: Vec<f64>,
    /// What the history contributes to the next state, where the law asks for it.
    known: Vec<f64>,
    infeasible: Option<Infeasible>,
    /// What is near, where the law asks for it.
    nearby: Option<Nearby>,
}

/// An arm of a system.
struct Member {
    arm: usize,
    name: String,
    /// The places of its joints in the union.
    places: Vec<usize>,
}

/// A task of a system.
pub(in crate::planner) struct TaskState {
    pub(in crate::planner) name: String,
    pub(in crate::planner) task: Arc<dyn Task>,
    /// The tips that it is about.
    tips: Vec<usize>,
    /// Whether it is the own task of an arm; errors of all others are kept by the system.
    is_own: bool,
    priority: usize,
    weight: f64,
}

/// When a system is evaluated.
#[derive(Clone, Copy, Debug)]
pub(in crate::planner) struct Moment {
    /// The time \[s\].
    pub(in crate::planner) t: f64,
    /// The feedback gain [1/s].
    pub(in crate::planner) gain: f64,
    /// Of a sample of the run that is met for the first time, what the two parts of the answer are multiplied by in the next
    /// state \[s\]; `None` for the stages of starts and second looks.
    pub(in crate::planner) sample: Option<[f64; 2]>,
}

impl System {
    /// The arms of these indices as one system with further tasks. The law is the given one, or that of a single arm, or the
    /// least-norm law; the threshold of the latter is the largest of the arms' own, which keeps every arm's promise: a
    /// singular value of the whole is at most that of a part. A law that keeps distances is shown the surroundings, if there are
    /// any.
    pub(in crate::planner) fn new(
        arms: &mut [ArmRuntime],
        indices: &[usize],
        added: &[AddedTask],
        law: Option<Box<dyn Law>>,
        sigma: f64,
        surroundings: Option<&Surroundings>,
    ) -> Result<Self, PlannerError> {
        let union = Union::of(indices.iter().map(|&arm| &arms[arm].arm));
        let members: Vec<Member> =
            indices.iter().map(|&arm| Member::new(arm, &arms[arm].arm, &union)).collect();
        let tips: Vec<Tip> =
            members.iter().map(|member| tip_of(&arms[member.arm].arm.chain, member.places.clone())).collect();
        let tasks = tasks(arms, &members, added);
        let has_own_law = law.is_some();
        let mut law = law.unwrap_or_else(|| default_law(arms, indices, sigma));
        let nearby = match surroundings.filter(|_| law.keeps_distances()) {
            Some(surroundings) => {
                let own = members.iter().map(|member| (&arms[member.arm].arm, member.places.clone()));
                let scene = surroundings.scene(union.joints.len(), &own.collect::<Vec<_>>())?;
                Some(Nearby::new(scene, surroundings))
            }
            None => None,
        };
        let shape = SystemShape {
            tasks: task_shapes(arms, &members, &tasks),
            joints: union.names(),
            axes: tips.iter().map(|tip| tip.axes.len()).collect(),
            sigma,
            contacts: nearby.as_ref().map_or(0, Nearby::rows),
        };
        if let Some(objection) = law.objection(&shape) {
            let arms = members.iter().map(|member| member.name.as_str()).collect::<Vec<_>>().join("`, `");
            return Err(PlannerError::LawDoesNotFit { arms, objection });
        }
        law.prepare(&shape);
        let joints_apart: usize = members.iter().map(|member| member.places.len()).sum();
        let coupling = match indices.len() {
            1 => Coupling::None,
            _ if joints_apart > shape.joints.len() => Coupling::Joints,
            _ => Coupling::Tasks,
        };
        for &arm in indices {
            let runtime = &mut arms[arm];
            runtime.coupling = coupling;
            if has_own_law || indices.len() == 1 {
                runtime.threshold = law.threshold();
            }
            runtime.bounds.has_too_few_joints |= shape.joints.len() < shape.rows();
        }
        let rows = tasks.iter().map(|state| {
            let rows = TaskRows::zeros(state.task.rows(), shape.joints.len());
            TaskRows { priority: state.priority, weight: state.weight, ..rows }
        });
        let zeros = vec![0.0; shape.joints.len()];
        Ok(Self {
            rows: rows.collect(),
            members,
            tips,
            tasks,
            law,
            limits: union.limits,
            q: zeros.clone(),
            velocity: [zeros.clone(), zeros.clone()],
            latest: zeros.clone(),
            previous: zeros.clone(),
            known: zeros,
            shape,
            infeasible: None,
            nearby,
        })
    }

    /// Its joints in order, each with all that it is called: one in common belongs to several arms.
    pub(in crate::planner) fn joints(&self) -> Vec<Vec<JointIndex>> {
        let mut joints = vec![Vec::new(); self.shape.joints.len()];
        for member in &self.members {
            for (joint, &place) in member.places.iter().enumerate() {
                joints[place].push(JointIndex { arm: member.arm, joint });
            }
        }
        joints
    }

    /// The arms, in order.
    pub(in crate::planner) fn arms(&self) -> impl Iterator<Item = usize> {
        self.members.iter().map(|member| member.arm)
    }

    /// The same system with every arm at an index that much higher.
    pub(in crate::planner) fn moved_by(mut self, arms: usize) -> Self {
        for member in &mut self.members {
            member.arm += arms;
        }
        self
    }

    pub(in crate::planner) fn shape(&self) -> &SystemShape {
        &self.shape
    }

    pub(in crate::planner) fn law(&self) -> &dyn Law {
        &*self.law
    }

    /// Whether it is a single arm whose tip tracks a motion by the least-norm law, and nothing else.
    pub(in crate::planner) fn is_plain(&self) -> bool {
        self.members.len() == 1
            && self.tasks.len() == 1
            && self.tasks[0].task.tracking().is_some()
            && self.law.fast_path().is_some()
    }

    /// The joint positions, to be written before an evaluation.
    pub(in crate::planner) fn positions_mut(&mut self) -> &mut [f64] {
        &mut self.q
    }

    /// Where to write what the history contributes to the next state, if the law asks for it.
    pub(in crate::planner) fn known_mut(&mut self) -> Option<&mut [f64]> {
        self.law.needs_next_state().then_some(&mut self.known)
    }

    /// What the two bodies of a pair are called.
    pub(in crate::planner) fn pair_names(&self, pair: usize) -> Option<[String; 2]> {
        self.nearby.as_ref().map(|nearby| nearby.pair_names(pair))
    }

    /// Both parts of the joint velocities that were resolved last.
    pub(in crate::planner) fn velocity(&self) -> [&[f64]; 2] {
        let [f, g] = &self.velocity;
        [f, g]
    }

    /// Kinematics and task errors at the joint positions it has at time `t`, then both parts of the velocity of all joints.
    pub(in crate::planner) fn evaluate(&mut self, arms: &mut [ArmRuntime], moment: Moment) {
        self.look(arms, moment.t);
        self.feed_back(arms, moment.gain);
        if moment.sample.is_some() {
            self.previous.copy_from_slice(&self.latest);
        }
        let resolution = self.resolve(moment);
        for member in &self.members {
            let runtime = &mut arms[member.arm];
            gather(&self.velocity[0], &member.places, &mut runtime.velocities);
            runtime.resolution = resolution;
        }
    }

    /// Kinematics and the rows of all tasks at the joint positions it has, at time `t`.
    pub(in crate::planner) fn look(&mut self, arms: &mut [ArmRuntime], t: f64) {
        for (member, tip) in self.members.iter().zip(&mut self.tips) {
            let runtime = &mut arms[member.arm];
            gather(&self.q, &member.places, &mut runtime.positions);
            runtime.pose(tip);
        }
        for (state, rows) in self.tasks.iter().zip(&mut self.rows) {
            rows.jacobian.fill(0.0);
            let instant = TaskInstant::new(t, &self.q, &self.tips, &state.tips);
            state.task.evaluate(&instant, rows);
            if state.is_own {
                arms[self.members[state.tips[0]].arm].error = rows.error_by_component(&*state.task);
            }
        }
    }

    /// Completes the rows by the corrective velocities, of the errors as the loop sees them.
    fn feed_back(&mut self, arms: &[ArmRuntime], gain: f64) {
        for (state, rows) in self.tasks.iter().zip(&mut self.rows) {
            let noise = arms[self.members[state.tips[0]].arm].disturbance.filter(|_| state.is_own);
            for row in 0..rows.rows() {
                let mut error = rows.error[row];
                if let Some(noise) = &noise {
                    let component = state.task.component(row).place();
                    error += noise.error[component];
                    rows.feedforward[row] += noise.twist[component];
                }
                rows.feedback[row] = error * -gain;
            }
        }
    }

    fn resolve(&mut self, moment: Moment) -> Resolution {
        let [f, g] = &mut self.velocity;
        let step = self.shape.sigma;
        let ([first, second], known) = match moment.sample {
            Some(factors) => (factors, &self.known),
            None => ([step, step], &self.q),
        };
        if let Some(nearby) = &mut self.nearby {
            nearby.look(&self.q);
        }
        let previous_velocity = if moment.sample.is_some() { &self.previous } else { &self.latest };
        let instant = Instant {
            t: moment.t,
            sigma: step,
            is_sample: moment.sample.is_some(),
            q: &self.q,
            previous_velocity,
            limits: &self.limits,
            tasks: &self.rows,
            tips: &self.tips,
            next: self.law.needs_next_state().then_some(NextState { known, first, second }),
            avoidance: self.nearby.as_ref().map(Nearby::avoidance),
        };
        let mut answer = JointVelocity { feedforward: &mut *f, feedback: &mut *g };
        let resolution = match self.law.resolve(&instant, &mut answer) {
            Ok(resolution) => resolution,
            Err(infeasible) => {
                // Nothing moves where nothing is allowed; the run stops when it sees the reason.
                f.fill(0.0);
                g.fill(0.0);
                self.infeasible = Some(infeasible);
                Resolution::default()
            }
        };
        if self.law.kind() == LinearityKind::Total {
            g.fill(0.0);
        }
        if moment.sample.is_some() {
            self.law.accept(&instant);
            for ((latest, f), g) in self.latest.iter_mut().zip(&*f).zip(&*g) {
                *latest = f + g;
            }
        }
        resolution
    }

    /// What could not be met since this was asked last.
    pub(in crate::planner) fn take_infeasible(&mut self) -> Option<Infeasible> {
        self.infeasible.take()
    }

    /// The tasks beside those of the arms, with their rows at the sample that was looked at last.
    pub(in crate::planner) fn added_tasks(
        &self,
    ) -> impl Iterator<Item = ((&TaskState, &TaskRows), &TaskShape)> {
        let all = self.tasks.iter().zip(&self.rows).zip(&self.shape.tasks);
        all.filter(|((state, _), _)| !state.is_own)
    }

    /// The Jacobians of all tasks at the sample that was looked at last.
    pub(in crate::planner) fn jacobians(&self) -> impl Iterator<Item = &DMatrix<f64>> {
        self.rows.iter().map(|rows| &rows.jacobian)
    }

    /// What a task is called, with the arm whose own it is.
    pub(in crate::planner) fn task_name(&self, task: usize) -> (String, Option<String>) {
        let state = &self.tasks[task];
        (state.name.clone(), state.is_own.then(|| self.members[state.tips[0]].name.clone()))
    }

    /// What a row of a task measures.
    pub(in crate::planner) fn component(&self, task: usize, row: usize) -> Component {
        self.tasks[task].task.component(row)
    }

    /// Whether all its arms are among those.
    pub(in crate::planner) fn is_within(&self, arms: &Range<usize>) -> bool {
        self.arms().all(|arm| arms.contains(&arm))
    }

    /// The names of the arms whose tips a task is about.
    pub(in crate::planner) fn arms_of<'a>(&'a self, task: &'a TaskState) -> impl Iterator<Item = &'a str> {
        task.tips.iter().map(|&tip| self.members[tip].name.as_str())
    }

    /// The names of its arms.
    pub(in crate::planner) fn arm_names(&self) -> Vec<String> {
        self.members.iter().map(|member| member.name.clone()).collect()
    }

    /// The joints that move two of its arms or more.
    pub(in crate::planner) fn joints_in_common(&self) -> Vec<String> {
        let is_common =
            |place: &usize| self.members.iter().filter(|member| member.places.contains(place)).count() > 1;
        let places = (0..self.shape.joints.len()).filter(is_common);
        places.map(|place| self.shape.joints[place].clone()).collect()
    }
}

impl Member {
    fn new(index: usize, arm: &Arm, union: &Union) -> Self {
        Self { arm: index, name: arm.name.clone(), places: union.places(arm) }
    }
}

/// What a joint is a part of.
#[derive(Clone, Debug, PartialEq, Eq)]
enum Owner {
    Machine(String),
    Arm(String),
}

/// The joints of several arms, each once: arms of one machine call one joint by one name.
#[derive(Default)]
struct Union {
    /// The machine or, where none was named, the arm, and the joint.
    joints: Vec<(Owner, String)>,
    /// The narrowest of what the arms say.
    limits: Vec<Limits>,
}

impl Union {
    fn of<'a>(arms: impl Iterator<Item = &'a Arm>) -> Self {
        let mut union = Self::default();
        for arm in arms {
            for joint in arm.chain.joints() {
                if let Some(place) = union.place(arm, &joint.name) {
                    union.limits[place] = union.limits[place].narrowed_by(&joint.limits);
                } else {
                    union.joints.push((Owner::of(arm), joint.name.clone()));
                    union.limits.push(joint.limits);
                }
            }
        }
        union
    }

    fn place(&self, arm: &Arm, joint: &str) -> Option<usize> {
        let owner = Owner::of(arm);
        self.joints.iter().position(|(other, name)| *other == owner && name == joint)
    }

    fn places(&self, arm: &Arm) -> Vec<usize> {
        arm.chain.joints().iter().filter_map(|joint| self.place(arm, &joint.name)).collect()
    }

    /// The names of the joints, with that of their machine where it takes it to tell them apart.
    fn names(&self) -> Vec<String> {
        let is_one_machine = self.joints.windows(2).all(|pair| pair[0].0 == pair[1].0);
        let name = |(owner, joint): &(Owner, String)| match owner {
            _ if is_one_machine => joint.clone(),
            Owner::Machine(name) | Owner::Arm(name) => format!("{name}.{joint}"),
        };
        self.joints.iter().map(name).collect()
    }
}

impl Owner {
    fn of(arm: &Arm) -> Self {
        arm.machine.clone().map_or_else(|| Self::Arm(arm.name.clone()), Self::Machine)
    }
}

/// The own tasks of the arms, then those beside them.
fn tasks(arms: &[ArmRuntime], members: &[Member], added: &[AddedTask]) -> Vec<TaskState> {
    let with_own = members.iter().enumerate().filter(|(_, member)| arms[member.arm].arm.has_own_task());
    let own = with_own.map(|(tip, member)| TaskState {
        name: arms[member.arm].arm.task.name().to_owned(),
        task: Arc::clone(&arms[member.arm].arm.task),
        tips: vec![tip],
        is_own: true,
        priority: 0,
        weight: 1.0,
    });
    let place = |name: &String| members.iter().position(|member| member.name == *name);
    let added = added.iter().map(|added| TaskState {
        name: added.name.clone(),
        task: Arc::clone(&added.task),
        tips: added.arms.iter().filter_map(place).collect(),
        is_own: false,
        priority: added.priority,
        weight: added.weight,
    });
    own.chain(added).collect()
}

fn task_shapes(arms: &[ArmRuntime], members: &[Member], tasks: &[TaskState]) -> Vec<TaskShape> {
    let shape = |state: &TaskState| {
        let mut joints: Vec<usize> = state.tips.iter().flat_map(|&tip| members[tip].places.clone()).collect();
        joints.sort_unstable();
        joints.dedup();
        TaskShape {
            name: state.name.clone(),
            components: (0..state.task.rows()).map(|row| state.task.component(row)).collect(),
            tips: state.tips.clone(),
            length: state.tips.iter().map(|&tip| arms[members[tip].arm].arm.length()).fold(0.0, f64::max),
            joints,
            priority: state.priority,
            weight: state.weight,
        }
    };
    tasks.iter().map(shape).collect()
}

/// The law of a single arm; of several the least-norm law, with the largest of the thresholds that they have apart.
fn default_law(arms: &mut [ArmRuntime], indices: &[usize], sigma: f64) -> Box<dyn Law> {
    if let [single] = *indices {
        return arms[single].arm.take_law();
    }
    let mut largest = 0.0_f64;
    for &arm in indices {
        let threshold = threshold_apart(&mut arms[arm].arm, sigma);
        arms[arm].threshold = threshold;
        largest = largest.max(threshold);
    }
    Box::new(Pseudoinverse::new().with_threshold(largest))
}

/// The threshold of an arm's law if it were resolved alone.
fn threshold_apart(arm: &mut Arm, sigma: f64) -> f64 {
    let (length, joints) = (arm.length(), arm.chain.dof());
    // An arm without a task of its own has a part in rows of any kind.
    let rows = if arm.has_own_task() { arm.task.rows() } else { Component::ALL.len() };
    let shape = SystemShape { sigma, ..SystemShape::of_one_task(rows, joints, length) };
    let mut law = arm.take_law();
    law.prepare(&shape);
    law.threshold()
}

fn gather(union: &[f64], places: &[usize], own: &mut [f64]) {
    for (own, &place) in own.iter_mut().zip(places) {
        *own = union[place];
    }
}
