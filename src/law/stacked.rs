//! The least-norm solution for any number of rows: several tasks over the joints of one system.

use super::SystemShape;
use crate::task::TaskRows;
use std::ops::Range;

/// `J^T (J J^T)^-1 v` for the stacked Jacobian of several tasks over the union of their joints.
///
/// A column has entries only in the rows of the tasks that its joint moves; the rest is never touched.
#[derive(Debug)]
pub(super) struct StackedRows {
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
}

impl StackedRows {
    /// Room for systems of this shape.
    pub(super) fn new(shape: &SystemShape) -> Self {
        let (rows, columns) = (shape.rows(), shape.joints.len());
        Self {
            rows,
            jacobian: vec![0.0; rows * columns],
            factor: vec![0.0; rows * rows],
            inverse: vec![0.0; rows],
            solved: [vec![0.0; rows], vec![0.0; rows]],
            spans: spans(shape),
        }
    }

    /// Stacks the Jacobians of all tasks.
    pub(super) fn stack(&mut self, tasks: &[TaskRows]) {
        let mut first = 0;
        for task in tasks {
            let rows = task.rows();
            let columns = self.jacobian.chunks_exact_mut(self.rows).zip(task.jacobian.column_iter());
            for (stacked, own) in columns {
                stacked[first..first + rows].copy_from_slice(own.as_slice());
            }
            first += rows;
        }
    }

    /// Writes `J^T (J J^T)^-1` times `v` and `w`, and returns a lower bound of the smallest singular value, at most a factor
    /// `sqrt(rows)` below it; `None` when `J J^T` is not positive definite.
    pub(super) fn solve(&mut self, [v, w]: [&[f64]; 2], f: &mut [f64], g: &mut [f64]) -> Option<f64> {
        if !self.factorise() {
            return None;
        }
        let bound = self.smallest_singular_value_bound();
        self.substitute(0, v);
        self.substitute(1, w);
        self.transposed(f, g);
        Some(bound)
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

    /// `1 / sqrt(trace((J J^T)^-1))`.
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
    fn substitute(&mut self, place: usize, v: &[f64]) {
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
}

/// For each joint the rows of the stack from the first to the last task that it may move.
fn spans(shape: &SystemShape) -> Vec<Range<usize>> {
    let mut spans: Vec<Option<Range<usize>>> = vec![None; shape.joints.len()];
    let mut first = 0;
    for task in &shape.tasks {
        for &joint in &task.joints {
            let start = spans[joint].as_ref().map_or(first, |span| span.start);
            spans[joint] = Some(start..first + task.rows());
        }
        first += task.rows();
    }
    spans.into_iter().map(Option::unwrap_or_default).collect()
}
