use super::bundle::Bundle;
use super::field::SynchronousField;
use super::{Plan, Planner};
use crate::integrate::Field;
use crate::math::LaneArray;
use fearless_simd::Level;

/// As many plans advance together: four doubles fill the registers of today's machines.
type Four = [f64; 4];

/// Runs plans, those alike four at a time: plan by plan in the lanes of registers. The results are those of
/// [`Planner::run`], to the last bit, in the order of the planners.
///
/// Plans are alike when they have the same gap and gain, and the same number of arms that move in the same way, with tasks
/// of the same kind, the plain least-norm law, no common joints and no noise: one robot from many places, on many paths, by many
/// formulas of one gain. All others run by themselves. For more threads, give each of them some of the planners.
///
/// ```
/// use kinstep::{planner, scheme};
/// # use kinstep::{planner::Arm, robot::embedded, task::{Motion, Planar, Circle, Sin2, TaskKind}};
/// # let chain = embedded::get("planar4")?.chain("base", "tip")?;
/// let plans = [0.1, 0.2, 0.3].map(|radius| {
///     # let q0 = vec![0.3, 0.4, 0.5, 0.6];
///     # let start = chain.forward(&q0, &mut chain.scratch()).pose();
///     # let motion = Motion::from_pose(Planar::whole(Circle { radius }), Sin2, 2.0, &start);
///     # let arm = Arm::new("arm", chain.clone(), q0, TaskKind::PositionXy, motion);
///     scheme::dtsmp([arm], 0.01, 0.4).duration(2.0).build()
/// });
/// let plans = planner::run_together(plans.into_iter().collect::<Result<_, _>>()?);
/// assert!(plans.iter().all(|plan| plan.is_completed()));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
pub fn run_together(planners: Vec<Planner>) -> Vec<Plan> {
    let mut rest: Vec<Option<Planner>> = planners.into_iter().map(Some).collect();
    let mut plans: Vec<Option<Plan>> = rest.iter().map(|_| None).collect();
    for first in 0..rest.len() {
        let Some(planner) = rest[first].take() else { continue };
        let mut places = vec![first];
        let mut alike = vec![planner];
        for (place, other) in rest.iter_mut().enumerate().skip(first + 1) {
            if alike.len() == Four::WIDTH {
                break;
            }
            let Some(candidate) = other.take_if(|candidate| is_alike(&alike[0], candidate)) else { continue };
            alike.push(candidate);
            places.push(place);
        }
        for (place, plan) in places.into_iter().zip(run_alike(alike)) {
            plans[place] = Some(plan);
        }
    }
    plans.into_iter().flatten().collect()
}

fn is_alike(a: &Planner, b: &Planner) -> bool {
    let pairs = || a.field().arms.iter().zip(&b.field().arms);
    a.sigma() == b.sigma()
        && a.field().gain == b.field().gain
        && a.field().arms.len() == b.field().arms.len()
        && [a, b].iter().all(|planner| planner.field().shared.is_empty() && !planner.is_noisy())
        && pairs().all(|(a, b)| Bundle::<Four>::new(&[&a.arm, &b.arm]).is_some())
}

/// Runs one to four plans that are alike.
fn run_alike(mut planners: Vec<Planner>) -> Vec<Plan> {
    let arms = planners[0].field().arms.len();
    let bundle = |arm: usize| {
        let arms: Vec<_> = planners.iter().map(|planner| &planner.field().arms[arm].arm).collect();
        Bundle::<Four>::new(&arms)
    };
    let bundles: Option<Vec<_>> = (0..arms).map(bundle).collect();
    let (Some(mut bundles), true) = (bundles, planners.len() > 1) else {
        return planners.into_iter().map(Planner::run).collect();
    };
    let level = Level::new();
    let mut records: Vec<_> = planners.iter().map(Planner::begin_record).collect();
    while planners.iter().any(|planner| !planner.is_finished()) {
        let moved: Vec<bool> = planners.iter_mut().map(Planner::advance).collect();
        let Some(leader) = moved.iter().position(|&moved| moved) else { continue };
        let at = (planners[leader].time(), planners[leader].field().gain);
        for (i, bundle) in bundles.iter_mut().enumerate() {
            bundle.evaluate(level, at, |lane| {
                let planner = &planners[lane.min(planners.len() - 1)];
                (&planner.field().arms[i].arm, planner.arm(i).positions)
            });
        }
        let running = planners.iter_mut().zip(&mut records).zip(moved).enumerate();
        for (lane, ((planner, record), _)) in running.filter(|(_, (_, moved))| *moved) {
            planner.arrive(|field| Delivery { field, bundles: &bundles, lane });
            planner.look_around();
            planner.record(record);
        }
    }
    planners.into_iter().zip(records).map(|(planner, record)| planner.conclude(record)).collect()
}

/// The right-hand side of the plan of one lane, evaluated already.
struct Delivery<'a> {
    field: &'a mut SynchronousField,
    bundles: &'a [Bundle<Four>],
    lane: usize,
}

impl Field<f64> for Delivery<'_> {
    fn dimension(&self) -> usize {
        self.field.dimension()
    }

    fn parts(&self) -> crate::integrate::Parts {
        self.field.parts()
    }

    fn evaluate(&mut self, t: f64, x: &[f64], f: &mut [f64], g: &mut [f64]) {
        let (at, mut from) = ((t, self.field.gain), 0);
        for (runtime, bundle) in self.field.arms.iter_mut().zip(self.bundles) {
            let range = from..from + runtime.arm.chain.dof();
            from = range.end;
            let out = [&mut f[range.clone()], &mut g[range.clone()]];
            bundle.deliver(self.lane, runtime, at, &x[range], out);
        }
    }
}
