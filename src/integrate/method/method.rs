use super::mode::Mode;
use crate::formula::NotRunnable;
use crate::integrate::coefficients::{Coefficients, RowKind};
use crate::integrate::error::IntegrateError;

/// How the next state is made: by one row, or by two that work together.
///
/// | method | the next state |
/// |---|---|
/// | explicit | is what the row makes of the past |
/// | implicit | solves `x = known + sigma beta_0 f(t, x) + sigma gamma_0 g(t, x)` |
/// | implicit-explicit | solves `x = known + sigma gamma_0 g(t, x)`; `f` enters from the past alone |
/// | predictor-corrector | is predicted by an explicit row and corrected by an implicit one, as its [`Mode`] says |
///
/// Equations are solved by the field ([`Field::solve`](crate::integrate::field::Field::solve)) or, where it does not offer that, by
/// [`FixedPoint`](crate::integrate::solve::FixedPoint).
///
/// ```
/// use kinstep::formula::FormulaTable;
/// use kinstep::integrate::{Method, Mode, Multistep, Ode, Starter};
///
/// let table = FormulaTable::builtin();
/// let pair = Method::pair(table.get("ab4")?, table.get("am3")?, Mode::Pece);
/// let mut swing = Ode::new(1, |t: f64, x: &[f64], f: &mut [f64]| f[0] = x[0] * t.cos());
/// let mut solution = Multistep::of_method(pair, &Starter::Rk4, &swing, 0.0, 0.01, &[1.0])?;
/// for _ in 0..100 {
///     solution.step(&mut swing);
/// }
/// assert!((solution.state()[0] - 1.0_f64.sin().exp()).abs() < 1e-9);
/// assert!(solution.error_estimate().unwrap()[0].abs() < 1e-10);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub enum Method<T> {
    /// An explicit row.
    Explicit(Coefficients<T>),
    /// A row with `beta_0` other than zero.
    Implicit(Coefficients<T>),
    /// An explicit row and an implicit one.
    PredictorCorrector {
        /// The explicit row.
        predictor: Coefficients<T>,
        /// The implicit row.
        corrector: Coefficients<T>,
        /// What is evaluated and corrected at each step.
        mode: Mode,
    },
    /// A row with `beta_0 = 0` and `gamma_0` other than zero.
    Imex(Coefficients<T>),
}

impl<T> Method<T> {
    /// Returns the method that a row by itself is: explicit, implicit or implicit-explicit.
    ///
    /// ```
    /// use kinstep::formula::FormulaTable;
    /// use kinstep::integrate::Method;
    /// let method = Method::<f64>::of(FormulaTable::builtin().get("bdf3")?);
    /// assert!(matches!(method, Method::Implicit(_)));
    /// # Ok::<(), kinstep::formula::UnknownFormula>(())
    /// ```
    pub fn of(row: impl Into<Coefficients<T>>) -> Self {
        let row = row.into();
        match row.kind() {
            RowKind::Explicit => Self::Explicit(row),
            RowKind::Implicit => Self::Implicit(row),
            RowKind::Imex => Self::Imex(row),
        }
    }

    /// Returns the predictor-corrector pair of an explicit row and an implicit one.
    pub fn pair(
        predictor: impl Into<Coefficients<T>>,
        corrector: impl Into<Coefficients<T>>,
        mode: Mode,
    ) -> Self {
        Self::PredictorCorrector { predictor: predictor.into(), corrector: corrector.into(), mode }
    }

    /// Returns the row that decides order and stability: the corrector of a pair, else the row itself.
    pub fn row(&self) -> &Coefficients<T> {
        match self {
            Self::Explicit(row) | Self::Implicit(row) | Self::Imex(row) => row,
            Self::PredictorCorrector { corrector, .. } => corrector,
        }
    }

    /// Returns the predictor of a pair.
    pub fn predictor(&self) -> Option<&Coefficients<T>> {
        match self {
            Self::PredictorCorrector { predictor, .. } => Some(predictor),
            _ => None,
        }
    }

    /// Returns the number of steps: how many past states are needed.
    pub fn steps(&self) -> usize {
        self.row().steps().max(self.predictor().map_or(0, Coefficients::steps))
    }

    /// Says whether the rows can do what they are asked to, whatever their stability.
    pub(in crate::integrate) fn check_roles(&self) -> Result<(), IntegrateError> {
        for row in [Some(self.row()), self.predictor()].into_iter().flatten() {
            if row.steps() == 0 {
                return Err(IntegrateError::NoStep { id: row.id().to_owned() });
            }
        }
        match self {
            Self::Explicit(row) => explicit(row),
            Self::Implicit(row) => of_kind(row, "solved for the new state", RowKind::Implicit),
            Self::Imex(row) => of_kind(row, "solved for the second part alone", RowKind::Imex),
            Self::PredictorCorrector { predictor, corrector, .. } => {
                if predictor.may_vary() != corrector.may_vary() {
                    let (predictor, corrector) = (predictor.id().to_owned(), corrector.id().to_owned());
                    return Err(IntegrateError::MixedPair { predictor, corrector });
                }
                of_kind(predictor, "a predictor", RowKind::Explicit)?;
                of_kind(corrector, "a corrector", RowKind::Implicit)
            }
        }
    }

    /// Says whether the errors of one step stay bounded in those that follow; a predictor's own do not matter, for nothing is
    /// remembered but what the corrector made of them.
    pub(in crate::integrate) fn check_stability(&self) -> Result<(), IntegrateError> {
        match self.row() {
            Coefficients::Fixed(formula) => match formula.runnable() {
                Err(unstable @ NotRunnable::Unstable { .. }) => Err(unstable.into()),
                _ => Ok(()),
            },
            Coefficients::Ratio(_) => Ok(()),
        }
    }
}

fn explicit<T>(row: &Coefficients<T>) -> Result<(), IntegrateError> {
    match row.kind() {
        RowKind::Explicit => Ok(()),
        _ => Err(NotRunnable::Implicit { id: row.id().to_owned() }.into()),
    }
}

fn of_kind<T>(row: &Coefficients<T>, role: &'static str, expected: RowKind) -> Result<(), IntegrateError> {
    if row.kind() == expected {
        return Ok(());
    }
    Err(IntegrateError::Kind { id: row.id().to_owned(), kind: row.kind(), role, expected })
}
