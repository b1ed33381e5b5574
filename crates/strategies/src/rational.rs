//! Small exact computations from which rows are made.

use kinstep::math::Rational;
use num_bigint::BigInt;
use num_traits::{One, Zero};

pub(super) fn ratio(numerator: i64, denominator: i64) -> Rational {
    Rational::new(numerator.into(), denominator.into())
}

/// The product of two polynomials, highest power first.
pub(super) fn product(a: &[Rational], b: &[Rational]) -> Vec<Rational> {
    let mut result = vec![Rational::zero(); a.len() + b.len() - 1];
    for (i, a) in a.iter().enumerate() {
        for (j, b) in b.iter().enumerate() {
            result[i + j] += a * b;
        }
    }
    result
}

pub(super) fn whole(number: impl Into<BigInt>) -> Rational {
    Rational::from_integer(number.into())
}

/// The number of ways to choose `k` of `n`.
pub(super) fn binomial(n: usize, k: usize) -> Rational {
    whole(num_integer::binomial(n, k))
}

/// `beta_0 = 0, beta_1, ..., beta_s` with which `alpha` has order `s`: the order conditions
/// `sum_j alpha_j (1-j)^q = q sum_j beta_j (1-j)^(q-1)`, q = 1..s, solved exactly.
pub(super) fn explicit_beta(alpha: &[Rational]) -> Vec<Rational> {
    let steps = alpha.len() - 1;
    let power = |j: usize, q: usize| num_traits::pow(whole(1) - whole(j), q);
    let mut system: Vec<Vec<Rational>> = (1..=steps)
        .map(|q| {
            let moment: Rational = alpha.iter().enumerate().map(|(j, a)| a * power(j, q)).sum();
            let row = (1..=steps).map(|j| power(j, q - 1));
            row.chain([moment / whole(q)]).collect()
        })
        .collect();
    eliminate(&mut system);
    std::iter::once(Rational::zero())
        .chain(system.into_iter().map(|mut row| row.swap_remove(steps)))
        .collect()
}

/// Gauss-Jordan elimination of a regular system with its right-hand side as the last column.
fn eliminate(system: &mut [Vec<Rational>]) {
    for k in 0..system.len() {
        let pivot = (k..system.len()).find(|&i| !system[i][k].is_zero());
        system.swap(k, pivot.expect("the matrix is Vandermonde's of distinct nodes, hence regular"));
        let inverse = Rational::one() / &system[k][k];
        for entry in &mut system[k] {
            *entry *= &inverse;
        }
        let row = system[k].clone();
        for (i, other) in system.iter_mut().enumerate().filter(|&(i, _)| i != k) {
            debug_assert_ne!(i, k);
            let factor = other[k].clone();
            for (entry, pivot) in other.iter_mut().zip(&row) {
                *entry -= &factor * pivot;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_adams_bashforth() {
        let alpha = [ratio(1, 1), ratio(-1, 1), ratio(0, 1), ratio(0, 1)];
        assert_eq!(explicit_beta(&alpha), [ratio(0, 1), ratio(23, 12), ratio(-4, 3), ratio(5, 12)]);
    }

    #[test]
    fn counts_choices() {
        assert_eq!(
            (0..=5).map(|k| binomial(5, k)).collect::<Vec<_>>(),
            [1, 5, 10, 10, 5, 1].map(|ways: i32| whole(ways))
        );
        assert!(binomial(2, 3).is_zero());
    }
}
