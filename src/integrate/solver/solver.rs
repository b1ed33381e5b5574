use super::Solution;
use super::choice::Choice;
use super::engine::Engine;
use super::event::Event;
use super::run::Run;
use crate::integrate::adaptive::{Family, SolveStatus};
use crate::integrate::error::IntegrateError;
use crate::integrate::field::Field;
use crate::integrate::method::Method;
use crate::math::Scalar;

/// Solves initial value problems `x' = f(t, x)`, `x(t_0) = x_0`, from a start to an end, forwards or backwards in time.
///
/// | what makes the steps | |
/// |---|---|
/// | [`Solver::automatic`] | Adams formulas of varying steps and order, and backward differentiation where the problem is stiff |
/// | [`Solver::family`] | one of the two |
/// | [`Solver::method`] | any row or pair of the table in equal steps |
///
/// The error of each step is held below a twentieth of `rtol |x_i| + atol_i` in the root mean square over the components, so that the
/// error at the end is mostly about what is allowed; more where the problem amplifies errors.
///
/// ```
/// use kinstep::integrate::{Direction, Event, Ode, Solver};
/// // A ball that is thrown, until it comes down.
/// let mut ball = Ode::new(2, |_t, x: &[f64], f: &mut [f64]| {
///     f[0] = x[1];
///     f[1] = -9.81;
/// });
/// let ground = Event::new("ground", |_t, x: &[f64]| x[0]).direction(Direction::Falling).terminal();
/// let solution = Solver::automatic().tolerance(1e-8, 1e-10).event(ground).sample_at([0.5]).solve(&mut ball, 0.0, &[0.0, 9.81], 5.0)?;
/// assert!((solution.t - 2.0).abs() < 1e-8);
/// assert!((solution.samples[0].x[0] - (9.81 * 0.5 - 9.81 * 0.125)).abs() < 1e-8);
/// # Ok::<(), kinstep::integrate::IntegrateError>(())
/// ```
#[derive(Debug)]
pub struct Solver<'e, T> {
    choice: Choice<T>,
    relative: f64,
    absolute: Vec<f64>,
    initial_step: Option<T>,
    largest_step: Option<T>,
    most_steps: usize,
    times: Vec<T>,
    events: Vec<Event<'e, T>>,
    keeps_steps: bool,
    is_dense: bool,
}

/// Steps before a solution is given up, unless another number is set.
const MOST_STEPS: usize = 1_000_000;

impl<'e, T: Scalar> Solver<'e, T> {
    /// Adams formulas, and backward differentiation from where the problem turns out to be stiff.
    pub fn automatic() -> Self {
        Self::of(Choice::Automatic)
    }

    /// The formulas of one family.
    pub fn family(family: Family) -> Self {
        Self::of(Choice::Family(family))
    }

    /// A row or a pair, in equal steps of at most `step`; tolerances do not matter.
    pub fn method(method: Method<T>, step: T) -> Self {
        Self::of(Choice::Method(method, step))
    }

    fn of(choice: Choice<T>) -> Self {
        Self {
            choice,
            relative: 1e-6,
            absolute: vec![1e-9],
            initial_step: None,
            largest_step: None,
            most_steps: MOST_STEPS,
            times: Vec::new(),
            events: Vec::new(),
            keeps_steps: false,
            is_dense: false,
        }
    }

    /// Sets the relative tolerance and the absolute one of all components; 1e-6 and 1e-9 unless set.
    #[must_use]
    pub fn tolerance(self, relative: f64, absolute: f64) -> Self {
        self.tolerances(relative, &[absolute])
    }

    /// Sets the relative tolerance and the absolute one of each component.
    #[must_use]
    pub fn tolerances(self, relative: f64, absolute: &[f64]) -> Self {
        Self { relative, absolute: absolute.to_vec(), ..self }
    }

    /// Sets the length of the first step, which is found otherwise.
    #[must_use]
    pub fn initial_step(self, step: T) -> Self {
        Self { initial_step: Some(step), ..self }
    }

    /// Makes no step longer than this.
    #[must_use]
    pub fn largest_step(self, step: T) -> Self {
        Self { largest_step: Some(step), ..self }
    }

    /// Gives up after so many steps; a million unless set.
    #[must_use]
    pub fn most_steps(self, steps: usize) -> Self {
        Self { most_steps: steps, ..self }
    }

    /// Tells the states at these times, which have to lie between start and end; steps do not change for them.
    #[must_use]
    pub fn sample_at(self, times: impl IntoIterator<Item = T>) -> Self {
        Self { times: times.into_iter().collect(), ..self }
    }

    /// Watches for an event.
    #[must_use]
    pub fn event(mut self, event: Event<'e, T>) -> Self {
        self.events.push(event);
        self
    }

    /// Keeps the state after every step.
    #[must_use]
    pub fn keep_steps(self) -> Self {
        Self { keeps_steps: true, ..self }
    }

    /// Keeps the polynomial of every step, for [`Solution::at`].
    #[must_use]
    pub fn dense(self) -> Self {
        Self { is_dense: true, ..self }
    }

    /// Solves the problem from the state `x0` at `t0` to the time `end`.
    ///
    /// # Errors
    /// An initial state of the wrong length or not finite, tolerances that are negative or not finite or nothing at all, an end at the
    /// start, times beyond the range, a formula that can not run or does not fit the field. What goes wrong on the way is the
    /// [status](Solution::status) of a partial solution.
    pub fn solve(
        self,
        field: &mut impl Field<T>,
        t0: T,
        x0: &[T],
        end: T,
    ) -> Result<Solution<T>, IntegrateError> {
        let mut engine = Engine::new(&self.choice, field, (t0, x0, end), (self.relative, &self.absolute))?;
        let lengths = [self.initial_step, self.largest_step];
        engine.set_steps(lengths)?;
        let mut run = Run::new((t0, x0, end), self.times, self.events, self.keeps_steps, self.is_dense)?;
        let status = loop {
            if run.is_at_event() {
                break SolveStatus::Event;
            }
            if engine.time() == end {
                break SolveStatus::Completed;
            }
            if engine.statistics().steps >= self.most_steps {
                break SolveStatus::TooManySteps;
            }
            if let Some(status) = engine.advance(field) {
                break status;
            }
            run.take_step(&engine);
            if matches!(self.choice, Choice::Automatic) {
                engine.change_family(field, end)?;
            }
        };
        Ok(run.finish(status, &engine))
    }
}
