//! Greatest common divisors by images modulo primes (Brown's algorithm).
//!
//! Remainder sequences over the integers swell with every step; images modulo a prime do not, and a few of them
//! joined by the Chinese remainder theorem give the divisor, which a division then proves.

use num_bigint::BigInt;
use num_integer::Integer;
use num_traits::{Signed, ToPrimitive};

use super::polynomial::Polynomial;

/// A polynomial modulo a prime, lowest power first, no zero at the end.
pub(super) type Image = Vec<u64>;

impl Polynomial {
    /// Returns the greatest common divisor of two polynomials, primitive with positive leading coefficient; 0 only for
    /// two zeros.
    pub fn gcd(&self, other: &Self) -> Self {
        if self.is_zero() {
            return other.normalised();
        }
        if other.is_zero() {
            return self.normalised();
        }
        gcd_of_primitive(&self.primitive_part(), &other.primitive_part())
    }
}

/// Returns the greatest common divisor of two primitive, nonzero polynomials, primitive with positive leading coefficient.
fn gcd_of_primitive(a: &Polynomial, b: &Polynomial) -> Polynomial {
    let leading_gcd = a.leading().gcd(&b.leading());
    let mut joined: Option<(Vec<BigInt>, BigInt)> = None;
    let mut degree = a.degree().min(b.degree()) + 1;
    for prime in primes_below(1 << 62) {
        let leading = residue(&leading_gcd, prime);
        // A prime that divides both leading coefficients may lose degrees: it says nothing.
        if leading == 0 {
            continue;
        }
        let image = image_gcd(image(a, prime), image(b, prime), prime);
        let image_degree = image.len() - 1;
        if image_degree == 0 {
            return Polynomial::constant(1);
        }
        if image_degree > degree {
            continue;
        }
        let scaled: Image = image.iter().map(|&c| mul(c, leading, prime)).collect();
        let (candidate, settled) = match joined.take() {
            Some((old, modulus)) if image_degree == degree => {
                let new = join(&old, &modulus, &scaled, prime);
                let settled = new == old;
                ((new, modulus * prime), settled)
            }
            // The first prime, or all earlier ones were unlucky.
            _ => {
                ((scaled.iter().map(|&c| symmetric(&c.into(), &prime.into())).collect(), prime.into()), true)
            }
        };
        degree = image_degree;
        if settled {
            let divisor = Polynomial::from_ascending(candidate.0.iter().cloned()).normalised();
            if a.exact_quotient(&divisor).is_some() && b.exact_quotient(&divisor).is_some() {
                return divisor;
            }
        }
        joined = Some(candidate);
    }
    unreachable!("the primes below 2^62 outlast any coefficients")
}

/// The odd primes below an even limit, from the top down.
pub(super) fn primes_below(limit: u64) -> impl Iterator<Item = u64> {
    (1..limit / 2).map(move |k| limit + 1 - 2 * k).filter(|&n| is_prime(n))
}

/// Decides primality exactly for 64-bit numbers (Miller-Rabin with the twelve bases that suffice below 2^64).
fn is_prime(n: u64) -> bool {
    const BASES: [u64; 12] = [2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37];
    if let Some(small) = BASES.iter().find(|&&p| n.is_multiple_of(p)) {
        return n == *small;
    }
    let twos = (n - 1).trailing_zeros();
    n > 1
        && BASES.iter().all(|&base| {
            let mut x = power(base, (n - 1) >> twos, n);
            if x == 1 || x == n - 1 {
                return true;
            }
            (1..twos).any(|_| {
                x = mul(x, x, n);
                x == n - 1
            })
        })
}

pub(super) fn mul(a: u64, b: u64, prime: u64) -> u64 {
    (u128::from(a) * u128::from(b) % u128::from(prime)) as u64
}

pub(super) fn sub(a: u64, b: u64, prime: u64) -> u64 {
    if a >= b { a - b } else { a + prime - b }
}

fn power(mut base: u64, mut exponent: u64, prime: u64) -> u64 {
    let mut result = 1;
    while exponent > 0 {
        if exponent & 1 == 1 {
            result = mul(result, base, prime);
        }
        base = mul(base, base, prime);
        exponent >>= 1;
    }
    result
}

fn inverse(a: u64, prime: u64) -> u64 {
    power(a, prime - 2, prime)
}

fn residue(value: &BigInt, prime: u64) -> u64 {
    value.mod_floor(&prime.into()).to_u64().expect("a residue is below its 62-bit prime")
}

pub(super) fn image(p: &Polynomial, prime: u64) -> Image {
    let mut image: Image = p.ascending().iter().map(|c| residue(c, prime)).collect();
    trim(&mut image);
    image
}

pub(super) fn trim(image: &mut Image) {
    while image.last() == Some(&0) {
        image.pop();
    }
}

/// The monic greatest common divisor modulo the prime (Euclid); not both images are zero.
pub(super) fn image_gcd(mut a: Image, mut b: Image, prime: u64) -> Image {
    while let Some(&leading) = b.last() {
        let scale = inverse(leading, prime);
        for c in &mut b {
            *c = mul(*c, scale, prime);
        }
        while a.len() >= b.len() {
            let (factor, shift) = (a[a.len() - 1], a.len() - b.len());
            for (k, &c) in b.iter().enumerate() {
                a[shift + k] = sub(a[shift + k], mul(factor, c, prime), prime);
            }
            trim(&mut a);
        }
        std::mem::swap(&mut a, &mut b);
    }
    monic(a, prime)
}

/// The multiple with leading coefficient 1 of an image that is not zero.
pub(super) fn monic(image: Image, prime: u64) -> Image {
    let scale = inverse(image[image.len() - 1], prime);
    image.into_iter().map(|c| mul(c, scale, prime)).collect()
}

/// Joins coefficients known modulo `modulus` with their images modulo one more prime.
fn join(old: &[BigInt], modulus: &BigInt, new: &[u64], prime: u64) -> Vec<BigInt> {
    let inverse_modulus = inverse(residue(modulus, prime), prime);
    let product = modulus * prime;
    old.iter()
        .zip(new)
        .map(|(known, &image)| {
            let step = mul(sub(image, residue(known, prime), prime), inverse_modulus, prime);
            symmetric(&(known + modulus * step), &product)
        })
        .collect()
}

/// The representative of least magnitude.
fn symmetric(value: &BigInt, modulus: &BigInt) -> BigInt {
    let value = value.mod_floor(modulus);
    if (&value + &value).abs() > *modulus { value - modulus } else { value }
}

#[cfg(test)]
mod tests {
    use num_traits::One;
    use proptest::prelude::*;

    use super::*;

    fn small() -> impl Strategy<Value = Polynomial> {
        proptest::collection::vec(-9_i64..=9, 1..5).prop_map(Polynomial::from_ascending)
    }

    #[test]
    fn knows_primes() {
        let small: Vec<u64> = (2..60).filter(|&n| is_prime(n)).collect();
        assert_eq!(small, [2, 3, 5, 7, 11, 13, 17, 19, 23, 29, 31, 37, 41, 43, 47, 53, 59]);
        assert!(is_prime((1 << 61) - 1));
        assert!(!is_prime(3_215_031_751), "the strong pseudoprime to the bases 2, 3, 5 and 7");
    }

    #[test]
    fn finds_divisors_larger_than_one_prime() {
        let huge: BigInt = BigInt::from(7).pow(300) + BigInt::one();
        let common = Polynomial::from_ascending([huge.clone(), BigInt::from(-3), huge.clone() * 2 + 1]);
        let a = &common * &Polynomial::from_descending(&[1, -1]);
        let b = &common * &Polynomial::from_ascending([huge, BigInt::from(5)]);
        assert_eq!(a.gcd(&b), common.normalised());
    }

    proptest! {
        #[test]
        fn the_gcd_contains_a_common_factor_and_divides_both(a in small(), b in small(), common in small()) {
            prop_assume!(!a.is_zero() && !b.is_zero() && !common.is_zero());
            let (left, right) = (&a * &common, &b * &common);
            let gcd = left.gcd(&right);
            prop_assert!(gcd.exact_quotient(&common.normalised()).is_some());
            prop_assert!(left.exact_quotient(&gcd).is_some() && right.exact_quotient(&gcd).is_some());
        }
    }
}
