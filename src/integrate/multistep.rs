use super::ring::{BLOCK, Ring};
use super::runge_kutta::RungeKutta;
use super::weights::{Terms, Weights};
use super::{Field, Parts, Scalar, Starter, Tableau};
use crate::formula::{Formula, NotRunnable};
use fearless_simd::Level;
use thiserror::Error;

/// Why a stepper could not be made.
#[derive(Clone, Debug, Error, PartialEq)]
#[non_exhaustive]
pub enum IntegrateError {
    /// The row may not run: it is implicit, or not zero-stable.
    #[error(transparent)]
    NotRunnable(#[from] NotRunnable),
    /// The initial state, or a given one, does not fit the field.
    #[error("{what} has {got} entries where the right-hand side has {expected}")]
    Dimension {
        /// Which vector.
        what: String,
        /// Its length.
        got: usize,
        /// The length it should have.
        expected: usize,
    },
    /// Too few or too many given starting states.
    #[error("formula `{id}` needs {expected} starting states besides the initial one, got {got}")]
    StartingStates {
        /// The row.
        id: String,
        /// How many were given.
        got: usize,
        /// How many it needs.
        expected: usize,
    },
}

/// Whether a stepper can go on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// All is well.
    Running,
    /// The step from the current state gave an infinite or NaN component; the last good state is kept.
    NonFinite,
}

/// How the next state comes about while the history is short.
#[derive(Clone, Debug)]
enum Start<T> {
    Rows(Vec<Weights<T>>),
    RungeKutta(RungeKutta<T>),
    Given(Vec<Vec<T>>),
}

/// The stepper: a row of the table, its history, and the start that fills it.
///
/// All memory is allocated in [`new`](Self::new); a step allocates nothing. Times are `t_0 + n sigma`, never
/// accumulated. See [`Ode`](super::Ode) for an example.
#[derive(Clone, Debug)]
pub struct Multistep<T> {
    weights: Weights<T>,
    start: Start<T>,
    steps: usize,
    x: Ring<T>,
    f: Ring<T>,
    g: Option<Ring<T>>,
    next: Vec<[T; BLOCK]>,
    t0: T,
    sigma: T,
    index: usize,
    status: Status,
    level: Level,
}

impl<T: Scalar> Multistep<T> {
    /// A stepper for `formula` from the state `x0` at `t0` with sampling gap `sigma`.
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
        let dimension = field.dimension();
        check_length("the initial state", x0, dimension)?;
        let weights = Weights::of(formula, sigma);
        let start = Start::new(formula, starter, dimension, field.parts(), sigma)?;
        // While starting, low-order rows may look further back into f or g than the row itself does.
        let steps = formula.steps();
        let mut stepper = Self {
            // One state more than a row of one step needs, for `previous`.
            x: Ring::new(steps.max(2), dimension, T::zero()),
            f: Ring::new(start.depth(|w| &w.first).max(weights.first.depth()), dimension, T::zero()),
            g: (field.parts() != Parts::One).then(|| {
                Ring::new(start.depth(|w| &w.second).max(weights.second.depth()), dimension, T::zero())
            }),
            next: vec![[T::zero(); BLOCK]; dimension.div_ceil(BLOCK)],
            weights,
            start,
            steps,
            t0,
            sigma,
            index: 0,
            status: Status::Running,
            level: Level::new(),
        };
        stepper.x.push().copy_from_slice(x0);
        Ok(stepper)
    }

    /// The state `x_n`.
    pub fn state(&self) -> &[T] {
        self.x.get(0)
    }

    /// The state `x_n`, to put in its place what was measured of it, before it is [evaluated](Self::evaluate).
    pub fn state_mut(&mut self) -> &mut [T] {
        self.x.newest_mut()
    }

    /// The state `x_(n-1)`; `x_0` itself at the start.
    pub fn previous(&self) -> &[T] {
        self.x.get(self.index.min(1))
    }

    /// The index `n` of the state.
    pub fn index(&self) -> usize {
        self.index
    }

    /// The time `t_n = t_0 + n sigma` of the state.
    pub fn time(&self) -> T {
        self.t0 + T::from_index(self.index) * self.sigma
    }

    /// Whether the run can go on.
    pub fn status(&self) -> Status {
        self.status
    }

    /// Whether the recursion itself has taken over from the starter.
    pub fn is_started(&self) -> bool {
        self.index + 1 >= self.steps
    }

    /// The first part `f(t_n, x_n)` of the last [`evaluate`](Self::evaluate).
    pub fn derivative(&self) -> &[T] {
        self.f.get(0)
    }

    /// Evaluates the field at `(t_n, x_n)`. Call it once for each state, then [`advance`](Self::advance).
    pub fn evaluate(&mut self, field: &mut impl Field<T>) {
        let t = self.time();
        let g = self.g.as_mut().map_or(&mut [] as &mut [T], Ring::push);
        field.evaluate(t, self.x.get(0), self.f.push(), g);
    }

    /// Goes from `x_n` to `x_{n+1}`, using what [`evaluate`](Self::evaluate) found.
    ///
    /// After a non-finite step nothing moves any more: [`state`](Self::state) stays the last good one.
    pub fn advance(&mut self, field: &mut impl Field<T>) -> Status {
        if self.status != Status::Running {
            return self.status;
        }
        let all_finite = if self.is_started() {
            self.weights.combine(self.level, &self.x, &self.f, self.g.as_ref(), &mut self.next)
        } else {
            self.advance_start(field);
            self.next.as_flattened().iter().all(|entry| entry.is_finite())
        };
        if all_finite {
            self.x.push_blocks().copy_from_slice(&self.next);
            self.index += 1;
        } else {
            self.status = Status::NonFinite;
        }
        self.status
    }

    /// Writes what the history contributes to the state after `x_n`, which is to be evaluated next, and returns what its two
    /// parts are multiplied by there: `x_{n+1} = known + first f(t_n, x_n) + second g(t_n, x_n)`.
    ///
    /// While a start is under way that is no row, it is the state after one Euler step.
    pub(crate) fn write_next_state(&self, known: &mut [T]) -> [T; 2] {
        known.copy_from_slice(self.x.get(0));
        [self.sigma; 2]
    }

    /// One step: [`evaluate`](Self::evaluate), then [`advance`](Self::advance).
    pub fn step(&mut self, field: &mut impl Field<T>) -> Status {
        if self.status == Status::Running {
            self.evaluate(field);
            self.advance(field);
        }
        self.status
    }

    fn advance_start(&mut self, field: &mut impl Field<T>) {
        let time = self.time();
        if let Start::Rows(rows) = &self.start {
            let row = &rows[self.index.min(rows.len() - 1)];
            row.combine(self.level, &self.x, &self.f, self.g.as_ref(), &mut self.next);
        }
        let next = &mut self.next.as_flattened_mut()[..field.dimension()];
        match &mut self.start {
            Start::Rows(_) => {}
            Start::RungeKutta(method) => {
                let known = (self.x.get(0), self.f.get(0), self.g.as_ref().map(|g| g.get(0)));
                method.step(field, time, self.sigma, known, next);
            }
            Start::Given(states) => next.copy_from_slice(&states[self.index]),
        }
    }
}

/// Where a component comes from: the index of a stepper among several, and its index there.
pub(crate) type Origin = (usize, usize);

impl<T: Scalar> Multistep<T> {
    /// Whether the other one goes on from the same instant in the same way, with components of its own.
    pub(crate) fn is_in_step_with(&self, other: &Self) -> bool {
        let instant = |stepper: &Self| (stepper.t0, stepper.sigma, stepper.index, stepper.status);
        instant(self) == instant(other)
            && self.weights == other.weights
            && self.g.is_some() == other.g.is_some()
            && self.start.is_like(&other.start)
    }

    /// A stepper that goes on from the histories of others that are [in step](Self::is_in_step_with): every component
    /// comes from one of theirs, or is zero. `None` without a stepper to come from.
    pub(crate) fn gathered(steppers: &[&Self], origins: &[Option<Origin>]) -> Option<Self> {
        let first = *steppers.first()?;
        let ring = |pick: fn(&Self) -> Option<&Ring<T>>| {
            let rings: Option<Vec<_>> = steppers.iter().map(|stepper| pick(stepper)).collect();
            rings.map(|rings| Ring::gathered(&rings, origins, T::zero()))
        };
        let starts: Vec<_> = steppers.iter().map(|stepper| &stepper.start).collect();
        Some(Self {
            weights: first.weights.clone(),
            start: Start::gathered(&starts, origins),
            x: ring(|stepper| Some(&stepper.x))?,
            f: ring(|stepper| Some(&stepper.f))?,
            g: ring(|stepper| stepper.g.as_ref()),
            next: vec![[T::zero(); BLOCK]; origins.len().div_ceil(BLOCK)],
            status: Status::Running,
            ..*first
        })
    }

    /// The components in which the last step was not finite, if it was not.
    pub(crate) fn not_finite(&self) -> impl Iterator<Item = usize> {
        let next = self.next.as_flattened().iter().enumerate();
        next.filter(|(_, entry)| self.status == Status::NonFinite && !entry.is_finite()).map(|(i, _)| i)
    }
}

impl<T: Scalar> Start<T> {
    fn is_like(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Rows(own), Self::Rows(others)) => own == others,
            (Self::RungeKutta(own), Self::RungeKutta(others)) => own.is_like(others),
            (Self::Given(own), Self::Given(others)) => own.len() == others.len(),
            _ => false,
        }
    }

    /// The start of components that come from several, of one kind.
    fn gathered(starts: &[&Self], origins: &[Option<Origin>]) -> Self {
        match starts[0] {
            Self::Rows(rows) => Self::Rows(rows.clone()),
            Self::RungeKutta(method) => Self::RungeKutta(method.for_dimension(origins.len())),
            Self::Given(states) => {
                Self::Given((0..states.len()).map(|k| gathered_state(starts, k, origins)).collect())
            }
        }
    }

    fn new(
        formula: &Formula,
        starter: &Starter<T>,
        dimension: usize,
        parts: Parts,
        sigma: T,
    ) -> Result<Self, IntegrateError> {
        let gamma_sum = formula.gamma_sum();
        Ok(match starter {
            Starter::Paper => Self::Rows(vec![Weights::euler(sigma, &gamma_sum)]),
            Starter::Ramp(ladder) => {
                let fits = |(k, row): &(usize, &Formula)| row.is_explicit() && row.steps() <= k + 1;
                let usable = ladder.iter().take(formula.steps() - 1).enumerate().take_while(fits);
                let rows = usable.map(|(_, row)| Weights::for_start(row, sigma, &gamma_sum));
                Self::Rows(std::iter::once(Weights::euler(sigma, &gamma_sum)).chain(rows.skip(1)).collect())
            }
            Starter::Rk4 => Self::RungeKutta(RungeKutta::new(Tableau::rk4(), dimension, parts)),
            Starter::Rk8 => Self::RungeKutta(RungeKutta::new(Tableau::rk8(), dimension, parts)),
            Starter::Given(states) => {
                let expected = formula.steps() - 1;
                if states.len() != expected {
                    let id = formula.id().to_owned();
                    return Err(IntegrateError::StartingStates { id, got: states.len(), expected });
                }
                for (k, state) in states.iter().enumerate() {
                    check_length(&format!("starting state {}", k + 1), state, dimension)?;
                }
                Self::Given(states.clone())
            }
        })
    }

    /// How far back the starting rows look, in the part that `pick` names; at least the newest evaluation is kept.
    fn depth(&self, pick: impl Fn(&Weights<T>) -> &Terms<T>) -> usize {
        match self {
            Self::Rows(rows) => rows.iter().map(|row| pick(row).depth()).max().unwrap_or(1).max(1),
            _ => 1,
        }
    }
}

/// The given state `k` of components that come from several starts.
fn gathered_state<T: Scalar>(starts: &[&Start<T>], k: usize, origins: &[Option<Origin>]) -> Vec<T> {
    let entry = |origin: &Option<Origin>| match origin.map(|(which, i)| (starts[which], i)) {
        Some((Start::Given(states), i)) => states[k][i],
        _ => T::zero(),
    };
    origins.iter().map(entry).collect()
}

fn check_length<T>(what: &str, vector: &[T], expected: usize) -> Result<(), IntegrateError> {
    if vector.len() == expected {
        return Ok(());
    }
    Err(IntegrateError::Dimension { what: what.to_owned(), got: vector.len(), expected })
}
