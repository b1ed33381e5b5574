//! The root condition of zero-stability, decided exactly.

use num_traits::{One, Zero};

use super::polynomial::Polynomial;
use super::rational::Rational;
use super::real_roots::real_roots_between;
use super::routh::is_schur;

/// Where the roots of a first characteristic polynomial rho lie relative to the unit circle.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum RootCondition {
    /// All roots are inside the circle except, at most, a simple one at z = 1: strictly zero-stable.
    StrictlyStable,
    /// All roots are inside or on the circle and those on it are simple, but there is one other than z = 1:
    /// zero-stable, with a parasitic solution that does not decay.
    WeaklyStable,
    /// A root lies outside the circle, or a repeated one on it: not zero-stable.
    Unstable,
}

/// Returns the verdict of the root condition on a polynomial, without any tolerance.
///
/// Divides out z = 1 and z = -1, then splits off gcd(rho, rho*), rho*(z) = z^s rho(1/z), which holds every other root on
/// the circle. The cofactor must have all roots inside. In the common factor w = z + 1/z turns roots on
/// the circle into real roots between -2 and 2: all of them must be, and distinct.
///
/// ```
/// use kinstep::math::{Polynomial, RootCondition, root_condition};
/// let leapfrog = Polynomial::from_descending(&[1, 0, -1]);
/// assert_eq!(root_condition(&leapfrog), RootCondition::WeaklyStable);
/// let double = Polynomial::from_descending(&[1, -2, 1]);
/// assert_eq!(root_condition(&double), RootCondition::Unstable);
/// ```
pub fn root_condition(rho: &Polynomial) -> RootCondition {
    if rho.is_zero() {
        return RootCondition::Unstable;
    }
    let (rest, at_one) = rho.without_root(&Rational::one());
    let (rest, at_minus_one) = rest.without_root(&-Rational::one());
    if at_one > 1 || at_minus_one > 1 {
        return RootCondition::Unstable;
    }
    let (rest, _) = rest.without_zero_roots();
    let mirrored = rest.gcd(&rest.reversed());
    let inside = rest.normalised().exact_quotient(&mirrored).unwrap_or_default();
    if !is_schur(&inside) || !has_only_simple_circle_roots(&mirrored) {
        return RootCondition::Unstable;
    }
    if at_minus_one == 0 && mirrored.degree() == 0 {
        RootCondition::StrictlyStable
    } else {
        RootCondition::WeaklyStable
    }
}

/// Decides for a palindromic polynomial without roots 1 and -1 whether all roots are simple and on the circle.
fn has_only_simple_circle_roots(palindrome: &Polynomial) -> bool {
    let pairs = palindrome.degree() / 2;
    let two = Rational::from_integer(2.into());
    real_roots_between(&in_sum_of_inverses(palindrome), &-two.clone(), &two).len() == pairs
}

/// Returns q with p(z) = z^d q(z + 1/z) for a palindromic p of degree 2d.
fn in_sum_of_inverses(palindrome: &Polynomial) -> Polynomial {
    let middle = palindrome.degree() / 2;
    // z^k + z^-k as polynomials in w: t_0 = 2, t_1 = w, t_(k+1) = w t_k - t_(k-1).
    let w = Polynomial::power(1);
    let (mut previous, mut current) = (Polynomial::constant(2), w.clone());
    let mut sum = Polynomial::constant(palindrome.coefficient(middle));
    for k in 1..=middle {
        sum = &sum + &(&current * &Polynomial::constant(palindrome.coefficient(middle + k)));
        let next = &(&w * &current) - &previous;
        previous = std::mem::replace(&mut current, next);
    }
    debug_assert!(!sum.is_zero() || palindrome.leading().is_zero());
    sum
}

#[cfg(test)]
mod tests {
    use super::RootCondition::{StrictlyStable, Unstable, WeaklyStable};
    use super::*;

    fn verdict(descending: &[i64]) -> RootCondition {
        root_condition(&Polynomial::from_descending(descending))
    }

    #[test]
    fn tells_the_three_cases_apart() {
        assert_eq!(verdict(&[1, -1]), StrictlyStable);
        assert_eq!(verdict(&[1, -1, 0, 0]), StrictlyStable);
        assert_eq!(verdict(&[24, -5, -12, -6, -4, 3]), StrictlyStable);
        assert_eq!(verdict(&[1, 0, -1]), WeaklyStable);
        assert_eq!(verdict(&[1, 0, 0, 0, -1]), WeaklyStable);
        assert_eq!(verdict(&[5, -6, 5]), WeaklyStable, "a complex pair on the circle, simple");
        assert_eq!(verdict(&[1, -2, 1]), Unstable);
        assert_eq!(verdict(&[1, 1, -1, -1]), Unstable, "double root at -1");
        assert_eq!(verdict(&[1, 4, -5]), Unstable);
        assert_eq!(verdict(&[25, -60, 86, -60, 25]), Unstable, "a double complex pair on the circle");
        assert_eq!(verdict(&[2, -5, 2]), Unstable, "2 and 1/2 mirror each other and are not on the circle");
    }

    #[test]
    fn degenerate_polynomials_have_a_verdict() {
        assert_eq!(verdict(&[]), Unstable);
        assert_eq!(verdict(&[7]), StrictlyStable);
        assert_eq!(verdict(&[1, 0, 0]), StrictlyStable, "all roots at 0");
    }
}
