use crate::law::{Law, Pseudoinverse};
use crate::robot::{Chain, ChainScratch};
use crate::task::{Motion, Task, TaskInstant, TaskKind, TaskRows, Tip, Tracking};
use nalgebra::{IsometryMatrix3, Vector6};
use std::sync::Arc;

/// One arm of a plan: a chain, where it stands, and what its tip shall do by which law.
pub struct Arm {
    pub(in crate::planner) name: String,
    pub(in crate::planner) chain: Chain,
    pub(in crate::planner) q0: Vec<f64>,
    pub(in crate::planner) task: Arc<dyn Task>,
    /// The least-norm law unless one was given.
    pub(in crate::planner) law: Option<Box<dyn Law>>,
    pub(in crate::planner) start_distance: Option<f64>,
    pub(in crate::planner) machine: Option<String>,
}

impl std::fmt::Debug for Arm {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Arm").field("name", &self.name).field("q0", &self.q0).finish_non_exhaustive()
    }
}

impl Arm {
    /// An arm called `name` that starts at the joint positions `q0` [rad or m] and follows `motion` in the components
    /// that `task` names, by the least-norm law.
    ///
    /// The motion is given in world axes: mount the chain first ([`Chain::mounted`]).
    pub fn new(name: impl Into<String>, chain: Chain, q0: Vec<f64>, task: TaskKind, motion: Motion) -> Self {
        Self {
            name: name.into(),
            chain,
            q0,
            task: Arc::new(Tracking { kind: task, motion }),
            law: None,
            start_distance: None,
            machine: None,
        }
    }

    /// The same arm with another law.
    #[must_use]
    pub fn with_law(mut self, law: impl Law + 'static) -> Self {
        self.law = Some(Box::new(law));
        self
    }

    /// The same arm with another task for its tip, in place of the one that tracks a motion.
    #[must_use]
    pub fn with_task(mut self, task: impl Task + 'static) -> Self {
        self.task = Arc::new(task);
        self
    }

    /// The same arm, with the remark that its start was solved for and leaves the tip at this distance [m, rad] from
    /// where it was asked to be.
    #[must_use]
    pub fn with_start_distance(mut self, distance: f64) -> Self {
        self.start_distance = Some(distance);
        self
    }

    /// The same arm as a part of the machine of that name.
    ///
    /// Arms of one machine move it together: a joint name in the chains of two of them is one joint. Such arms are resolved
    /// as one system, by the least-norm motion of all their joints that meets all their tasks, and have to start their
    /// joints in common at the same positions.
    #[must_use]
    pub fn on_machine(mut self, machine: impl Into<String>) -> Self {
        self.machine = Some(machine.into());
        self
    }

    /// The arm's name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The machine that it is a part of, if one was named.
    pub fn machine(&self) -> Option<&str> {
        self.machine.as_deref()
    }

    /// The chain it moves, mounted in the world.
    pub fn chain(&self) -> &Chain {
        &self.chain
    }

    /// The task error (linear \[m\]; angular \[rad\]) with the joints at `q` [rad or m] at time `t` \[s\]: zero in the
    /// components that the task does not ask for.
    pub fn task_error(&self, t: f64, q: &[f64], scratch: &mut ChainScratch) -> Vector6<f64> {
        let posed = self.chain.forward(q, scratch);
        if let Some((kind, motion)) = self.task.tracking() {
            return kind.error(&posed.pose(), &motion.at(t));
        }
        let mut tip = tip_of(&self.chain, (0..self.chain.dof()).collect());
        tip.pose = posed.pose();
        posed.geometric_jacobian(&mut tip.jacobian);
        let mut rows = TaskRows::zeros(self.task.rows(), self.chain.dof());
        self.task.evaluate(&TaskInstant::new(t, q, &[tip], &[0]), &mut rows);
        rows.error_by_component(&*self.task)
    }

    /// Where the joint of that name starts [rad or m], if it is one of its own.
    pub fn start_of(&self, joint: &str) -> Option<f64> {
        let place = self.chain.joints().iter().position(|own| own.name == joint)?;
        self.q0.get(place).copied()
    }

    /// The names of the joints it moves, in the order of their positions.
    pub(in crate::planner) fn joint_names(&self) -> Vec<String> {
        self.chain.joints().iter().map(|joint| joint.name.clone()).collect()
    }

    /// Takes the law that it was given, or the least-norm law.
    pub(in crate::planner) fn take_law(&mut self) -> Box<dyn Law> {
        self.law.take().unwrap_or_else(|| Box::new(Pseudoinverse::new()))
    }

    /// Whether its law is the least-norm law and nothing else.
    pub(in crate::planner) fn has_plain_law(&self) -> bool {
        self.law.as_ref().is_none_or(|law| law.fast_path().is_some())
    }

    /// The chain's reach \[m\], or a metre where that is infinite.
    pub(in crate::planner) fn length(&self) -> f64 {
        let reach = self.chain.reach();
        if reach.is_finite() { reach } else { 1.0 }
    }
}

/// A tip that a chain is to move, its joints at the places `joints` of a system.
pub(in crate::planner) fn tip_of(chain: &Chain, joints: Vec<usize>) -> Tip {
    Tip { pose: IsometryMatrix3::identity(), jacobian: vec![Vector6::zeros(); chain.dof()], joints }
}
