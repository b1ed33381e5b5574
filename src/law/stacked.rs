//! The least-norm law for the tasks of several arms at once, when they share joints.

use super::Resolution;
use crate::math::RowRotations;
use std::ops::Range;

/// `J^+ v` for the stacked Jacobian of several tasks over the union of their joints.
///
/// The same policy as [`Pseudoinverse`](super::Pseudoinverse), for any number of rows: a Cholesky factorisation of
/// `J J^T` while the smallest singular value is certain to lie above the threshold, else one-sided Jacobi rotations and
/// damping. A column has entries only in the rows of the tasks that its joint moves; the rest is never touched.
#[derive(Debug)]
pub(crate) struct StackedPseudoinverse {
    threshold: f64,
    rows: usize,
    /// For each column the rows that it may have entries in.
    spans: Vec<Range<usize>>,
    /// Column after column.
    jacobian: Vec<f64>,
    /// The lower triangle of `J J^T`, then its Cholesky factor with the reciprocals of the pivots on the diagonal.
    factor: Vec<f64>,
    /// Column by column of the inverse of the factor, for its trace.
    inverse: Vec<f64>,
    solved: [Vec<f64>; 2],
    rotations: RowRotations,
}

impl StackedPseudoinverse {
    /// A law for `rows` task components in all, and one column per entry of `spans`.
    pub(crate) fn new(rows: usize, spans: Vec<Range<usize>>, threshold: f64) -> Self {
        let columns = spans.len();
        Self {
            threshold,
            rows,
            jacobian: vec![0.0; rows * columns],
            factor: vec![0.0; rows * rows],
            inverse: vec![0.0; rows],
            solved: [vec![0.0; rows], vec![0.0; rows]],
            rotations: RowRotations::with_capacity(rows, columns),
            spans,
        }
    }

    /// The entries of a column in the rows from `row` on.
    pub(crate) fn column(&mut self, column: usize, row: usize) -> &mut [f64] {
        let from = column * self.rows;
        &mut self.jacobian[from + row..from + self.rows]
    }

    /// Writes `J^+ v` and `J^+ w`.
    pub(crate) fn resolve(&mut self, [v, w]: [&[f64]; 2], f: &mut [f64], g: &mut [f64]) -> Resolution {
        if let Some(bound) = self.factorise().then(|| self.smallest_singular_value_bound())
            && bound > self.threshold
        {
            self.solve(0, v);
            self.solve(1, w);
            self.transposed(f, g);
            return Resolution { smallest_singular_value: bound, damped: false };
        }
        self.resolve_near_singular(v, w, f, g)
    }

    /// Whether all pivots of `J J^T` were positive.
    fn factorise(&mut self) -> bool {
        let m = self.rows;
        self.factor.fill(0.0);
        for (column, span) in self.jacobian.chunks_exact(m).zip(&self.spans) {
            for i in span.clone() {
                let (entry, row) = (column[i], &mut self.factor[i * m + span.start..=i * m + i]);
                for (sum, other) in row.iter_mut().zip(&column[span.start..=i]) {
                    *sum += entry * other;
                }
            }
        }
        for k in 0..m {
            let (above, rest) = self.factor.split_at_mut(k * m);
            let row = &mut rest[..=k];
            for j in 0..k {
                let other = &above[j * m..=j * m + j];
                let sum: f64 = row[..j].iter().zip(other).map(|(a, b)| a * b).sum();
                row[j] = (row[j] - sum) * other[j];
            }
            let pivot = row[k] - row[..k].iter().map(|entry| entry * entry).sum::<f64>();
            if !(pivot > 0.0 && pivot.is_finite()) {
                return false;
            }
            row[k] = pivot.sqrt().recip();
        }
        true
    }

    /// `1 / sqrt(trace((J J^T)^-1))`, at most a factor `sqrt(rows)` below the smallest singular value.
    fn smallest_singular_value_bound(&mut self) -> f64 {
        let (m, mut trace) = (self.rows, 0.0);
        for column in 0..m {
            for i in column..m {
                let row = &self.factor[i * m..=i * m + i];
                let inner: f64 = (column..i).map(|j| row[j] * self.inverse[j]).sum();
                self.inverse[i] = if i == column { row[i] } else { -inner * row[i] };
                trace += self.inverse[i] * self.inverse[i];
            }
        }
        trace.sqrt().recip()
    }

    /// Puts `(J J^T)^-1 v` into a place of `solved`.
    fn solve(&mut self, place: usize, v: &[f64]) {
        let (m, y) = (self.rows, &mut self.solved[place]);
        y.copy_from_slice(v);
        for i in 0..m {
            let row = &self.factor[i * m..=i * m + i];
            let sum: f64 = row[..i].iter().zip(&*y).map(|(l, y)| l * y).sum();
            y[i] = (y[i] - sum) * row[i];
        }
        for i in (0..m).rev() {
            y[i] *= self.factor[i * m + i];
            let known = y[i];
            for j in 0..i {
                y[j] -= self.factor[i * m + j] * known;
            }
        }
    }

    /// Writes `J^T` times what was solved for.
    fn transposed(&self, f: &mut [f64], g: &mut [f64]) {
        let [y, z] = &self.solved;
        let columns = self.jacobian.chunks_exact(self.rows).zip(&self.spans);
        for ((column, span), (f, g)) in columns.zip(f.iter_mut().zip(g)) {
            let dot = |y: &[f64]| span.clone().map(|row| column[row] * y[row]).sum();
            (*f, *g) = (dot(y), dot(z));
        }
    }

    fn resolve_near_singular(&mut self, v: &[f64], w: &[f64], f: &mut [f64], g: &mut [f64]) -> Resolution {
        let (m, jacobian) = (self.rows, &self.jacobian);
        self.rotations.compute(self.spans.len(), |row, column| jacobian[column * m + row]);
        let smallest = self.rotations.smallest();
        let damping = (self.threshold * self.threshold - smallest * smallest).max(0.0);
        for (velocity, out) in [(v, f), (w, g)] {
            out.fill(0.0);
            self.rotations.apply(velocity, |s| s / (s * s + damping), out);
        }
        Resolution { smallest_singular_value: smallest, damped: damping > 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Demand, Law, Pseudoinverse};
    use super::*;
    use nalgebra::Vector6;
    use proptest::prelude::*;

    /// Two tasks of six rows; the first `shared` columns move both, then six move the first and seven the second.
    fn stacked(entries: &[f64], shared: usize, threshold: f64) -> StackedPseudoinverse {
        let spans = (0..shared + 13).map(|i| match i {
            _ if i < shared => 0..12,
            _ if i < shared + 6 => 0..6,
            _ => 6..12,
        });
        let spans: Vec<_> = spans.collect();
        let mut law = StackedPseudoinverse::new(12, spans.clone(), threshold);
        for (i, span) in spans.into_iter().enumerate() {
            law.column(i, span.start)[..span.len()].copy_from_slice(&entries[12 * i..12 * i + span.len()]);
        }
        law
    }

    fn image(law: &StackedPseudoinverse, q: &[f64]) -> Vec<f64> {
        let row = |row: usize| q.iter().enumerate().map(|(i, q)| law.jacobian[i * law.rows + row] * q).sum();
        (0..law.rows).map(row).collect()
    }

    fn apart(a: &[f64], b: &[f64]) -> f64 {
        a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
    }

    proptest! {
        #[test]
        fn the_answer_meets_all_tasks_and_has_the_least_norm(
            entries in prop::collection::vec(-1.0..1.0_f64, 12 * 15), v in prop::collection::vec(-1.0..1.0_f64, 12),
            w in prop::collection::vec(-1.0..1.0_f64, 12), other in prop::collection::vec(-1.0..1.0_f64, 15),
        ) {
            let mut law = stacked(&entries, 2, 1e-3);
            let (mut f, mut g) = (vec![0.0; 15], vec![0.0; 15]);
            let resolution = law.resolve([&v, &w], &mut f, &mut g);
            prop_assume!(resolution.smallest_singular_value > 0.02);
            prop_assert!(apart(&image(&law, &f), &v) < 1e-10 && apart(&image(&law, &g), &w) < 1e-10);
            // The part of any motion that no task sees is at right angles to the answer.
            let (mut seen, mut unused) = (vec![0.0; 15], vec![0.0; 15]);
            let moved = image(&law, &other);
            law.resolve([&moved, &v], &mut seen, &mut unused);
            let dot: f64 = f.iter().zip(other.iter().zip(&seen)).map(|(f, (o, s))| f * (o - s)).sum();
            prop_assert!(dot.abs() < 1e-9, "{dot}");
            // Rotations of the rows give the same answer.
            let mut forced = stacked(&entries, 2, resolution.smallest_singular_value);
            let (mut slow, mut back) = (vec![0.0; 15], vec![0.0; 15]);
            let exact = forced.resolve([&v, &w], &mut slow, &mut back);
            prop_assert!(!exact.damped && apart(&slow, &f) < 1e-9 && apart(&back, &g) < 1e-9);
            let (bound, exact) = (resolution.smallest_singular_value, exact.smallest_singular_value);
            prop_assert!(bound <= exact * (1.0 + 1e-6) && exact <= bound * 12.0_f64.sqrt() * (1.0 + 1e-6));
        }

        #[test]
        fn tasks_that_share_nothing_are_resolved_as_if_alone(
            entries in prop::collection::vec(-1.0..1.0_f64, 12 * 13), v in prop::collection::vec(-1.0..1.0_f64, 12),
        ) {
            let mut law = stacked(&entries, 0, 1e-3);
            let (mut f, mut g) = (vec![0.0; 13], vec![0.0; 13]);
            let resolution = law.resolve([&v, &v], &mut f, &mut g);
            prop_assume!(resolution.smallest_singular_value > 0.02);
            let mut alone = vec![0.0; 13];
            for (rows, joints) in [(0..6, 0..6), (6..12, 6..13)] {
                let own = |i: usize| Vector6::from_column_slice(&entries[12 * i..12 * i + 6]);
                let (columns, velocity): (Vec<_>, _) =
                    (joints.clone().map(own).collect(), Vector6::from_column_slice(&v[rows]));
                let (q, mut unused) = (vec![0.0; columns.len()], vec![0.0; columns.len()]);
                let demand =
                    Demand { rows: 6, jacobian: &columns, q: &q, feedforward: &velocity, feedback: &velocity };
                let mut law = Pseudoinverse::new().with_threshold(1e-3);
                law.prepare(6, columns.len(), 1.0);
                law.resolve(&demand, &mut alone[joints], &mut unused);
            }
            prop_assert!(apart(&f, &alone) < 1e-10 && f == g);
        }
    }

    #[test]
    fn tasks_that_contradict_each_other_are_damped_and_bounded() {
        // One joint, two tasks of one row that it moves alike.
        let mut law = StackedPseudoinverse::new(2, vec![0..2; 1], 0.1);
        law.column(0, 0).copy_from_slice(&[1.0, 1.0]);
        let (mut f, mut g) = ([0.0], [0.0]);
        let resolution = law.resolve([&[1.0, -1.0], &[1.0, 1.0]], &mut f, &mut g);
        assert!(!resolution.damped && (resolution.smallest_singular_value - 2.0_f64.sqrt()).abs() < 1e-15);
        assert!(f[0].abs() < 1e-15 && (g[0] - 1.0).abs() < 1e-15, "the best that one joint can do");
        // Two joints that come ever nearer to being one.
        for tilt in [0.0, 1e-9, 1e-3, 0.05] {
            let mut law = StackedPseudoinverse::new(2, vec![0..2, 0..2], 0.1);
            law.column(0, 0).copy_from_slice(&[1.0, 1.0]);
            law.column(1, 0).copy_from_slice(&[1.0, 1.0 + tilt]);
            let (mut f, mut g) = ([0.0; 2], [0.0; 2]);
            let resolution = law.resolve([&[0.0, 1.0], &[1.0, 0.0]], &mut f, &mut g);
            assert!(resolution.damped && f.iter().chain(&g).all(|x| x.abs() <= 1.0 / 0.1), "{f:?} {g:?}");
        }
    }
}
