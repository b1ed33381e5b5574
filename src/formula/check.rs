//! The one door from a row to a formula.

use num_traits::Zero;

use crate::math::Rational;

use super::analysis::Analysis;
use super::error::{Contradiction, Defect, DefectKind, Place};
use super::formula::Formula;
use super::row::{Places, Row};

/// A row with what its numbers say, and what contradicts it there.
#[derive(Debug, Clone)]
pub struct CheckedRow {
    row: Row,
    analysis: Analysis,
    contradictions: Vec<Contradiction>,
}

impl Row {
    /// Returns the row with everything that its numbers say, and every contradiction between the two.
    pub fn check(self) -> CheckedRow {
        let analysis = Analysis::of(self.weights());
        let contradictions = contradictions(&self, &analysis);
        CheckedRow { row: self, analysis, contradictions }
    }
}

impl CheckedRow {
    /// Returns the row as written.
    pub fn row(&self) -> &Row {
        &self.row
    }

    /// Returns what the row's numbers say.
    pub fn analysis(&self) -> &Analysis {
        &self.analysis
    }

    /// Returns every contradiction, with both values; none for a row that may become a formula.
    pub fn contradictions(&self) -> &[Contradiction] {
        &self.contradictions
    }

    /// Returns the formula that the row is, where nothing contradicts it.
    ///
    /// # Errors
    /// The contradictions, as defects at the place of the row.
    pub fn into_formula(self) -> Result<Formula, Vec<Defect>> {
        if self.contradictions.is_empty()
            && let Some(formula) = Formula::from_checked(self.row.clone(), self.analysis)
        {
            return Ok(formula);
        }
        let defect = |contradiction: Contradiction| Defect {
            place: place_of(&contradiction, &self.row.places),
            row: Some(self.row.id.clone()),
            kind: DefectKind::Contradicted(Box::new(contradiction)),
        };
        Err(self.contradictions.into_iter().map(defect).collect())
    }
}

/// The part of the row that a contradiction is about.
fn place_of(contradiction: &Contradiction, places: &Places) -> Place {
    match contradiction {
        Contradiction::Order { .. } | Contradiction::BeyondDahlquistBarrier { .. } => places.order,
        Contradiction::ErrorConstant { .. } => places.error_constant,
        Contradiction::ZeroStability { .. } => places.zero_stable,
        Contradiction::NoFeedback => places.gamma,
        _ => places.coefficients,
    }
}

fn contradictions(row: &Row, analysis: &Analysis) -> Vec<Contradiction> {
    let mut found = inconsistencies(analysis);
    let declared = &row.declared;
    found.extend(declared.order.and_then(|order| beyond_barrier(order, declared.zero_stable, analysis)));
    if let Some((declared, computed)) = disagreement(declared.order, analysis.order()) {
        found.push(Contradiction::Order { declared, computed });
    }
    if let Some((declared, computed)) =
        disagreement(declared.error_constant.clone(), analysis.error_constant())
    {
        found.push(Contradiction::ErrorConstant { declared, computed });
    }
    if let Some(declared) = declared.zero_stable.filter(|declared| *declared != analysis.is_zero_stable()) {
        let moduli = analysis.root_moduli().iter().take(3).map(|modulus| rounded(*modulus)).collect();
        found.push(Contradiction::ZeroStability { declared, computed: analysis.root_condition(), moduli });
    }
    found
}

/// Both values where both are known and differ.
fn disagreement<T: PartialEq>(declared: Option<T>, computed: Option<T>) -> Option<(T, T)> {
    declared.zip(computed).filter(|(declared, computed)| declared != computed)
}

fn inconsistencies(analysis: &Analysis) -> Vec<Contradiction> {
    let mut found = Vec::new();
    let beta_sum: Rational = analysis.beta().iter().sum();
    let (residual, slope) = (analysis.order_defect(0), analysis.order_defect(1));
    if !residual.is_zero() {
        found.push(Contradiction::WeightsDoNotSumToZero { residual });
    }
    if !slope.is_zero() {
        found.push(Contradiction::FirstMomentDiffers { moment: slope + &beta_sum, weight: beta_sum });
    } else if beta_sum.is_zero() {
        found.push(Contradiction::NothingIntegrated);
    }
    if analysis.gamma_sum().is_zero() && analysis.is_split() {
        found.push(Contradiction::NoFeedback);
    }
    found
}

/// Dahlquist: a zero-stable formula of s steps has an order of at most s when explicit, else s + 1, or s + 2 for even s.
fn beyond_barrier(order: usize, zero_stable: Option<bool>, analysis: &Analysis) -> Option<Contradiction> {
    let steps = analysis.steps();
    let (kind, barrier) = match (analysis.beta()[0].is_zero(), steps % 2) {
        (true, _) => ("explicit", steps),
        (false, 0) => ("implicit", steps + 2),
        (false, _) => ("implicit", steps + 1),
    };
    (zero_stable == Some(true) && order > barrier).then_some(Contradiction::BeyondDahlquistBarrier {
        declared: order,
        steps,
        kind,
        barrier,
    })
}

/// A modulus to nine places, without idle zeros.
fn rounded(modulus: f64) -> String {
    let text = format!("{modulus:.9}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}
