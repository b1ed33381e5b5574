use super::error_norm::ErrorNorm;
use crate::integrate::affine::{Affine, Solved};
use crate::integrate::field::Field;
use crate::math::{LuFactors, Scalar};

/// Iterations before another Jacobian is tried, or the step is given up.
const MOST_ITERATIONS: usize = 4;
/// How near an iterate has to be to what it converges to, in units of the allowed error.
const NEAR: f64 = 0.1;
/// The worst rate of convergence that is put up with.
const SLOWEST: f64 = 0.9;
/// By what fraction the factor of `f` may change before the matrix is factorised anew.
const STALE: f64 = 0.3;
/// Iterations where the answer is to be as good as the numbers.
const MOST_PRECISE_ITERATIONS: usize = 40;
/// The last change, in units of a few resolutions, that is put up with where rounding ends the convergence.
const ROUNDING: f64 = 1e5;
/// For how many steps a Jacobian is kept.
const OLDEST: usize = 50;

/// Solves `x = known + first f(t, x)` by Newton's method, with a Jacobian that is kept as long as it serves.
///
/// Each iteration is `(I - first' J) d = known + first f(t, x) - x`, `x += d`, with the factors of an earlier step where its
/// `first'` is near `first`; `d` is then scaled by `2 / (1 + first / first')`. It ends where `rate |d| / (1 - rate)` is below a tenth
/// of what is allowed. (Hairer and Wanner, Solving Ordinary Differential Equations II, section IV.8; Brenan, Campbell and Petzold,
/// Numerical Solution of Initial-Value Problems in Differential-Algebraic Equations, section 5.2.2.)
#[derive(Clone, Debug)]
pub(in crate::integrate) struct Newton<T> {
    jacobian: Vec<T>,
    factors: LuFactors<T>,
    /// The factor of `f` in the factors; nothing where there are none.
    factored: Option<T>,
    /// For how many steps the Jacobian has been used; nothing where there is none.
    age: Option<usize>,
    rate: f64,
    most_iterations: usize,
    /// The size of a change at which it does not matter that changes no longer become smaller.
    stagnant: f64,
    guess: Vec<T>,
    derivative: Vec<T>,
    change: Vec<T>,
    counts: NewtonCounts,
}

/// What solving took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(in crate::integrate) struct NewtonCounts {
    /// Evaluations of the field, those for differences among them.
    pub(in crate::integrate) evaluations: usize,
    /// Jacobians.
    pub(in crate::integrate) jacobians: usize,
    /// Factorisations.
    pub(in crate::integrate) factorizations: usize,
}

impl<T: Scalar> Newton<T> {
    /// The memory for systems of so many unknowns.
    pub(in crate::integrate) fn new(dimension: usize) -> Self {
        let vector = || vec![T::zero(); dimension];
        Self {
            jacobian: vec![T::zero(); dimension * dimension],
            factors: LuFactors::new(dimension),
            factored: None,
            age: None,
            rate: 1.0,
            most_iterations: MOST_ITERATIONS,
            stagnant: 0.0,
            guess: vector(),
            derivative: vector(),
            change: vector(),
            counts: NewtonCounts::default(),
        }
    }

    /// The same for answers that are as good as the numbers: the norm has to allow a few of their resolutions.
    pub(in crate::integrate) fn precise(dimension: usize) -> Self {
        Self { most_iterations: MOST_PRECISE_ITERATIONS, stagnant: ROUNDING, ..Self::new(dimension) }
    }

    /// What solving took so far.
    pub(in crate::integrate) fn counts(&self) -> NewtonCounts {
        self.counts
    }

    /// The derivatives `df_i/dx_j`, row after row, as they were last needed.
    pub(in crate::integrate) fn jacobian(&self) -> &[T] {
        &self.jacobian
    }

    /// Solves for `x`, which holds a first guess.
    pub(in crate::integrate) fn solve(
        &mut self,
        field: &mut impl Field<T>,
        norm: &ErrorNorm,
        t: T,
        next: Affine<'_, T>,
        x: &mut [T],
    ) -> Solved {
        self.guess.copy_from_slice(x);
        let was_new = self.age.is_none_or(|age| age >= OLDEST);
        if self.attempt(field, norm, t, next, x) {
            return Solved::Converged;
        }
        // The Jacobian was an old one: once more with that of here.
        self.age = None;
        x.copy_from_slice(&self.guess);
        if !was_new && self.attempt(field, norm, t, next, x) {
            return Solved::Converged;
        }
        self.age = None;
        Solved::NotConverged
    }

    fn attempt(
        &mut self,
        field: &mut impl Field<T>,
        norm: &ErrorNorm,
        t: T,
        next: Affine<'_, T>,
        x: &mut [T],
    ) -> bool {
        self.evaluate(field, t, x);
        if self.age.is_none_or(|age| age >= OLDEST) {
            self.differentiate(field, norm, t, x);
        }
        self.age = self.age.map(|age| age + 1);
        self.factorize(next.first) && self.iterate(field, norm, t, next, x)
    }

    fn evaluate(&mut self, field: &mut impl Field<T>, t: T, x: &[T]) {
        field.evaluate(t, x, &mut self.derivative, &mut []);
        self.counts.evaluations += 1;
    }

    /// Takes the field's Jacobian, or differences in its place.
    fn differentiate(&mut self, field: &mut impl Field<T>, norm: &ErrorNorm, t: T, x: &mut [T]) {
        let dimension = x.len();
        self.counts.jacobians += 1;
        self.age = Some(0);
        self.factored = None;
        if field.jacobian(t, x, &mut self.jacobian) {
            return;
        }
        let root = T::RESOLUTION.sqrt();
        for j in 0..dimension {
            let (entry, size) = (x[j], x[j].to_f64().abs());
            let step = T::from_f64(root * size.max(norm.allowed(j)));
            x[j] = entry + step;
            let step = x[j] - entry;
            field.evaluate(t, x, &mut self.change, &mut []);
            x[j] = entry;
            for i in 0..dimension {
                self.jacobian[i * dimension + j] = (self.change[i] - self.derivative[i]) / step;
            }
        }
        self.counts.evaluations += dimension;
    }

    /// Makes factors of `I - first J`, unless those that there are serve; returns whether there are some.
    fn factorize(&mut self, first: T) -> bool {
        let is_near = |factored: T| ((first - factored) / factored).to_f64().abs() <= STALE;
        if self.factored.is_some_and(is_near) {
            return true;
        }
        let dimension = self.change.len();
        let matrix = self.factors.matrix();
        for (entry, &derivative) in matrix.iter_mut().zip(&self.jacobian) {
            *entry = -first * derivative;
        }
        for i in 0..dimension {
            matrix[i * dimension + i] += T::one();
        }
        self.counts.factorizations += 1;
        self.rate = 1.0;
        self.factored = self.factors.factorize().then_some(first);
        self.factored.is_some()
    }

    fn iterate(
        &mut self,
        field: &mut impl Field<T>,
        norm: &ErrorNorm,
        t: T,
        next: Affine<'_, T>,
        x: &mut [T],
    ) -> bool {
        let ratio = self.factored.map_or(1.0, |factored| (next.first / factored).to_f64());
        let scale = T::from_f64(2.0 / (1.0 + ratio));
        let mut before: Option<f64> = None;
        for iteration in 0..self.most_iterations {
            if iteration > 0 {
                self.evaluate(field, t, x);
            }
            for i in 0..x.len() {
                self.change[i] = scale * (next.known[i] + next.first * self.derivative[i] - x[i]);
            }
            self.factors.solve(&mut self.change);
            let size = norm.of(|i| self.change[i]);
            if !size.is_finite() {
                return false;
            }
            for (entry, &change) in x.iter_mut().zip(&self.change) {
                *entry += change;
            }
            if let Some(before) = before {
                let rate = size / before;
                if rate > SLOWEST {
                    return size <= self.stagnant;
                }
                self.rate = rate.max(0.2 * self.rate);
            }
            if size * (self.rate / (1.0 - self.rate.min(SLOWEST))).min(1.0) <= NEAR || size == 0.0 {
                return true;
            }
            before = Some(size);
        }
        false
    }
}
