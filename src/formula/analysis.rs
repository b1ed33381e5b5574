//! Everything that follows from the numbers of a row alone, whatever the row claims.

use std::sync::OnceLock;

use num_traits::Zero;

use crate::math::{Polynomial, Rational, RootCondition, rational_from_f64, root_condition, root_moduli};

use super::closed_form::{ClosedForm, closed_form};
use super::feedback_range::{ClosedLoop, FeedbackRange};
use super::noise::{NoiseGain, noise_gain};
use super::order::{Order, order_defect, order_of};
use super::radius::{Optimum, optimum, spectral_radius};
use super::radius_bound::is_radius_reached;
use super::ssp::ssp_coefficient;
use super::weights::Weights;

/// What the numbers of a row say: facts at once, figures when first asked for.
///
/// A row that is inconsistent has no order, no error constant and no closed loop, but still roots.
#[derive(Debug, Clone)]
pub struct Analysis {
    weights: Weights,
    rho: Polynomial,
    order: Option<Order>,
    feedback_order: Option<usize>,
    root_condition: RootCondition,
    /// `None` for a row that is inconsistent or whose gamma sums to zero.
    closed_loop: Option<ClosedLoop>,
    moduli: OnceLock<Vec<f64>>,
    range: OnceLock<Option<FeedbackRange>>,
    optimum: OnceLock<Option<Optimum>>,
}

impl Analysis {
    pub(crate) fn of(weights: Weights) -> Self {
        let rho = Polynomial::from_rationals_descending(&weights.alpha);
        let order = order_of(&weights.alpha, &weights.beta);
        let gamma_sum: Rational = weights.gamma.iter().sum();
        let closed_loop = (order.is_some() && !gamma_sum.is_zero())
            .then(|| ClosedLoop::new(&weights.alpha, &weights.gamma));
        Self {
            root_condition: root_condition(&rho),
            feedback_order: order_of(&weights.alpha, &weights.gamma).map(|order| order.order),
            rho,
            order,
            closed_loop,
            weights,
            moduli: OnceLock::new(),
            range: OnceLock::new(),
            optimum: OnceLock::new(),
        }
    }

    /// Returns alpha_0 = 1, alpha_1, ..., alpha_s: the weights of the states, newest sample first.
    pub fn alpha(&self) -> &[Rational] {
        &self.weights.alpha
    }

    /// Returns beta_0, ..., beta_s: the weights of f, newest sample first.
    pub fn beta(&self) -> &[Rational] {
        &self.weights.beta
    }

    /// Returns gamma_0, ..., gamma_s: the weights of g, newest sample first; beta unless the row says otherwise.
    pub fn gamma(&self) -> &[Rational] {
        &self.weights.gamma
    }

    /// Returns the number of steps s: how many past states the row needs.
    pub fn steps(&self) -> usize {
        self.weights.alpha.len() - 1
    }

    /// Returns rho(z) = sum_j alpha_j z^(s-j) as a primitive integer polynomial.
    pub fn rho(&self) -> &Polynomial {
        &self.rho
    }

    /// Returns the order p of (alpha, beta), `None` for an inconsistent row.
    pub fn order(&self) -> Option<usize> {
        self.order.as_ref().map(|order| order.order)
    }

    /// Returns C = E_(p+1)/(p+1)!, the error of one step in units of sigma^(p+1) x^(p+1).
    pub fn per_step_constant(&self) -> Option<&Rational> {
        self.order.as_ref().map(|order| &order.per_step)
    }

    /// Returns c = C/beta(1), the constant that rows declare.
    pub fn error_constant(&self) -> Option<Rational> {
        self.per_step_constant().map(|per_step| per_step / self.weights.beta.iter().sum::<Rational>())
    }

    /// Returns the order of the pair (alpha, gamma), `None` where that pair is not consistent.
    ///
    /// Feedback only needs gamma(1) to differ from zero; integrating x' = f + g in two parts needs this order too.
    pub fn feedback_order(&self) -> Option<usize> {
        self.feedback_order
    }

    /// Returns the order defect E_q of (alpha, beta): zero for q = 0 and 1 in a consistent row.
    pub fn order_defect(&self, q: usize) -> Rational {
        order_defect(&self.weights.alpha, &self.weights.beta, q)
    }

    /// Returns the sum of gamma, which scales the feedback step: h = sigma k gamma(1).
    pub fn gamma_sum(&self) -> Rational {
        self.weights.gamma.iter().sum()
    }

    /// Returns whether neither f nor g of the new state is needed.
    pub fn is_explicit(&self) -> bool {
        self.weights.beta[0].is_zero() && self.weights.gamma[0].is_zero()
    }

    /// Returns whether feedback has weights of its own.
    pub fn is_split(&self) -> bool {
        self.weights.beta != self.weights.gamma
    }

    /// Returns the verdict of the root condition on rho, exact.
    pub fn root_condition(&self) -> RootCondition {
        self.root_condition
    }

    /// Returns whether all roots of rho are in the closed unit disc and those on the circle simple.
    pub fn is_zero_stable(&self) -> bool {
        self.root_condition != RootCondition::Unstable
    }

    /// Returns whether all roots of rho are inside the unit circle but for a simple one at z = 1.
    pub fn is_strictly_zero_stable(&self) -> bool {
        self.root_condition == RootCondition::StrictlyStable
    }

    /// Returns the moduli of the roots of rho, largest first.
    pub fn root_moduli(&self) -> &[f64] {
        self.moduli.get_or_init(|| root_moduli(&self.rho))
    }

    /// Whether the row is consistent and its gamma does not cancel.
    pub(crate) fn has_closed_loop(&self) -> bool {
        self.closed_loop.is_some()
    }

    /// Returns the feedback range (0, h_max), exact; `None` for a row without a closed loop.
    pub fn feedback_range(&self) -> Option<&FeedbackRange> {
        self.range.get_or_init(|| self.closed_loop.as_ref().map(FeedbackRange::of)).as_ref()
    }

    /// Returns the feedback step of least spectral radius inside the feedback range, `None` where there is none.
    pub fn optimum(&self) -> Option<Optimum> {
        *self.optimum.get_or_init(|| optimum(self.closed_loop.as_ref()?, self.feedback_range()?))
    }

    /// Returns h_opt and r_opt^2 as algebraic numbers, found by elimination; `None` without an optimum or where the
    /// elimination is out of reach (long rows). Computed anew at every call.
    pub fn closed_form(&self) -> Option<ClosedForm> {
        closed_form(self.closed_loop.as_ref()?, self.feedback_range()?, self.optimum()?)
    }

    /// Returns a radius, a billionth part below that of the optimum, which provably no h of the feedback range reaches.
    ///
    /// `None` without an optimum and for rows of more than 16 steps. Computed anew at every call.
    pub fn radius_bound(&self) -> Option<f64> {
        const MARGIN: f64 = 1e-9;
        const MOST_STEPS: usize = 16;
        let radius = self.optimum()?.radius * (1.0 - MARGIN);
        let (closed_loop, range) = (self.closed_loop.as_ref()?, self.feedback_range()?);
        let is_proved = radius < MARGIN
            || self.steps() <= MOST_STEPS
                && !is_radius_reached(closed_loop, range, &rational_from_f64(radius)?);
        is_proved.then_some(radius)
    }

    /// Returns the coefficient of strong stability preservation of (alpha, beta), `None` where there is none.
    pub fn ssp_coefficient(&self) -> Option<Rational> {
        ssp_coefficient(&self.weights.alpha, &self.weights.beta)
    }

    /// The loop whose roots the pictures show.
    pub(crate) fn closed_loop(&self) -> Option<&ClosedLoop> {
        self.closed_loop.as_ref()
    }

    /// Returns the spectral radius of the closed loop at h; NaN where there is no loop or h is not finite.
    pub fn spectral_radius(&self, h: f64) -> f64 {
        self.closed_loop.as_ref().map_or(f64::NAN, |closed_loop| spectral_radius(closed_loop, h))
    }

    /// Returns the noise gains of the closed loop at h, `None` where the loop is not strictly stable.
    pub fn noise_gain(&self, h: f64) -> Option<NoiseGain> {
        noise_gain(&self.weights, self.closed_loop.as_ref()?, h)
    }
}
