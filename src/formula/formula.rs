//! A formula: a row whose every claim has been checked.

use crate::math::{Rational, RootCondition};

use super::analysis::Analysis;
use super::error::NotRunnable;
use super::feedback_range::FeedbackRange;
use super::noise::NoiseGain;
use super::radius::Optimum;
use super::row::Row;
use super::weights::Weights;

/// A multistep formula
/// sum_j alpha_j x_(n+1-j) = sigma sum_j beta_j f_(n+1-j) + sigma sum_j gamma_j g_(n+1-j)
/// of exact fractions, consistent and in agreement with everything its row declares.
///
/// Index j is time n+1-j: **newest sample first** (not the ascending order of Hairer, Norsett and Wanner).
///
/// ```
/// use kinstep::formula::FormulaTable;
/// let formula = FormulaTable::builtin().get("la6-wang-guo")?;
/// assert_eq!(formula.order(), 3);
/// assert_eq!(formula.error_constant().to_string(), "5/16");
/// assert_eq!(formula.feedback_range().to_string(), "(0, 2/3)");
/// # Ok::<(), kinstep::formula::UnknownFormula>(())
/// ```
#[derive(Debug, Clone)]
pub struct Formula {
    row: Row,
    analysis: Analysis,
    order: usize,
    error_constant: Rational,
    per_step_constant: Rational,
}

impl Formula {
    /// Returns the formula of a row without contradictions.
    pub(crate) fn from_checked(row: Row, analysis: Analysis) -> Option<Self> {
        let order = analysis.order()?;
        let error_constant = analysis.error_constant()?;
        let per_step_constant = analysis.per_step_constant()?.clone();
        if !analysis.has_closed_loop() {
            return None;
        }
        Some(Self { row, analysis, order, error_constant, per_step_constant })
    }

    /// Returns the id, by which tables, scenarios and the command line find the formula.
    pub fn id(&self) -> &str {
        &self.row.id
    }

    /// Returns the name for people; the id where the row gives none.
    pub fn name(&self) -> &str {
        self.row.name.as_deref().unwrap_or(&self.row.id)
    }

    /// Returns the family, such as `look-ahead` or `adams-bashforth`; `other` where the row gives none.
    pub fn family(&self) -> &str {
        self.row.family.as_deref().unwrap_or("other")
    }

    /// Returns where the coefficients are from: a key of the bibliography and a place; empty where the row gives none.
    pub fn source(&self) -> &str {
        self.row.source.as_deref().unwrap_or_default()
    }

    /// Returns how the source was consulted, such as `read` or `recalled`.
    pub fn attribution(&self) -> Option<&str> {
        self.row.attribution.as_deref()
    }

    /// Returns the remark of the row.
    pub fn note(&self) -> Option<&str> {
        self.row.note.as_deref()
    }

    /// Returns the row as it was written.
    pub fn row(&self) -> &Row {
        &self.row
    }

    /// Returns everything that follows from the numbers alone.
    pub fn analysis(&self) -> &Analysis {
        &self.analysis
    }

    /// Returns alpha_0 = 1, ..., alpha_s: the weights of the states, newest sample first.
    pub fn alpha(&self) -> &[Rational] {
        self.analysis.alpha()
    }

    /// Returns beta_0, ..., beta_s: the weights of f, newest sample first.
    pub fn beta(&self) -> &[Rational] {
        self.analysis.beta()
    }

    /// Returns gamma_0, ..., gamma_s: the weights of g, newest sample first.
    pub fn gamma(&self) -> &[Rational] {
        self.analysis.gamma()
    }

    /// Returns the sum of gamma, never zero: h = sigma k gamma(1).
    pub fn gamma_sum(&self) -> Rational {
        self.analysis.gamma_sum()
    }

    /// Returns the number of steps s: how many past states are needed.
    pub fn steps(&self) -> usize {
        self.analysis.steps()
    }

    /// Returns the order p of (alpha, beta).
    pub fn order(&self) -> usize {
        self.order
    }

    /// Returns c of x'(t_n) = formula - c sigma^p x^(p+1) + ..., that is E_(p+1)/((p+1)! beta(1)).
    pub fn error_constant(&self) -> &Rational {
        &self.error_constant
    }

    /// Returns C = c beta(1): a step errs by C sigma^(p+1) x^(p+1), and the steady residual is about C/h times that.
    pub fn per_step_constant(&self) -> &Rational {
        &self.per_step_constant
    }

    /// Returns whether neither f nor g of the new state is needed.
    pub fn is_explicit(&self) -> bool {
        self.analysis.is_explicit()
    }

    /// Returns whether feedback has weights of its own.
    pub fn is_split(&self) -> bool {
        self.analysis.is_split()
    }

    /// Returns the verdict of the root condition, decided exactly.
    pub fn root_condition(&self) -> RootCondition {
        self.analysis.root_condition()
    }

    /// Returns whether the root condition holds: all roots of rho in the closed unit disc, those on the circle simple.
    pub fn is_zero_stable(&self) -> bool {
        self.analysis.is_zero_stable()
    }

    /// Returns whether all roots of rho are inside the unit circle but for a simple one at z = 1.
    pub fn is_strictly_zero_stable(&self) -> bool {
        self.analysis.is_strictly_zero_stable()
    }

    /// Returns the moduli of the roots of rho, largest first.
    pub fn root_moduli(&self) -> Vec<f64> {
        self.analysis.root_moduli().to_vec()
    }

    /// Returns the interval (0, h_max) of feedback steps with a stable closed loop, decided exactly.
    ///
    /// # Panics
    /// Never: a formula is only made of a row that has a closed loop.
    pub fn feedback_range(&self) -> &FeedbackRange {
        self.analysis.feedback_range().expect("a formula is only made of a row that has a closed loop")
    }

    /// Returns the feedback step with the least spectral radius in the range, `None` where there is none.
    pub fn optimum(&self) -> Option<Optimum> {
        self.analysis.optimum()
    }

    /// Returns the spectral radius r(h) of the closed loop: residuals decay like r^n; NaN where h is not finite.
    pub fn spectral_radius(&self, h: f64) -> f64 {
        self.analysis.spectral_radius(h)
    }

    /// Returns what the closed loop makes of noise at h, `None` where it is not strictly stable.
    pub fn noise_gain(&self, h: f64) -> Option<NoiseGain> {
        self.analysis.noise_gain(h)
    }

    /// Returns the order of the pair (alpha, gamma), `None` where that pair alone is not consistent.
    pub fn feedback_order(&self) -> Option<usize> {
        self.analysis.feedback_order()
    }

    /// Returns the analysis of the pair (alpha, beta) alone, as if the feedback part were weighted by beta too.
    ///
    /// Its feedback range bounds what the feedforward part of a split formula can follow explicitly.
    pub fn without_split(&self) -> Analysis {
        let (alpha, beta) = (self.alpha().to_vec(), self.beta().to_vec());
        Analysis::of(Weights { alpha, gamma: beta.clone(), beta })
    }

    /// Says whether the explicit stepper may run this formula on x' = f.
    ///
    /// # Errors
    /// [`NotRunnable`] for a formula that is not zero-stable or that is implicit.
    pub fn runnable(&self) -> Result<(), NotRunnable> {
        let id = self.id().to_owned();
        if !self.is_zero_stable() {
            let modulus = self.analysis.root_moduli().first().copied().unwrap_or(f64::NAN);
            return Err(NotRunnable::Unstable { id, modulus });
        }
        if !self.is_explicit() {
            return Err(NotRunnable::Implicit { id });
        }
        Ok(())
    }

    /// Says whether the explicit stepper may run this formula with feedback, as a controller does.
    ///
    /// # Errors
    /// As [`Formula::runnable`], and for a weakly stable formula, which no feedback step makes stable.
    pub fn runnable_with_feedback(&self) -> Result<(), NotRunnable> {
        self.runnable()?;
        if self.root_condition() == RootCondition::WeaklyStable && self.feedback_range().is_empty() {
            return Err(NotRunnable::WeaklyStable { id: self.id().to_owned() });
        }
        Ok(())
    }
}
