use crate::integrate::error::IntegrateError;
use crate::math::Scalar;

/// The weighted root-mean-square norm `sqrt(1/d sum_i (v_i / (rtol |x_i| + atol_i))^2)`: one where errors are as large as they may be.
#[derive(Clone, Debug)]
pub(in crate::integrate) struct ErrorNorm {
    relative: f64,
    /// One for all components, or one for each.
    absolute: Vec<f64>,
    weights: Vec<f64>,
}

impl ErrorNorm {
    /// The norm of these tolerances for so many components.
    pub(in crate::integrate) fn new(
        relative: f64,
        absolute: &[f64],
        dimension: usize,
    ) -> Result<Self, IntegrateError> {
        let refuse =
            |what: &'static str, value: f64| IntegrateError::Tolerance { what, text: value.to_string() };
        if !(relative >= 0.0 && relative.is_finite()) {
            return Err(refuse("the relative tolerance", relative));
        }
        if absolute.len() != 1 && absolute.len() != dimension {
            let what = "the list of absolute tolerances".to_owned();
            return Err(IntegrateError::Dimension { what, got: absolute.len(), expected: dimension });
        }
        if let Some(value) = absolute.iter().find(|value| !(**value >= 0.0 && value.is_finite())) {
            return Err(refuse("an absolute tolerance", *value));
        }
        if relative == 0.0 && absolute.contains(&0.0) {
            return Err(IntegrateError::NoTolerance);
        }
        Ok(Self { relative, absolute: absolute.to_vec(), weights: vec![0.0; dimension] })
    }

    /// Allows a part of what was allowed, but for relative errors as small as `least`.
    pub(in crate::integrate) fn tighten(&mut self, part: f64, least: f64) {
        self.relative = if self.relative > 0.0 { (part * self.relative).max(least) } else { 0.0 };
        self.absolute.iter_mut().for_each(|absolute| *absolute *= part);
    }

    /// A norm that [allows](Self::allow) all components the same.
    pub(in crate::integrate) fn even(dimension: usize) -> Self {
        Self { relative: 0.0, absolute: vec![1.0], weights: vec![1.0; dimension] }
    }

    /// Allows errors of this size in all components.
    pub(in crate::integrate) fn allow(&mut self, error: f64) {
        self.weights.fill(1.0 / error);
    }

    /// Weighs errors by the size of a state.
    pub(in crate::integrate) fn weigh_by<T: Scalar>(&mut self, state: &[T]) {
        let last = self.absolute.len() - 1;
        for (i, (weight, x)) in self.weights.iter_mut().zip(state).enumerate() {
            let allowed = self.relative * x.to_f64().abs() + self.absolute[i.min(last)];
            // A component of zero without an absolute tolerance allows nothing.
            *weight = 1.0 / allowed.max(f64::MIN_POSITIVE);
        }
    }

    /// The norm of the vector whose entry `i` is `entry(i)`.
    #[inline]
    pub(in crate::integrate) fn of<T: Scalar>(&self, entry: impl Fn(usize) -> T) -> f64 {
        let square = |(i, weight): (usize, &f64)| {
            let scaled = entry(i).to_f64() * weight;
            scaled * scaled
        };
        let sum: f64 = self.weights.iter().enumerate().map(square).sum();
        (sum / self.weights.len().max(1) as f64).sqrt()
    }

    /// The norm of a matrix of `df_i/dx_j`, row after row, that goes with the largest component in these weights.
    pub(in crate::integrate) fn of_matrix<T: Scalar>(&self, matrix: &[T]) -> f64 {
        let rows = matrix.chunks_exact(self.weights.len().max(1)).zip(&self.weights);
        let sum = |(row, own): (&[T], &f64)| -> f64 {
            row.iter().zip(&self.weights).map(|(entry, weight)| entry.to_f64().abs() * own / weight).sum()
        };
        rows.map(sum).fold(0.0, f64::max)
    }

    /// The largest allowed error of component `i`.
    pub(in crate::integrate) fn allowed(&self, i: usize) -> f64 {
        1.0 / self.weights[i]
    }
}
