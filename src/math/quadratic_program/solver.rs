use super::active_set::ActiveSet;
use super::problem::{Constraint, LeastDistance, NoSolution, dot};

/// What counts as a violation, as a fraction of the size of the numbers.
const TOLERANCE: f64 = 1e-13;

/// Solves problems of a size without allocating, each from the constraints that were active in the one before.
///
/// The dual active set method of Goldfarb and Idnani (Mathematical Programming 27, 1983): from the nearest point on the
/// equalities it takes in the constraint that is violated most, and gives up those whose multipliers would change sign, until
/// none is violated. That rows contradict each other it finds out on the way, with the rows.
///
/// ```
/// use kinstep::math::{LeastDistance, LeastDistanceSolver};
///
/// let mut solver = LeastDistanceSolver::with_capacity(2);
/// let problem = LeastDistance {
///     target: &[0.0, 0.0],
///     equalities: &[1.0, 1.0],
///     values: &[2.0],
///     lower: &[f64::NEG_INFINITY; 2],
///     upper: &[0.5, f64::INFINITY],
///     inequalities: &[],
///     bounds: &[],
/// };
/// let mut x = [0.0; 2];
/// solver.solve(&problem, &mut x).expect("there is such a point");
/// assert!((x[0] - 0.5).abs() < 1e-15 && (x[1] - 1.5).abs() < 1e-15);
/// ```
#[derive(Clone, Debug)]
pub struct LeastDistanceSolver {
    set: ActiveSet,
    previous: Vec<Constraint>,
    conflict: Vec<Constraint>,
}

/// How a solution was found.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Solved {
    /// How often the set of active constraints changed.
    pub steps: usize,
    /// How many equalities follow from others.
    pub dependent_equalities: usize,
}

impl LeastDistanceSolver {
    /// Room for problems of so many unknowns.
    pub fn with_capacity(unknowns: usize) -> Self {
        Self {
            set: ActiveSet::with_capacity(unknowns),
            previous: Vec::with_capacity(unknowns),
            conflict: Vec::with_capacity(unknowns + 1),
        }
    }

    /// Forgets which constraints were active.
    pub fn forget(&mut self) {
        self.previous.clear();
    }

    /// The constraints that are active, equalities first, with their multipliers: `x - c` is the sum of the normals times these.
    pub fn active(&self) -> impl Iterator<Item = (Constraint, f64)> + '_ {
        self.set.constraints.iter().copied().zip(self.set.multipliers.iter().copied())
    }

    /// The rows that contradict each other, after [`NoSolution::Infeasible`].
    pub fn conflict(&self) -> &[Constraint] {
        &self.conflict
    }

    /// Writes the nearest point.
    ///
    /// # Errors
    /// [`NoSolution`]; `x` then means nothing.
    ///
    /// # Panics
    /// When the problem has another number of unknowns, or lists that do not fit together.
    pub fn solve(&mut self, problem: &LeastDistance<'_>, x: &mut [f64]) -> Result<Solved, NoSolution> {
        if !problem.is_sound() {
            return Err(NoSolution::NotFinite);
        }
        self.set.clear();
        self.conflict.clear();
        x.copy_from_slice(problem.target);
        let mut solved = Solved { steps: 0, dependent_equalities: self.meet_equalities(problem, x)? };
        let equalities = self.set.constraints.len();
        self.start_warm(problem, equalities, x);
        let most = 50 + 10 * (problem.unknowns() + problem.bounds.len());
        while let Some(worst) = self.worst(problem, x) {
            self.take_in(problem, worst, equalities, x, (&mut solved.steps, most))?;
        }
        self.set.solve(problem, x);
        self.previous.clear();
        self.previous.extend_from_slice(&self.set.constraints[equalities..]);
        Ok(solved)
    }

    /// Goes to the nearest point on the equalities, and returns how many of them follow from others.
    fn meet_equalities(&mut self, problem: &LeastDistance<'_>, x: &mut [f64]) -> Result<usize, NoSolution> {
        let mut dependent = 0;
        for i in 0..problem.values.len() {
            let equality = Constraint::Equality(i);
            let (value, free) = self.set.look_at(problem, equality);
            let missed = value - dot(&self.set.normal, x);
            if free > 0.0 {
                let length = missed / free;
                for (x, step) in x.iter_mut().zip(&self.set.step) {
                    *x += length * step;
                }
                self.set.add(equality, length);
            } else if missed.abs() <= 1e-9 * (value.abs() + norm(&self.set.normal) * norm(x)) {
                dependent += 1;
            } else {
                self.note_conflict(equality);
                return Err(NoSolution::Infeasible);
            }
        }
        Ok(dependent)
    }

    /// Takes what was active last as active, and leaves out what does not push against its side.
    fn start_warm(&mut self, problem: &LeastDistance<'_>, equalities: usize, x: &mut [f64]) {
        for place in 0..self.previous.len() {
            let constraint = self.previous[place];
            let is_there = match constraint {
                Constraint::Inequality(i) => problem.bounds.get(i).is_some_and(|bound| bound.is_finite()),
                Constraint::Lower(j) => problem.lower[j].is_finite(),
                Constraint::Upper(j) => problem.upper[j].is_finite(),
                Constraint::Equality(_) => false,
            };
            if is_there && self.set.look_at(problem, constraint).1 > 0.0 {
                self.set.add(constraint, 0.0);
            }
        }
        if self.set.constraints.len() == equalities {
            return;
        }
        loop {
            self.set.solve(problem, x);
            let least = (equalities..self.set.constraints.len())
                .min_by(|&a, &b| self.set.multipliers[a].total_cmp(&self.set.multipliers[b]));
            match least {
                Some(place) if self.set.multipliers[place] < 0.0 => self.set.remove(place),
                _ => return,
            }
        }
    }

    /// The constraint that `x` violates most, if there is one.
    fn worst(&self, problem: &LeastDistance<'_>, x: &[f64]) -> Option<Constraint> {
        let size = TOLERANCE * (1.0 + x.iter().fold(0.0_f64, |most, entry| most.max(entry.abs())));
        let mut worst = (size, None);
        for constraint in problem.inequalities() {
            let violation = problem.violation(constraint, x);
            if violation > worst.0 && !self.set.constraints.contains(&constraint) {
                worst = (violation, Some(constraint));
            }
        }
        worst.1
    }

    /// Moves `x` until a constraint holds, and makes it active; gives up those that would pull instead of push.
    fn take_in(
        &mut self,
        problem: &LeastDistance<'_>,
        constraint: Constraint,
        equalities: usize,
        x: &mut [f64],
        (steps, most): (&mut usize, usize),
    ) -> Result<(), NoSolution> {
        let mut multiplier = 0.0;
        loop {
            *steps += 1;
            if *steps > most {
                return Err(NoSolution::TooManySteps);
            }
            let (value, free) = self.set.look_at(problem, constraint);
            let missed = value - dot(&self.set.normal, x);
            let full = if free > 0.0 { missed / free } else { f64::INFINITY };
            let (partial, leaving) = self.first_to_leave(equalities);
            let length = full.min(partial);
            if length.is_infinite() {
                self.note_conflict(constraint);
                return Err(NoSolution::Infeasible);
            }
            if free > 0.0 {
                for (x, step) in x.iter_mut().zip(&self.set.step) {
                    *x += length * step;
                }
            }
            for (own, change) in self.set.multipliers.iter_mut().zip(&self.set.change) {
                *own -= length * change;
            }
            multiplier += length;
            if full <= partial {
                self.set.add(constraint, multiplier);
                return Ok(());
            }
            self.set.remove(leaving);
        }
    }

    /// How far the step may go until the multiplier of an active inequality is zero, and which it is.
    fn first_to_leave(&self, equalities: usize) -> (f64, usize) {
        let mut first = (f64::INFINITY, 0);
        for place in equalities..self.set.constraints.len() {
            let change = self.set.change[place];
            let until = self.set.multipliers[place].max(0.0) / change;
            if change > 0.0 && until < first.0 {
                first = (until, place);
            }
        }
        first
    }

    /// Notes which active constraints a row depends on: together they can not hold.
    fn note_conflict(&mut self, constraint: Constraint) {
        let largest =
            self.set.change[..self.set.constraints.len()].iter().map(|entry| entry.abs()).fold(0.0, f64::max);
        self.conflict.push(constraint);
        for (own, change) in self.set.constraints.iter().zip(&self.set.change) {
            if change.abs() > 1e-9 * largest {
                self.conflict.push(*own);
            }
        }
    }
}

fn norm(entries: &[f64]) -> f64 {
    dot(entries, entries).sqrt()
}
