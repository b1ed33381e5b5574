//! How the feedback brought an arm in that started off its path.

use nalgebra::Vector6;

/// How the feedback brought an arm in that started off its path.
#[derive(Clone, Debug, PartialEq)]
pub struct Convergence {
    /// Norm of the task error [m, rad] at the start.
    pub initial_error: f64,
    /// Norm of the task error [m, rad] below which the arm counts as on its path.
    pub tolerance: f64,
    /// From when on the error stayed below the tolerance \[s\]; `None` where it did not. Errors of the run count from then on.
    pub reached: Option<f64>,
    /// The factor `r(h)` by which the feedback shrinks an error per step in the long run: the spectral radius of the loop.
    pub factor: f64,
    /// When `r(h)^n` times the initial error falls below the tolerance \[s\], counted from the end of the start; infinite where
    /// it never does.
    pub predicted: f64,
}

impl Convergence {
    /// What became of an arm whose errors these are; the loop takes `recovery` steps to recover where its factor is zero.
    pub(super) fn of(
        errors: &[Vector6<f64>],
        tolerance: f64,
        (factor, recovery): (f64, usize),
        sigma: f64,
    ) -> Self {
        let initial_error = errors.first().map_or(0.0, Vector6::norm);
        // A NaN is not on the path.
        let is_on = |error: &Vector6<f64>| error.norm() <= tolerance;
        let off = errors.iter().rposition(|error| !is_on(error)).map_or(0, |last| last + 1);
        let steps = match () {
            () if initial_error <= tolerance => 0.0,
            () if factor == 0.0 => recovery as f64,
            () if factor < 1.0 => ((tolerance / initial_error).ln() / factor.ln()).ceil(),
            () => f64::INFINITY,
        };
        Self {
            initial_error,
            tolerance,
            reached: (off < errors.len()).then_some(off as f64 * sigma),
            factor,
            predicted: steps * sigma,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_arm_is_on_its_path_from_when_it_stays_there() {
        let errors: Vec<Vector6<f64>> =
            [1.0, 0.5, 0.05, 0.2, 0.1, 0.05].map(|x| Vector6::new(x, 0.0, 0.0, 0.0, 0.0, 0.0)).to_vec();
        let found = Convergence::of(&errors, 0.1, (0.5, 3), 2.0);
        assert_eq!((found.initial_error, found.reached, found.predicted), (1.0, Some(8.0), 8.0));
        assert_eq!(Convergence::of(&errors[..4], 0.1, (0.5, 3), 2.0).reached, None);
        assert_eq!(Convergence::of(&errors, 0.1, (0.0, 3), 2.0).predicted, 6.0);
        assert_eq!(Convergence::of(&errors, 0.1, (1.0, 3), 2.0).predicted, f64::INFINITY);
    }
}
