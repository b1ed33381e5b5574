use super::{Criteria, Criterion, Instant, SystemShape};

/// The null-space criteria of a law, and the sum `c` of what they ask for.
#[derive(Default)]
pub(super) struct CriteriaSum {
    criteria: Criteria,
    sum: Vec<f64>,
    summand: Vec<f64>,
}

impl CriteriaSum {
    pub(super) fn of(criteria: Criteria) -> Self {
        Self { criteria, ..Self::default() }
    }

    pub(super) fn push(&mut self, criterion: impl Criterion + 'static) {
        self.criteria.push(Box::new(criterion));
    }

    pub(super) fn is_empty(&self) -> bool {
        self.criteria.is_empty()
    }

    pub(super) fn prepare(&mut self, shape: &SystemShape) {
        for criterion in &mut self.criteria {
            criterion.prepare(shape);
        }
        self.sum = vec![0.0; shape.joints.len()];
        self.summand = self.sum.clone();
    }

    /// Adds up what the criteria ask for at an instant.
    pub(super) fn evaluate(&mut self, instant: &Instant<'_>) {
        self.sum.fill(0.0);
        for criterion in &mut self.criteria {
            criterion.velocity(instant, &mut self.summand);
            for (sum, summand) in self.sum.iter_mut().zip(&self.summand) {
                *sum += summand;
            }
        }
    }

    /// What was added up last: one entry per joint [rad/s or m/s].
    pub(super) fn sum(&self) -> &[f64] {
        &self.sum
    }

    /// The sum of the rates [1/s] that are known beforehand.
    pub(super) fn rate(&self) -> Option<f64> {
        let known = self.criteria.iter().filter_map(Criterion::rate);
        known.reduce(|sum, rate| sum + rate)
    }

    /// The sum of the rates [1/s] at the instant that was evaluated last.
    pub(super) fn rate_at(&self, instant: &Instant<'_>) -> f64 {
        self.criteria.iter().map(|criterion| criterion.rate_at(instant)).sum()
    }

    /// Whether one of them looks at the distances of bodies.
    pub(super) fn keeps_distances(&self) -> bool {
        self.criteria.iter().any(Criterion::keeps_distances)
    }

    pub(super) fn objection(&self, shape: &SystemShape) -> Option<String> {
        self.criteria.iter().find_map(|criterion| criterion.objection(shape))
    }
}
