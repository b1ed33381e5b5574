use crate::integrate::affine::{Affine, Solved};
use crate::integrate::coefficients::{WeightedRow, combine};
use crate::integrate::field::{Field, Parts};
use crate::integrate::history::{BLOCK, History};
use crate::integrate::method::{Method, Mode};
use crate::integrate::solve::Iteration;
use crate::integrate::status::Status;
use crate::math::Scalar;
use fearless_simd::Level;

/// How a candidate becomes the next state in methods that are not explicit, with the memory for it.
#[derive(Clone, Debug)]
pub(super) struct Correction<T> {
    /// The second row of a pair; nothing where the first row is solved.
    pub(super) corrector: Option<Corrector<T>>,
    /// What the past contributes to the next state.
    known: Vec<[T; BLOCK]>,
    prediction: Vec<[T; BLOCK]>,
    /// The last evaluation at the new time.
    f: Vec<T>,
    g: Vec<T>,
    error: Vec<T>,
    /// Whether the last step was made by a pair, which tells its error.
    has_error: bool,
    iteration: Iteration<T>,
}

/// The row that corrects, and how often.
#[derive(Clone, Debug)]
pub(super) struct Corrector<T> {
    pub(super) row: WeightedRow<T>,
    pub(super) mode: Mode,
    /// Whether the predictor has the same order, so that the two error constants tell the errors apart.
    has_order_of_predictor: bool,
}

impl<T: Scalar> Correction<T> {
    /// What a method needs to correct; nothing for an explicit one.
    pub(super) fn new(method: &Method<T>, field: &impl Field<T>, sigma: T) -> Option<Self> {
        let corrector = match method {
            Method::Explicit(_) => return None,
            Method::Implicit(_) | Method::Imex(_) => None,
            Method::PredictorCorrector { predictor, corrector, mode } => Some(Corrector {
                row: WeightedRow::new(corrector, sigma),
                mode: *mode,
                has_order_of_predictor: predictor.order() == corrector.order(),
            }),
        };
        Some(Self::for_dimension(corrector, field.dimension(), field.parts() != Parts::One))
    }

    /// The same for states of another length.
    pub(super) fn resized(&self, dimension: usize) -> Self {
        Self::for_dimension(self.corrector.clone(), dimension, !self.g.is_empty())
    }

    fn for_dimension(corrector: Option<Corrector<T>>, dimension: usize, has_second: bool) -> Self {
        let blocks = || vec![[T::zero(); BLOCK]; dimension.div_ceil(BLOCK)];
        let vector = |length| vec![T::zero(); length];
        Self {
            corrector,
            known: blocks(),
            prediction: blocks(),
            f: vector(dimension),
            g: vector(if has_second { dimension } else { 0 }),
            error: vector(dimension),
            has_error: false,
            iteration: Iteration::new(dimension, has_second),
        }
    }

    /// The estimate of the error of the last step, where it was made by a pair.
    pub(super) fn error(&self) -> Option<&[T]> {
        self.has_error.then_some(&self.error)
    }

    /// The evaluation that the past remembers of the new state, where it is not that of the state itself.
    pub(super) fn kept_evaluation(&self) -> Option<(&[T], &[T])> {
        let corrector = self.corrector.as_ref().filter(|_| self.has_error)?;
        corrector.mode.keeps_evaluation_of_prediction().then_some((&self.f, &self.g))
    }

    /// Leaves a candidate that was made without this as it is.
    pub(super) fn pass(&mut self) -> Status {
        self.has_error = false;
        Status::Running
    }

    /// Solves for the candidate, which holds what the past contributes to it, at the time `t`; `new` multiplies both parts of the
    /// field there, and `newest` is the first guess.
    pub(super) fn solve(
        &mut self,
        field: &mut impl Field<T>,
        t: T,
        new: [T; 2],
        newest: &[T],
        candidate: &mut [[T; BLOCK]],
    ) -> Status {
        self.has_error = false;
        self.known.copy_from_slice(candidate);
        candidate.as_flattened_mut()[..newest.len()].copy_from_slice(newest);
        self.solve_from(field, t, new, candidate)
    }

    /// Corrects a candidate that was predicted by a row with the error constant `predictor_constant`.
    pub(super) fn correct(
        &mut self,
        field: &mut impl Field<T>,
        level: Level,
        history: &History<T>,
        predictor_constant: T,
        candidate: &mut [[T; BLOCK]],
    ) -> Status {
        let Some(corrector) = &mut self.corrector else { return Status::Running };
        corrector.row.adapt(&history.times);
        let (mode, new) = (corrector.mode, corrector.row.weights.new);
        let factor = corrector.error_factor(predictor_constant);
        combine(level, &corrector.row.weights, history, &mut self.known);
        self.prediction.copy_from_slice(candidate);
        let t = history.times.next();
        let status = match mode.corrections() {
            Some(corrections) => self.repeat(field, t, new, corrections, candidate),
            None => self.solve_from(field, t, new, candidate),
        };
        self.estimate_error(factor, candidate);
        status
    }

    /// Evaluates and corrects so many times.
    fn repeat(
        &mut self,
        field: &mut impl Field<T>,
        t: T,
        new: [T; 2],
        corrections: usize,
        candidate: &mut [[T; BLOCK]],
    ) -> Status {
        let candidate = &mut candidate.as_flattened_mut()[..self.f.len()];
        for _ in 0..corrections {
            field.evaluate(t, candidate, &mut self.f, &mut self.g);
            for (i, entry) in candidate.iter_mut().enumerate() {
                *entry = self.known.as_flattened()[i] + new[0] * self.f[i];
                if let Some(&g) = self.g.get(i) {
                    *entry += new[1] * g;
                }
            }
        }
        Status::of_finite(candidate)
    }

    /// Solves with what is known, from the candidate as first guess.
    fn solve_from(
        &mut self,
        field: &mut impl Field<T>,
        t: T,
        [first, second]: [T; 2],
        candidate: &mut [[T; BLOCK]],
    ) -> Status {
        let x = &mut candidate.as_flattened_mut()[..self.f.len()];
        let known = &self.known.as_flattened()[..self.f.len()];
        let second = if self.g.is_empty() { T::zero() } else { second };
        let next = Affine { known, first, second };
        let solved = match field.solve(t, next, x) {
            Solved::NotOffered => self.iteration.solve(field, t, next, x),
            solved => solved,
        };
        if solved == Solved::Converged { Status::of_finite(x) } else { Status::NotSolved }
    }

    /// Milne's estimate: `factor` times the difference of corrected and predicted state.
    fn estimate_error(&mut self, factor: T, candidate: &[[T; BLOCK]]) {
        let pairs = candidate.as_flattened().iter().zip(self.prediction.as_flattened());
        for (error, (&corrected, &predicted)) in self.error.iter_mut().zip(pairs) {
            *error = factor * (corrected - predicted);
        }
        self.has_error = true;
    }
}

impl<T: Scalar> Corrector<T> {
    /// What the difference of corrected and predicted state is multiplied by to be the error of a step.
    ///
    /// The predicted state errs by `C_P sigma^(p+1) x^(p+1)`, the corrected one by `C_C sigma^(p+1) x^(p+1)`, so the latter is
    /// `C_C / (C_P - C_C)` times their difference (Milne 1926; Lambert, Numerical Methods for Ordinary Differential Systems,
    /// section 4.3). With different orders the difference itself is the error of the lower one.
    fn error_factor(&self, predictor_constant: T) -> T {
        let (predictor, corrector) = (predictor_constant, self.row.per_step_constant);
        let tells_apart = self.has_order_of_predictor && predictor != corrector;
        if tells_apart { corrector / (predictor - corrector) } else { T::one() }
    }
}
