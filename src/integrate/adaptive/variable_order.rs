use super::adams::{Adams, Step};
use super::backward_differentiation::BackwardDifferentiation;
use super::differences::{Differences, MOST};
use super::family::{Family, Past};
use super::initial_step::initial_step;
use super::order_choice::{Errors, growth};
use super::piece::Piece;
use super::solve_status::SolveStatus;
use super::statistics::Statistics;
use crate::integrate::error::{IntegrateError, check_length};
use crate::integrate::field::{Field, Parts};
use crate::integrate::solve::ErrorNorm;
use crate::math::Scalar;

/// What part of the tolerances a step may err by: errors of steps add up, and so what is asked for is about what the end has.
const PER_STEP: f64 = 0.05;
/// How many resolutions of the numbers a step may err by at least.
const RESOLVED: f64 = 10.0;
/// How much a step may grow at once.
const GROWTH: f64 = 1.3;
/// The same while orders rise after a start.
const START_GROWTH: f64 = 2.0;
/// How much a step may shrink at once.
const SHRINKAGE: f64 = 0.5;
/// Steps of implicit formulas stay as they are unless they may grow so much: their factors serve on.
const WORTH_IT: f64 = 1.2;
/// What is left of a step that came to nothing.
const AFTER_FAILURE: f64 = 0.25;
/// How many attempts may fail at one place before the past is forgotten.
const FAILURES: usize = 3;
/// How many steps in a row have to be bounded by stability before a problem is called stiff.
const STIFF_STREAK: usize = 25;
/// For the orders from one on, the largest `h L` on the negative real axis at which the pair of Adams formulas in PECE is stable at
/// equal steps, L being the rate of decay: where the characteristic polynomial leaves the unit circle.
const STABLE: [f64; 12] = [2.0, 2.4, 1.93, 1.41, 1.04, 0.77, 0.58, 0.44, 0.34, 0.26, 0.21, 0.16];
/// The part of that at which a step is taken to be bounded by it.
const NEAR_UNSTABLE: f64 = 0.6;

/// A stepper of varying steps and order: the formulas of a [`Family`], of which each step takes the one that goes furthest within the
/// tolerances.
///
/// [`advance`](Self::advance) makes one step and allocates nothing; [`state_at`](Self::state_at) tells the states within the last
/// one. [`Solver`](crate::integrate::Solver) is the same with output times, events and a choice of the family.
///
/// ```
/// use kinstep::integrate::{Family, Ode, VariableOrder};
/// let mut swing = Ode::new(2, |_t, x: &[f64], f: &mut [f64]| {
///     f[0] = x[1];
///     f[1] = -x[0];
/// });
/// let mut stepper = VariableOrder::new(Family::ADAMS, &mut swing, 0.0, &[1.0, 0.0], 10.0, 1e-8, &[1e-8])?;
/// while stepper.time() < 10.0 {
///     assert!(stepper.advance(&mut swing).is_none());
/// }
/// assert!((stepper.state()[0] - 10.0_f64.cos()).abs() < 1e-6);
/// # Ok::<(), kinstep::integrate::IntegrateError>(())
/// ```
#[derive(Clone, Debug)]
pub struct VariableOrder<T> {
    scheme: Scheme<T>,
    family: Family,
    past: Differences<T>,
    norm: ErrorNorm,
    t: T,
    end: T,
    h: T,
    largest: f64,
    order: usize,
    /// The order of the step that was made last.
    last_order: usize,
    x: Vec<T>,
    next: Vec<T>,
    /// Steps since the order or the length changed.
    held: usize,
    /// Whether orders rise and steps double, as they do after a start.
    is_starting: bool,
    streak: usize,
    statistics: Statistics,
}

#[derive(Clone, Debug)]
enum Scheme<T> {
    Adams(Box<Adams<T>>),
    BackwardDifferentiation(Box<BackwardDifferentiation<T>>),
}

/// Why the last attempt came to nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Failed {
    Error,
    NotFinite,
    NotSolved,
}

impl<T: Scalar> VariableOrder<T> {
    /// A stepper from the state `x0` at `t0` to the time `end`, with the tolerances `relative |x| + absolute`, one absolute tolerance
    /// for all components or one for each. Each step may err by a twentieth of them, in the root mean square over the components.
    ///
    /// # Errors
    /// An initial state of the wrong length or not finite, tolerances that are negative or not finite or nothing at all, an end at the
    /// start or not finite, a field of two parts.
    pub fn new(
        family: Family,
        field: &mut impl Field<T>,
        t0: T,
        x0: &[T],
        end: T,
        relative: f64,
        absolute: &[f64],
    ) -> Result<Self, IntegrateError> {
        let dimension = field.dimension();
        check_length("the initial state", x0, dimension)?;
        if field.parts() != Parts::One {
            return Err(IntegrateError::TwoParts { id: family.id().to_owned() });
        }
        let mut norm = ErrorNorm::new(relative, absolute, dimension)?;
        norm.tighten(PER_STEP, RESOLVED * T::RESOLUTION);
        norm.weigh_by(x0);
        if !(end - t0).is_finite() || end == t0 {
            return Err(IntegrateError::Range { start: format!("{t0:?}"), end: format!("{end:?}") });
        }
        if let Some(i) = x0.iter().position(|x| !x.is_finite()) {
            return Err(IntegrateError::InitialState { index: i, text: format!("{:?}", x0[i]) });
        }
        let highest = family.highest();
        let scheme = match family.past() {
            Past::Derivatives => Scheme::Adams(Box::new(Adams::new(highest, dimension))),
            Past::States => {
                Scheme::BackwardDifferentiation(Box::new(BackwardDifferentiation::new(highest, dimension)))
            }
        };
        let mut stepper = Self {
            scheme,
            family,
            past: Differences::new(MOST, dimension),
            norm,
            t: t0,
            end,
            h: T::zero(),
            largest: f64::INFINITY,
            order: 1,
            last_order: 1,
            x: x0.to_vec(),
            next: x0.to_vec(),
            held: 0,
            is_starting: true,
            streak: 0,
            statistics: Statistics::default(),
        };
        let mut derivative = x0.to_vec();
        field.evaluate(t0, x0, &mut derivative, &mut []);
        stepper.h = initial_step(field, &stepper.norm, t0, (x0, &derivative), end - t0);
        stepper.statistics.evaluations += 2;
        stepper.begin(&derivative);
        Ok(stepper)
    }

    /// Makes no step longer than this.
    pub fn set_largest_step(&mut self, largest: T) {
        self.largest = largest.to_f64().abs();
    }

    /// Makes the next step of this length, or of its opposite where that goes to the end.
    pub fn set_step(&mut self, step: T) {
        let length = step.to_f64().abs();
        self.h = T::from_f64(length.copysign((self.end - self.t).to_f64()));
    }

    /// The time of the state.
    pub fn time(&self) -> T {
        self.t
    }

    /// The state.
    pub fn state(&self) -> &[T] {
        &self.x
    }

    /// The length of the last step; zero before the first.
    pub fn last_step(&self) -> T {
        if self.statistics.steps == 0 { T::zero() } else { self.past.psi(0) }
    }

    /// The order of the formula that made the last step.
    pub fn last_order(&self) -> usize {
        self.last_order
    }

    /// The family.
    pub fn family(&self) -> Family {
        self.family
    }

    /// What was done so far.
    pub fn statistics(&self) -> Statistics {
        let mut statistics = self.statistics;
        if let Scheme::BackwardDifferentiation(scheme) = &self.scheme {
            let counts = scheme.newton.counts();
            statistics.evaluations += counts.evaluations;
            statistics.jacobians += counts.jacobians;
            statistics.factorizations += counts.factorizations;
        }
        statistics
    }

    /// Whether the last two dozen steps were bounded by the stability of an explicit formula, not by its error.
    pub fn is_stiff(&self) -> bool {
        self.family.past() == Past::Derivatives && self.streak >= STIFF_STREAK
    }

    /// Whether the last two dozen steps of an implicit formula could have been those of an explicit one.
    pub fn is_nonstiff(&self) -> bool {
        self.family.past() == Past::States && self.streak >= STIFF_STREAK
    }

    /// Makes one step, of at most what is left to the end, which is met exactly. Returns why there is none, at the end or where it can
    /// not go on: then the state is the last good one.
    pub fn advance(&mut self, field: &mut impl Field<T>) -> Option<SolveStatus> {
        if self.t == self.end {
            return Some(SolveStatus::Completed);
        }
        let mut failures = 0;
        loop {
            self.bound_step();
            let t = self.next_time();
            if t == self.t || !t.is_finite() {
                return Some(SolveStatus::StepTooSmall);
            }
            match self.attempt(field, t) {
                Ok(errors) => {
                    self.accept(field, t, errors);
                    return None;
                }
                Err(failed) => {
                    failures += 1;
                    self.statistics.rejected += 1;
                    if let Some(status) = self.retreat(field, failed, failures) {
                        return Some(status);
                    }
                }
            }
        }
    }

    /// Writes the state at a time within the last step, by a polynomial of the order of the formula.
    pub fn state_at(&self, t: T, out: &mut [T]) {
        let newest = self.past.newest(self.interpolated());
        Piece::<T>::write(self.family.past(), newest, &self.x, t - self.t, out);
    }

    /// The polynomial of the last step.
    pub(in crate::integrate) fn piece(&self) -> Piece<T> {
        let start = self.t - self.last_step();
        Piece::new([start, self.t], self.family.past(), self.past.newest(self.interpolated()), &self.x)
    }

    /// How many differences the polynomial of the last step takes.
    fn interpolated(&self) -> usize {
        (self.last_order + 1).min(self.past.known())
    }

    fn begin(&mut self, derivative: &[T]) {
        match self.family.past() {
            Past::Derivatives => self.past.begin(derivative, None),
            Past::States => self.past.begin(&self.x, Some((derivative, self.h))),
        }
        self.order = 1;
        self.held = 0;
        self.is_starting = true;
        self.streak = 0;
    }

    fn bound_step(&mut self) {
        let length = self.h.to_f64();
        if length.abs() > self.largest {
            self.h = T::from_f64(self.largest.copysign(length));
        }
    }

    /// The time after the next step, whose length is made to meet the end.
    fn next_time(&mut self) -> T {
        let (left, h) = ((self.end - self.t).to_f64(), self.h.to_f64());
        if h.abs() >= left.abs() * (1.0 - 1e-10) {
            self.h = self.end - self.t;
            return self.end;
        }
        // Two equal steps rather than one and a sliver.
        if 2.0 * h.abs() > left.abs() {
            self.h = T::from_f64(0.5 * left);
        }
        self.t + self.h
    }

    fn attempt(&mut self, field: &mut impl Field<T>, t: T) -> Result<Errors, Failed> {
        self.past.prepare(self.h);
        let Self { scheme, past, norm, h, order, x, next, statistics, .. } = self;
        let step = Step { t, h: *h, order: *order, from: x };
        let errors = match scheme {
            Scheme::Adams(scheme) => {
                statistics.evaluations += 1;
                scheme.attempt(field, past, norm, step, next).ok_or(Failed::NotFinite)?
            }
            Scheme::BackwardDifferentiation(scheme) => {
                scheme.attempt(field, past, norm, step, next).ok_or(Failed::NotSolved)?
            }
        };
        if !next.iter().all(|entry| entry.is_finite()) {
            return Err(Failed::NotFinite);
        }
        if errors.own <= 1.0 {
            return Ok(errors);
        }
        self.shrink_for(errors);
        Err(Failed::Error)
    }

    /// Makes the step after one with too large an error shorter, and of a lower order where that would have erred less.
    fn shrink_for(&mut self, errors: Errors) {
        let order = self.order;
        if errors.lower.is_some_and(|lower| lower <= errors.own) {
            self.order -= 1;
        }
        self.scale(growth(errors.own, order).clamp(0.2, 0.9));
    }

    fn scale(&mut self, factor: f64) {
        self.h = self.h * T::from_f64(factor);
        self.held = 0;
    }

    /// What follows an attempt that failed; returns why nothing does.
    fn retreat(&mut self, field: &mut impl Field<T>, failed: Failed, failures: usize) -> Option<SolveStatus> {
        self.is_starting = false;
        if failed != Failed::Error {
            self.scale(AFTER_FAILURE);
        }
        let too_small =
            self.h.to_f64().abs() <= 4.0 * T::RESOLUTION * self.t.to_f64().abs().max(f64::MIN_POSITIVE);
        if too_small || failures > 100 {
            return Some(match failed {
                Failed::Error => SolveStatus::StepTooSmall,
                Failed::NotFinite => SolveStatus::NonFinite,
                Failed::NotSolved => SolveStatus::NoConvergence,
            });
        }
        if failures >= FAILURES {
            self.forget(field);
        }
        None
    }

    /// Begins anew from here: what is remembered does not belong to what comes.
    fn forget(&mut self, field: &mut impl Field<T>) {
        let mut derivative = std::mem::take(&mut self.next);
        field.evaluate(self.t, &self.x, &mut derivative, &mut []);
        self.statistics.evaluations += 1;
        self.scale(0.5);
        self.begin(&derivative);
        self.next = derivative;
        self.is_starting = false;
    }

    fn accept(&mut self, field: &mut impl Field<T>, t: T, errors: Errors) {
        let order = self.order;
        match &mut self.scheme {
            Scheme::Adams(scheme) => {
                scheme.accept(field, &mut self.past, &self.norm, (t, order), &self.next);
                self.statistics.evaluations += 1;
            }
            Scheme::BackwardDifferentiation(scheme) => scheme.accept(&mut self.past, order),
        }
        std::mem::swap(&mut self.x, &mut self.next);
        self.t = t;
        self.norm.weigh_by(&self.x);
        self.statistics.steps += 1;
        self.statistics.orders[order] += 1;
        self.last_order = order;
        self.held += 1;
        self.watch_stiffness();
        match self.family.past() {
            Past::Derivatives => self.choose_freely(errors),
            Past::States => self.choose_sparingly(errors),
        }
    }

    /// The errors of orders that the family has.
    fn available(&self, errors: Errors) -> Errors {
        let may_rise = self.order < self.family.highest();
        Errors { higher: errors.higher.filter(|_| may_rise), ..errors }
    }

    /// The next order and step of an explicit formula: both may change at every step.
    fn choose_freely(&mut self, errors: Errors) {
        let errors = self.available(errors);
        let may_rise = self.order < self.family.highest();
        let rises = may_rise
            && self.past.known() > self.order
            && errors.higher.is_none_or(|higher| higher < errors.own);
        if self.is_starting && rises {
            let factor = growth(errors.own, self.order).clamp(SHRINKAGE, START_GROWTH);
            self.order += 1;
            self.scale(factor);
            return;
        }
        self.is_starting = false;
        let (order, factor) = errors.best(self.order);
        self.order = order;
        self.scale(factor.clamp(SHRINKAGE, GROWTH));
    }

    /// The next order and step of an implicit formula, whose factors are worth keeping.
    fn choose_sparingly(&mut self, errors: Errors) {
        let mut errors = self.available(errors);
        if self.is_starting
            && self.order < self.family.highest()
            && errors.lower.is_none_or(|lower| lower > errors.own)
        {
            let factor = growth(errors.own, self.order).clamp(SHRINKAGE, START_GROWTH);
            self.order += 1;
            self.scale(factor);
            return;
        }
        self.is_starting = false;
        if self.held <= self.order {
            errors.higher = None;
        }
        let (order, factor) = errors.best(self.order);
        let is_worth_it = factor < 1.0 || factor >= WORTH_IT && self.held > self.order;
        if order < self.order || is_worth_it {
            self.order = order;
            self.scale(factor.clamp(SHRINKAGE, START_GROWTH));
        }
    }

    fn watch_stiffness(&mut self) {
        let h = self.past.psi(0).to_f64().abs();
        let is_met = match &self.scheme {
            Scheme::Adams(scheme) => h * scheme.lipschitz() > NEAR_UNSTABLE * STABLE[self.last_order - 1],
            Scheme::BackwardDifferentiation(scheme) => {
                h * self.norm.of_matrix(scheme.newton.jacobian())
                    < 0.5 * NEAR_UNSTABLE * STABLE[self.last_order]
            }
        };
        self.streak = if is_met { self.streak + 1 } else { self.streak.saturating_sub(2) };
    }
}
