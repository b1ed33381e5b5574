//! The normal equations of a short, wide matrix: `J J^T` and its Cholesky factorisation, of static size.

use nalgebra::Vector6;

/// The Cholesky factorisation `G = L L^T` of the Gram matrix `G = J J^T` of the first `M` rows of `J`.
#[derive(Clone, Copy, Debug)]
pub struct GramCholesky<const M: usize> {
    /// `L` below the diagonal, and the reciprocals of its diagonal entries on it.
    factor: [[f64; M]; M],
}

impl<const M: usize> GramCholesky<M> {
    /// Factorises `J J^T` for `J` given by its columns, of which the first `M` entries count.
    ///
    /// `None` when a pivot is not positive: the rows are dependent to working precision, or not finite.
    #[inline]
    pub fn new(columns: &[Vector6<f64>]) -> Option<Self> {
        let mut factor = gram::<M>(columns);
        // What lies above the diagonal is never read.
        for k in 0..M {
            let pivot = factor[k][k];
            if !(pivot > 0.0 && pivot.is_finite()) {
                return None;
            }
            let reciprocal = pivot.sqrt().recip();
            factor[k][k] = reciprocal;
            for i in k + 1..M {
                factor[i][k] *= reciprocal;
            }
            for i in k + 1..M {
                for j in k + 1..=i {
                    factor[i][j] -= factor[i][k] * factor[j][k];
                }
            }
        }
        Some(Self { factor })
    }

    /// The `y` with `J J^T y = v`.
    pub fn solve(&self, v: &[f64; M]) -> [f64; M] {
        let l = &self.factor;
        let mut y = *v;
        for i in 0..M {
            for j in 0..i {
                y[i] -= l[i][j] * y[j];
            }
            y[i] *= l[i][i];
        }
        for i in (0..M).rev() {
            for j in i + 1..M {
                y[i] -= l[j][i] * y[j];
            }
            y[i] *= l[i][i];
        }
        y
    }

    /// A lower bound of the smallest singular value of `J`, at most a factor `sqrt(M)` below it:
    /// `1 / sqrt(trace(G^-1))`, where `trace(G^-1)` is the squared Frobenius norm of `L^-1`.
    pub fn smallest_singular_value_bound(&self) -> f64 {
        let l = &self.factor;
        let mut trace = 0.0;
        for column in 0..M {
            let mut inverse = [0.0; M];
            inverse[column] = l[column][column];
            trace += inverse[column] * inverse[column];
            for i in column + 1..M {
                let mut entry = 0.0;
                for j in column..i {
                    entry -= l[i][j] * inverse[j];
                }
                inverse[i] = entry * l[i][i];
                trace += inverse[i] * inverse[i];
            }
        }
        trace.sqrt().recip()
    }
}

/// `J J^T`, summed column by column: whole rows at a time, in constant bounds that the compiler can unroll.
#[inline]
fn gram<const M: usize>(columns: &[Vector6<f64>]) -> [[f64; M]; M] {
    let mut gram = [[0.0; M]; M];
    for column in columns {
        let entries: [f64; M] = std::array::from_fn(|i| column[i]);
        for i in 0..M {
            for j in 0..M {
                gram[i][j] += entries[i] * entries[j];
            }
        }
    }
    gram
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
