//! The sampling gaps of a study.

use num_integer::Integer;
use thiserror::Error;

/// One run of a study.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rung {
    /// Steps of the run.
    pub steps: usize,
    /// The sampling gap \[s\]: the duration over the steps.
    pub sigma: f64,
}

/// Why a ladder could not be made.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum LadderError {
    /// The duration is not a positive number.
    #[error("the duration of a ladder is {value} s; it must be a positive number")]
    Duration {
        /// What was given \[s\].
        value: f64,
    },
    /// A gap is not positive, or longer than the duration.
    #[error("sigma is {value} s; it must be positive and at most the duration, {duration} s")]
    Sigma {
        /// What was given \[s\].
        value: f64,
        /// The duration \[s\].
        duration: f64,
    },
    /// A gap would need a shortened last step.
    #[error(
        "sigma = {value} s does not divide the duration {duration} s, and a shortened last step would spoil the order; the nearest that does is {nearest} s"
    )]
    DoesNotDivide {
        /// What was given \[s\].
        value: f64,
        /// The duration \[s\].
        duration: f64,
        /// The nearest gap that divides it \[s\].
        nearest: f64,
    },
    /// The gaps do not become finer from rung to rung.
    #[error(
        "the ladder goes from {coarser} to {finer} steps; write the coarsest gap first and each finer than the last"
    )]
    NotDescending {
        /// Steps of a rung.
        coarser: usize,
        /// Steps of the next one.
        finer: usize,
    },
    /// There is no rung, or one without steps.
    #[error("a ladder needs at least one rung, and every rung at least one step")]
    Empty,
}

/// Sampling gaps from coarse to fine, each a whole fraction of one duration: `sigma = T / N`, time by index, no
/// shortened last step.
///
/// ```
/// use kinstep_study::Ladder;
/// let ladder = Ladder::halvings(10.0, 250, 4)?;
/// assert_eq!(ladder.sigmas(), [0.04, 0.02, 0.01, 0.005]);
/// assert!(Ladder::from_sigmas(10.0, &[0.03]).is_err());
/// # Ok::<(), kinstep_study::LadderError>(())
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Ladder {
    duration: f64,
    steps: Vec<usize>,
}

impl Ladder {
    /// The ladder of these numbers of steps over `duration` \[s\].
    ///
    /// # Errors
    /// [`LadderError`]: no rung, a rung without steps, steps that do not increase, an unusable duration.
    pub fn from_steps(duration: f64, steps: impl IntoIterator<Item = usize>) -> Result<Self, LadderError> {
        if !(duration > 0.0 && duration.is_finite()) {
            return Err(LadderError::Duration { value: duration });
        }
        let steps: Vec<usize> = steps.into_iter().collect();
        if steps.first().is_none_or(|&first| first == 0) {
            return Err(LadderError::Empty);
        }
        if let Some(pair) = steps.windows(2).find(|pair| pair[0] >= pair[1]) {
            return Err(LadderError::NotDescending { coarser: pair[0], finer: pair[1] });
        }
        Ok(Self { duration, steps })
    }

    /// The ladder of these gaps \[s\], coarsest first.
    ///
    /// # Errors
    /// [`LadderError`]: as [`from_steps`](Self::from_steps), and for a gap that does not divide the duration.
    pub fn from_sigmas(duration: f64, sigmas: &[f64]) -> Result<Self, LadderError> {
        let steps = sigmas.iter().map(|&sigma| steps_of(duration, sigma)).collect::<Result<Vec<_>, _>>()?;
        Self::from_steps(duration, steps)
    }

    /// `rungs` rungs over `duration` \[s\], the coarsest of `coarsest` steps, each half the gap of the one before.
    ///
    /// # Errors
    /// [`LadderError`]: no rung, no steps, an unusable duration.
    pub fn halvings(duration: f64, coarsest: usize, rungs: usize) -> Result<Self, LadderError> {
        Self::from_steps(duration, (0..rungs).map(|k| coarsest.saturating_mul(1 << k.min(60))))
    }

    /// `rungs` rungs whose steps are `coarsest` times 1, 3/2, 2, 3, 4, 6, ...: narrower pairs than halvings, for high
    /// orders, which pass from coarse to the round-off floor within few of those. `coarsest` is made even.
    ///
    /// # Errors
    /// [`LadderError`]: no rung, no steps, an unusable duration.
    pub fn half_octaves(duration: f64, coarsest: usize, rungs: usize) -> Result<Self, LadderError> {
        let half = coarsest.div_ceil(2);
        let steps = (0..rungs).map(|k| half.saturating_mul((2 + k % 2) << (k / 2).min(60)));
        Self::from_steps(duration, steps)
    }

    /// How long every run takes \[s\].
    pub fn duration(&self) -> f64 {
        self.duration
    }

    /// The rungs, coarsest first.
    pub fn rungs(&self) -> impl ExactSizeIterator<Item = Rung> {
        self.steps.iter().map(|&steps| self.rung(steps))
    }

    /// The gaps \[s\], coarsest first.
    pub fn sigmas(&self) -> Vec<f64> {
        self.rungs().map(|rung| rung.sigma).collect()
    }

    /// The coarsest run with a sample at every time at which some rung has one; nothing where it would have more than
    /// 2^40 steps.
    pub fn common(&self) -> Option<Rung> {
        const MOST: usize = 1 << 40;
        let join = |common: usize, steps: &usize| {
            (common / common.gcd(steps)).checked_mul(*steps).filter(|&common| common <= MOST)
        };
        self.steps.iter().try_fold(1, join).map(|steps| self.rung(steps))
    }

    /// The run of that many steps over the same duration.
    pub(super) fn rung(&self, steps: usize) -> Rung {
        Rung { steps, sigma: self.duration / steps as f64 }
    }
}

fn steps_of(duration: f64, sigma: f64) -> Result<usize, LadderError> {
    if !(sigma > 0.0 && sigma <= duration) {
        return Err(LadderError::Sigma { value: sigma, duration });
    }
    let (exact, whole) = (duration / sigma, (duration / sigma).round());
    if (exact - whole).abs() <= 1e-9 * whole {
        return Ok(whole as usize);
    }
    Err(LadderError::DoesNotDivide { value: sigma, duration, nearest: duration / whole })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn refuses_gaps_that_would_shorten_the_last_step() {
        let error = Ladder::from_sigmas(1.0, &[0.3]).unwrap_err();
        assert!(error.to_string().contains("shortened last step"), "{error}");
        assert!(matches!(Ladder::from_sigmas(1.0, &[0.0]), Err(LadderError::Sigma { .. })));
        assert!(matches!(Ladder::from_sigmas(1.0, &[f64::NAN]), Err(LadderError::Sigma { .. })));
        assert!(matches!(Ladder::from_sigmas(f64::NAN, &[0.1]), Err(LadderError::Sigma { .. })));
        assert!(matches!(Ladder::halvings(0.0, 10, 3), Err(LadderError::Duration { .. })));
    }

    #[test]
    fn refuses_ladders_without_rungs_or_order() {
        assert_eq!(Ladder::halvings(1.0, 10, 0), Err(LadderError::Empty));
        assert_eq!(Ladder::halvings(1.0, 0, 2), Err(LadderError::Empty));
        assert!(matches!(Ladder::from_steps(1.0, [8, 8]), Err(LadderError::NotDescending { .. })));
    }

    #[test]
    fn half_octaves_meet_on_a_common_grid() {
        let ladder = Ladder::half_octaves(2.0, 16, 5).unwrap();
        assert_eq!(ladder.rungs().map(|rung| rung.steps).collect::<Vec<_>>(), [16, 24, 32, 48, 64]);
        assert_eq!(ladder.common().unwrap().steps, 192);
        let primes = [99_991, 99_989, 99_971, 99_961].into_iter().rev();
        assert_eq!(Ladder::from_steps(2.0, primes).unwrap().common(), None);
    }
}
