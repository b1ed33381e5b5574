use super::diagnosis;
use super::field::{ArmRuntime, SynchronousField};
use super::monitor::{Deviation, Monitor};
use super::noise::NoisyLoop;
use super::{ArmPlan, Noise, Plan, PlanStatus, PlannerBuilder};
use crate::integrate::{Field, Multistep, Status};
use crate::task::Reference;
use nalgebra::Vector6;

/// The task error at which a run is stopped, as a fraction of the chain's reach.
const LOST_FRACTION_OF_REACH: f64 = 0.1;
/// The orientation error at which a run is stopped \[rad\].
const LOST_ORIENTATION: f64 = 1.0;
/// The fraction of those bounds that an arm with fewer joints than task components is held to: the error of a path that it
/// can not follow does not grow, it just stays.
const WITH_TOO_FEW_JOINTS: f64 = 0.01;
/// The fraction that an arm of a stable loop is held to once it came near a singularity: whatever it loses there, no
/// feedback will bring back, and the velocities it would take grow with the error.
const NEAR_SINGULARITY: f64 = 0.2;
/// Within this many thresholds a configuration counts as near a singularity.
const NEAR: f64 = 10.0;
/// Below this fraction of those bounds an arm counts as back on its path after a singularity.
const RECOVERED: f64 = 0.05;

/// What a plan says of itself.
#[derive(Clone, Debug)]
pub(super) struct Description {
    pub(super) formula: String,
    pub(super) sigma: f64,
    pub(super) h: f64,
    /// Whether `h` lies in the formula's feedback range.
    pub(super) is_stable: bool,
    pub(super) start: &'static str,
    pub(super) steps: usize,
    pub(super) warnings: Vec<String>,
}

/// Why and where a run stopped early.
#[derive(Clone, Debug, PartialEq)]
pub struct Stop {
    /// The kind of stop.
    pub status: PlanStatus,
    /// The reason as a sentence.
    pub reason: String,
}

/// One arm at the present sample.
#[derive(Clone, Copy, Debug)]
pub struct ArmState<'a> {
    /// Joint positions [rad or m].
    pub positions: &'a [f64],
    /// Feedforward joint velocities [rad/s or m/s].
    pub velocities: &'a [f64],
    /// Task error (linear \[m\]; angular \[rad\]).
    pub error: &'a Vector6<f64>,
    /// Whether the law damped its answer here.
    pub damped: bool,
}

/// A formula, arms, tasks and laws, ready to run: as a whole with [`run`](Self::run), or sample by sample in a control
/// loop with [`step`](Self::step), which allocates nothing.
///
/// ```
/// use kinstep::scheme;
/// # use kinstep::{planner::Arm, robot::embedded, task::{Motion, Planar, Circle, Sin2, TaskKind}};
/// # let chain = embedded::get("planar4")?.chain("base", "tip")?;
/// # let q0 = vec![0.3, 0.4, 0.5, 0.6];
/// # let start = chain.forward(&q0, &mut chain.scratch()).pose();
/// # let motion = Motion::from_pose(Planar::whole(Circle { radius: 0.3 }), Sin2, 2.0, &start);
/// # let arm = Arm::new("arm", chain, q0, TaskKind::PositionXy, motion);
/// let mut planner = scheme::dtsmp([arm], 0.01, 0.4).duration(2.0).build()?;
/// while !planner.is_finished() {
///     let command = planner.arm(0).positions; // to the robot
///     # let _ = command;
///     planner.step();
/// }
/// assert!(planner.stop().is_none());
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Planner {
    description: Description,
    stepper: Multistep<f64>,
    field: SynchronousField,
    monitors: Vec<Monitor>,
    noisy: Option<NoisyLoop>,
    /// Whether each arm has met a singularity that it has not recovered from, one sample ago.
    was_singular: Vec<bool>,
    stop: Option<Stop>,
}

impl std::fmt::Debug for Planner {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Planner").field("description", &self.description).finish_non_exhaustive()
    }
}

impl Planner {
    /// An empty builder.
    pub fn builder() -> PlannerBuilder {
        PlannerBuilder::default()
    }

    /// Takes a stepper whose first state has been evaluated.
    pub(super) fn begin(description: Description, stepper: Multistep<f64>, field: SynchronousField) -> Self {
        let sigma = description.sigma;
        let monitors = field.arms.iter().map(|runtime| Monitor::new(&runtime.arm.chain, sigma)).collect();
        let was_singular = vec![true; field.arms.len()];
        let mut planner =
            Self { description, stepper, field, monitors, noisy: None, was_singular, stop: None };
        planner.watch();
        planner.check_start();
        planner
    }

    /// The same with noise, from the next sample on.
    pub(super) fn with_noise(mut self, noise: Noise) -> Self {
        self.noisy = Some(NoisyLoop::new(noise, self.stepper.state().to_vec()));
        self.field = self.field.one_by_one();
        self
    }

    /// Whether the loop suffers noise.
    pub(super) fn is_noisy(&self) -> bool {
        self.noisy.is_some()
    }

    /// The joint positions sent to the robot at the present sample.
    fn commanded(&self) -> &[f64] {
        self.noisy.as_ref().map_or(self.stepper.state(), NoisyLoop::commanded)
    }

    /// The index of the present sample.
    pub fn index(&self) -> usize {
        self.stepper.index()
    }

    /// The time of the present sample \[s\].
    pub fn time(&self) -> f64 {
        self.stepper.time()
    }

    /// Steps of the whole plan.
    pub fn steps(&self) -> usize {
        self.description.steps
    }

    /// The sampling gap used \[s\].
    pub fn sigma(&self) -> f64 {
        self.description.sigma
    }

    /// The feedback step used.
    pub fn h(&self) -> f64 {
        self.description.h
    }

    /// What the user should know before running.
    pub fn warnings(&self) -> &[String] {
        &self.description.warnings
    }

    /// Whether the last sample was reached or the run has stopped.
    pub fn is_finished(&self) -> bool {
        self.stop.is_some() || self.index() >= self.steps()
    }

    /// Why the run stopped early, if it did.
    pub fn stop(&self) -> Option<&Stop> {
        self.stop.as_ref()
    }

    /// Arm `i` (in the order in which arms were added) at the present sample.
    ///
    /// # Panics
    /// If there is no arm `i`.
    pub fn arm(&self, i: usize) -> ArmState<'_> {
        let [positions, velocities] = self.field.joints_of(i, self.commanded(), self.stepper.derivative());
        ArmState {
            positions,
            velocities,
            error: &self.field.arms[i].error,
            damped: self.field.arms[i].resolution.damped,
        }
    }

    /// Where the tip of arm `i` (in the order in which arms were added) shall be at the time `t` \[s\].
    ///
    /// # Panics
    /// If there is no arm `i`.
    pub fn reference(&self, i: usize, t: f64) -> Reference {
        self.field.arms[i].arm.motion.at(t)
    }

    /// Goes to the next sample; does nothing once [finished](Self::is_finished).
    ///
    /// A run that stops does so at a sample that lies beyond its bounds: look at [`is_finished`](Self::is_finished) before
    /// sending positions on.
    pub fn step(&mut self) {
        if self.advance() {
            match &mut self.noisy {
                None => self.stepper.evaluate(&mut self.field),
                Some(noisy) => noisy.evaluate(&mut self.stepper, &mut self.field),
            }
            self.look_around();
        }
    }

    /// Moves on to the next sample, which is to be evaluated then; false when there is none.
    pub(super) fn advance(&mut self) -> bool {
        if self.is_finished() {
            return false;
        }
        if self.stepper.advance(&mut self.field) == Status::NonFinite {
            let t = self.time();
            let reason = format!("a joint position became infinite or NaN in the step after t = {t:.6} s");
            self.stop = Some(Stop { status: PlanStatus::NonFinite, reason });
            return false;
        }
        true
    }

    /// Evaluates a sample that was [moved on to](Self::advance) by what `field` makes of the planner's own right-hand side.
    pub(super) fn arrive<'a, F: Field<f64>>(&'a mut self, field: impl FnOnce(&'a mut SynchronousField) -> F) {
        self.stepper.evaluate(&mut field(&mut self.field));
    }

    /// Checks and observes a sample that was evaluated.
    pub(super) fn look_around(&mut self) {
        self.check_lost();
        if self.stop.is_none() {
            self.watch();
        }
    }

    pub(super) fn field(&self) -> &SynchronousField {
        &self.field
    }

    /// Runs to the end and returns the trajectories.
    pub fn run(self) -> Plan {
        self.run_with(|_, _| {})
    }

    /// Runs to the end, telling `progress` after every step how many of how many are done.
    pub fn run_with(mut self, mut progress: impl FnMut(usize, usize)) -> Plan {
        let mut arms = self.begin_record();
        while !self.is_finished() {
            self.step();
            if self.record(&mut arms) {
                progress(self.index(), self.steps());
            }
        }
        self.conclude(arms)
    }

    /// A record with the first sample in it.
    pub(super) fn begin_record(&self) -> Vec<ArmPlan> {
        let mut arms: Vec<_> = self.field.arms.iter().map(|arm| empty_plan(arm, self.steps())).collect();
        self.write_down(&mut arms);
        arms
    }

    /// Records the present sample, unless the run stopped there: such a sample is not one to send to a robot.
    pub(super) fn record(&self, arms: &mut [ArmPlan]) -> bool {
        if self.stop.is_none() {
            self.write_down(arms);
        }
        self.stop.is_none()
    }

    fn write_down(&self, arms: &mut [ArmPlan]) {
        for (i, plan) in arms.iter_mut().enumerate() {
            let state = self.arm(i);
            plan.positions.extend_from_slice(state.positions);
            plan.velocities.extend_from_slice(state.velocities);
            plan.errors.push(*state.error);
        }
    }

    pub(super) fn conclude(self, mut arms: Vec<ArmPlan>) -> Plan {
        let mut warnings = self.description.warnings;
        for ((plan, monitor), runtime) in arms.iter_mut().zip(&self.monitors).zip(&self.field.arms) {
            plan.max_error = monitor.max_error();
            plan.max_error_component = monitor.max_error_component;
            plan.max_error_steady = steady_maximum(&plan.errors);
            plan.rms_error_steady = steady_mean_square(&plan.errors).sqrt();
            plan.max_position_error = monitor.max_position_error();
            plan.max_orientation_error = monitor.max_orientation_error();
            plan.smallest_singular_value = (monitor.smallest_singular_value, monitor.smallest_at);
            plan.damped_samples = monitor.damped_samples;
            plan.violations = monitor.violations(&runtime.arm.chain);
            warnings.extend(damping_warning(plan, runtime.arm.law.threshold()));
        }
        let (status, reason) = match self.stop {
            Some(stop) => (stop.status, Some(stop.reason)),
            None => (PlanStatus::Completed, None),
        };
        let Description { formula, sigma, h, start, steps, .. } = self.description;
        let shared = self.field.shared.iter().map(|shared| shared.report(&self.field.arms)).collect();
        let noise = self.noisy.map(|noisy| *noisy.noise());
        Plan { status, reason, formula, sigma, h, start, steps, noise, arms, shared, warnings }
    }

    /// Observes the present sample: errors, limits, conditioning.
    fn watch(&mut self) {
        let t = self.stepper.time();
        let state = self.noisy.as_ref().map_or(self.stepper.state(), NoisyLoop::commanded);
        let derivative = self.stepper.derivative();
        for (i, (runtime, monitor)) in self.field.arms.iter().zip(&mut self.monitors).enumerate() {
            let [q, velocity] = self.field.joints_of(i, state, derivative);
            monitor.observe_error(&runtime.error, &Deviation::of(&runtime.error));
            monitor.observe_joints(t, q, velocity);
            monitor.observe_conditioning(&runtime.resolution, t);
        }
    }

    /// A run does not begin in a singular configuration: nothing could be promised about its first steps.
    fn check_start(&mut self) {
        for (was, runtime) in self.was_singular.iter_mut().zip(&self.field.arms) {
            *was = is_singular(runtime, 1.0);
        }
        if let Some(i) = self.was_singular.iter().position(|&singular| singular) {
            let runtime = &self.field.arms[i];
            let of = if runtime.is_shared {
                "the stacked task Jacobian of all arms that share its joints".to_owned()
            } else {
                format!("its {}-row task Jacobian", runtime.arm.task.rows())
            };
            let reason = format!(
                "arm `{}` starts in a singular configuration: the smallest singular value of {of} at q0 is {:.3e}, below the threshold {:.3e}; choose another q0 (a bent arm) or a task with fewer components",
                runtime.arm.name,
                runtime.resolution.smallest_singular_value,
                runtime.arm.law.threshold()
            );
            self.stop = Some(Stop { status: PlanStatus::Singular, reason });
        }
    }

    /// Stops the run when an arm has lost its path, and finds out why.
    ///
    /// A loop outside its range diverges unless rank is missing right now. Inside the range the loop is not to blame:
    /// what counts is whether the arm met a singularity since it was last on its path, and whether the point it should
    /// go to can be reached.
    fn check_lost(&mut self) {
        for i in 0..self.field.arms.len() {
            let runtime = &self.field.arms[i];
            let is_stable = self.description.is_stable;
            let singular = is_singular(runtime, if is_stable { NEAR } else { 1.0 });
            let lost_rank = singular || self.was_singular[i];
            let fraction = if is_stable && lost_rank { NEAR_SINGULARITY } else { 1.0 };
            if !is_within(runtime, fraction) {
                self.stop = Some(self.diagnose(i, lost_rank));
                return;
            }
            let remembers = is_stable && !is_within(runtime, RECOVERED);
            self.was_singular[i] = singular || (remembers && self.was_singular[i]);
        }
    }

    fn diagnose(&self, i: usize, lost_rank: bool) -> Stop {
        let (runtime, t) = (&self.field.arms[i], self.time());
        if !lost_rank && !self.description.is_stable {
            return diverged(
                runtime,
                t,
                "the closed loop is not stable at this h: choose h inside the formula's range",
            );
        }
        let reference = runtime.arm.motion.at(t);
        let distance = diagnosis::smallest_distance(runtime, self.arm(i).positions, &reference);
        if !diagnosis::is_reached(distance) {
            return unreachable(runtime, t, &reference, distance);
        }
        if lost_rank {
            return singular(runtime, t, &reference);
        }
        diverged(runtime, t, "sigma is too coarse for this path: choose a smaller one, or a longer duration")
    }
}

/// Whether the smallest singular value lies below that many of the law's thresholds.
fn is_singular(runtime: &ArmRuntime, thresholds: f64) -> bool {
    runtime.resolution.smallest_singular_value < thresholds * runtime.arm.law.threshold()
}

/// Whether the task error lies within this fraction of the bounds at which a run is stopped; false for NaN.
fn is_within(runtime: &ArmRuntime, fraction: f64) -> bool {
    let Deviation { position, orientation } = Deviation::of(&runtime.error);
    let bound = LOST_FRACTION_OF_REACH * runtime.length;
    let fraction = if runtime.has_too_few_joints { WITH_TOO_FEW_JOINTS * fraction } else { fraction };
    position <= (fraction * bound).powi(2) && orientation <= (fraction * LOST_ORIENTATION).powi(2)
}

fn diverged(runtime: &ArmRuntime, t: f64, remedy: &str) -> Stop {
    let reason = format!(
        "arm `{}` diverged: at t = {t:.6} s its task error is {:.3e} although it is far from singular; {remedy}",
        runtime.arm.name,
        runtime.error.norm()
    );
    Stop { status: PlanStatus::Diverged, reason }
}

fn singular(runtime: &ArmRuntime, t: f64, reference: &Reference) -> Stop {
    // What a set of arms can reach at once is not known from what each of them can.
    let (of, reached) = if runtime.is_shared {
        ("the Jacobian of all arms that share its joints", "by this arm if it were alone")
    } else {
        ("its Jacobian", "from another q0 for instance")
    };
    let reason = format!(
        "arm `{}` met a singularity and lost its path at t = {t:.6} s with a task error of {:.3e}: the smallest singular value of {of} is {:.3e}, with a threshold of {:.3e}; the path's point {} can be reached, {reached}",
        runtime.arm.name,
        runtime.error.norm(),
        runtime.resolution.smallest_singular_value,
        runtime.arm.law.threshold(),
        place(reference)
    );
    Stop { status: PlanStatus::Singular, reason }
}

fn unreachable(runtime: &ArmRuntime, t: f64, reference: &Reference, distance: f64) -> Stop {
    let reason = format!(
        "arm `{}` can not reach its path at t = {t:.6} s: the nearest it gets to {} is a task error of {distance:.3e} (the run stopped at {:.3e}); move the path nearer or make it smaller",
        runtime.arm.name,
        place(reference),
        runtime.error.norm()
    );
    Stop { status: PlanStatus::Unreachable, reason }
}

fn place(reference: &Reference) -> String {
    let p = reference.position;
    format!("({:.4}, {:.4}, {:.4}) m", p.x, p.y, p.z)
}

/// The largest norm over the second half of the samples.
fn steady_maximum(errors: &[Vector6<f64>]) -> f64 {
    errors[errors.len() / 2..].iter().map(Vector6::norm).fold(0.0, f64::max)
}

fn steady_mean_square(errors: &[Vector6<f64>]) -> f64 {
    let half = &errors[errors.len() / 2..];
    half.iter().map(Vector6::norm_squared).sum::<f64>() / half.len() as f64
}

fn damping_warning(plan: &ArmPlan, threshold: f64) -> Option<String> {
    let (smallest, at) = plan.smallest_singular_value;
    (plan.damped_samples > 1).then(|| {
        format!(
            "arm `{}` came near a singularity: damped least squares acted on {} samples; the smallest singular value was {smallest:.3e} at t = {at:.6} s (threshold {threshold:.3e})",
            plan.name, plan.damped_samples
        )
    })
}

fn empty_plan(runtime: &ArmRuntime, steps: usize) -> ArmPlan {
    let joints = runtime.arm.joint_names();
    let entries = (steps + 1) * joints.len();
    ArmPlan {
        name: runtime.arm.name.clone(),
        joints,
        positions: Vec::with_capacity(entries),
        velocities: Vec::with_capacity(entries),
        errors: Vec::with_capacity(steps + 1),
        max_error: 0.0,
        max_error_component: 0.0,
        max_error_steady: 0.0,
        rms_error_steady: 0.0,
        max_position_error: 0.0,
        max_orientation_error: 0.0,
        smallest_singular_value: (f64::INFINITY, 0.0),
        damped_samples: 0,
        violations: Vec::new(),
        start_distance: runtime.arm.start_distance,
    }
}
