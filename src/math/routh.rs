//! Where the roots lie relative to the unit circle, decided over the integers.
//!
//! The map z = (1 + w)/(1 - w) takes the inside of the circle to the left half-plane, where the fraction-free
//! Routh array decides: its first column holds the Hurwitz determinants.

use num_bigint::BigInt;
use num_traits::{Signed, Zero};

use super::polynomial::{Polynomial, taylor_shift};
use super::rational::Rational;

/// Returns whether every root of a polynomial is strictly inside the unit circle: so for a constant, which has no root,
/// and not for zero, of which every number is a root.
pub fn is_schur(polynomial: &Polynomial) -> bool {
    !polynomial.is_zero() && is_hurwitz(&half_plane_image(polynomial, polynomial.degree()))
}

/// Returns whether every root of a polynomial has a modulus strictly below an exact positive radius.
pub fn is_schur_within(polynomial: &Polynomial, radius: &Rational) -> bool {
    radius.is_positive() && is_schur(&polynomial.shifted_and_scaled(&Rational::zero(), radius))
}

/// Returns (1 - w)^n p((1 + w)/(1 - w)), highest power first, n + 1 coefficients whatever the degree drops to.
///
/// The first coefficient is zero exactly when z = -1 is a root, or n is above the degree and even more so.
pub(crate) fn half_plane_image(polynomial: &Polynomial, n: usize) -> Vec<BigInt> {
    // z = -1 + 2/u with u = 1 - w: shift by -1, double, reverse to powers of u, then put u = 1 - w.
    let padded = (0..=n).map(|k| polynomial.coefficient(k)).collect();
    let mut in_u = taylor_shift(padded, &BigInt::from(-1));
    for (k, c) in in_u.iter_mut().enumerate() {
        *c <<= k;
    }
    in_u.reverse();
    // p(1 - w) = q(-w) with q(v) = p(1 + v).
    let mut in_w = taylor_shift(in_u, &BigInt::from(1));
    for c in in_w.iter_mut().skip(1).step_by(2) {
        *c = -std::mem::take(c);
    }
    in_w.reverse();
    in_w
}

/// Decides whether all roots have negative real parts; coefficients highest power first.
pub(crate) fn is_hurwitz(descending: &[BigInt]) -> bool {
    let degree = descending.len() - 1;
    // Equal signs throughout are necessary, and cheap to see.
    let sign = descending[0].sign();
    if descending[0].is_zero() || descending.iter().any(|c| c.sign() != sign) {
        return false;
    }
    let positive: Vec<BigInt> = descending.iter().map(Signed::abs).collect();
    let mut stable = true;
    hurwitz_determinants(&positive, degree.saturating_sub(1), |determinant| {
        stable &= determinant.is_positive();
        stable
    });
    stable
}

/// Returns the Hurwitz determinant of order n - 1, `None` when a smaller one that the array divides by is zero.
///
/// It is, up to a factor without zeros, the product over all pairs of roots of w_i + w_j.
pub(crate) fn last_hurwitz_determinant(descending: &[BigInt]) -> Option<BigInt> {
    let order = descending.len().saturating_sub(2);
    let mut last = Some(BigInt::from(1));
    let complete = hurwitz_determinants(descending, order, |determinant| {
        last = Some(determinant.clone());
        true
    });
    last.filter(|_| complete)
}

/// Gives the Hurwitz determinants of orders 1, 2, ..., `count` to `visit` until it returns false.
///
/// Row k+1 of the array is (R_k0 R_(k-1,j+1) - R_(k-1,0) R_(k,j+1)) / R_(k-2,0) from k = 3 on, undivided before: then R_k0 is
/// the determinant of order k and every division is exact. Returns false where a divisor is zero.
fn hurwitz_determinants(descending: &[BigInt], count: usize, mut visit: impl FnMut(&BigInt) -> bool) -> bool {
    let every_second = |start: usize| descending.iter().skip(start).step_by(2).cloned().collect();
    let mut rows: Vec<Vec<BigInt>> = vec![every_second(0), every_second(1)];
    let entry = |row: &[BigInt], j: usize| row.get(j).cloned().unwrap_or_default();
    for k in 1..=count {
        let (above, row) = (&rows[k - 1], &rows[k]);
        let pivot = entry(row, 0);
        if !visit(&pivot) {
            return true;
        }
        let divisor = if k >= 3 { entry(&rows[k - 2], 0) } else { BigInt::from(1) };
        if divisor.is_zero() {
            return false;
        }
        let head = entry(above, 0);
        let next = (0..above.len().saturating_sub(1))
            .map(|j| (&pivot * entry(above, j + 1) - &head * entry(row, j + 1)) / &divisor)
            .collect();
        rows.push(next);
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// The Schur-Cohn recursion in rationals: an independent, slow decision.
    fn schur_cohn(polynomial: &Polynomial) -> bool {
        let mut a: Vec<Rational> =
            polynomial.ascending().iter().cloned().map(Rational::from_integer).collect();
        while a.len() > 1 {
            let ratio = &a[0] / &a[a.len() - 1];
            if ratio.abs() >= Rational::from_integer(1.into()) {
                return false;
            }
            let mirrored: Vec<Rational> = a.iter().rev().cloned().collect();
            a = a.iter().zip(&mirrored).skip(1).map(|(x, y)| x - &ratio * y).collect();
        }
        !a.is_empty()
    }

    /// A determinant by cofactors.
    fn determinant(m: &[Vec<BigInt>]) -> BigInt {
        let Some((first, rest)) = m.split_first() else { return BigInt::from(1) };
        (0..first.len())
            .map(|c| {
                let minor: Vec<Vec<BigInt>> = rest
                    .iter()
                    .map(|r| r.iter().enumerate().filter(|(k, _)| *k != c).map(|(_, v)| v.clone()).collect())
                    .collect();
                let term = &first[c] * determinant(&minor);
                if c % 2 == 0 { term } else { -term }
            })
            .sum()
    }

    fn hurwitz_matrix(descending: &[BigInt], order: usize) -> Vec<Vec<BigInt>> {
        let at =
            |k: isize| usize::try_from(k).ok().and_then(|k| descending.get(k)).cloned().unwrap_or_default();
        (0..order)
            .map(|i| (0..order).map(|j| at((2 * j).cast_signed() - i.cast_signed() + 1)).collect())
            .collect()
    }

    #[test]
    fn the_circle_itself_is_not_inside() {
        assert!(is_schur(&Polynomial::from_descending(&[2, 0, 1])));
        assert!(!is_schur(&Polynomial::from_descending(&[1, 0, 1])));
        assert!(!is_schur(&Polynomial::from_descending(&[1, 1])));
        assert!(!is_schur(&Polynomial::from_descending(&[1, -1])));
        assert!(is_schur(&Polynomial::constant(5)));
        assert!(!is_schur(&Polynomial::default()));
    }

    proptest! {
        #[test]
        fn agrees_with_schur_cohn(c in proptest::collection::vec(-9_i64..=9, 0..7), lead in 6_i64..40) {
            let p = Polynomial::from_ascending(c.into_iter().chain([lead]));
            prop_assert_eq!(is_schur(&p), schur_cohn(&p));
        }

        #[test]
        fn the_array_holds_the_hurwitz_determinants(c in proptest::collection::vec(-9_i64..=9, 2..8)) {
            let descending: Vec<BigInt> = c.into_iter().map(BigInt::from).collect();
            let mut order = 0;
            hurwitz_determinants(&descending, descending.len() - 1, |found| {
                order += 1;
                assert_eq!(*found, determinant(&hurwitz_matrix(&descending, order)));
                true
            });
            if let Some(last) = last_hurwitz_determinant(&descending) {
                prop_assert_eq!(last, determinant(&hurwitz_matrix(&descending, descending.len() - 2)));
            }
        }

        #[test]
        fn a_radius_scales_the_circle(n in 1_i64..30, d in 1_i64..30, r in 1_i64..30) {
            let p = Polynomial::from_descending(&[d * d, 0, n * n]);
            prop_assert_eq!(is_schur_within(&p, &Rational::new(r.into(), 7.into())), 7 * n < r * d);
        }
    }
}
