use super::PlannerError;
use crate::formula::{FeedbackRange, Formula};
use crate::law::LinearityKind;
use crate::math::Rational;
use num_traits::ToPrimitive;

/// How strongly the task error is fed back.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Feedback {
    /// The step `h = sigma k sum(gamma)`, held fixed whatever `sigma`: errors fall as `sigma^(p+1)`.
    Step(f64),
    /// The continuous gain `k` [1/s]: `h` shrinks with `sigma`, and errors fall as `sigma^p` only.
    Gain(f64),
}

/// How the error is fed back in a run: the step, and what it means.
#[derive(Clone, Copy, Debug)]
pub(super) struct FeedbackStep {
    /// The step `h` of the whole row.
    pub(super) h: f64,
    /// The gain `k = h / (sigma sum(gamma))` [1/s].
    pub(super) gain: f64,
    /// Whether the loops of all systems are stable.
    pub(super) is_stable: bool,
}

/// The coefficients by which laws of one kind feed back, and the steps at which their loops are stable.
struct Loop {
    /// The sum of the coefficients: `h = sigma k sum`.
    sum: f64,
    range: Option<FeedbackRange>,
    /// The best step, which takes a search to find.
    optimum: fn(&Formula) -> Option<f64>,
}

impl Loop {
    /// Split laws are fed back by `gamma`, in the range of the whole row; all others by `beta`, in that of `(alpha, beta)`.
    fn of(formula: &Formula, kind: LinearityKind) -> Self {
        let real = |sum: &Rational| sum.to_f64().unwrap_or(f64::NAN);
        match kind {
            LinearityKind::Split => Self {
                sum: real(&formula.gamma_sum()),
                range: Some(formula.feedback_range().clone()),
                optimum: |formula| formula.optimum().map(|optimum| optimum.h),
            },
            LinearityKind::Total => {
                let pair = formula.without_split();
                Self {
                    sum: real(&pair.gamma_sum()),
                    range: pair.feedback_range().cloned(),
                    optimum: |formula| formula.without_split().optimum().map(|optimum| optimum.h),
                }
            }
        }
    }
}

/// The feedback of a run whose systems have laws of these `kinds`: as asked for, or the best of the row.
pub(super) fn feedback_step(
    formula: &Formula,
    asked: Option<Feedback>,
    kinds: &[LinearityKind],
    (sigma, allow_unstable): (f64, bool),
    warnings: &mut Vec<String>,
) -> Result<FeedbackStep, PlannerError> {
    let loops: Vec<Loop> = [LinearityKind::Split, LinearityKind::Total]
        .into_iter()
        .filter(|kind| kinds.contains(kind))
        .map(|kind| Loop::of(formula, kind))
        .collect();
    let gamma_sum = formula.gamma_sum().to_f64().unwrap_or(f64::NAN);
    let h = match asked {
        Some(Feedback::Step(h)) => h,
        Some(Feedback::Gain(gain)) => {
            check_feedback("gain", gain)?;
            sigma * gain * gamma_sum
        }
        None => loops
            .first()
            .and_then(|first| Some((first.optimum)(formula)? * gamma_sum / first.sum))
            .unwrap_or(0.0),
    };
    check_feedback("step h", h)?;
    let gain = h / (sigma * gamma_sum);
    if h == 0.0 {
        warnings.push("h = 0: without feedback the task error is never corrected and drifts".to_owned());
        return Ok(FeedbackStep { h, gain, is_stable: formula.feedback_range().contains(h) });
    }
    let mut is_stable = true;
    for own in &loops {
        // The same gain is another step for other coefficients.
        let h = if own.sum == gamma_sum { h } else { sigma * gain * own.sum };
        if own.range.as_ref().is_some_and(|range| range.contains(h)) {
            continue;
        }
        is_stable = false;
        let range = own.range.as_ref().map_or_else(|| "(none)".to_owned(), ToString::to_string);
        let id = formula.id().to_owned();
        if !allow_unstable {
            return Err(PlannerError::StepSizeOutsideRange { h, formula: id, range });
        }
        warnings
            .push(format!("h = {h} lies outside the feedback range {range} of formula `{id}`, as allowed"));
    }
    Ok(FeedbackStep { h, gain, is_stable })
}

fn check_feedback(what: &'static str, value: f64) -> Result<(), PlannerError> {
    if value >= 0.0 && value.is_finite() {
        return Ok(());
    }
    Err(PlannerError::Feedback { what, value })
}
