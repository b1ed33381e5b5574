use super::closest_approach::ClosestApproach;
use super::plan::ArmPlan;
use crate::collision::Scene;
use crate::planner::PlannerError;
use crate::planner::system::{Arm, Surroundings};

/// The bodies of a plan, to be looked at sample after sample once the run is over: in a step they cost nothing then.
#[derive(Clone, Debug)]
pub(in crate::planner) struct DistanceWatch {
    /// Its columns are the joints of all arms, one after the other.
    scene: Scene,
    margin: f64,
}

impl DistanceWatch {
    /// The watch over all arms of a plan.
    pub(in crate::planner) fn new(surroundings: &Surroundings, arms: &[Arm]) -> Result<Self, PlannerError> {
        let mut columns = 0;
        let mut places = Vec::new();
        for arm in arms {
            let end = columns + arm.chain.dof();
            places.push((arm, (columns..end).collect()));
            columns = end;
        }
        Ok(Self { scene: surroundings.scene(columns, &places)?, margin: surroundings.margin() })
    }

    /// Whether there is nothing to be kept apart.
    pub(in crate::planner) fn is_idle(&self) -> bool {
        self.scene.pairs() == 0
    }

    /// Checks that arms do not start nearer to anything than they may.
    pub(in crate::planner) fn check_start(&self, arms: &[Arm]) -> Result<(), PlannerError> {
        let q: Vec<f64> = arms.iter().flat_map(|arm| arm.q0.iter().copied()).collect();
        let mut scratch = self.scene.scratch();
        let nearest = self.scene.place(&q, &mut scratch).minimum();
        let Some(nearest) = nearest.filter(|nearest| nearest.separation.distance < self.margin) else {
            return Ok(());
        };
        let [one, other] = self.scene.pair_names(nearest.pair);
        let (distance, margin) = (nearest.separation.distance, self.margin);
        Err(PlannerError::TooNear { one, other, distance, margin })
    }

    /// How near the bodies came to each other over the samples of the arms.
    pub(in crate::planner) fn closest(&self, arms: &[ArmPlan], sigma: f64) -> Option<ClosestApproach> {
        let samples = arms.iter().map(|arm| arm.errors.len()).min()?;
        let (mut scratch, mut q) = (self.scene.scratch(), Vec::with_capacity(self.scene.columns()));
        let mut course = Vec::with_capacity(samples);
        let mut closest: Option<(usize, usize)> = None;
        for n in 0..samples {
            q.clear();
            for arm in arms {
                q.extend_from_slice(arm.position(n));
            }
            let nearest = self.scene.place(&q, &mut scratch).minimum()?;
            let distance = nearest.separation.distance;
            if closest.is_none_or(|(n, _)| distance < course[n]) {
                closest = Some((n, nearest.pair));
            }
            course.push(distance);
        }
        let (n, pair) = closest?;
        Some(ClosestApproach {
            minimum: course[n],
            pair: self.scene.pair_names(pair),
            t: n as f64 * sigma,
            margin: self.margin,
            course,
        })
    }
}
