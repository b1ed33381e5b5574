use crate::math::{LaneFactor, Lanes};

/// The least-norm joint velocities of two task velocities, and how sure they are.
pub(crate) struct LeastNorm<V> {
    /// A lower bound of the smallest singular value of `J`, at most a factor `sqrt(M)` below it.
    pub(crate) bound: V,
    /// Where this is not positive, the bound and the velocities mean nothing.
    pub(crate) smallest_pivot: V,
}

/// Gives `write` for every column the entries of `J^T (J J^T)^-1 v` and `J^T (J J^T)^-1 w`.
///
/// `J` has `joints` columns of `M` entries, which `entry(column, row)` reads; every lane holds a Jacobian of its own.
#[inline(always)]
pub(crate) fn least_norm<V: Lanes, const M: usize>(
    token: V::Token,
    joints: usize,
    entry: impl Fn(usize, usize) -> V + Copy,
    [v, w]: [&[V; M]; 2],
    mut write: impl FnMut(usize, V, V),
) -> LeastNorm<V> {
    let factor = LaneFactor::<V, M>::of(token, joints, entry);
    let (y, z) = (factor.solve(v), factor.solve(w));
    for column in 0..joints {
        let first = entry(column, 0);
        let (mut forward, mut back) = (first * y[0], first * z[0]);
        for row in 1..M {
            let entry = entry(column, row);
            forward = forward + entry * y[row];
            back = back + entry * z[row];
        }
        write(column, forward, back);
    }
    LeastNorm { bound: factor.smallest_singular_value_bound(), smallest_pivot: factor.smallest_pivot }
}
