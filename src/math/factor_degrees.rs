//! Which degrees the factors of an exact polynomial can have: what its images modulo primes leave possible.

use super::modular::{self, Image};
use super::polynomial::Polynomial;

/// So many primes are asked; for most irreducible polynomials half a dozen are enough.
const MOST_PRIMES: usize = 24;
/// Beyond this degree nothing is worked out, and every degree counts as possible.
const MOST_DEGREE: usize = 48;

/// Returns the degrees, between 0 and its own, that factors with integer coefficients of a square-free polynomial can have.
///
/// None at all proves the polynomial irreducible: a factor has an image modulo every prime, whose degree is then a sum of degrees of
/// irreducible factors there, and no proper degree is such a sum for each of the primes asked. The converse does not hold: a
/// degree that is left may still belong to no factor.
///
/// ```
/// use kinstep::math::{Polynomial, possible_factor_degrees};
/// assert!(possible_factor_degrees(&Polynomial::from_descending(&[1, 0, 0, -2])).is_empty());
/// // (z^2 + 1)(z^3 - 2)
/// assert_eq!(possible_factor_degrees(&Polynomial::from_descending(&[1, 0, 1, -2, 0, -2])), [2, 3]);
/// ```
pub fn possible_factor_degrees(polynomial: &Polynomial) -> Vec<usize> {
    let n = polynomial.degree();
    if n <= 1 {
        return Vec::new();
    }
    let mut possible = vec![true; n];
    if n <= MOST_DEGREE {
        for degrees in modular::primes_below(1 << 31)
            .take(2 * MOST_PRIMES)
            .filter_map(|prime| irreducible_degrees(polynomial, prime))
            .take(MOST_PRIMES)
        {
            let sums = subset_sums(&degrees, n);
            possible.iter_mut().zip(sums).for_each(|(known, sum)| *known &= sum);
            if possible[1..].iter().all(|known| !known) {
                break;
            }
        }
    }
    (1..n).filter(|&degree| possible[degree]).collect()
}

/// Which of 0, ..., n - 1 are sums of some of the degrees.
fn subset_sums(degrees: &[usize], n: usize) -> Vec<bool> {
    let mut sums = vec![false; n + 1];
    sums[0] = true;
    for &degree in degrees {
        for sum in (degree..=n).rev() {
            sums[sum] |= sums[sum - degree];
        }
    }
    sums
}

/// The degrees of the irreducible factors modulo a prime, `None` where the image loses degree or has a repeated factor.
///
/// z^(p^d) - z is the product of all irreducible polynomials whose degree divides d, so greatest common divisors with it sort the
/// factors by degree.
fn irreducible_degrees(polynomial: &Polynomial, prime: u64) -> Option<Vec<usize>> {
    let image = modular::image(polynomial, prime);
    let slope = modular::image(&polynomial.derivative(), prime);
    if image.len() <= polynomial.degree() || slope.is_empty() {
        return None;
    }
    let mut rest = modular::monic(image, prime);
    if modular::image_gcd(rest.clone(), slope, prime).len() > 1 {
        return None;
    }
    let mut degrees = Vec::new();
    let mut power: Image = vec![0, 1];
    for d in 1.. {
        if 2 * d >= rest.len() {
            break;
        }
        power = power_modulo(&power, prime, &rest, prime);
        let mut shifted = power.clone();
        shifted.resize(shifted.len().max(2), 0);
        shifted[1] = modular::sub(shifted[1], 1, prime);
        modular::trim(&mut shifted);
        let common = modular::image_gcd(rest.clone(), shifted, prime);
        let count = (common.len() - 1) / d;
        if count > 0 {
            degrees.extend(std::iter::repeat_n(d, count));
            rest = divided(rest, &common, prime).0;
            power = divided(power, &rest, prime).1;
        }
    }
    if rest.len() > 1 {
        degrees.push(rest.len() - 1);
    }
    Some(degrees)
}

/// base^exponent modulo a monic image.
fn power_modulo(base: &Image, mut exponent: u64, modulus: &Image, prime: u64) -> Image {
    let times = |a: &Image, b: &Image| divided(product(a, b, prime), modulus, prime).1;
    let mut square = divided(base.clone(), modulus, prime).1;
    let mut result: Image = vec![1];
    while exponent > 0 {
        if exponent & 1 == 1 {
            result = times(&result, &square);
        }
        square = times(&square, &square);
        exponent >>= 1;
    }
    result
}

fn product(a: &Image, b: &Image, prime: u64) -> Image {
    if a.is_empty() || b.is_empty() {
        return Vec::new();
    }
    let mut product = vec![0; a.len() + b.len() - 1];
    for (i, x) in a.iter().enumerate() {
        for (j, y) in b.iter().enumerate() {
            product[i + j] = (product[i + j] + modular::mul(*x, *y, prime)) % prime;
        }
    }
    modular::trim(&mut product);
    product
}

/// Quotient and remainder by a monic image.
fn divided(mut a: Image, monic: &Image, prime: u64) -> (Image, Image) {
    let mut quotient = vec![0; (a.len() + 1).saturating_sub(monic.len())];
    while a.len() >= monic.len() {
        let (factor, shift) = (a[a.len() - 1], a.len() - monic.len());
        quotient[shift] = factor;
        for (k, &c) in monic.iter().enumerate() {
            a[shift + k] = modular::sub(a[shift + k], modular::mul(factor, c, prime), prime);
        }
        modular::trim(&mut a);
    }
    (quotient, a)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn cyclotomic_polynomials_split_modulo_every_prime_and_stay_undecided() {
        // z^4 + 1 is irreducible, but has factors of degree 2 modulo every prime.
        assert_eq!(possible_factor_degrees(&Polynomial::from_descending(&[1, 0, 0, 0, 1])), [2]);
    }

    #[test]
    fn eisenstein_polynomials_of_all_degrees_are_irreducible() {
        for degree in 2..30_usize {
            let mut descending = vec![0; degree + 1];
            (descending[0], descending[degree - 1], descending[degree]) = (1, 6, 2);
            let polynomial = Polynomial::from_descending(&descending);
            assert!(possible_factor_degrees(&polynomial).is_empty(), "{polynomial:?}");
        }
    }

    #[test]
    fn constants_and_lines_have_no_proper_factor() {
        for polynomial in
            [Polynomial::default(), Polynomial::constant(6), Polynomial::from_descending(&[2, 1])]
        {
            assert!(possible_factor_degrees(&polynomial).is_empty());
        }
    }

    proptest! {
        #[test]
        fn the_degree_of_a_factor_is_always_possible(
            a in proptest::collection::vec(-9_i64..=9, 2..6),
            b in proptest::collection::vec(-9_i64..=9, 2..6),
        ) {
            let (a, b) = (Polynomial::from_ascending(a), Polynomial::from_ascending(b));
            let product = &a * &b;
            prop_assume!(a.degree() > 0 && b.degree() > 0 && product.is_square_free());
            let possible = possible_factor_degrees(&product.primitive_part());
            prop_assert!(possible.contains(&a.degree()) && possible.contains(&b.degree()));
        }
    }
}
