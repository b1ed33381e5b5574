use super::coefficients::Coefficients;
use super::ratio::{RatioCoefficients, RatioRow};
use super::weights::Weights;
use crate::integrate::history::Times;
use crate::math::Scalar;
use std::sync::Arc;

/// A row with its weights, which follow the steps where the coefficients do.
#[derive(Clone, Debug)]
pub(in crate::integrate) struct WeightedRow<T> {
    pub(in crate::integrate) weights: Weights<T>,
    /// What the weights are computed of; nothing at equal steps.
    varying: Option<Varying<T>>,
    /// C of the local error `C sigma^(p+1) x^(p+1)`.
    pub(in crate::integrate) per_step_constant: T,
}

/// Coefficients that depend on the ratios of steps, with the memory that they are written to.
#[derive(Clone, Debug)]
struct Varying<T> {
    row: Arc<dyn RatioCoefficients<T>>,
    ratios: Vec<T>,
    alpha: Vec<T>,
    beta: Vec<T>,
    gamma: Vec<T>,
}

impl<T: Scalar> WeightedRow<T> {
    /// The row at the step `sigma`.
    pub(in crate::integrate) fn new(coefficients: &Coefficients<T>, sigma: T) -> Self {
        match coefficients {
            Coefficients::Fixed(formula) => Self {
                weights: Weights::of(formula, sigma),
                varying: None,
                per_step_constant: T::from_rational(formula.per_step_constant()),
            },
            Coefficients::Ratio(row) => Self {
                weights: Weights::with_room_for(row.steps()),
                per_step_constant: T::zero(),
                varying: Some(Varying::new(Arc::clone(row))),
            },
        }
    }

    /// Computes the weights for the step that is to follow.
    #[inline]
    pub(in crate::integrate) fn adapt(&mut self, times: &Times<T>) {
        if self.varying.is_some() {
            self.rewrite(times);
        }
    }

    /// Apart, so that rows of equal steps pay for a comparison only.
    #[cold]
    fn rewrite(&mut self, times: &Times<T>) {
        if let Some(varying) = &mut self.varying {
            varying.write(times, &mut self.weights);
            self.per_step_constant = varying.row.per_step_constant(&varying.ratios);
        }
    }

    /// How many samples of `f` and of `g` the row looks back to, itself given or to be computed.
    pub(in crate::integrate) fn depths(&self) -> (usize, usize) {
        match &self.varying {
            None => (self.weights.first.depth(), self.weights.second.depth()),
            Some(varying) => (varying.row.steps(), varying.row.steps()),
        }
    }

    /// Whether the other one makes the same of the same history.
    pub(in crate::integrate) fn is_like(&self, other: &Self) -> bool {
        self.varying.is_none() && other.varying.is_none() && self.weights == other.weights
    }
}

impl<T: Scalar> Varying<T> {
    fn new(row: Arc<dyn RatioCoefficients<T>>) -> Self {
        let zeros = |length| vec![T::zero(); length];
        let steps = row.steps();
        Self {
            row,
            ratios: zeros(steps.saturating_sub(1)),
            alpha: zeros(steps + 1),
            beta: zeros(steps + 1),
            gamma: zeros(steps + 1),
        }
    }

    fn write(&mut self, times: &Times<T>, weights: &mut Weights<T>) {
        times.write_ratios(&mut self.ratios);
        for list in [&mut self.alpha, &mut self.beta, &mut self.gamma] {
            list.fill(T::zero());
        }
        self.row.write(&self.ratios, lent(&mut self.alpha, &mut self.beta, &mut self.gamma));
        if !self.row.is_split() {
            self.gamma.copy_from_slice(&self.beta);
        }
        weights.write(&lent(&mut self.alpha, &mut self.beta, &mut self.gamma), times.step());
    }
}

fn lent<'a, T>(alpha: &'a mut [T], beta: &'a mut [T], gamma: &'a mut [T]) -> RatioRow<'a, T> {
    RatioRow { alpha, beta, gamma }
}
