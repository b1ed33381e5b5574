//! Singular values of a short, wide matrix by one-sided Jacobi rotations of its rows.

use nalgebra::Vector6;

/// Sweeps over all pairs of rows; convergence is quadratic and has never needed half of them.
const SWEEPS: usize = 30;

/// The singular value decomposition `J = U S V^T` of the first `M` rows of `J`: a workspace, and after
/// [`compute`](Self::compute) the result.
///
/// Rows are rotated in pairs until they are orthogonal (Hestenes 1958); the singular values come out to high relative
/// accuracy, and the number of sweeps is bounded, for matrices with NaN too.
#[derive(Clone, Debug)]
pub struct SingularValues<const M: usize> {
    rotations: RowRotations,
    values: [f64; M],
}

impl<const M: usize> SingularValues<M> {
    /// Returns a workspace for matrices of `n` columns, so that [`compute`](Self::compute) allocates nothing.
    pub fn with_capacity(n: usize) -> Self {
        Self { rotations: RowRotations::with_capacity(M, n), values: [0.0; M] }
    }

    /// Returns the decomposition of the matrix with these columns.
    pub fn of(columns: &[Vector6<f64>]) -> Self {
        let mut result = Self::with_capacity(columns.len());
        result.compute(columns);
        result
    }

    /// Replaces the decomposition by that of the matrix with these columns.
    pub fn compute(&mut self, columns: &[Vector6<f64>]) {
        self.rotations.compute(columns.len(), |row, column| columns[column][row]);
        self.values.copy_from_slice(&self.rotations.values);
    }

    /// Returns the singular values, in no particular order.
    pub fn values(&self) -> &[f64; M] {
        &self.values
    }

    /// Returns the smallest of the `min(M, n)` singular values that an `M x n` matrix can have.
    pub fn smallest(&self) -> f64 {
        self.rotations.smallest()
    }

    /// Returns the largest singular value.
    pub fn largest(&self) -> f64 {
        self.values.iter().fold(0.0, |most: f64, &value| most.max(value))
    }

    /// Adds `sum_i v_i weight(s_i) (u_i . v)` to `out`: with `weight(s) = 1/s` the pseudoinverse applied to `v`,
    /// with `s / (s^2 + lambda^2)` its damped form.
    ///
    /// A zero singular value contributes nothing: `weight` is not called for it.
    pub fn apply(&self, v: &[f64; M], weight: impl Fn(f64) -> f64, out: &mut [f64]) {
        self.rotations.apply(v, weight, out);
    }
}

/// The singular value decomposition `J = U S V^T` of a matrix with any number of rows, known at run time: the workspace, then
/// the result. [`SingularValues`] is the same for a number of rows that is known at compile time.
///
/// ```
/// use kinstep::math::RowRotations;
/// let rows = [[3.0, 0.0, 0.0], [0.0, 4.0, 0.0]];
/// let mut rotations = RowRotations::with_capacity(2, 3);
/// rotations.compute(3, |row, column| rows[row][column]);
/// assert_eq!((rotations.values(), rotations.smallest()), (&[3.0, 4.0][..], 3.0));
/// ```
#[derive(Clone, Debug)]
pub struct RowRotations {
    rows: usize,
    /// Columns of the matrix: at most this many singular values can differ from zero.
    columns: usize,
    /// `U^T J`, row after row: row `i` is `s_i v_i^T`.
    rotated: Vec<f64>,
    /// Row `i` is the left singular vector of `values[i]`.
    u: Vec<f64>,
    values: Vec<f64>,
}

impl RowRotations {
    /// A workspace for matrices of `rows` rows and `columns` columns, so that [`compute`](Self::compute) allocates nothing.
    pub fn with_capacity(rows: usize, columns: usize) -> Self {
        Self {
            rows,
            columns,
            rotated: Vec::with_capacity(rows * columns),
            u: vec![0.0; rows * rows],
            values: vec![0.0; rows],
        }
    }

    /// Replaces the decomposition by that of the matrix of `columns` columns whose entries `entry(row, column)` reads.
    pub fn compute(&mut self, columns: usize, entry: impl Fn(usize, usize) -> f64) {
        let rows = self.rows;
        self.columns = columns;
        self.rotated.clear();
        self.rotated.extend((0..rows * columns).map(|place| entry(place / columns, place % columns)));
        self.u.fill(0.0);
        self.u.iter_mut().step_by(rows + 1).for_each(|diagonal| *diagonal = 1.0);
        for _ in 0..SWEEPS {
            if !self.sweep() {
                break;
            }
        }
        for (i, value) in self.values.iter_mut().enumerate() {
            let row = &self.rotated[i * columns..(i + 1) * columns];
            *value = row.iter().map(|entry| entry * entry).sum::<f64>().sqrt();
        }
        self.drop_impossible_values();
    }

    /// With fewer columns than rows the surplus singular values are zero; rounding leaves crumbs, which are cleared.
    fn drop_impossible_values(&mut self) {
        for _ in self.columns..self.rows {
            let least = (0..self.rows)
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
        for p in 0..self.rows {
            for q in p + 1..self.rows {
                moved |= self.rotate(p, q);
            }
        }
        moved
    }

    fn rotate(&mut self, p: usize, q: usize) -> bool {
        let (a, b) = two_rows(&mut self.rotated, self.columns, p, q);
        let (mut pp, mut qq, mut pq) = (0.0, 0.0, 0.0);
        for (a, b) in a.iter().zip(&*b) {
            pp += a * a;
            qq += b * b;
            pq += a * b;
        }
        if !(pq.abs() > f64::EPSILON * (pp * qq).sqrt()) {
            return false;
        }
        let zeta = (qq - pp) / (2.0 * pq);
        let tangent = zeta.signum() / (zeta.abs() + zeta.hypot(1.0));
        let cosine = tangent.hypot(1.0).recip();
        let turn = (cosine, tangent * cosine);
        turn_rows(a, b, turn);
        let (a, b) = two_rows(&mut self.u, self.rows, p, q);
        turn_rows(a, b, turn);
        true
    }

    /// The singular values, in no particular order.
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// The smallest of the `min(rows, columns)` singular values that such a matrix can have.
    pub fn smallest(&self) -> f64 {
        // In ascending order this is the value after the surplus ones; ties count by their place.
        let surplus = self.rows.saturating_sub(self.columns);
        let rank = |i: usize| {
            let comes_before = |j: &usize| self.values[*j].total_cmp(&self.values[i]).then(j.cmp(&i)).is_lt();
            (0..self.rows).filter(comes_before).count()
        };
        (0..self.rows).find(|&i| rank(i) == surplus).map_or(0.0, |i| self.values[i])
    }

    /// Every singular value `s_i` with its left singular vector `u_i` and with `s_i v_i`, in the order of the values.
    pub fn directions(&self) -> impl Iterator<Item = (f64, &[f64], &[f64])> {
        let left = self.u.chunks_exact(self.rows.max(1));
        let right = self.rotated.chunks_exact(self.columns.max(1));
        self.values.iter().zip(left.zip(right)).map(|(value, (u, row))| (*value, u, row))
    }

    /// Adds `sum_i v_i weight(s_i) (u_i . v)` to `out`: with `weight(s) = 1/s` the pseudoinverse applied to `v`, with
    /// `s / (s^2 + lambda^2)` its damped form. A zero singular value contributes nothing.
    pub fn apply(&self, v: &[f64], weight: impl Fn(f64) -> f64, out: &mut [f64]) {
        for (i, &s) in self.values.iter().enumerate() {
            if s == 0.0 {
                continue;
            }
            let u = &self.u[i * self.rows..(i + 1) * self.rows];
            let along: f64 = u.iter().zip(v).map(|(a, b)| a * b).sum();
            let factor = along * weight(s) / s;
            let row = &self.rotated[i * self.columns..(i + 1) * self.columns];
            for (entry, c) in out.iter_mut().zip(row) {
                *entry += factor * c;
            }
        }
    }
}

/// Rows `p < q` of a matrix that is stored row after row.
fn two_rows(matrix: &mut [f64], columns: usize, p: usize, q: usize) -> (&mut [f64], &mut [f64]) {
    let (head, tail) = matrix.split_at_mut(q * columns);
    (&mut head[p * columns..(p + 1) * columns], &mut tail[..columns])
}

fn turn_rows(a: &mut [f64], b: &mut [f64], (cosine, sine): (f64, f64)) {
    for (a, b) in a.iter_mut().zip(b) {
        (*a, *b) = (cosine * *a - sine * *b, sine * *a + cosine * *b);
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
