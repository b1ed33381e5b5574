use super::given::GivenStates;
use super::kind::StarterKind;
use super::paper;
use super::ramp::{Ramp, builtin_ladder};
use super::runge_kutta::RungeKutta;
use super::starter::Starter;
use super::tableau::Tableau;
use crate::formula::Formula;
use crate::integrate::coefficients::{Coefficients, Weights};
use crate::integrate::error::IntegrateError;
use crate::integrate::field::Field;
use crate::integrate::history::{History, Origin};
use crate::integrate::method::Method;
use crate::math::Rational;
use crate::math::Scalar;
use num_traits::One;

/// A starter at work, with the memory that it needs.
#[derive(Clone, Debug)]
pub(in crate::integrate) enum RunningStarter<T> {
    /// The row of each step, the last one for all that are left.
    Rows(Vec<Weights<T>>),
    /// States that the starter makes without the row.
    Apart(Apart<T>),
}

/// A starter that makes the next state by itself.
#[derive(Clone, Debug)]
pub(in crate::integrate) enum Apart<T> {
    RungeKutta(RungeKutta<T>),
    Given(GivenStates<T>),
}

impl<T: Scalar> RunningStarter<T> {
    /// The start of a method on a field, in steps of `sigma`.
    pub(in crate::integrate) fn new(
        starter: &Starter<T>,
        method: &Method<T>,
        field: &impl Field<T>,
        sigma: T,
    ) -> Result<Self, IntegrateError> {
        let (dimension, parts) = (field.dimension(), field.parts());
        let gamma_sum = fixed(method.row()).map_or_else(Rational::one, Formula::gamma_sum);
        let ramp = Ramp {
            sigma,
            steps: method.steps(),
            gamma_sum: &gamma_sum,
            takes_implicit: !matches!(method, Method::Explicit(_)),
        };
        let runge_kutta =
            |tableau| Self::Apart(Apart::RungeKutta(RungeKutta::new(tableau, dimension, parts)));
        Ok(match starter {
            Starter::Sufficient => {
                let kind = StarterKind::sufficient_for(method.row().order());
                return Self::new(&kind.into(), method, field, sigma);
            }
            Starter::Paper => Self::Rows(paper::rows(sigma, &gamma_sum)),
            Starter::Ramp => {
                let row = fixed(method.predictor().unwrap_or_else(|| method.row()));
                Self::Rows(ramp.rows(&row.map(builtin_ladder).unwrap_or_default()))
            }
            Starter::Rows(ladder) => Self::Rows(ramp.rows(ladder)),
            Starter::Rk4 => runge_kutta(Tableau::rk4()),
            Starter::Rk8 => runge_kutta(Tableau::rk8()),
            Starter::Given(states) => {
                let states = GivenStates::new(states, method.row().id(), method.steps(), dimension)?;
                Self::Apart(Apart::Given(states))
            }
        })
    }

    /// The row that makes the state after the one of index `index`, where a row does.
    pub(in crate::integrate) fn row(&self, index: usize) -> Option<&Weights<T>> {
        match self {
            Self::Rows(rows) => rows.get(index).or(rows.last()),
            Self::Apart(_) => None,
        }
    }

    /// How far back the starting rows look into `f` and into `g`; at least the newest evaluation is kept.
    pub(in crate::integrate) fn depths(&self) -> (usize, usize) {
        let Self::Rows(rows) = self else { return (1, 1) };
        let deepest = |depth: fn(&Weights<T>) -> usize| rows.iter().map(depth).max().unwrap_or(1).max(1);
        (deepest(|row| row.first.depth()), deepest(|row| row.second.depth()))
    }

    /// Whether the other one goes on in the same way.
    pub(in crate::integrate) fn is_like(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Rows(own), Self::Rows(others)) => own == others,
            (Self::Apart(own), Self::Apart(others)) => own.is_like(others),
            _ => false,
        }
    }

    /// The start of components that come from several, of one kind.
    pub(in crate::integrate) fn gathered(starts: &[&Self], origins: &[Option<Origin>]) -> Self {
        match starts[0] {
            Self::Rows(rows) => Self::Rows(rows.clone()),
            Self::Apart(Apart::RungeKutta(method)) => {
                Self::Apart(Apart::RungeKutta(method.for_dimension(origins.len())))
            }
            Self::Apart(Apart::Given(_)) => {
                let given: Vec<_> = starts.iter().filter_map(|start| start.given()).collect();
                Self::Apart(Apart::Given(GivenStates::gathered(&given, origins)))
            }
        }
    }

    fn given(&self) -> Option<&GivenStates<T>> {
        match self {
            Self::Apart(Apart::Given(states)) => Some(states),
            _ => None,
        }
    }
}

impl<T: Scalar> Apart<T> {
    /// Writes the state that follows the newest of a history.
    pub(in crate::integrate) fn write(
        &mut self,
        field: &mut impl Field<T>,
        history: &History<T>,
        next: &mut [T],
    ) {
        let times = &history.times;
        match self {
            Self::RungeKutta(method) => method.step(field, times.now(), times.step(), history.known(), next),
            Self::Given(states) => next.copy_from_slice(states.after(times.index())),
        }
    }

    fn is_like(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::RungeKutta(own), Self::RungeKutta(others)) => own.is_like(others),
            (Self::Given(own), Self::Given(others)) => own.len() == others.len(),
            _ => false,
        }
    }
}

/// The formula of a row for equal steps.
fn fixed<T>(row: &Coefficients<T>) -> Option<&Formula> {
    match row {
        Coefficients::Fixed(formula) => Some(formula),
        Coefficients::Ratio(_) => None,
    }
}
