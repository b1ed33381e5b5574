use super::bundle::are_alike;
use super::fleet::Fleet;
use super::{ArmState, Plan, Planner, Stop};

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
    fleets: Vec<Fleet>,
    /// The fleet of each plan, and its index there.
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
        let mut rest: Vec<Option<Fleet>> =
            planners.into_iter().map(|planner| Some(planner.into_fleet())).collect();
        let (mut fleets, mut places) = (Vec::new(), vec![(0, 0); rest.len()]);
        for first in 0..rest.len() {
            let Some(fleet) = rest[first].take() else { continue };
            let mut alike = vec![fleet];
            places[first] = (fleets.len(), 0);
            for (place, other) in places.iter_mut().zip(&mut rest).skip(first + 1) {
                if alike.len() == TOGETHER {
                    break;
                }
                if let Some(other) = other.take_if(|other| is_alike(&alike[0], other)) {
                    *place = (fleets.len(), alike.len());
                    alike.push(other);
                }
            }
            match alike.pop() {
                Some(single) if alike.is_empty() => fleets.push(single),
                last => fleets.extend(Fleet::join(alike.into_iter().chain(last).collect())),
            }
        }
        Self { fleets, places }
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
        self.fleets.iter_mut().for_each(Fleet::step);
    }

    /// Whether all plans have reached their last samples or have stopped.
    pub fn is_finished(&self) -> bool {
        self.fleets.iter().all(Fleet::are_all_finished)
    }

    /// Whether that plan (in the order in which they were given) has.
    ///
    /// # Panics
    /// If there is no such plan; so do the others that ask for one.
    pub fn is_plan_finished(&self, plan: usize) -> bool {
        let (fleet, course) = self.places[plan];
        self.fleets[fleet].is_finished(course)
    }

    /// Why that plan stopped early, if it did.
    pub fn stop(&self, plan: usize) -> Option<&Stop> {
        let (fleet, course) = self.places[plan];
        self.fleets[fleet].courses[course].stop.as_ref()
    }

    /// The index of that plan's present sample.
    pub fn index(&self, plan: usize) -> usize {
        let (fleet, course) = self.places[plan];
        self.fleets[fleet].index(course)
    }

    /// Arm `i` of that plan (in the order in which arms were added) at the present sample.
    ///
    /// # Panics
    /// If there is no such arm.
    pub fn arm(&self, plan: usize, i: usize) -> ArmState<'_> {
        let (fleet, course) = self.places[plan];
        let fleet = &self.fleets[fleet];
        let arms = fleet.courses[course].arms.clone();
        assert!(i < arms.len(), "plan {plan} has {} arms", arms.len());
        fleet.field.arm(arms.start + i)
    }

    /// Runs all plans to their ends and returns the trajectories, in the order of the plans.
    pub fn run(self) -> Vec<Plan> {
        let mut plans: Vec<Vec<Option<Plan>>> = Vec::new();
        for fleet in self.fleets {
            plans.push(fleet.run_with(|_, _| {}).into_iter().map(Some).collect());
        }
        self.places.iter().filter_map(|&(fleet, course)| plans[fleet][course].take()).collect()
    }
}

fn is_alike(one: &Fleet, other: &Fleet) -> bool {
    let arms = || one.field.arms.iter().zip(&other.field.arms);
    one.field.arms.len() == other.field.arms.len()
        && one.is_in_step_with(other)
        && arms().all(|(one, other)| are_alike(&[&one.arm, &other.arm]))
}

/// Runs plans to their ends, those alike together; see [`Batch`].
pub fn run_together(planners: Vec<Planner>) -> Vec<Plan> {
    Batch::new(planners).run()
}
