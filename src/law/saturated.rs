use super::limited::{Limited, RangeMethod};
use super::{LawKind, MakeLaw, SystemShape};
use crate::kind::Kind;
use crate::math::{Constraint, LeastDistance, NoSolution, RowRotations, dot};

/// What counts as lost rank, as a fraction of the smallest singular value with all joints.
const LOST_RANK: f64 = 1e-6;
/// By how much a velocity may pass its range, as a fraction of the bound: rounding.
const ROUNDING: f64 = 1e-12;

/// Saturation in the null space (Flacco, De Luca and Khatib 2012): joints that would leave their ranges are held at them one
/// after the other, the most critical first, and the others make up for it ([`Limited`] has the problem).
///
/// It keeps the limits that [`QuadraticProgram`](super::QuadraticProgram) keeps, costs less where few of them are active, and is
/// greedy: a joint that was held is not let go within a sample, so its answer need not be the nearest, and where it finds none
/// the quadratic program may still find one.
///
/// ```
/// use kinstep::law::Saturated;
/// use kinstep::planner::JointSystem;
///
/// let pair = JointSystem::of(["left", "right"]).with_law(Saturated::new());
/// # let _ = pair;
/// ```
pub type Saturated = Limited<NullSpaceSaturation>;

/// The method of [`Saturated`].
#[derive(Default)]
pub struct NullSpaceSaturation {
    /// The side at which a joint is held, if it is.
    held: Vec<Option<Constraint>>,
    rotations: Option<RowRotations>,
    /// `q_N`: where held joints are held, and the target of the others.
    fixed: Vec<f64>,
    /// What is asked of the joints that are free.
    rest: Vec<f64>,
    /// What the tasks' own part of the answer is: it is what a slower task would scale.
    own: Vec<f64>,
    conflict: Vec<Constraint>,
}

impl RangeMethod for NullSpaceSaturation {
    fn prepare(&mut self, shape: &SystemShape) {
        let (rows, joints) = (shape.rows(), shape.joints.len());
        *self = Self {
            held: vec![None; joints],
            rotations: Some(RowRotations::with_capacity(rows, joints)),
            fixed: vec![0.0; joints],
            rest: vec![0.0; rows],
            own: vec![0.0; joints],
            conflict: Vec::with_capacity(joints + rows),
        };
    }

    fn solve(&mut self, problem: &LeastDistance<'_>, x: &mut [f64]) -> Result<(), NoSolution> {
        self.held.fill(None);
        self.fixed.copy_from_slice(problem.target);
        let regular = self.decompose(problem).unwrap_or(0.0);
        self.scale_part(problem);
        while let Some(critical) = self.most_critical(problem, x) {
            let (joint, bound) = match critical {
                Constraint::Lower(joint) => (joint, problem.lower[joint]),
                Constraint::Upper(joint) => (joint, problem.upper[joint]),
                Constraint::Equality(_) | Constraint::Inequality(_) => return Err(NoSolution::NotFinite),
            };
            self.held[joint] = Some(critical);
            self.fixed[joint] = bound;
            if self.decompose(problem).is_none_or(|smallest| smallest <= LOST_RANK * regular) {
                self.note_conflict(problem);
                return Err(NoSolution::Infeasible);
            }
            self.write_answer(problem, x);
            self.scale_part(problem);
        }
        Ok(())
    }

    fn conflict(&self) -> &[Constraint] {
        &self.conflict
    }
}

impl NullSpaceSaturation {
    /// Decomposes the Jacobian of the joints that are free, and returns its smallest singular value; none where there are fewer
    /// of them than rows.
    fn decompose(&mut self, problem: &LeastDistance<'_>) -> Option<f64> {
        let (joints, held) = (problem.target.len(), &self.held);
        let rotations = self.rotations.as_mut()?;
        rotations.compute(joints, |row, joint| {
            if held[joint].is_none() { problem.equalities[row * joints + joint] } else { 0.0 }
        });
        let free = held.iter().filter(|held| held.is_none()).count();
        (free >= problem.values.len()).then(|| rotations.smallest())
    }

    /// Writes `q_N + (J W)^+ (v - J q_N)`.
    fn write_answer(&mut self, problem: &LeastDistance<'_>, x: &mut [f64]) {
        let joints = x.len();
        let rows = problem.equalities.chunks_exact(joints).zip(problem.values);
        for (rest, (row, value)) in self.rest.iter_mut().zip(rows) {
            *rest = value - dot(row, &self.fixed);
        }
        x.copy_from_slice(&self.fixed);
        if let Some(rotations) = &self.rotations {
            rotations.apply(&self.rest, f64::recip, x);
        }
    }

    /// Finds what the tasks' own part of the answer is, `(J W)^+ v`.
    fn scale_part(&mut self, problem: &LeastDistance<'_>) {
        self.own.fill(0.0);
        if let Some(rotations) = &self.rotations {
            rotations.apply(problem.values, f64::recip, &mut self.own);
        }
    }

    /// Of the joints that leave their ranges, the one that would allow the slowest task; none where all are within.
    fn most_critical(&self, problem: &LeastDistance<'_>, x: &[f64]) -> Option<Constraint> {
        let mut most: Option<(f64, Constraint)> = None;
        for joint in (0..x.len()).filter(|&joint| self.held[joint].is_none()) {
            let (lower, upper) = (problem.lower[joint], problem.upper[joint]);
            let (bound, side) = if x[joint] > upper + ROUNDING * upper.abs() {
                (upper, Constraint::Upper(joint))
            } else if x[joint] < lower - ROUNDING * lower.abs() {
                (lower, Constraint::Lower(joint))
            } else {
                continue;
            };
            // x = own s + other: the scale s at which the joint would be at its bound.
            let (own, other) = (self.own[joint], x[joint] - self.own[joint]);
            let scale = if own == 0.0 { f64::NEG_INFINITY } else { (bound - other) / own };
            if most.is_none_or(|(least, _)| scale < least) {
                most = Some((scale, side));
            }
        }
        most.map(|(_, side)| side)
    }

    fn note_conflict(&mut self, problem: &LeastDistance<'_>) {
        self.conflict.clear();
        self.conflict.extend((0..problem.values.len()).map(Constraint::Equality));
        self.conflict.extend(self.held.iter().flatten());
    }
}

pub(super) const KIND: LawKind = Kind::new(
    "saturated",
    "The least-norm joint velocity with joints held at their limits one after the other: saturation in the null space.",
    &[],
    MakeLaw::WithCriteria(|_, criteria| Box::new(Limited::by(NullSpaceSaturation::default(), criteria))),
);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::LeastDistanceSolver;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn what_it_finds_lies_within_the_ranges_and_meets_the_tasks_and_is_never_nearer_than_the_nearest(
            equalities in prop::collection::vec(-1.0..1.0_f64, 21), values in prop::collection::vec(-1.0..1.0_f64, 3),
            target in prop::collection::vec(-1.0..1.0_f64, 7),
        ) {
            let bounds = [0.6; 7];
            let problem = LeastDistance {
                target: &target, equalities: &equalities, values: &values, lower: &bounds.map(|b| -b), upper: &bounds,
                inequalities: &[], bounds: &[],
            };
            let free = LeastDistance { lower: &[-1e9; 7], upper: &[1e9; 7], ..problem };
            let mut solver = LeastDistanceSolver::with_capacity(7);
            let mut x = [0.0; 7];
            prop_assume!(solver.solve(&free, &mut x).is_ok());
            let mut exact = [0.0; 7];
            let nearest = solver.solve(&problem, &mut exact);
            let mut saturation = NullSpaceSaturation::default();
            saturation.prepare(&SystemShape::of_one_task(3, 7, 1.0));
            match saturation.solve(&problem, &mut x) {
                Ok(()) => {
                    prop_assert!(nearest.is_ok(), "it found a point where there is none");
                    prop_assert!(x.iter().all(|x| x.abs() <= 0.6 * (1.0 + 1e-9)), "{x:?}");
                    for (row, value) in equalities.chunks(7).zip(&values) {
                        prop_assert!((dot(row, &x) - value).abs() < 1e-8);
                    }
                    let way = |x: &[f64; 7]| x.iter().zip(&target).map(|(x, c)| (x - c).powi(2)).sum::<f64>();
                    prop_assert!(way(&x) >= way(&exact) - 1e-9);
                }
                Err(failure) => {
                    prop_assert_eq!(failure, NoSolution::Infeasible);
                    prop_assert!(saturation.conflict().len() > 3, "the tasks and the joints that are held");
                }
            }
        }
    }
}
