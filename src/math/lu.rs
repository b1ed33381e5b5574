//! Linear systems of any size, solved without allocating.

use super::Scalar;

/// A square matrix and its factors `P A = L U`, by elimination with the largest pivot of each column.
///
/// ```
/// use kinstep::math::LuFactors;
/// let mut factors = LuFactors::new(2);
/// factors.matrix().copy_from_slice(&[0.0, 2.0, 4.0, 1.0]);
/// assert!(factors.factorize());
/// let mut x = [6.0, 7.0];
/// factors.solve(&mut x);
/// assert_eq!(x, [1.0, 3.0]);
/// ```
#[derive(Clone, Debug)]
pub struct LuFactors<T> {
    entries: Vec<T>,
    dimension: usize,
    /// The row that changed places with each row.
    pivots: Vec<usize>,
}

impl<T: Scalar> LuFactors<T> {
    /// Room for a matrix of so many rows and columns.
    pub fn new(dimension: usize) -> Self {
        Self { entries: vec![T::zero(); dimension * dimension], dimension, pivots: vec![0; dimension] }
    }

    /// The matrix that is to be [factorised](Self::factorize), row after row. After that it holds the factors.
    pub fn matrix(&mut self) -> &mut [T] {
        &mut self.entries
    }

    /// Factorises the matrix; returns false where a pivot is zero or not finite.
    pub fn factorize(&mut self) -> bool {
        let n = self.dimension;
        for k in 0..n {
            let size = |i: usize| self.entries[i * n + k].to_f64().abs();
            let larger = |best: usize, i: usize| if size(i) > size(best) { i } else { best };
            let pivot = (k + 1..n).fold(k, larger);
            let value = self.entries[pivot * n + k];
            if !value.is_finite() || value == T::zero() {
                return false;
            }
            self.pivots[k] = pivot;
            self.swap_rows(k, pivot);
            self.eliminate(k);
        }
        true
    }

    fn swap_rows(&mut self, one: usize, other: usize) {
        let n = self.dimension;
        if one != other {
            let (before, after) = self.entries.split_at_mut(other * n);
            before[one * n..][..n].swap_with_slice(&mut after[..n]);
        }
    }

    /// Takes multiples of row `k` off those below it.
    fn eliminate(&mut self, k: usize) {
        let n = self.dimension;
        let (above, below) = self.entries.split_at_mut((k + 1) * n);
        let row = &above[k * n..];
        for other in below.chunks_exact_mut(n) {
            let factor = other[k] / row[k];
            other[k] = factor;
            if factor != T::zero() {
                for (entry, &own) in other[k + 1..].iter_mut().zip(&row[k + 1..n]) {
                    *entry = *entry - factor * own;
                }
            }
        }
    }

    /// Puts the solution `x` of `A x = b` in the place of `b`.
    pub fn solve(&self, b: &mut [T]) {
        let n = self.dimension;
        for k in 0..n {
            b.swap(k, self.pivots[k]);
        }
        for i in 0..n {
            let (known, rest) = b.split_at_mut(i);
            for (&factor, &x) in self.entries[i * n..][..i].iter().zip(&*known) {
                rest[0] = rest[0] - factor * x;
            }
        }
        for i in (0..n).rev() {
            let (rest, known) = b.split_at_mut(i + 1);
            for (&factor, &x) in self.entries[i * n + i + 1..(i + 1) * n].iter().zip(&*known) {
                rest[i] = rest[i] - factor * x;
            }
            rest[i] = rest[i] / self.entries[i * n + i];
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn solutions_solve(n in 1..8_usize, entries in proptest::collection::vec(-1.0..1.0_f64, 72)) {
            let (matrix, x) = (&entries[..n * n], &entries[64..64 + n]);
            let product = |i: usize| matrix[i * n..][..n].iter().zip(x).map(|(a, x)| a * x).sum::<f64>();
            let mut found: Vec<f64> = (0..n).map(product).collect();
            let mut factors = LuFactors::new(n);
            factors.matrix().copy_from_slice(matrix);
            prop_assume!(factors.factorize());
            let smallest = (0..n).map(|i| factors.entries[i * n + i].abs()).fold(f64::INFINITY, f64::min);
            factors.solve(&mut found);
            let apart = found.iter().zip(x).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            prop_assert!(apart <= 1e-12 / smallest.powi(2).min(1.0), "{apart} {smallest}");
        }
    }

    #[test]
    fn a_singular_matrix_has_no_factors() {
        for entries in [[0.0; 4], [1.0, 2.0, 2.0, 4.0], [f64::NAN, 1.0, 1.0, 1.0]] {
            let mut factors = LuFactors::new(2);
            factors.matrix().copy_from_slice(&entries);
            assert!(!factors.factorize(), "{entries:?}");
        }
    }
}
