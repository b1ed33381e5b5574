use super::{
    Criteria, Criterion, Infeasible, Instant, JointVelocity, Law, LawKind, MakeLaw, Pseudoinverse,
    Resolution, SystemShape,
};
use crate::kind::{ByJoint, Form, Kind, Parameter};
use crate::task::TaskRows;

/// The joint velocity of least weighted norm `q'^T W q'` that meets all tasks, `W` a positive weight for each joint (Whitney
/// 1969): `q' = W^-1/2 (J W^-1/2)^+ (phi' - k e - J c) + c`, with `c` what the null-space criteria ask for.
///
/// A joint of weight 100 moves a hundredth as much as one of weight 1 that serves the tasks as well. Only ratios count: weights
/// are scaled so that the least is 1. Near a singularity it is damped as [`Pseudoinverse`] is, by the singular values of
/// `J W^-1/2`.
///
/// ```
/// use kinstep::kind::ByJoint;
/// use kinstep::law::Weighted;
/// use kinstep::planner::JointSystem;
///
/// let law = Weighted::new(ByJoint::Named(vec![("shoulder".to_owned(), 100.0)]));
/// let pair = JointSystem::of(["left", "right"]).with_law(law);
/// # let _ = pair;
/// ```
#[derive(Debug)]
pub struct Weighted {
    weights: ByJoint,
    /// The least-norm law of `W^1/2 q'`.
    scaled: Pseudoinverse,
    factors: Vec<f64>,
    rows: Vec<TaskRows>,
}

impl Weighted {
    /// The law with these weights; joints that are not named have weight 1.
    pub fn new(weights: ByJoint) -> Self {
        Self { weights, scaled: Pseudoinverse::new(), factors: Vec::new(), rows: Vec::new() }
    }

    /// The same with a threshold of your own on the smallest singular value of `J W^-1/2`.
    #[must_use]
    pub fn with_threshold(mut self, threshold: f64) -> Self {
        self.scaled = self.scaled.with_threshold(threshold);
        self
    }

    /// The same with a criterion for the null space; criteria add up.
    #[must_use]
    pub fn with_criterion(mut self, criterion: impl Criterion + 'static) -> Self {
        let (criterion, weights) = (Box::new(criterion), self.weights.clone());
        let scaled = ScaledCriterion { criterion, weights, factors: Vec::new() };
        self.scaled = self.scaled.with_criterion(scaled);
        self
    }

    fn with_criteria(self, criteria: Criteria) -> Self {
        criteria.into_iter().fold(self, Self::with_criterion)
    }
}

/// `W^-1/2`, one entry per joint, with weights scaled so that the least is 1.
fn factors(weights: &ByJoint, shape: &SystemShape) -> Vec<f64> {
    let weight = |joint: &String| weights.number(joint).unwrap_or(1.0);
    let least = shape.joints.iter().map(weight).fold(f64::INFINITY, f64::min);
    shape.joints.iter().map(|joint| (least / weight(joint)).sqrt()).collect()
}

impl Law for Weighted {
    fn prepare(&mut self, shape: &SystemShape) {
        self.factors = factors(&self.weights, shape);
        let rows = shape.tasks.iter().map(|task| TaskRows::zeros(task.rows(), shape.joints.len()));
        self.rows = rows.collect();
        self.scaled.prepare(shape);
    }

    fn resolve(
        &mut self,
        instant: &Instant<'_>,
        velocity: &mut JointVelocity<'_>,
    ) -> Result<Resolution, Infeasible> {
        for (scaled, own) in self.rows.iter_mut().zip(instant.tasks) {
            scaled.feedforward.copy_from_slice(&own.feedforward);
            scaled.feedback.copy_from_slice(&own.feedback);
            scaled.jacobian.copy_from(&own.jacobian);
            for (mut column, factor) in scaled.jacobian.column_iter_mut().zip(&self.factors) {
                column *= *factor;
            }
        }
        let resolution = self.scaled.resolve(&Instant { tasks: &self.rows, ..*instant }, velocity)?;
        let parts = velocity.feedforward.iter_mut().zip(&mut *velocity.feedback);
        for ((f, g), factor) in parts.zip(&self.factors) {
            *f *= factor;
            *g *= factor;
        }
        Ok(resolution)
    }

    fn threshold(&self) -> f64 {
        self.scaled.threshold()
    }

    fn objection(&self, shape: &SystemShape) -> Option<String> {
        self.scaled.objection(shape)
    }

    fn keeps_distances(&self) -> bool {
        self.scaled.keeps_distances()
    }

    fn criterion_rate(&self) -> Option<f64> {
        self.scaled.criterion_rate()
    }
}

/// What a criterion asks of `W^1/2 q'`.
struct ScaledCriterion {
    criterion: Box<dyn Criterion>,
    weights: ByJoint,
    factors: Vec<f64>,
}

impl Criterion for ScaledCriterion {
    fn prepare(&mut self, shape: &SystemShape) {
        self.factors = factors(&self.weights, shape);
        self.criterion.prepare(shape);
    }

    fn objection(&self, shape: &SystemShape) -> Option<String> {
        self.criterion.objection(shape)
    }

    fn velocity(&mut self, instant: &Instant<'_>, c: &mut [f64]) {
        self.criterion.velocity(instant, c);
        for (c, factor) in c.iter_mut().zip(&self.factors) {
            *c /= factor;
        }
    }

    fn rate(&self) -> Option<f64> {
        self.criterion.rate()
    }

    fn rate_at(&self, instant: &Instant<'_>) -> f64 {
        self.criterion.rate_at(instant)
    }
}

pub(super) const KIND: LawKind = Kind::new(
    "weighted",
    "The joint velocity of least weighted norm that meets all tasks: heavy joints move less.",
    &[
        Parameter::required(
            "weights",
            Form::ByJoint { noun: "weight" },
            "",
            "Weights by the names of joints; those that are not named have weight 1.",
        ),
        super::pseudoinverse::THRESHOLD,
    ],
    MakeLaw::WithCriteria(|given, criteria| {
        let law = Weighted::new(given.by_joint("weights").unwrap_or(ByJoint::All(1.0)));
        let law = given.number("threshold").into_iter().fold(law, Weighted::with_threshold);
        Box::new(law.with_criteria(criteria))
    }),
);

#[cfg(test)]
mod tests {
    use super::super::Posture;
    use super::super::trial::{prepared, resolve, task};
    use super::*;
    use nalgebra::{DMatrix, DVector, Vector6};
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn it_is_the_weighted_inverse_and_the_null_space_part_moves_no_task(
            entries in prop::collection::vec(-1.0..1.0_f64, 42), v in prop::array::uniform6(-1.0..1.0_f64),
            weights in prop::collection::vec(1.0..50.0_f64, 7),
        ) {
            let columns: Vec<_> = entries.chunks(6).map(Vector6::from_column_slice).collect();
            let jacobian = DMatrix::from_fn(3, 7, |row, column| columns[column][row]);
            let named = weights.iter().enumerate().map(|(joint, weight)| (format!("joint {joint}"), *weight));
            let by_joint = ByJoint::Named(named.collect());
            let inverse = DMatrix::from_diagonal(&DVector::from_vec(weights).map(f64::recip));
            let gram = &jacobian * &inverse * jacobian.transpose();
            prop_assume!(gram.clone().symmetric_eigenvalues().min() > 1e-3);
            let wanted = DVector::from_row_slice(&v[..3]);
            let expected = &inverse * jacobian.transpose() * gram.try_inverse().unwrap_or_default() * &wanted;
            let demand = [task(3, &columns, &v, &v)];
            let mut law = prepared(Weighted::new(by_joint.clone()), 3, 7);
            let ([f, g], _) = resolve(&mut law, &[0.3; 7], &demand);
            prop_assert!((DVector::from_vec(f) - &expected).norm() < 1e-8 && (DVector::from_vec(g) - &expected).norm() < 1e-8);
            let pulled = Weighted::new(by_joint).with_criterion(Posture::new(1.0, vec![0.0; 7]));
            let ([f, _], resolution) = resolve(&mut prepared(pulled, 3, 7), &[0.3; 7], &demand);
            prop_assert!((&jacobian * DVector::from_vec(f) - wanted).norm() < 1e-9);
            prop_assert_eq!(resolution.criterion_rate, 1.0);
        }
    }
}
