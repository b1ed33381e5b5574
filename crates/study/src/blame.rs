//! What is the problem's fault and not the row's.

use super::convergence::{Convergence, Mark, Undecidable, Verdict};
use super::ladder::Ladder;
use super::order::{Judged, OrderReport, OrderStudy};
use super::reference::{Reference, growth, rough_between};
use super::stability::Spectra;
use kinstep::formula::Formula;
use kinstep::integrate::Equations;
use kinstep::math::DoubleDouble;
use num_traits::Zero;

/// References that differ by more than this part of the solution follow nothing.
const NOT_FOLLOWED: f64 = 1e-6;
/// Errors above this part of the solution are those of runs that have left it.
const LOST: f64 = 1e-2;
/// Growth of small changes from which on a problem is called sensitive.
const SENSITIVE: f64 = 1e3;
/// The tolerance of the run that looks for where a right-hand side is not smooth.
const TOLERANCE: f64 = 1e-24;
/// States of the solution at which the Jacobian matrix is looked at.
const STATES: usize = 33;

impl OrderStudy {
    /// Takes back verdicts against a row where the problem is at fault, and says why.
    pub(super) fn blame(
        &self,
        report: &mut OrderReport,
        mut judged: Judged,
        formula: &Formula,
        equations: &Equations,
        reference: &Reference,
    ) {
        if reference.trouble.is_some() {
            return;
        }
        let scale = reference.scale();
        if reference.uncertainty > NOT_FOLLOWED * scale {
            let why = Undecidable::NotFollowed { uncertainty: reference.uncertainty, scale };
            return unless_confirmed(report, |_| Some(why));
        }
        let clean = |part: &Convergence| {
            part.marks.iter().all(|mark| *mark != Mark::Stopped && *mark != Mark::PreAsymptotic)
        };
        if report.of_solution().all(|part| part.verdict.is_confirmed() && clean(part)) {
            return;
        }
        self.leave_out_unstable(report, &mut judged, formula, equations, reference);
        let lost = |part: &Convergence| part.errors.last().is_some_and(|error| *error > LOST * scale);
        let is_lost = report.of_solution().any(|part| !part.verdict.is_confirmed() && lost(part));
        if is_lost && let Some(growth) = growth(equations, self.ladder()).filter(|growth| *growth > SENSITIVE)
        {
            unless_confirmed(report, |part| lost(part).then_some(Undecidable::Sensitive { growth }));
        }
        let is_blamed = |part: &Convergence| !part.verdict.is_confirmed() && part.finest_slope().is_some();
        if !report.of_solution().any(|part| is_blamed(part)) {
            return;
        }
        let Some(rough) = Roughness::of(equations, reference, self.ladder()) else { return };
        unless_confirmed(report, |part| {
            let is_known = matches!(part.verdict, Verdict::Undecidable(why) if !is_open(why));
            let finest = part.finest_slope().filter(|_| !is_known)?;
            Some(Undecidable::NotSmooth { at: rough.at, finest })
        });
        let is_rough =
            |part: &Convergence| matches!(part.verdict, Verdict::Undecidable(Undecidable::NotSmooth { .. }));
        if report.of_solution().any(|part| is_rough(part)) {
            report.notes.push(rough.sentence);
        }
    }

    /// Judges anew without the gaps at which the row is unstable.
    fn leave_out_unstable(
        &self,
        report: &mut OrderReport,
        judged: &mut Judged,
        formula: &Formula,
        equations: &Equations,
        reference: &Reference,
    ) {
        let spectra = Spectra::along(equations, self.ladder().duration(), &reference.sampled(STATES));
        let lost = LOST * 0.1 * reference.scale();
        let mut unstable = Vec::new();
        for (i, rung) in self.ladder().rungs().enumerate() {
            let is_off = !(judged.errors[i].transient <= lost);
            if is_off && spectra.spoil(formula, rung.sigma) {
                judged.left_out[i] = Some(Mark::Unstable);
                unstable.push(rung.sigma);
            }
        }
        let (Some(coarsest), Some(finest)) = (unstable.first(), unstable.last()) else { return };
        self.judge_formula(report, judged);
        let (rungs, rate) = (judged.errors.len(), spectra.radius());
        report.notes.push(format!(
            "{} is unstable at {} of {rungs} gaps, from {coarsest:.3e} s to {finest:.3e} s: the spectral radius of the Jacobian matrix reaches {rate:.3e} 1/s, times the gap up to {:.3}, outside the row's stability region",
            formula.id(),
            unstable.len(),
            rate * coarsest,
        ));
        if rungs - unstable.len() < 3 {
            let why = Undecidable::Unstable { unstable: unstable.len(), rungs, rate };
            unless_confirmed(report, |_| Some(why));
        }
    }
}

/// Whether a smoother right-hand side could have decided.
fn is_open(why: Undecidable) -> bool {
    matches!(why, Undecidable::Unsettled { .. } | Undecidable::NotFalling { .. })
}

fn unless_confirmed(report: &mut OrderReport, why: impl Fn(&Convergence) -> Option<Undecidable>) {
    for part in report.of_solution().filter(|part| !part.verdict.is_confirmed()) {
        if let Some(why) = why(part) {
            part.verdict = Verdict::Undecidable(why);
            // A power law through what the problem spoils says nothing.
            part.fit = None;
        }
    }
}

/// Where the right-hand side was seen not to be smooth, and by what.
struct Roughness {
    at: f64,
    sentence: String,
}

impl Roughness {
    fn of(equations: &Equations, reference: &Reference, ladder: &Ladder) -> Option<Self> {
        if let Some((text, between, count)) = first_switch(equations, reference) {
            let often = if count == 1 { "once".to_owned() } else { format!("{count} times") };
            let sentence = format!(
                "`{text}` switches {often} on the way, first between t = {:.6} s and {:.6} s: derivatives of the right-hand side jump there",
                between.0, between.1
            );
            let within = reference.rough.filter(|at| (between.0..=between.1).contains(at));
            return Some(Self { at: within.unwrap_or(between.1), sentence });
        }
        let at = reference.rough.or_else(|| rough_between(equations, ladder, TOLERANCE))?;
        let sentence = format!(
            "near t = {at:.6} s the reference needed steps a ten-thousandth of the finest gap: the right-hand side, or a derivative of it, jumps or is infinite there"
        );
        Some(Self { at, sentence })
    }
}

/// The part of the right-hand side that switches first along the solution, between which samples, and how often it does.
fn first_switch(equations: &Equations, reference: &Reference) -> Option<(String, (f64, f64), usize)> {
    let texts: Vec<&str> = equations.switches().collect();
    if texts.is_empty() {
        return None;
    }
    let mut field = equations.field::<DoubleDouble>();
    let mut quantities = vec![DoubleDouble::zero(); texts.len()];
    let mut signs = vec![0.0; texts.len()];
    let mut seen: Vec<Option<(f64, f64)>> = vec![None; texts.len()];
    let mut counts = vec![0; texts.len()];
    let mut before = 0.0;
    for (t, state) in reference.finest() {
        field.switches(t, state, &mut quantities);
        for (k, quantity) in quantities.iter().enumerate() {
            let value = quantity.to_f64();
            if value == 0.0 || value.is_nan() {
                continue;
            }
            let sign = value.signum();
            if signs[k] * sign < 0.0 {
                counts[k] += 1;
                seen[k].get_or_insert((before, t.to_f64()));
            }
            signs[k] = sign;
        }
        before = t.to_f64();
    }
    let first = (0..texts.len()).filter(|&k| seen[k].is_some());
    let first = first.min_by(|&a, &b| {
        seen[a].map(|s| s.1).partial_cmp(&seen[b].map(|s| s.1)).unwrap_or(std::cmp::Ordering::Equal)
    })?;
    Some((texts[first].to_owned(), seen[first]?, counts[first]))
}
