use super::lead::Lead;
use crate::law::{Law, Pseudoinverse};
use crate::math::RowRotations;
use crate::robot::{Chain, ChainScratch, MovingAxis, Posed};
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
    pub(in crate::planner) lead: Option<Lead>,
    pub(in crate::planner) convergence: Option<f64>,
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
        Self::of(name.into(), chain, q0, Arc::new(Tracking { kind: task, motion }))
    }

    /// An arm called `name` that starts at the joint positions `q0` [rad or m] and does any task with its tip, by the least-norm
    /// law. With [`Free`](crate::task::Free) it is left to the tasks that it has together with others.
    pub fn with_own_task(name: impl Into<String>, chain: Chain, q0: Vec<f64>, task: Box<dyn Task>) -> Self {
        Self::of(name.into(), chain, q0, task.into())
    }

    fn of(name: String, chain: Chain, q0: Vec<f64>, task: Arc<dyn Task>) -> Self {
        Self {
            name,
            chain,
            q0,
            task,
            law: None,
            start_distance: None,
            machine: None,
            lead: None,
            convergence: None,
        }
    }

    /// The same arm with another law.
    #[must_use]
    pub fn with_law(mut self, law: impl Law + 'static) -> Self {
        self.law = Some(Box::new(law));
        self
    }

    /// The same arm, with the remark that its start was solved for and leaves the tip at this distance [m, rad] from
    /// where it was asked to be.
    #[must_use]
    pub fn with_start_distance(mut self, distance: f64) -> Self {
        self.start_distance = Some(distance);
        self
    }

    /// The same arm, led to its q0 before the run: from rest at the joint positions `from` [rad or m] to rest, in `duration`
    /// \[s\], by a quintic of each joint. The plan holds that way before the path, which begins that much later; arms that are
    /// planned with it wait.
    ///
    /// # Panics
    /// If there is not one position for each joint.
    #[must_use]
    pub fn with_lead(mut self, from: Vec<f64>, duration: f64) -> Self {
        assert_eq!(from.len(), self.chain.dof(), "a lead needs one position for each joint");
        self.lead = Some(Lead { from, duration });
        self
    }

    /// The same arm, led for so long \[s\]: from where it was to be led, or standing still at its q0 while others are led.
    #[must_use]
    pub fn led_for(mut self, duration: f64) -> Self {
        let from = self.lead.map_or_else(|| self.q0.clone(), |lead| lead.from);
        self.lead = Some(Lead { from, duration });
        self
    }

    /// How long the arm is led to its path before the run \[s\].
    pub fn lead_duration(&self) -> f64 {
        self.lead.as_ref().map_or(0.0, |lead| lead.duration)
    }

    /// The same arm, which may start off its path: the feedback brings it in, and it counts as on its path once the norm of
    /// its task error [m, rad] stays within `tolerance`. The transient is told apart ([`Convergence`](crate::planner::Convergence)).
    #[must_use]
    pub fn converging_to(mut self, tolerance: f64) -> Self {
        self.convergence = Some(tolerance);
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
    /// components that the task does not ask for. While the arm is [led](Self::with_lead) the path waits at its beginning.
    pub fn task_error(&self, t: f64, q: &[f64], scratch: &mut ChainScratch) -> Vector6<f64> {
        let t = (t - self.lead_duration()).max(0.0);
        if let Some((kind, motion)) = self.task.tracking() {
            return kind.error(&self.chain.forward(q, scratch).pose(), &motion.at(t));
        }
        self.task_rows(t, q, scratch).error_by_component(&*self.task)
    }

    /// What its task asks for at time `t` \[s\] of the path with the joints at `q` [rad or m].
    fn task_rows(&self, t: f64, q: &[f64], scratch: &mut ChainScratch) -> TaskRows {
        let mut tip = tip_of(&self.chain, (0..self.chain.dof()).collect());
        pose(&mut tip, self.chain.forward(q, scratch));
        let mut rows = TaskRows::zeros(self.task.rows(), self.chain.dof());
        self.task.evaluate(&TaskInstant::new(t, q, &[tip], &[0]), &mut rows);
        rows
    }

    /// The smallest singular value of its task Jacobian at time `t` \[s\] of the path with the joints at `q` [rad or m].
    pub(in crate::planner) fn smallest_singular_value(&self, t: f64, q: &[f64]) -> f64 {
        self.weakest_direction(t, q).0
    }

    /// The same with its left singular vector (linear; angular), by what the rows of the task measure.
    pub(in crate::planner) fn weakest_direction(&self, t: f64, q: &[f64]) -> (f64, Vector6<f64>) {
        let jacobian = self.task_rows(t, q, &mut self.chain.scratch()).jacobian;
        let mut rotations = RowRotations::with_capacity(jacobian.nrows(), jacobian.ncols());
        rotations.compute(jacobian.ncols(), |row, column| jacobian[(row, column)]);
        let (smallest, mut direction) = (rotations.smallest(), Vector6::zeros());
        if let Some((_, left, _)) = rotations.directions().find(|(value, ..)| *value == smallest) {
            for (row, entry) in left.iter().enumerate() {
                direction[self.task.component(row).place()] += entry;
            }
        }
        (smallest, direction)
    }

    /// The index of the first of samples at `times` \[s\] with these [task errors](Self::task_error) that counts as on the path:
    /// after the way there, and from when on an arm that converges stays within its tolerance. Where none does, the number of
    /// samples.
    pub fn on_path_from(&self, times: &[f64], errors: &[Vector6<f64>]) -> usize {
        let rounding = 1e-9 * self.lead_duration();
        let led = times.iter().take_while(|t| **t < self.lead_duration() - rounding).count();
        let Some(tolerance) = self.convergence else { return led };
        let off = errors.iter().rposition(|error| !(error.norm() <= tolerance)).map_or(0, |last| last + 1);
        led.max(off)
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

    /// Whether it has a task of its own.
    pub fn has_own_task(&self) -> bool {
        self.task.rows() > 0
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
    Tip {
        pose: IsometryMatrix3::identity(),
        jacobian: vec![Vector6::zeros(); chain.dof()],
        axes: vec![MovingAxis::default(); chain.moving_axes()],
        joints,
    }
}

/// Writes where a chain that was posed has its tip, and how its joints move it.
pub(in crate::planner) fn pose(tip: &mut Tip, posed: Posed<'_>) {
    tip.pose = posed.pose();
    posed.axes(&mut tip.axes);
    tip.jacobian.fill(Vector6::zeros());
    for axis in &tip.axes {
        tip.jacobian[axis.joint] += axis.twist;
    }
}
