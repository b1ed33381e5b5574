use super::counted::Counted;
use crate::integrate::adaptive::{Family, Piece, SolveStatus, StateWindow, Statistics, VariableOrder};
use crate::integrate::error::IntegrateError;
use crate::integrate::field::{Field, Parts};
use crate::integrate::method::Method;
use crate::integrate::starter::Starter;
use crate::integrate::status::Status;
use crate::integrate::stepper::Multistep;
use crate::math::Scalar;

/// The tolerance of the start of an implicit row, in resolutions of the numbers.
const TOLERANCE: f64 = 1e4;
/// How much longer than asked for a step may be so that a whole number of them meets the end.
const ROUNDING: f64 = 1e-9;

/// A method in equal steps, with the polynomials between its states.
#[derive(Clone, Debug)]
pub(super) struct FixedSteps<T> {
    stepper: Multistep<T>,
    window: StateWindow<T>,
    order: usize,
    end: T,
    left: usize,
    statistics: Statistics,
}

impl<T: Scalar> FixedSteps<T> {
    /// The method in as many equal steps as reach the end, none of which is longer than `step`.
    pub(super) fn new(
        method: Method<T>,
        field: &mut impl Field<T>,
        (t0, x0, end): (T, &[T], T),
        step: T,
    ) -> Result<Self, IntegrateError> {
        let count = ((end - t0).to_f64() / step.to_f64()).abs();
        if !(count > 0.0 && count < 1e15) {
            return Err(IntegrateError::SamplingGap { text: format!("{step:?}") });
        }
        let left = (count * (1.0 - ROUNDING)).ceil().max(1.0) as usize;
        let sigma = (end - t0) / T::from_index(left);
        let order = method.row().order();
        let mut statistics = Statistics::default();
        let starter = starter(&method, field, (t0, x0), sigma, &mut statistics)?;
        let stepper = Multistep::of_method(method, &starter, field, t0, sigma, x0)?;
        let window = StateWindow::new(order, x0);
        Ok(Self { stepper, window, order, end, left, statistics })
    }

    pub(super) fn time(&self) -> T {
        if self.left == 0 { self.end } else { self.stepper.time() }
    }

    pub(super) fn state(&self) -> &[T] {
        self.stepper.state()
    }

    pub(super) fn order(&self) -> usize {
        self.order
    }

    pub(super) fn statistics(&self) -> Statistics {
        self.statistics
    }

    pub(super) fn piece(&self) -> Piece<T> {
        self.window.piece(self.time())
    }

    pub(super) fn state_at(&self, t: T, out: &mut [T]) {
        self.window.state_at(self.time(), t, out);
    }

    /// Makes one step; returns why there is none.
    pub(super) fn advance(&mut self, field: &mut impl Field<T>) -> Option<SolveStatus> {
        let mut counted = Counted::new(field);
        let status = self.stepper.step(&mut counted);
        self.statistics.evaluations += counted.evaluations();
        match status {
            Status::Running => {}
            Status::NotSolved => return Some(SolveStatus::NoConvergence),
            Status::StepTooSmall | Status::Rejected => return Some(SolveStatus::StepTooSmall),
            Status::NonFinite => return Some(SolveStatus::NonFinite),
        }
        self.left -= 1;
        self.statistics.steps += 1;
        let counted_order = self.order.min(self.statistics.orders.len() - 1);
        self.statistics.orders[counted_order] += 1;
        self.window.push(self.stepper.step_size(), self.stepper.state());
        None
    }
}

/// How the first states come about: by Runge-Kutta steps or, before an implicit row on a field of one part, which may be there because the
/// problem is stiff, by backward differentiation as closely as the numbers allow.
fn starter<T: Scalar>(
    method: &Method<T>,
    field: &mut impl Field<T>,
    (t0, x0): (T, &[T]),
    sigma: T,
    statistics: &mut Statistics,
) -> Result<Starter<T>, IntegrateError> {
    let steps = method.steps();
    if !matches!(method, Method::Implicit(_)) || field.parts() != Parts::One || steps < 2 {
        return Ok(Starter::Sufficient);
    }
    let times: Vec<T> = (1..steps).map(|n| t0 + T::from_index(n) * sigma).collect();
    let tolerance = TOLERANCE * T::RESOLUTION;
    let mut stepper =
        VariableOrder::new(Family::BDF, field, t0, x0, times[steps - 2], tolerance, &[tolerance])?;
    let mut states: Vec<Vec<T>> = Vec::new();
    while states.len() + 1 < steps {
        if stepper.advance(field).is_some() {
            return Ok(Starter::Sufficient);
        }
        while let Some(&t) = times.get(states.len())
            && (t - stepper.time()).to_f64() * sigma.to_f64() <= 0.0
        {
            let mut state = x0.to_vec();
            stepper.state_at(t, &mut state);
            states.push(state);
        }
    }
    statistics.evaluations += stepper.statistics().evaluations;
    Ok(Starter::Given(states))
}
