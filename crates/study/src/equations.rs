//! Studies of initial value problems that were written as text, in doubles or with 32 digits.

use super::order::{OrderReport, OrderStudy};
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
        let mut errors = Vec::new();
        for (i, rung) in self.ladder().rungs().enumerate() {
            let states = trajectory(formula, starter, equations, self.ladder().duration(), rung.steps)?;
            let truth = reference.states.get(i).map_or(&[][..], Vec::as_slice);
            if states.len() < (rung.steps + 1) * dimension {
                let (sigma, steps) = (rung.sigma, states.len() / dimension - 1);
                report.notes.push(format!(
                    "the run at sigma = {sigma} s became infinite or NaN after {steps} of {} steps",
                    rung.steps
                ));
            }
            errors.push(if states.len() == truth.len() {
                let difference = |(x, y): (&T, _)| (x.to_extended() - y).to_f64();
                let differences: Vec<f64> =
                    states.iter().zip(truth.iter().copied()).map(difference).collect();
                Errors::of_differences(&differences, dimension, scale)
            } else {
                Errors::NONE
            });
        }
        self.judge_formula(&mut report, &errors, T::RESOLUTION, reference.uncertainty);
        Ok(report)
    }
}
