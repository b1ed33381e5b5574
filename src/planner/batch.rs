use super::lanes::are_alike;
use super::planner::Planner;
use super::run::{Ensemble, Plan, Stop};
use super::system::ArmState;

/// As many plans advance together: the lanes of today's widest common registers.
const TOGETHER: usize = 4;

/// Many plans that are stepped at once, those alike in the lanes of registers. Every plan moves the same bits as if it were
/// stepped by itself.
///
/// Plans are alike when they stand at the same sample and have the same formula, start, gap and gain, and the same number of
/// arms that move in the same way, with tasks of the same kind, the plain least-norm law, no common joints and no noise: one robot from
/// many places, on many paths. All others are stepped by themselves. For more threads, give each of them some of the plans.
///
/// ```
/// use kinstep::{planner::Batch, scheme};
/// # use kinstep::{planner::Arm, robot::embedded, task::{Motion, Planar, Circle, Sin2, TaskKind}};
/// # let chain = embedded::get("planar4")?.chain("base", "tip")?;
/// let planners = [0.1, 0.2, 0.3].map(|radius| {
///     # let q0 = vec![0.3, 0.4, 0.5, 0.6];
///     # let start = chain.forward(&q0, &mut chain.scratch()).pose();
///     # let motion = Motion::from_pose(Planar::whole(Circle { radius }), Sin2, 2.0, &start);
///     # let arm = Arm::new("arm", chain.clone(), q0, TaskKind::PositionXy, motion);
///     scheme::dtsmp([arm], 0.01, 0.4).duration(2.0).build()
/// });
/// let mut batch = Batch::new(planners.into_iter().collect::<Result<Vec<_>, _>>()?);
/// while !batch.is_finished() {
///     let command = batch.arm(2, 0).positions; // of the first arm of the third plan
///     # let _ = command;
///     batch.step();
/// }
/// assert!((0..batch.plans()).all(|plan| batch.stop(plan).is_none()));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub struct Batch {
    ensembles: Vec<Ensemble>,
    /// The ensemble of each plan, and its index there.
    places: Vec<(usize, usize)>,
}

impl std::fmt::Debug for Batch {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Batch").field("places", &self.places).finish_non_exhaustive()
    }
}

impl Batch {
    /// Takes plans as they stand.
    pub fn new(planners: impl IntoIterator<Item = Planner>) -> Self {
        let mut rest: Vec<Option<Ensemble>> =
            planners.into_iter().map(|planner| Some(planner.into_ensemble())).collect();
        let (mut ensembles, mut places) = (Vec::new(), vec![(0, 0); rest.len()]);
        for first in 0..rest.len() {
            let Some(ensemble) = rest[first].take() else { continue };
            let mut alike = vec![ensemble];
            places[first] = (ensembles.len(), 0);
            for (place, other) in places.iter_mut().zip(&mut rest).skip(first + 1) {
                if alike.len() == TOGETHER {
                    break;
                }
                if let Some(other) = other.take_if(|other| is_alike(&alike[0], other)) {
                    *place = (ensembles.len(), alike.len());
                    alike.push(other);
                }
            }
            match alike.pop() {
                Some(single) if alike.is_empty() => ensembles.push(single),
                last => ensembles.extend(Ensemble::join(alike.into_iter().chain(last).collect())),
            }
        }
        Self { ensembles, places }
    }

    /// How many plans there are.
    pub fn plans(&self) -> usize {
        self.places.len()
    }

    /// Goes to the next sample of every plan; those that are [finished](Self::is_plan_finished) stay where they are.
    ///
    /// A run that stops does so at a sample that lies beyond its bounds: look at [`is_plan_finished`](Self::is_plan_finished)
    /// before sending positions on.
    pub fn step(&mut self) {
        self.ensembles.iter_mut().for_each(Ensemble::step);
    }

    /// Whether all plans have reached their last samples or have stopped.
    pub fn is_finished(&self) -> bool {
        self.ensembles.iter().all(Ensemble::are_all_finished)
    }

    /// Whether that plan (in the order in which they were given) has reached its last sample or has stopped.
    ///
    /// # Panics
    /// If there is no such plan; so do the others that ask for one.
    pub fn is_plan_finished(&self, plan: usize) -> bool {
        let (ensemble, run) = self.places[plan];
        self.ensembles[ensemble].is_finished(run)
    }

    /// Why that plan stopped early, if it did.
    pub fn stop(&self, plan: usize) -> Option<&Stop> {
        let (ensemble, run) = self.places[plan];
        self.ensembles[ensemble].runs[run].stop.as_ref()
    }

    /// The index of that plan's present sample.
    pub fn index(&self, plan: usize) -> usize {
        let (ensemble, run) = self.places[plan];
        self.ensembles[ensemble].index(run)
    }

    /// Arm `i` of that plan (in the order in which arms were added) at the present sample.
    ///
    /// # Panics
    /// If there is no such arm.
    pub fn arm(&self, plan: usize, i: usize) -> ArmState<'_> {
        let (ensemble, run) = self.places[plan];
        let ensemble = &self.ensembles[ensemble];
        let arms = ensemble.runs[run].arms.clone();
        assert!(i < arms.len(), "plan {plan} has {} arms", arms.len());
        ensemble.field.arm(arms.start + i)
    }

    /// Runs all plans to their ends and returns the trajectories, in the order of the plans.
    pub fn run(self) -> Vec<Plan> {
        let mut plans: Vec<Vec<Option<Plan>>> = Vec::new();
        for ensemble in self.ensembles {
            plans.push(ensemble.run_with(|_, _| {}).into_iter().map(Some).collect());
        }
        self.places.iter().filter_map(|&(ensemble, run)| plans[ensemble][run].take()).collect()
    }
}

fn is_alike(one: &Ensemble, other: &Ensemble) -> bool {
    let (one_field, other_field) = (&one.field, &other.field);
    let alike = |i: usize| {
        are_alike(&[
            (&one_field.arms[i], &one_field.systems[i]),
            (&other_field.arms[i], &other_field.systems[i]),
        ])
    };
    one_field.arms.len() == other_field.arms.len()
        && one.is_in_step_with(other)
        && (0..one_field.arms.len()).all(alike)
}

/// Runs plans to their ends, those alike together; see [`Batch`].
pub fn run_together(planners: Vec<Planner>) -> Vec<Plan> {
    Batch::new(planners).run()
}
