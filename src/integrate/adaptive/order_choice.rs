/// The estimated errors of a step by rows of neighbouring orders, each in units of what is allowed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Errors {
    /// By the row of the order that made the step.
    pub(super) own: f64,
    /// By the row of one order less.
    pub(super) lower: Option<f64>,
    /// By the row of one order more.
    pub(super) higher: Option<f64>,
}

/// What part of the step that the error allows is taken.
const SAFETY: f64 = 0.9;
/// The least that an error is taken for: it bounds what a step can grow by.
const LEAST: f64 = 1e-12;

/// The factor by which a step of that order may grow so that its error is what is allowed.
pub(super) fn growth(error: f64, order: usize) -> f64 {
    SAFETY * error.max(LEAST).powf(-1.0 / (order as f64 + 1.0))
}

impl Errors {
    /// The order, of those that are known, by which the next step can be longest, and the factor by which it may grow.
    pub(super) fn best(self, order: usize) -> (usize, f64) {
        let own = (order, growth(self.own, order));
        let lower = self.lower.map(|error| (order - 1, growth(error, order - 1)));
        let higher = self.higher.map(|error| (order + 1, growth(error, order + 1)));
        let longer = |one: (usize, f64), other: (usize, f64)| if other.1 > one.1 { other } else { one };
        [lower, higher].into_iter().flatten().fold(own, longer)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_order_of_the_longest_step_is_taken() {
        let errors = |lower, own, higher| Errors { own, lower, higher };
        assert_eq!(errors(Some(1.0), 1.0, Some(1.0)).best(3), (3, SAFETY));
        assert_eq!(errors(Some(1e-3), 0.1, Some(0.1)).best(3).0, 2);
        assert_eq!(errors(Some(0.1), 0.1, Some(1e-6)).best(3).0, 4);
        assert!(growth(0.0, 1).is_finite() && growth(4.0, 1) < 0.5);
    }
}
