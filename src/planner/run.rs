use super::field::SynchronousField;
use super::fleet::{Description, Fleet};
use super::runtime::ArmRuntime;
use super::{Noise, Plan, PlanStatus, PlannerBuilder};
use crate::integrate::Multistep;
use nalgebra::Vector6;

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
    pub error: Vector6<f64>,
    /// Whether the law damped its answer here.
    pub damped: bool,
}

impl<'a> ArmState<'a> {
    pub(super) fn of(arm: &'a ArmRuntime) -> Self {
        Self {
            positions: &arm.positions,
            velocities: &arm.velocities,
            error: arm.error,
            damped: arm.resolution.damped,
        }
    }
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
    /// Of this plan alone.
    fleet: Fleet,
}

impl std::fmt::Debug for Planner {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Planner").field("description", self.description()).finish_non_exhaustive()
    }
}

impl Planner {
    /// An empty builder.
    pub fn builder() -> PlannerBuilder {
        PlannerBuilder::default()
    }

    /// Takes a stepper whose first state has been evaluated and told to the arms.
    pub(super) fn begin(
        description: Description,
        stepper: Multistep<f64>,
        field: SynchronousField,
        noise: Option<Noise>,
    ) -> Self {
        Self { fleet: Fleet::begin(description, stepper, field, noise) }
    }

    fn description(&self) -> &Description {
        &self.fleet.courses[0].description
    }

    pub(super) fn into_fleet(self) -> Fleet {
        self.fleet
    }

    /// The index of the present sample.
    pub fn index(&self) -> usize {
        self.fleet.index(0)
    }

    /// The time of the present sample \[s\].
    pub fn time(&self) -> f64 {
        self.fleet.time(0)
    }

    /// Steps of the whole plan.
    pub fn steps(&self) -> usize {
        self.description().steps
    }

    /// The sampling gap used \[s\].
    pub fn sigma(&self) -> f64 {
        self.description().sigma
    }

    /// The feedback step used.
    pub fn h(&self) -> f64 {
        self.description().h
    }

    /// What the user should know before running.
    pub fn warnings(&self) -> &[String] {
        &self.description().warnings
    }

    /// Whether the last sample was reached or the run has stopped.
    pub fn is_finished(&self) -> bool {
        self.fleet.is_finished(0)
    }

    /// Why the run stopped early, if it did.
    pub fn stop(&self) -> Option<&Stop> {
        self.fleet.courses[0].stop.as_ref()
    }

    /// Arm `i` (in the order in which arms were added) at the present sample.
    ///
    /// # Panics
    /// If there is no arm `i`.
    pub fn arm(&self, i: usize) -> ArmState<'_> {
        self.fleet.field.arm(i)
    }

    /// Goes to the next sample; does nothing once [finished](Self::is_finished).
    ///
    /// A run that stops does so at a sample that lies beyond its bounds: look at [`is_finished`](Self::is_finished) before
    /// sending positions on.
    pub fn step(&mut self) {
        self.fleet.step();
    }

    /// Runs to the end and returns the trajectories.
    pub fn run(self) -> Plan {
        self.run_with(|_, _| {})
    }

    /// Runs to the end, telling `progress` after every step how many of how many are done.
    pub fn run_with(self, progress: impl FnMut(usize, usize)) -> Plan {
        self.fleet.run_with(progress).remove(0)
    }
}
