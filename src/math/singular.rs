//! Singular values of a short, wide matrix by one-sided Jacobi rotations of its rows.

use nalgebra::Vector6;

/// Sweeps over all pairs of rows; convergence is quadratic and has never needed half of them.
const SWEEPS: usize = 30;

/// `J = U S V^T` of the first `M` rows of `J`: the workspace, then the result.
///
/// Rows are rotated in pairs until they are orthogonal (Hestenes 1958); the singular values come out to high relative
/// accuracy, and the sweeps are bounded, so NaN ends the work like anything else.
#[derive(Clone, Debug)]
pub struct SingularValues<const M: usize> {
    /// The rotated columns `U^T J`: row `i` is `s_i v_i^T`.
    rotated: Vec<Vector6<f64>>,
    /// Row `i` of `u` is the left singular vector of `values[i]`.
    u: [[f64; M]; M],
    values: [f64; M],
    /// Columns of the matrix: at most this many singular values can differ from zero.
    columns: usize,
}

impl<const M: usize> SingularValues<M> {
    /// A workspace for matrices of `n` columns, so that [`compute`](Self::compute) allocates nothing.
    pub fn with_capacity(n: usize) -> Self {
        Self { rotated: Vec::with_capacity(n), u: [[0.0; M]; M], values: [0.0; M], columns: n }
    }

    /// The decomposition of the matrix with these columns.
    pub fn of(columns: &[Vector6<f64>]) -> Self {
        let mut result = Self::with_capacity(columns.len());
        result.compute(columns);
        result
    }

    /// Replaces the decomposition by that of the matrix with these columns.
    pub fn compute(&mut self, columns: &[Vector6<f64>]) {
        self.columns = columns.len();
        self.rotated.clear();
        self.rotated.extend_from_slice(columns);
        self.u = std::array::from_fn(|i| std::array::from_fn(|j| f64::from(u8::from(i == j))));
        for _ in 0..SWEEPS {
            if !self.sweep() {
                break;
            }
        }
        for i in 0..M {
            self.values[i] = self.rotated.iter().map(|c| c[i] * c[i]).sum::<f64>().sqrt();
        }
        self.drop_impossible_values();
    }

    /// With fewer columns than rows the surplus singular values are zero; rounding leaves crumbs, which are cleared.
    fn drop_impossible_values(&mut self) {
        for _ in self.columns..M {
            let least = (0..M)
                .filter(|&i| self.values[i] > 0.0)
                .min_by(|&a, &b| self.values[a].total_cmp(&self.values[b]));
            if let Some(i) = least.filter(|_| self.rank_bound() > self.columns) {
                self.values[i] = 0.0;
            }
        }
    }

    fn rank_bound(&self) -> usize {
        self.values.iter().filter(|v| **v > 0.0).count()
    }

    /// Rotates every pair of rows once; false when all were orthogonal already.
    fn sweep(&mut self) -> bool {
        let mut moved = false;
        for p in 0..M {
            for q in p + 1..M {
                moved |= self.rotate(p, q);
            }
        }
        moved
    }

    fn rotate(&mut self, p: usize, q: usize) -> bool {
        let (mut pp, mut qq, mut pq) = (0.0, 0.0, 0.0);
        for c in &self.rotated {
            pp += c[p] * c[p];
            qq += c[q] * c[q];
            pq += c[p] * c[q];
        }
        if !(pq.abs() > f64::EPSILON * (pp * qq).sqrt()) {
            return false;
        }
        let zeta = (qq - pp) / (2.0 * pq);
        let tangent = zeta.signum() / (zeta.abs() + zeta.hypot(1.0));
        let cosine = tangent.hypot(1.0).recip();
        let sine = tangent * cosine;
        for c in &mut self.rotated {
            (c[p], c[q]) = (cosine * c[p] - sine * c[q], sine * c[p] + cosine * c[q]);
        }
        for j in 0..M {
            let (a, b) = (self.u[p][j], self.u[q][j]);
            self.u[p][j] = cosine * a - sine * b;
            self.u[q][j] = sine * a + cosine * b;
        }
        true
    }

    /// The singular values, in no particular order.
    pub fn values(&self) -> &[f64; M] {
        &self.values
    }

    /// The smallest of the `min(M, n)` singular values that an `M x n` matrix can have.
    pub fn smallest(&self) -> f64 {
        let mut sorted = self.values;
        sorted.sort_unstable_by(|a, b| b.total_cmp(a));
        sorted[..self.columns.min(M)].last().copied().unwrap_or(0.0)
    }

    /// The largest singular value.
    pub fn largest(&self) -> f64 {
        self.values.iter().fold(0.0, |most: f64, &value| most.max(value))
    }

    /// Adds `sum_i v_i weight(s_i) (u_i . v)` to `out`: with `weight(s) = 1/s` the pseudoinverse applied to `v`,
    /// with `s / (s^2 + lambda^2)` its damped form.
    ///
    /// A zero singular value contributes nothing: `weight` is not asked about it.
    pub fn apply(&self, v: &[f64; M], weight: impl Fn(f64) -> f64, out: &mut [f64]) {
        for i in 0..M {
            let s = self.values[i];
            if s == 0.0 {
                continue;
            }
            let along: f64 = self.u[i].iter().zip(v).map(|(a, b)| a * b).sum();
            let factor = along * weight(s) / s;
            for (entry, c) in out.iter_mut().zip(&self.rotated) {
                *entry += factor * c[i];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn known_singular_values_are_found(
            values in proptest::array::uniform3(0.0..8.0_f64), turn in proptest::array::uniform3(-3.0..3.0_f64),
        ) {
            // U diag(s) [I 0]: the values are known by construction, down to 1e-8.
            let s = values.map(|e| 10_f64.powf(-e));
            let u = nalgebra::Rotation3::new(nalgebra::Vector3::from(turn));
            let columns: Vec<_> = (0..3)
                .map(|j| {
                    let c = u.matrix().column(j) * s[j];
                    Vector6::new(c[0], c[1], c[2], 0.0, 0.0, 0.0)
                })
                .collect();
            let mut found = *SingularValues::<3>::of(&columns).values();
            let mut expected = s;
            found.sort_by(f64::total_cmp);
            expected.sort_by(f64::total_cmp);
            for (a, b) in found.iter().zip(&expected) {
                prop_assert!((a - b).abs() < 1e-15 * (1.0 + expected[2] / expected[0] * b), "{found:?} {expected:?}");
            }
        }
    }

    #[test]
    fn nan_ends_in_bounded_time_and_stays_nan() {
        let columns = [Vector6::repeat(f64::NAN), Vector6::repeat(1.0)];
        assert!(SingularValues::<6>::of(&columns).values().iter().any(|v| v.is_nan()));
    }

    #[test]
    fn a_single_column_has_one_singular_value_and_an_inverse() {
        let column = Vector6::new(0.3, -0.4, 0.0, 1.0, 2.0, 2.0);
        let decomposition = SingularValues::<6>::of(&[column]);
        assert!((decomposition.smallest() - column.norm()).abs() < 1e-15);
        let mut out = [0.0];
        decomposition.apply(&column.into(), f64::recip, &mut out);
        assert!((out[0] - 1.0).abs() < 1e-15);
    }
}
