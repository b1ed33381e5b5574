/// The point `x` nearest to `target`: minimise `1/2 |x - c|^2` subject to `A x = b`, `lower <= x <= upper` and `G x <= g`.
///
/// Rows lie one after the other, each with one entry per unknown.
#[derive(Clone, Copy, Debug)]
pub struct LeastDistance<'a> {
    /// `c`, one entry per unknown.
    pub target: &'a [f64],
    /// `A`, row after row.
    pub equalities: &'a [f64],
    /// `b`.
    pub values: &'a [f64],
    /// The least values of the unknowns; minus infinity where there is none.
    pub lower: &'a [f64],
    /// Their largest values; infinity where there is none.
    pub upper: &'a [f64],
    /// `G`, row after row.
    pub inequalities: &'a [f64],
    /// `g`; infinity where a row asks for nothing.
    pub bounds: &'a [f64],
}

/// A row of a problem.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Constraint {
    /// The equality of that place.
    Equality(usize),
    /// The least value of that unknown.
    Lower(usize),
    /// The largest value of that unknown.
    Upper(usize),
    /// The inequality of that place.
    Inequality(usize),
}

/// Why there is no answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum NoSolution {
    /// Some of the rows contradict each other: [`conflict`](super::LeastDistanceSolver::conflict) has them.
    Infeasible,
    /// A number of the problem is not finite, where it has to be.
    NotFinite,
    /// The steps that were allowed did not suffice, which rounding can bring about where rows nearly depend on each other.
    TooManySteps,
}

impl LeastDistance<'_> {
    /// How many unknowns there are.
    pub(super) fn unknowns(&self) -> usize {
        self.target.len()
    }

    /// Whether all that has to be finite is, and no bound is NaN.
    pub fn is_sound(&self) -> bool {
        let finite = [self.target, self.equalities, self.values, self.inequalities];
        let bounds = [self.lower, self.upper, self.bounds];
        finite.iter().all(|list| list.iter().all(|entry| entry.is_finite()))
            && bounds.iter().all(|list| list.iter().all(|entry| !entry.is_nan()))
    }

    /// Writes the normal `n` of a constraint in the form `n x >= value`, and returns that value.
    pub(super) fn normal(&self, constraint: Constraint, out: &mut [f64]) -> f64 {
        let n = self.unknowns();
        match constraint {
            Constraint::Equality(i) => {
                out.copy_from_slice(&self.equalities[i * n..(i + 1) * n]);
                self.values[i]
            }
            Constraint::Lower(j) => {
                out.fill(0.0);
                out[j] = 1.0;
                self.lower[j]
            }
            Constraint::Upper(j) => {
                out.fill(0.0);
                out[j] = -1.0;
                -self.upper[j]
            }
            Constraint::Inequality(i) => {
                for (out, entry) in out.iter_mut().zip(&self.inequalities[i * n..(i + 1) * n]) {
                    *out = -entry;
                }
                -self.bounds[i]
            }
        }
    }

    /// By how much `x` misses a constraint that is no equality, in units of its normal; negative where it is kept.
    pub(super) fn violation(&self, constraint: Constraint, x: &[f64]) -> f64 {
        match constraint {
            Constraint::Equality(_) => 0.0,
            Constraint::Lower(j) => self.lower[j] - x[j],
            Constraint::Upper(j) => x[j] - self.upper[j],
            Constraint::Inequality(i) => {
                let row = &self.inequalities[i * x.len()..(i + 1) * x.len()];
                let (product, norm) = (dot(row, x), dot(row, row).sqrt());
                if norm > 0.0 { (product - self.bounds[i]) / norm } else { -self.bounds[i] }
            }
        }
    }

    /// All constraints that are no equalities.
    pub(super) fn inequalities(&self) -> impl Iterator<Item = Constraint> + use<> {
        let bounds = (0..self.unknowns()).flat_map(|j| [Constraint::Lower(j), Constraint::Upper(j)]);
        bounds.chain((0..self.bounds.len()).map(Constraint::Inequality))
    }
}

pub(crate) fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
