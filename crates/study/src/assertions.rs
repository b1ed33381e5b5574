//! Assertions for tests of other crates.

/// Stops a test unless the errors at the gaps confirm an order: `assert_order!(order, sigmas, errors)`.
///
/// Gaps stand coarsest first; the optional `floor = ...` is the size below which errors are rounding, 1e-14 unless given, and
/// `tolerance = ...` how far the finest slope may be off, 0.2 unless given. The message says what was seen rung by rung.
///
/// ```
/// use kinstep_study::assert_order;
/// let sigmas = [0.1, 0.05, 0.025, 0.0125];
/// let errors = sigmas.map(|sigma: f64| 0.7 * sigma.powi(3));
/// assert_order!(3, sigmas, errors);
/// assert_order!(3, sigmas, errors, floor = 1e-12, tolerance = 0.05);
/// ```
///
/// ```should_panic
/// # use kinstep_study::assert_order;
/// let sigmas = [0.1, 0.05, 0.025, 0.0125];
/// assert_order!(4, sigmas, sigmas.map(|sigma: f64| 0.7 * sigma.powi(3)));
/// ```
#[macro_export]
macro_rules! assert_order {
    ($order:expr, $sigmas:expr, $errors:expr $(, floor = $floor:expr)? $(, tolerance = $tolerance:expr)? $(,)?) => {{
        #[allow(unused_mut, unused_assignments)]
        let (mut floor, mut criteria) = (1e-14, $crate::Criteria::default());
        $( floor = $floor; )?
        $( criteria = criteria.with_tolerance($tolerance); )?
        let (sigmas, errors) = (&$sigmas[..], &$errors[..]);
        let seen = $crate::Convergence::judge(sigmas, errors, floor, Some($order), &criteria);
        assert!(
            seen.verdict.is_confirmed(),
            "{}\n  sigma  {sigmas:?}\n  error  {errors:?}\n  slope  {:?}",
            seen.verdict,
            seen.slopes
        );
    }};
}

/// Stops a test unless a study confirms the order that it was asked about: `assert_confirmed!(report)`, by the measure of the whole run
/// or another, `assert_confirmed!(report, Measure::Steady)`.
///
/// ```
/// use kinstep_study::assert_confirmed;
/// use kinstep::formula::FormulaTable;
/// use kinstep_study::{Ladder, Measure, OrderStudy, Orders, Problem};
/// let ab4 = FormulaTable::builtin().get("ab4")?;
/// let study = OrderStudy::new(Ladder::halvings(Problem::SWING.duration, 64, 6)?);
/// let report = study.claiming(Orders::at_fixed_step(4)).of_formula(ab4, &Problem::SWING)?;
/// assert_confirmed!(report);
/// assert_confirmed!(report, Measure::MeanSquare);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[macro_export]
macro_rules! assert_confirmed {
    ($report:expr $(,)?) => {
        $crate::assert_confirmed!($report, $crate::Measure::Maximum)
    };
    ($report:expr, $measure:expr $(,)?) => {{
        let report = &$report;
        let seen = report.measured($measure).expect("the study measured something");
        assert!(seen.verdict.is_confirmed(), "{}\n{report}", seen.verdict);
    }};
}

/// Stops a test unless a row of coefficients is zero-stable; with `strictly`, unless 1 is its only root on the circle.
///
/// ```
/// use kinstep_study::assert_zero_stable;
/// use kinstep::formula::FormulaTable;
/// assert_zero_stable!(FormulaTable::builtin().get("la6-wang-guo")?);
/// assert_zero_stable!(strictly, FormulaTable::builtin().get("ab4")?);
/// # Ok::<(), kinstep::formula::UnknownFormula>(())
/// ```
///
/// ```should_panic
/// # use kinstep::formula::FormulaTable;
/// # use kinstep_study::assert_zero_stable;
/// assert_zero_stable!(FormulaTable::builtin().get("bad-bdf7").unwrap());
/// ```
#[macro_export]
macro_rules! assert_zero_stable {
    (strictly, $formula:expr $(,)?) => {{
        let formula = $formula;
        assert!(
            formula.is_strictly_zero_stable(),
            "formula `{}` is not strictly zero-stable: the moduli of its roots are {:?}",
            formula.id(),
            formula.root_moduli()
        );
    }};
    ($formula:expr $(,)?) => {{
        let formula = $formula;
        assert!(
            formula.is_zero_stable(),
            "formula `{}` is not zero-stable: the moduli of its roots are {:?}",
            formula.id(),
            formula.root_moduli()
        );
    }};
}
