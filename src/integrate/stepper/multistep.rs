use super::correction::Correction;
use super::phase::Phase;
use crate::formula::{Formula, NotRunnable};
use crate::integrate::coefficients::{Coefficients, WeightedRow, Weights, combine};
use crate::integrate::controller::{Attempt, Decision, StepController};
use crate::integrate::error::{IntegrateError, check_length};
use crate::integrate::field::{Field, Parts};
use crate::integrate::history::{BLOCK, Depths, History, Origin, Times};
use crate::integrate::method::Method;
use crate::integrate::starter::{RunningStarter, Starter};
use crate::integrate::status::Status;
use crate::math::Scalar;
use fearless_simd::Level;

/// The stepper: a method, its history, and the start that fills it.
///
/// [`step`](Self::step) is the simple door. A step consists of [`evaluate`](Self::evaluate), [`predict`](Self::predict),
/// [`correct`](Self::correct), and [`accept`](Self::accept) or [`reject`](Self::reject), each of which can be called by itself.
///
/// All memory is allocated when it is made; a step allocates nothing. Times of equal steps are `t_0 + n sigma`, never
/// accumulated. See [`Ode`](crate::integrate::field::Ode) for an example.
#[derive(Clone, Debug)]
pub struct Multistep<T> {
    /// The row that makes candidates: the only one, or the predictor of a pair.
    row: WeightedRow<T>,
    /// Nothing in an explicit method.
    correction: Option<Box<Correction<T>>>,
    starter: RunningStarter<T>,
    history: History<T>,
    candidate: Vec<[T; BLOCK]>,
    steps: usize,
    order: usize,
    phase: Phase,
    status: Status,
    level: Level,
}

impl<T: Scalar> Multistep<T> {
    /// A stepper for the explicit row `formula` from the state `x0` at `t0` with sampling gap `sigma`.
    ///
    /// # Errors
    /// An implicit or unstable row, an initial or given state of the wrong length, a wrong number of given states.
    pub fn new(
        formula: &Formula,
        starter: &Starter<T>,
        field: &impl Field<T>,
        t0: T,
        sigma: T,
        x0: &[T],
    ) -> Result<Self, IntegrateError> {
        formula.runnable()?;
        Self::for_study(formula, starter, field, t0, sigma, x0)
    }

    /// The same without the zero-stability check, to watch an unstable row fail.
    ///
    /// # Errors
    /// As [`new`](Self::new), except that unstable rows are let through.
    pub fn for_study(
        formula: &Formula,
        starter: &Starter<T>,
        field: &impl Field<T>,
        t0: T,
        sigma: T,
        x0: &[T],
    ) -> Result<Self, IntegrateError> {
        if !formula.is_explicit() {
            return Err(NotRunnable::Implicit { id: formula.id().to_owned() }.into());
        }
        Self::unchecked(&Method::of(formula), starter, field, t0, sigma, x0)
    }

    /// A stepper for any method, explicit or not, from the state `x0` at `t0`; `sigma` is the sampling gap or, where steps may
    /// vary, the length of the first steps, up to the end of the start.
    ///
    /// # Errors
    /// An unstable row (of a pair, the corrector), a row whose kind does not fit its place, an implicit-explicit row on a field of
    /// one part, an initial or given state of the wrong length, a wrong number of given states.
    #[expect(
        clippy::needless_pass_by_value,
        reason = "a method is mostly made where it is needed, as an argument"
    )]
    pub fn of_method(
        method: Method<T>,
        starter: &Starter<T>,
        field: &impl Field<T>,
        t0: T,
        sigma: T,
        x0: &[T],
    ) -> Result<Self, IntegrateError> {
        method.check_stability()?;
        method.check_roles()?;
        if let (Method::Imex(row), Parts::One) = (&method, field.parts()) {
            return Err(IntegrateError::OnePart { id: row.id().to_owned() });
        }
        Self::unchecked(&method, starter, field, t0, sigma, x0)
    }

    fn unchecked(
        method: &Method<T>,
        starter: &Starter<T>,
        field: &impl Field<T>,
        t0: T,
        sigma: T,
        x0: &[T],
    ) -> Result<Self, IntegrateError> {
        let dimension = field.dimension();
        check_length("the initial state", x0, dimension)?;
        if !sigma.is_finite() || sigma == T::zero() {
            return Err(IntegrateError::SamplingGap { text: format!("{sigma:?}") });
        }
        let starter = RunningStarter::new(starter, method, field, sigma)?;
        let row = WeightedRow::new(method.predictor().unwrap_or_else(|| method.row()), sigma);
        let correction = Correction::new(method, field, sigma).map(Box::new);
        let steps = method.steps();
        let times =
            if method.row().may_vary() { Times::stored(t0, sigma, steps) } else { Times::uniform(t0, sigma) };
        // While starting, low-order rows may look further back into f or g than the row itself does.
        let corrector = correction.as_ref().and_then(|correction| correction.corrector.as_ref());
        let looks_back = [Some(starter.depths()), Some(row.depths()), corrector.map(|c| c.row.depths())];
        let looks_back = looks_back.into_iter().flatten();
        let (first, second) =
            looks_back.fold((0, 0), |deepest, depths| (deepest.0.max(depths.0), deepest.1.max(depths.1)));
        let depths = Depths {
            // One state more than a row of one step needs, for `previous`.
            states: steps.max(2),
            first,
            second: (field.parts() != Parts::One).then_some(second),
        };
        let predictor_order = method.predictor().map(Coefficients::order);
        Ok(Self {
            row,
            correction,
            starter,
            history: History::new(depths, times, x0),
            candidate: vec![[T::zero(); BLOCK]; dimension.div_ceil(BLOCK)],
            steps,
            order: method.row().order().min(predictor_order.unwrap_or(usize::MAX)),
            phase: Phase::Reached,
            status: Status::Running,
            level: Level::new(),
        })
    }

    /// The state `x_n`.
    pub fn state(&self) -> &[T] {
        self.history.x.get(0)
    }

    /// The state `x_n`, to put in its place what was measured of it, before it is [evaluated](Self::evaluate).
    pub fn state_mut(&mut self) -> &mut [T] {
        self.history.x.newest_mut()
    }

    /// The state `x_(n-1)`; `x_0` itself at the start.
    pub fn previous(&self) -> &[T] {
        self.history.x.get(self.index().min(1))
    }

    /// The index `n` of the state.
    pub fn index(&self) -> usize {
        self.history.times.index()
    }

    /// The time `t_n` of the state: `t_0 + n sigma`, or what the accepted steps add up to where steps may vary.
    pub fn time(&self) -> T {
        self.history.times.now()
    }

    /// The length of the step that is to follow.
    pub fn step_size(&self) -> T {
        self.history.times.step()
    }

    /// Whether the run can go on.
    pub fn status(&self) -> Status {
        self.status
    }

    /// Whether the recursion itself has taken over from the starter.
    pub fn is_started(&self) -> bool {
        self.index() + 1 >= self.steps
    }

    /// The first part `f(t_n, x_n)` of the last [`evaluate`](Self::evaluate).
    pub fn derivative(&self) -> &[T] {
        self.history.f.get(0)
    }

    /// The next state as [`predict`](Self::predict) and [`correct`](Self::correct) made it, before it is accepted.
    pub fn candidate(&self) -> &[T] {
        &self.candidate.as_flattened()[..self.state().len()]
    }

    /// The estimate of the last step's own error by a predictor-corrector pair, component by component; `None` for other methods
    /// and while the starter is at work.
    ///
    /// For rows of one order it is Milne's, `C_C / (C_P - C_C)` times the difference of corrected and predicted state, with the
    /// error constants `C` of both rows: what the exact solution through the same past has more than the corrected state. For
    /// rows of different orders it is that difference itself.
    pub fn error_estimate(&self) -> Option<&[T]> {
        self.correction.as_ref().and_then(|correction| correction.error())
    }

    /// Evaluates the field at `(t_n, x_n)`, unless that has been done for this state.
    #[inline]
    pub fn evaluate(&mut self, field: &mut impl Field<T>) {
        if self.phase == Phase::Reached {
            self.history.evaluate(field);
            self.phase = Phase::Evaluated;
        }
    }

    /// Makes a [candidate](Self::candidate) for the next state of what is known, after [evaluating](Self::evaluate) this one if
    /// that has not been done. To be [corrected](Self::correct).
    #[inline]
    pub fn predict(&mut self, field: &mut impl Field<T>) -> Status {
        if self.status != Status::Running {
            return self.status;
        }
        self.evaluate(field);
        let weights = if self.is_started() {
            self.row.adapt(&self.history.times);
            &self.row.weights
        } else {
            match self.starter.row(self.index()) {
                Some(weights) => weights,
                None => return self.start(field),
            }
        };
        let is_finite = combine(self.level, weights, &self.history, &mut self.candidate);
        self.conclude(if is_finite { Status::Running } else { Status::NonFinite }, Phase::Predicted)
    }

    /// Corrects what was [predicted](Self::predict): solves for it, or evaluates and corrects it, as the method says. Nothing
    /// happens in an explicit method, or without a prediction.
    #[inline]
    pub fn correct(&mut self, field: &mut impl Field<T>) -> Status {
        if self.phase != Phase::Predicted {
            return self.status;
        }
        let status = if self.correction.is_some() { self.apply_correction(field) } else { Status::Running };
        self.conclude(status, Phase::Corrected)
    }

    /// Makes the [corrected](Self::correct) candidate the next state. Nothing happens without one.
    #[inline]
    pub fn accept(&mut self) -> Status {
        if self.phase == Phase::Corrected {
            self.history.commit(&self.candidate);
            self.phase = Phase::Reached;
            if self.correction.is_some() {
                self.keep_evaluation();
            }
        }
        self.status
    }

    /// Drops the candidate; the state and its history are what they were before it was predicted.
    pub fn reject(&mut self) {
        self.phase = self.phase.min(Phase::Evaluated);
    }

    /// Makes the step that is to follow of another length, and drops a candidate. Rows of fixed coefficients keep
    /// their step, and so does the start.
    ///
    /// Returns [`Status::StepTooSmall`], and ends the run, where that would not change the time, or would turn it round.
    pub fn set_step_size(&mut self, step: T) -> Status {
        if self.status == Status::Running && self.history.times.may_vary() && self.is_started() {
            self.reject();
            let (now, zero) = (self.time(), T::zero());
            let advance = now + step - now;
            let is_forward = if self.step_size() < zero { advance < zero } else { advance > zero };
            if is_forward && advance.is_finite() {
                self.history.times.set_step(step);
            } else {
                self.status = Status::StepTooSmall;
            }
        }
        self.status
    }

    /// Goes from `x_n` to `x_{n+1}` in a step of unchanged length.
    ///
    /// After a failure nothing moves any more: [`state`](Self::state) stays the last good one. It is what
    /// [`step_under`](Self::step_under) does with [`FixedStep`](crate::integrate::controller::FixedStep).
    pub fn step(&mut self, field: &mut impl Field<T>) -> Status {
        self.predict(field);
        self.correct(field);
        self.accept()
    }

    /// Goes from `x_n` to `x_{n+1}` in the first step that the controller accepts.
    ///
    /// Rejected attempts leave the state and its history as they were. While the starter is at work the controller is not asked.
    pub fn step_under(
        &mut self,
        field: &mut impl Field<T>,
        controller: &mut impl StepController<T>,
    ) -> Status {
        while self.status == Status::Running {
            self.predict(field);
            self.correct(field);
            if self.judge(controller) {
                break;
            }
        }
        self.status
    }

    /// Makes a candidate by a starter that is no row.
    #[cold]
    fn start(&mut self, field: &mut impl Field<T>) -> Status {
        let next = &mut self.candidate.as_flattened_mut()[..field.dimension()];
        if let RunningStarter::Apart(starter) = &mut self.starter {
            starter.write(field, &self.history, next);
        }
        let status = Status::of_finite(next);
        self.conclude(status, Phase::Predicted)
    }

    /// Takes over the evaluation that a pair made at the new time, where its mode keeps that one.
    fn keep_evaluation(&mut self) {
        let correction = self.correction.as_ref();
        if let Some((f, g)) = correction.and_then(|correction| correction.kept_evaluation()) {
            self.history.remember_evaluation(f, g);
            self.phase = Phase::Evaluated;
        }
    }

    fn apply_correction(&mut self, field: &mut impl Field<T>) -> Status {
        let is_started = self.is_started();
        let Self { row, correction, starter, history, candidate, level, .. } = self;
        let Some(correction) = correction else { return Status::Running };
        if is_started && correction.corrector.is_some() {
            return correction.correct(field, *level, history, row.per_step_constant, candidate);
        }
        let weights = if is_started { Some(&row.weights) } else { starter.row(history.times.index()) };
        match weights.filter(|weights| weights.is_implicit()) {
            Some(weights) => {
                correction.solve(field, history.times.next(), weights.new, history.x.get(0), candidate)
            }
            None => correction.pass(),
        }
    }

    /// Notes how a part of the step went.
    #[inline]
    fn conclude(&mut self, status: Status, phase: Phase) -> Status {
        self.status = status;
        self.phase = if status == Status::Running { phase } else { Phase::Evaluated };
        status
    }

    /// Does what the controller says to an attempt, and returns whether that was the last one from this state.
    #[inline]
    fn judge(&mut self, controller: &mut impl StepController<T>) -> bool {
        if self.status != Status::Running {
            return self.judge_failure(controller);
        }
        if !self.is_started() {
            self.accept();
            return true;
        }
        match controller.judge(&self.attempt()) {
            Decision::Accept { next } => {
                self.accept();
                self.set_step_size(next);
                true
            }
            Decision::Reject { .. } if !self.history.times.may_vary() => {
                self.conclude(Status::Rejected, Phase::Evaluated);
                true
            }
            Decision::Reject { retry } => {
                self.set_step_size(retry);
                false
            }
        }
    }

    /// Tries another step after one that came to nothing, where the controller has one to offer.
    fn judge_failure(&mut self, controller: &mut impl StepController<T>) -> bool {
        if !self.is_started() || !self.history.times.may_vary() {
            return true;
        }
        match controller.after_failure(self.step_size(), self.status) {
            None => true,
            Some(retry) => {
                self.status = Status::Running;
                self.set_step_size(retry);
                false
            }
        }
    }

    fn attempt(&self) -> Attempt<'_, T> {
        Attempt {
            time: self.time(),
            step: self.step_size(),
            from: self.state(),
            to: self.candidate(),
            error: self.error_estimate(),
            order: self.order,
        }
    }
}

impl<T: Scalar> Multistep<T> {
    /// Whether the other one goes on from the same instant in the same way, with components of its own. Methods that correct
    /// are never, for what they solve is a matter of all components together.
    pub(crate) fn is_in_step_with(&self, other: &Self) -> bool {
        let is_explicit = self.correction.is_none() && other.correction.is_none();
        is_explicit
            && (self.phase, self.status) == (other.phase, other.status)
            && self.history.is_in_step_with(&other.history)
            && self.row.is_like(&other.row)
            && self.starter.is_like(&other.starter)
    }

    /// A stepper that goes on from the histories of others that are [in step](Self::is_in_step_with): every component
    /// comes from one of theirs, or is zero. `None` without a stepper to come from.
    pub(crate) fn gathered(steppers: &[&Self], origins: &[Option<Origin>]) -> Option<Self> {
        let first = *steppers.first()?;
        let histories: Vec<_> = steppers.iter().map(|stepper| &stepper.history).collect();
        let starters: Vec<_> = steppers.iter().map(|stepper| &stepper.starter).collect();
        let correction = first.correction.as_ref().map(|correction| correction.resized(origins.len()));
        Some(Self {
            row: first.row.clone(),
            correction: correction.map(Box::new),
            starter: RunningStarter::gathered(&starters, origins),
            history: History::gathered(&histories, origins)?,
            candidate: vec![[T::zero(); BLOCK]; origins.len().div_ceil(BLOCK)],
            phase: first.phase.min(Phase::Evaluated),
            status: Status::Running,
            ..*first
        })
    }

    /// The components in which the last step was not finite, if it was not.
    pub(crate) fn not_finite(&self) -> impl Iterator<Item = usize> {
        let next = self.candidate.as_flattened().iter().enumerate();
        next.filter(|(_, entry)| self.status == Status::NonFinite && !entry.is_finite()).map(|(i, _)| i)
    }

    /// The history.
    pub(super) fn history(&self) -> &History<T> {
        &self.history
    }

    /// The row that makes the next candidate, where a row does.
    pub(super) fn next_row(&self) -> Option<&Weights<T>> {
        if self.is_started() { Some(&self.row.weights) } else { self.starter.row(self.history.times.index()) }
    }
}
