use super::run::{Description, Ensemble, Noise, Plan, Stop, SynchronousField};
use super::system::ArmState;
use crate::integrate::Multistep;

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
    ensemble: Ensemble,
}

impl std::fmt::Debug for Planner {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Planner").field("description", self.description()).finish_non_exhaustive()
    }
}

impl Planner {
    /// Takes a stepper whose first state has been evaluated and scattered to the arms.
    pub(super) fn begin(
        description: Description,
        stepper: Multistep<f64>,
        field: SynchronousField,
        noise: Option<Noise>,
    ) -> Self {
        Self { ensemble: Ensemble::begin(description, stepper, field, noise) }
    }

    fn description(&self) -> &Description {
        &self.ensemble.runs[0].description
    }

    pub(super) fn into_ensemble(self) -> Ensemble {
        self.ensemble
    }

    /// The index of the present sample.
    pub fn index(&self) -> usize {
        self.ensemble.index(0)
    }

    /// The time of the present sample \[s\].
    pub fn time(&self) -> f64 {
        self.ensemble.time(0)
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

    /// How many derivatives of the motions are continuous, if not all: errors fall like `sigma` to one power more at best.
    pub fn smoothness(&self) -> Option<usize> {
        self.description().smoothness
    }

    /// Whether the last sample was reached or the run has stopped.
    pub fn is_finished(&self) -> bool {
        self.ensemble.is_finished(0)
    }

    /// Why the run stopped early, if it did.
    pub fn stop(&self) -> Option<&Stop> {
        self.ensemble.runs[0].stop.as_ref()
    }

    /// Arm `i` (in the order in which arms were added) at the present sample.
    ///
    /// # Panics
    /// If there is no arm `i`.
    pub fn arm(&self, i: usize) -> ArmState<'_> {
        self.ensemble.field.arm(i)
    }

    /// Goes to the next sample; does nothing once [finished](Self::is_finished).
    ///
    /// A run that stops does so at a sample that lies beyond its bounds: look at [`is_finished`](Self::is_finished) before
    /// sending positions on.
    pub fn step(&mut self) {
        self.ensemble.step();
    }

    /// Runs to the end and returns the trajectories.
    pub fn run(self) -> Plan {
        self.run_with(|_, _| {})
    }

    /// Runs to the end, telling `progress` after every step how many of how many are done.
    pub fn run_with(self, progress: impl FnMut(usize, usize)) -> Plan {
        self.ensemble.run_with(progress).remove(0)
    }
}
