//! The samples of a run, and its errors against an exact solution.

use super::measure::Measure;
use super::round_off::jitter;

/// The states of a run on a uniform grid, first sample first: `states[n * dimension + i]`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Samples {
    /// Entries of a state.
    pub dimension: usize,
    /// The states one after the other, the initial one included.
    pub states: Vec<f64>,
}

impl Samples {
    /// Number of steps between the first and the last sample.
    pub fn steps(&self) -> usize {
        (self.states.len() / self.dimension.max(1)).saturating_sub(1)
    }

    /// The state of sample `n`.
    pub(super) fn state(&self, n: usize) -> &[f64] {
        &self.states[n * self.dimension..(n + 1) * self.dimension]
    }
}

/// The errors of one run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Errors {
    /// The largest over the whole run, start-up included.
    pub transient: f64,
    /// The largest over its second half, where the start is forgotten.
    pub steady: f64,
    /// The largest entry at the last sample.
    pub end_point: f64,
    /// The root of the mean square over the samples.
    pub mean_square: f64,
    /// How rough the errors are from sample to sample; see [`jitter`].
    pub jitter: f64,
    /// The largest entry that was rounded to get there.
    pub scale: f64,
}

impl Errors {
    /// A run that has none to show, because it stopped.
    pub const NONE: Self = Self {
        transient: f64::NAN,
        steady: f64::NAN,
        end_point: f64::NAN,
        mean_square: f64::NAN,
        jitter: 0.0,
        scale: 1.0,
    };

    /// The number by which a measure sums them up.
    pub fn measured(&self, measure: Measure) -> f64 {
        match measure {
            Measure::Maximum => self.transient,
            Measure::Steady => self.steady,
            Measure::EndPoint => self.end_point,
            Measure::MeanSquare => self.mean_square,
        }
    }

    /// The errors of `samples` against `exact(t, state)` at gap `sigma`, largest entry of each sample.
    pub(super) fn against(samples: &Samples, sigma: f64, exact: impl Fn(f64, &mut [f64])) -> Self {
        let mut truth = vec![0.0; samples.dimension];
        let mut differences = Vec::with_capacity(samples.states.len());
        let mut scale = 0.0_f64;
        for n in 0..=samples.steps() {
            exact(n as f64 * sigma, &mut truth);
            scale = truth.iter().fold(scale, |most, entry| most.max(entry.abs()));
            differences.extend(samples.state(n).iter().zip(&truth).map(|(state, truth)| state - truth));
        }
        Self::of_differences(&differences, samples.dimension, scale)
    }

    /// The errors whose entries stand one sample after the other; `scale` is the largest entry of the solution.
    pub(super) fn of_differences(differences: &[f64], dimension: usize, scale: f64) -> Self {
        let steps = (differences.len() / dimension.max(1)).saturating_sub(1);
        let mut errors =
            Self { transient: 0.0, steady: 0.0, end_point: 0.0, mean_square: 0.0, jitter: 0.0, scale };
        for (n, sample) in differences.chunks_exact(dimension.max(1)).enumerate() {
            let size = sample.iter().fold(0.0, |most, entry| larger(most, *entry));
            errors.transient = larger(errors.transient, size);
            if 2 * n >= steps {
                errors.steady = larger(errors.steady, size);
            }
            errors.end_point = size;
            errors.mean_square += size * size;
        }
        errors.mean_square = (errors.mean_square / (steps + 1) as f64).sqrt();
        let settled = |i: usize| -> Vec<f64> {
            differences
                .iter()
                .skip(steps.div_ceil(2) * dimension + i)
                .step_by(dimension.max(1))
                .copied()
                .collect()
        };
        errors.jitter = (0..dimension).filter_map(|i| jitter(&settled(i))).fold(0.0, f64::max);
        errors
    }
}

/// The larger size of the two, written so that NaN stays.
pub(super) fn larger(most: f64, error: f64) -> f64 {
    if error.abs() <= most || most.is_nan() { most } else { error.abs() }
}
