//! The samples of a run, and its errors against an exact solution.

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
    /// How rough the errors are from sample to sample; see [`jitter`].
    pub jitter: f64,
    /// The largest entry that was rounded to get there.
    pub scale: f64,
}

impl Errors {
    /// A run that has none to show, because it stopped.
    pub const NONE: Self = Self { transient: f64::NAN, steady: f64::NAN, jitter: 0.0, scale: 1.0 };

    /// The errors of `samples` against `exact(t, state)` at gap `sigma`, largest entry of each sample.
    pub(super) fn against(samples: &Samples, sigma: f64, exact: impl Fn(f64, &mut [f64])) -> Self {
        let steps = samples.steps();
        let mut errors = Self { transient: 0.0, steady: 0.0, jitter: 0.0, scale: 0.0 };
        let mut truth = vec![0.0; samples.dimension];
        let mut series = vec![Vec::with_capacity(steps / 2 + 1); samples.dimension];
        for n in 0..=steps {
            exact(n as f64 * sigma, &mut truth);
            for (i, (state, truth)) in samples.state(n).iter().zip(&truth).enumerate() {
                errors.observe(state - truth, 2 * n >= steps);
                errors.scale = errors.scale.max(truth.abs());
                if 2 * n >= steps {
                    series[i].push(state - truth);
                }
            }
        }
        errors.jitter = series.iter().filter_map(|series| jitter(series)).fold(0.0, f64::max);
        errors
    }

    fn observe(&mut self, error: f64, steady: bool) {
        // Written so that NaN stays.
        let larger = |most: f64, error: f64| if error.abs() <= most { most } else { error.abs() };
        self.transient = larger(self.transient, error);
        if steady {
            self.steady = larger(self.steady, error);
        }
    }
}
