//! The rational roots of an exact polynomial: roots modulo a small prime, lifted by Newton's iteration (Loos's method).

use num_bigint::BigInt;
use num_integer::Integer;
use num_traits::{Signed, ToPrimitive, Zero};

use super::polynomial::Polynomial;
use super::rational::Rational;

/// Returns every rational root of a polynomial once, in ascending order; none for the zero polynomial.
///
/// A root n/d in lowest terms has d dividing the leading coefficient L, so L n/d is an integer below L plus the largest
/// coefficient: its residue modulo a prime power beyond twice that bound determines it, and a division proves it.
pub fn rational_roots(polynomial: &Polynomial) -> Vec<Rational> {
    if polynomial.degree() == 0 {
        return Vec::new();
    }
    let (rest, zeros) = polynomial.square_free_part().without_zero_roots();
    let zero = (zeros > 0).then(Rational::zero);
    let (prime, residues) = fewest_residues(&rest);
    let mut roots: Vec<Rational> =
        residues.iter().filter_map(|residue| lifted(&rest, prime, *residue)).chain(zero).collect();
    roots.sort();
    roots
}

/// The roots modulo the prime that has the fewest of them, of several primes that keep degree and simple roots.
fn fewest_residues(square_free: &Polynomial) -> (u64, Vec<u64>) {
    const PRIMES_TRIED: usize = 24;
    if square_free.degree() == 0 {
        return (2, Vec::new());
    }
    let mut best: Option<(u64, Vec<u64>)> = None;
    for (prime, residues) in
        small_primes().filter_map(|p| simple_residues(square_free, p).map(|r| (p, r))).take(PRIMES_TRIED)
    {
        if best.as_ref().is_none_or(|(_, known)| residues.len() < known.len()) {
            best = Some((prime, residues));
        }
        if best.as_ref().is_some_and(|(_, known)| known.is_empty()) {
            break;
        }
    }
    best.unwrap_or((2, Vec::new()))
}

/// The primes from 101 on.
fn small_primes() -> impl Iterator<Item = u64> {
    (101_u64..).filter(|n| (2..=n.isqrt()).all(|d| n % d != 0))
}

/// The roots modulo a prime, `None` where the degree drops or a root is repeated.
fn simple_residues(polynomial: &Polynomial, prime: u64) -> Option<Vec<u64>> {
    let image = |p: &Polynomial| -> Vec<u64> {
        p.ascending().iter().map(|c| c.mod_floor(&prime.into()).to_u64().unwrap_or_default()).collect()
    };
    let (values, slopes) = (image(polynomial), image(&polynomial.derivative()));
    if values.last() == Some(&0) {
        return None;
    }
    let at = |image: &[u64], x: u64| image.iter().rev().fold(0, |sum, c| (sum * x + c) % prime);
    let roots: Vec<u64> = (0..prime).filter(|x| at(&values, *x) == 0).collect();
    roots.iter().all(|x| at(&slopes, *x) != 0).then_some(roots)
}

/// The rational root that is this residue modulo the prime, if there is one.
fn lifted(polynomial: &Polynomial, prime: u64, residue: u64) -> Option<Rational> {
    let leading = polynomial.leading();
    let largest = polynomial.ascending().iter().map(Signed::abs).max()?;
    let enough: BigInt = (leading.abs() + largest) * 2;
    let slope = polynomial.derivative();
    let mut modulus = BigInt::from(prime);
    let mut root = BigInt::from(residue);
    while modulus <= enough {
        modulus = &modulus * &modulus;
        let inverse = value_modulo(&slope, &root, &modulus).modinv(&modulus)?;
        root = (&root - value_modulo(polynomial, &root, &modulus) * inverse).mod_floor(&modulus);
    }
    let numerator = (&leading * root).mod_floor(&modulus);
    let numerator = if &numerator * 2 > modulus { numerator - modulus } else { numerator };
    let candidate = Rational::new(numerator, leading);
    (polynomial.sign_at(&candidate) == 0).then_some(candidate)
}

fn value_modulo(polynomial: &Polynomial, x: &BigInt, modulus: &BigInt) -> BigInt {
    polynomial.ascending().iter().rev().fold(BigInt::zero(), |sum, c| (sum * x + c).mod_floor(modulus))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn finds_none_where_there_is_none() {
        assert!(rational_roots(&Polynomial::from_descending(&[1, 0, -2])).is_empty());
        assert!(rational_roots(&Polynomial::constant(4)).is_empty());
        assert!(rational_roots(&Polynomial::default()).is_empty());
    }

    #[test]
    fn finds_roots_of_hundreds_of_digits() {
        let huge: BigInt = BigInt::from(3).pow(700) + 2;
        let numerator: BigInt = &huge * 7 + 1;
        let factor = Polynomial::from_ascending([-numerator.clone(), huge.clone()]);
        let product = &(&factor * &factor) * &Polynomial::from_descending(&[1, 0, 1]);
        assert_eq!(rational_roots(&product), [Rational::new(numerator, huge)]);
    }

    proptest! {
        #[test]
        fn finds_exactly_the_roots_it_was_built_from(
            roots in proptest::collection::btree_set((-500_i64..500, 1_i64..500), 0..5),
            shift in 1_i64..50,
        ) {
            // z^2 + z + shift has no real root.
            let mut product = Polynomial::from_descending(&[1, 1, shift]);
            for (n, d) in &roots {
                product = &product * &Polynomial::from_descending(&[*d, -*n]);
            }
            let mut expected: Vec<Rational> =
                roots.iter().map(|(n, d)| Rational::new((*n).into(), (*d).into())).collect();
            expected.sort();
            expected.dedup();
            prop_assert_eq!(rational_roots(&product), expected);
        }
    }
}
