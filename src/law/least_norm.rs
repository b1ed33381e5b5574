use crate::math::{LaneFactor, Lanes};

/// The least-norm joint velocities of two task velocities, and how sure they are.
pub(crate) struct LeastNorm<V> {
    /// A lower bound of the smallest singular value of `J`, at most a factor `sqrt(M)` below it.
    pub(crate) bound: V,
    /// Where this is not positive, the bound and the velocities mean nothing.
    pub(crate) smallest_pivot: V,
}

/// Gives `write` for every column the entries of `J^T (J J^T)^-1 v` and `J^T (J J^T)^-1 w` of two `velocities`.
///
/// `J` has columns whose entries `entry(column, row)` reads, of which `M` count; every lane holds a Jacobian of its own.
#[inline(always)]
pub(crate) fn least_norm<V: Lanes, C, const M: usize>(
    token: V::Token,
    columns: &[C],
    entry: impl Fn(&C, usize) -> V + Copy,
    velocities: impl FnOnce() -> [[V; M]; 2],
    mut write: impl FnMut(usize, V, V),
) -> LeastNorm<V> {
    let factor = LaneFactor::<V, M>::of(token, columns, entry);
    // Asked for only now: until here the registers are full.
    let [v, w] = velocities();
    let (y, z) = (factor.solve(&v), factor.solve(&w));
    for (place, column) in columns.iter().enumerate() {
        let first = entry(column, 0);
        let (mut forward, mut back) = (first * y[0], first * z[0]);
        for row in 1..M {
            let entry = entry(column, row);
            forward = entry.times_plus(y[row], forward);
            back = entry.times_plus(z[row], back);
        }
        write(place, forward, back);
    }
    LeastNorm { bound: factor.smallest_singular_value_bound(), smallest_pivot: factor.smallest_pivot }
}
