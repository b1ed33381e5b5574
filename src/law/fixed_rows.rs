//! The least-norm solution for one task of two, three or six rows, whose factorisation stays in registers.

use super::least_norm::least_norm;
use crate::math::{Kernel, Lane, Lanes, level, with_instructions};
use crate::task::TaskRows;
use fearless_simd::Simd;

/// `f = J^T (J J^T)^-1 v` and `g = J^T (J J^T)^-1 w` for a Jacobian of `M` rows.
pub(super) struct FixedRows<'a, const M: usize> {
    /// Column by column.
    jacobian: &'a [[f64; M]],
    wanted: [&'a [f64]; 2],
    f: &'a mut [f64],
    g: &'a mut [f64],
}

impl<'a, const M: usize> FixedRows<'a, M> {
    /// The solution for what is `wanted` of a task.
    pub(super) fn of(task: &'a TaskRows, wanted: [&'a [f64]; 2], f: &'a mut [f64], g: &'a mut [f64]) -> Self {
        Self { jacobian: task.jacobian.as_slice().as_chunks().0, wanted, f, g }
    }

    /// Writes `f` and `g`; returns a lower bound of the smallest singular value and the smallest pivot.
    pub(super) fn solve(self) -> (f64, f64) {
        with_instructions(level(), self)
    }
}

impl<const M: usize> Kernel for FixedRows<'_, M> {
    type Output = (f64, f64);

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> (f64, f64) {
        let Self { jacobian, wanted: [v, w], f, g } = self;
        let lanes =
            |velocity: &[f64]| -> [_; M] { std::array::from_fn(|row| Lane::splat(simd, velocity[row])) };
        let found = least_norm(
            simd,
            jacobian,
            #[inline(always)]
            |column: &[f64; M], row| Lane::splat(simd, column[row]),
            #[inline(always)]
            || [lanes(v), lanes(w)],
            #[inline(always)]
            |column, forward: Lane<S>, back: Lane<S>| {
                f[column] = forward.value;
                g[column] = back.value;
            },
        );
        (found.bound.value, found.smallest_pivot.value)
    }
}
