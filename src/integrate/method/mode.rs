use std::num::NonZeroUsize;

/// What a predictor-corrector pair does at each step: P predicts, E evaluates the field, C corrects.
///
/// With the prediction `x^0` and everything that the corrector takes from the past in `known`, a correction is
/// `x^(k+1) = known + sigma beta_0 f(t_{n+1}, x^k) + sigma gamma_0 g(t_{n+1}, x^k)`.
/// (Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I, section III.1; Lambert, Numerical Methods for
/// Ordinary Differential Systems, chapter 4.)
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// PEC: one evaluation for each step, of the prediction; the past remembers that one.
    Pec,
    /// PECE: one correction; the past remembers the evaluation of the corrected state.
    Pece,
    /// P(EC)^m E: this many corrections; the past remembers the evaluation of the last one. One correction is PECE.
    Repeated(NonZeroUsize),
    /// The corrector's equation is solved, from the prediction as first guess: the method is the corrector, and the prediction
    /// tells the error.
    Solved,
}

impl Mode {
    /// Returns the number of corrections, `None` where the equation is solved.
    pub fn corrections(self) -> Option<usize> {
        match self {
            Self::Pec | Self::Pece => Some(1),
            Self::Repeated(corrections) => Some(corrections.get()),
            Self::Solved => None,
        }
    }

    /// Returns whether the evaluation of the new state that the past remembers is that of the prediction.
    pub(in crate::integrate) fn keeps_evaluation_of_prediction(self) -> bool {
        self == Self::Pec
    }
}
