//! The normal equations of a short, wide matrix: `J J^T` and its triangular factorisation, of static size.

use super::lanes::{Kernel, Lane, Lanes, level, with_instructions};
use fearless_simd::Simd;
use nalgebra::Vector6;

/// The Cholesky factorisation without square roots, `G = L D L^T` (L unit lower triangular, D diagonal), of the Gram
/// matrix `G = J J^T` of the first `M` rows of `J`.
#[derive(Clone, Copy, Debug)]
pub struct GramCholesky<const M: usize> {
    /// `L` below the diagonal.
    lower: [[f64; M]; M],
    /// `D^-1`.
    inverse_pivots: [f64; M],
    /// The trace of `G^-1`.
    trace_of_inverse: f64,
}

impl<const M: usize> GramCholesky<M> {
    /// Returns the factorisation of `J J^T` for `J` given by its columns, of which the first `M` entries count.
    ///
    /// `None` when a pivot is not positive: the rows are dependent to working precision, or not finite.
    #[inline]
    pub fn new(columns: &[Vector6<f64>]) -> Option<Self> {
        with_instructions(level(), Factorise(columns))
    }

    /// Returns the `y` with `J J^T y = v`.
    #[inline]
    pub fn solve(&self, v: &[f64; M]) -> [f64; M] {
        with_instructions(level(), Solve(self, v))
    }

    /// Returns a lower bound of the smallest singular value of `J`, at most a factor `sqrt(M)` below it:
    /// `1 / sqrt(trace(G^-1))`.
    #[inline]
    pub fn smallest_singular_value_bound(&self) -> f64 {
        1.0 / self.trace_of_inverse.sqrt()
    }
}

/// See [`GramCholesky::new`].
struct Factorise<'a, const M: usize>(&'a [Vector6<f64>]);

impl<const M: usize> Kernel for Factorise<'_, M> {
    type Output = Option<GramCholesky<M>>;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Self::Output {
        let entry = |column: &Vector6<f64>, row: usize| Lane::splat(simd, column[row]);
        let factor = LaneFactor::<Lane<S>, M>::of(simd, self.0, entry);
        let trace_of_inverse = factor.trace_of_inverse().value;
        let is_definite = factor.smallest_pivot.value > 0.0 && trace_of_inverse.is_finite();
        is_definite.then(|| GramCholesky {
            lower: factor.lower.map(|row| row.map(|entry| entry.value)),
            inverse_pivots: factor.inverse_pivots.map(|pivot| pivot.value),
            trace_of_inverse,
        })
    }
}

/// See [`GramCholesky::solve`].
struct Solve<'a, const M: usize>(&'a GramCholesky<M>, &'a [f64; M]);

impl<const M: usize> Kernel for Solve<'_, M> {
    type Output = [f64; M];

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> [f64; M] {
        let real = |value| Lane::splat(simd, value);
        let GramCholesky { lower, inverse_pivots, .. } = self.0;
        let factor = LaneFactor {
            lower: lower.map(|row| row.map(real)),
            inverse_pivots: inverse_pivots.map(real),
            smallest_pivot: real(f64::MAX),
        };
        factor.solve(&self.1.map(real)).map(|entry| entry.value)
    }
}

/// The same for one matrix in each lane.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LaneFactor<V, const M: usize> {
    /// `L` below the diagonal.
    lower: [[V; M]; M],
    /// `D^-1`.
    inverse_pivots: [V; M],
    /// The least entry of `D`; where it is not positive, nothing else here means anything.
    pub(crate) smallest_pivot: V,
}

/// The most rows that [`rows`] can count.
const MOST_ROWS: usize = 12;

/// Evaluates `$body` with the constant `$i` = 0, ..., `$m` - 1. The compiler unrolls no triangular loops by itself, and only
/// with constant indices do the numbers stay in registers.
macro_rules! rows {
    ($m:ident, $i:ident, $body:expr) => {
        rows!($m, $i, $body; 0 1 2 3 4 5 6 7 8 9 10 11)
    };
    ($m:ident, $i:ident, $body:expr; $($index:literal)*) => {$(
        #[allow(clippy::absurd_extreme_comparisons, clippy::reversed_empty_ranges, reason = "the first index is 0")]
        if $index < $m {
            const $i: usize = $index;
            $body;
        }
    )*};
}

impl<V: Lanes, const M: usize> LaneFactor<V, M> {
    /// Factorises `J J^T` for the `J` of whose columns `entry(column, row)` reads the entries.
    #[inline(always)]
    pub(crate) fn of<C>(token: V::Token, columns: &[C], entry: impl Fn(&C, usize) -> V) -> Self {
        const { assert!(M > 0 && M <= MOST_ROWS) };
        let zero = V::splat(token, 0.0);
        let mut factor =
            Self { lower: [[zero; M]; M], inverse_pivots: [zero; M], smallest_pivot: zero.like(f64::MAX) };
        add_products::<V, C, M, true>(&mut factor.lower, columns, &entry);
        add_products::<V, C, M, false>(&mut factor.lower, columns, &entry);
        rows!(M, I, factor_row::<V, M, I>(&mut factor));
        factor
    }

    /// The `y` with `L D L^T y = v`.
    #[inline(always)]
    pub(crate) fn solve(&self, v: &[V; M]) -> [V; M] {
        let mut y = *v;
        rows!(M, I, substitute_forward::<V, M, I>(self, &mut y));
        for i in 0..M {
            y[i] = y[i] * self.inverse_pivots[i];
        }
        rows!(M, I, substitute_back::<V, M, I>(self, &mut y));
        y
    }

    /// A lower bound of the smallest singular value of `J`, at most a factor `sqrt(M)` below it.
    #[inline(always)]
    pub(crate) fn smallest_singular_value_bound(&self) -> V {
        self.smallest_pivot.like(1.0) / self.trace_of_inverse().sqrt()
    }

    /// The trace of `G^-1`: the squares of the entries of `L^-1`, each over the pivot of its row.
    #[inline(always)]
    fn trace_of_inverse(&self) -> V {
        let zero = self.smallest_pivot.like(0.0);
        let (mut inverse, mut trace) = ([[zero; M]; M], zero);
        rows!(M, I, invert_row::<V, M, I>(self, &mut inverse, &mut trace));
        trace
    }
}

/// Adds up the products of rows of `J` on and below the diagonal of `G`: those of linear rows with linear ones and of angular
/// rows with angular ones (`ALIKE`), or those of both kinds together. So many sums just find room in the registers.
#[inline(always)]
fn add_products<V: Lanes, C, const M: usize, const ALIKE: bool>(
    lower: &mut [[V; M]; M],
    columns: &[C],
    entry: &impl Fn(&C, usize) -> V,
) {
    if !ALIKE && M <= 3 {
        return;
    }
    let mut sums = *lower;
    for column in columns {
        let mut entries = sums[0];
        for row in 0..M {
            entries[row] = entry(column, row);
        }
        rows!(M, I, {
            rows!(M, J, {
                if J <= I && (I / 3 == J / 3) == ALIKE {
                    sums[I][J] = entries[I].times_plus(entries[J], sums[I][J]);
                }
            });
        });
    }
    *lower = sums;
}

/// Row `I` of the factors, which stands in the place of that row of `G`: `u_j = g_j - sum_(k<j) u_k l_jk` with `u = d l`.
#[inline(always)]
fn factor_row<V: Lanes, const M: usize, const I: usize>(factor: &mut LaneFactor<V, M>) {
    let zero = factor.smallest_pivot.like(0.0);
    let mut row = factor.lower[I];
    let mut scaled = [zero; M];
    rows!(M, J, {
        if J <= I {
            for k in 0..J {
                // In the last entry the other factor is this row itself, scaled.
                let other = if J == I { scaled[k] } else { factor.lower[J][k] };
                row[J] = row[J].less_product(row[k], other);
            }
            if J < I {
                scaled[J] = row[J] * factor.inverse_pivots[J];
            }
        }
    });
    factor.lower[I] = scaled;
    factor.inverse_pivots[I] = zero.like(1.0) / row[I];
    factor.smallest_pivot = row[I].least(factor.smallest_pivot);
}

#[inline(always)]
fn substitute_forward<V: Lanes, const M: usize, const I: usize>(factor: &LaneFactor<V, M>, y: &mut [V; M]) {
    for j in 0..I {
        y[I] = y[I].less_product(factor.lower[I][j], y[j]);
    }
}

/// Takes `y` of row `M - 1 - I`, which is final, out of the rows above it.
#[inline(always)]
fn substitute_back<V: Lanes, const M: usize, const I: usize>(factor: &LaneFactor<V, M>, y: &mut [V; M]) {
    let last = M - 1 - I;
    for j in 0..last {
        y[j] = y[j].less_product(factor.lower[last][j], y[last]);
    }
}

/// Row `I` of `-L^-1` below the diagonal, and its part of the trace.
#[inline(always)]
fn invert_row<V: Lanes, const M: usize, const I: usize>(
    factor: &LaneFactor<V, M>,
    inverse: &mut [[V; M]; M],
    trace: &mut V,
) {
    let mut squares = trace.like(1.0);
    rows!(M, J, {
        if J < I {
            let mut entry = factor.lower[I][J];
            for k in J + 1..I {
                entry = entry.less_product(factor.lower[I][k], inverse[k][J]);
            }
            inverse[I][J] = entry;
            squares = entry.times_plus(entry, squares);
        }
    });
    *trace = squares.times_plus(factor.inverse_pivots[I], *trace);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::SingularValues;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn solves_the_normal_equations_and_bounds_the_smallest_singular_value(
            entries in proptest::collection::vec(-1.0..1.0_f64, 42), v in proptest::array::uniform6(-1.0..1.0_f64),
        ) {
            let columns: Vec<_> = entries.chunks(6).map(Vector6::from_column_slice).collect();
            let exact = SingularValues::<6>::of(&columns).smallest();
            prop_assume!(exact > 1e-3);
            let gram = GramCholesky::<6>::new(&columns).unwrap();
            let y = gram.solve(&v);
            // J (J^T y) is v again.
            let mut image = Vector6::zeros();
            for column in &columns {
                image += column * column.dot(&Vector6::from_column_slice(&y));
            }
            prop_assert!((image - Vector6::from_column_slice(&v)).norm() < 1e-9);
            let bound = gram.smallest_singular_value_bound();
            prop_assert!(bound <= exact * (1.0 + 1e-6) && exact <= bound * 6.0_f64.sqrt() * (1.0 + 1e-6));
        }
    }

    #[test]
    fn refuses_dependent_rows_and_nan() {
        let row = |x: f64| Vector6::new(x, 2.0 * x, 0.0, 0.0, 0.0, 0.0);
        assert!(GramCholesky::<2>::new(&[row(1.0), row(0.5)]).is_none());
        assert!(GramCholesky::<2>::new(&[row(f64::NAN), row(0.5)]).is_none());
    }
}
