//! Studies of initial value problems that were written as text, in doubles or with 32 digits.

use super::convergence::Mark;
use super::ladder::Rung;
use super::order::{Judged, OrderReport, OrderStudy};
use super::reference::{Reference, trajectory};
use super::samples::Errors;
use kinstep::formula::Formula;
use kinstep::integrate::{Elementary, Equations, IntegrateError, Starter};

impl OrderStudy {
    /// Studies a formula on a problem in numbers of the kind `T` against a reference on the same ladder.
    ///
    /// ```
    /// use kinstep::formula::FormulaTable;
    /// use kinstep::integrate::{EquationText, Equations, Starter};
    /// use kinstep::math::DoubleDouble;
    /// use kinstep_study::{Ladder, OrderStudy, Orders, Reference};
    ///
    /// let swing = Equations::parse(&EquationText {
    ///     equations: vec!["x' = x*cos(t)".to_owned()],
    ///     initial: vec!["x = 1".to_owned()],
    ///     ..EquationText::default()
    /// })?;
    /// // Eighth order, far below what doubles could show.
    /// let formula = FormulaTable::builtin().get("ab8")?;
    /// let ladder = Ladder::halvings(6.0, 200, 4)?;
    /// let reference = Reference::extended(&swing, &ladder, 1e-30);
    /// let study = OrderStudy::new(ladder).claiming(Orders::at_fixed_step(8));
    /// let report = study.of_equations::<DoubleDouble>(formula, &Starter::Rk8, &swing, &reference)?;
    /// let seen = report.formula.unwrap();
    /// assert!(seen.verdict.is_confirmed() && *seen.errors.last().unwrap() < 1e-15);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    /// [`IntegrateError`] for a row that may not run.
    pub fn of_equations<T: Elementary>(
        &self,
        formula: &Formula,
        starter: &Starter<T>,
        equations: &Equations,
        reference: &Reference,
    ) -> Result<OrderReport, IntegrateError> {
        let mut report = OrderReport::empty(self.ladder());
        report.notes.extend(reference.trouble.clone());
        let (dimension, scale) = (reference.dimension, reference.scale());
        let (mut errors, mut left_out, mut stopped) = (Vec::new(), Vec::new(), Vec::new());
        for (i, rung) in self.ladder().rungs().enumerate() {
            let states = trajectory(formula, starter, equations, self.ladder().duration(), rung.steps)?;
            let truth = reference.states.get(i).map_or(&[][..], Vec::as_slice);
            let whole = (rung.steps + 1) * dimension;
            let (is_whole, is_known) = (states.len() == whole, truth.len() == whole);
            if !is_whole {
                stopped.push((rung, states.len() / dimension - 1));
            }
            left_out.push((is_whole && !is_known).then_some(Mark::NoReference));
            errors.push(if is_whole && is_known {
                let difference = |(x, y): (&T, _)| (x.to_extended() - y).to_f64();
                let differences: Vec<f64> =
                    states.iter().zip(truth.iter().copied()).map(difference).collect();
                Errors::of_differences(&differences, dimension, scale)
            } else {
                Errors::NONE
            });
        }
        report.notes.extend(stopped_early(&stopped, self.ladder().sigmas().len()));
        let judged =
            Judged { errors, left_out, resolution: T::RESOLUTION, uncertainty: reference.uncertainty };
        self.judge_formula(&mut report, &judged);
        self.blame(&mut report, judged, formula, equations, reference);
        Ok(report)
    }
}

/// One sentence for all runs that became infinite.
fn stopped_early(stopped: &[(Rung, usize)], rungs: usize) -> Option<String> {
    let (first, last) = (stopped.first()?, stopped.last()?);
    let one = |(rung, steps): &(Rung, usize)| {
        let t = *steps as f64 * rung.sigma;
        format!("at sigma = {:.4e} s after {steps} of {} steps, t = {t:.4} s", rung.sigma, rung.steps)
    };
    let which = if stopped.len() == 1 { one(first) } else { format!("{}; ...; {}", one(first), one(last)) };
    Some(format!("{} of {rungs} runs became infinite or NaN: {which}", stopped.len()))
}
