//! Real roots of exact polynomials: isolated by Descartes' rule of signs, refined by bisection, compared exactly.

use std::cmp::Ordering;

use num_bigint::BigInt;
use num_traits::{One, Signed, Zero};

use super::polynomial::{Polynomial, taylor_shift};
use super::rational::{Rational, rational_to_f64};
use super::rational_roots::rational_roots;

/// One real root: a square-free polynomial and an interval that holds exactly this root of it.
#[derive(Debug, Clone)]
pub struct RealRoot {
    polynomial: Polynomial,
    /// Equal ends mean that the root is this fraction; otherwise the root is strictly between them.
    low: Rational,
    high: Rational,
    /// The sign of the polynomial between `low` and the root.
    sign_below: i32,
}

impl RealRoot {
    /// Returns the root of a square-free polynomial in the open interval, which must hold exactly one.
    fn isolated(polynomial: &Polynomial, low: Rational, high: Rational) -> Self {
        let at_low = polynomial.sign_at(&low);
        // The lower end may itself be another, simple root: the sign beside it is the slope's.
        let sign_below = if at_low == 0 { polynomial.derivative().sign_at(&low) } else { at_low };
        Self { polynomial: polynomial.clone(), low, high, sign_below }
    }

    fn exact(polynomial: &Polynomial, value: Rational) -> Self {
        Self { polynomial: polynomial.clone(), low: value.clone(), high: value, sign_below: 0 }
    }

    /// Returns the ends of an interval that holds the root; equal ends are the root itself.
    pub fn interval(&self) -> (&Rational, &Rational) {
        (&self.low, &self.high)
    }

    /// Returns the square-free polynomial of which this is a root.
    pub fn polynomial(&self) -> &Polynomial {
        &self.polynomial
    }

    /// Halves the interval.
    fn bisect(&mut self) {
        let middle = (&self.low + &self.high) / Rational::from_integer(2.into());
        match self.polynomial.sign_at(&middle) {
            0 => (self.low, self.high) = (middle.clone(), middle),
            sign if sign == self.sign_below => self.low = middle,
            _ => self.high = middle,
        }
    }

    /// Narrows the interval until it is at most this wide.
    pub fn refine(&mut self, width: &Rational) {
        while &self.high - &self.low > *width {
            self.bisect();
        }
    }

    /// Returns how the root compares with an exact number.
    pub fn compare(&self, value: &Rational) -> Ordering {
        if self.low == self.high {
            return self.low.cmp(value);
        }
        if *value <= self.low {
            return Ordering::Greater;
        }
        if *value >= self.high {
            return Ordering::Less;
        }
        match self.polynomial.sign_at(value) {
            0 => Ordering::Equal,
            sign if sign == self.sign_below => Ordering::Greater,
            _ => Ordering::Less,
        }
    }

    /// Returns the root as a fraction when it is one.
    pub fn rational_value(&self) -> Option<Rational> {
        rational_roots(&self.polynomial).into_iter().find(|value| self.compare(value) == Ordering::Equal)
    }

    /// Returns the root as a double: the one nearest to the middle of an interval that is refined well below the
    /// spacing of doubles.
    pub fn to_f64(&self) -> f64 {
        let mut narrow = self.clone();
        let relative =
            narrow.high.abs().max(Rational::one()) / Rational::from_integer(BigInt::one() << 64_u32);
        narrow.refine(&relative);
        rational_to_f64(&((&narrow.low + &narrow.high) / Rational::from_integer(2.into())))
    }
}

/// Returns the distinct real roots of a polynomial strictly between two exact numbers, in ascending order.
///
/// The polynomial may have repeated roots; each is given once. A polynomial without roots, zero included, gives none.
pub fn real_roots_between(polynomial: &Polynomial, low: &Rational, high: &Rational) -> Vec<RealRoot> {
    if polynomial.degree() == 0 || low >= high {
        return Vec::new();
    }
    let square_free = polynomial.square_free_part();
    let width = high - low;
    let on_unit = square_free.shifted_and_scaled(low, &width);
    unit_intervals(on_unit.ascending().to_vec())
        .into_iter()
        .map(|(start, end)| {
            let (start, end) = (low + &width * start, low + &width * end);
            if start == end {
                RealRoot::exact(&square_free, start)
            } else {
                RealRoot::isolated(&square_free, start, end)
            }
        })
        .collect()
}

/// Returns the distinct positive real roots of a polynomial in ascending order.
pub fn positive_roots(polynomial: &Polynomial) -> Vec<RealRoot> {
    real_roots_between(polynomial, &Rational::zero(), &root_bound(polynomial))
}

/// A power of two above every root's modulus (Cauchy: 1 + max |c_k| / |c_n|).
fn root_bound(polynomial: &Polynomial) -> Rational {
    let largest = polynomial.ascending().iter().map(BigInt::bits).max().unwrap_or(0);
    let excess = (largest + 2).saturating_sub(polynomial.leading().bits());
    Rational::from_integer(BigInt::one() << excess)
}

/// Intervals within (0, 1), in ascending order, each with exactly one root of a square-free polynomial.
///
/// A pair of equal ends is a root met exactly at a point of subdivision.
fn unit_intervals(ascending: Vec<BigInt>) -> Vec<(Rational, Rational)> {
    let mut found = Vec::new();
    // Index c at depth k stands for (c/2^k, (c+1)/2^k), with the polynomial moved onto (0, 1).
    let mut pending = vec![(BigInt::zero(), 0_u32, ascending)];
    while let Some((index, depth, polynomial)) = pending.pop() {
        let end = |offset: u32| Rational::new(&index + offset, BigInt::one() << depth);
        match sign_variations_on_unit(&polynomial) {
            0 => {}
            1 => found.push((end(0), end(1))),
            _ => {
                let left = halved(&polynomial);
                let mut right = taylor_shift(left.clone(), &BigInt::one());
                let first: BigInt = &index << 1;
                if right[0].is_zero() {
                    let middle = Rational::new(&first + 1, BigInt::one() << (depth + 1));
                    found.push((middle.clone(), middle));
                    right.remove(0);
                }
                pending.push((&first + 1, depth + 1, right));
                pending.push((first, depth + 1, left));
            }
        }
    }
    found.sort();
    found
}

/// 2^n p(z/2).
fn halved(ascending: &[BigInt]) -> Vec<BigInt> {
    let degree = ascending.len() - 1;
    ascending.iter().enumerate().map(|(k, c)| c << (degree - k)).collect()
}

/// The sign variations of (1+z)^n p(1/(1+z)): 0 and 1 are the numbers of roots in (0, 1), more is a bound.
fn sign_variations_on_unit(ascending: &[BigInt]) -> usize {
    let reversed: Vec<BigInt> = ascending.iter().rev().cloned().collect();
    let shifted = taylor_shift(reversed, &BigInt::one());
    let signs: Vec<bool> = shifted.iter().filter(|c| !c.is_zero()).map(Signed::is_positive).collect();
    signs.windows(2).filter(|pair| pair[0] != pair[1]).count()
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn fraction(n: i64, d: i64) -> Rational {
        Rational::new(n.into(), d.into())
    }

    /// Sturm's count of distinct roots in (low, high], by rational remainders: slow, independent, an oracle.
    fn sturm_count(polynomial: &Polynomial, low: &Rational, high: &Rational) -> usize {
        let mut chain = vec![polynomial.square_free_part()];
        chain.push(chain[0].derivative());
        while chain[chain.len() - 1].degree() > 0 {
            let (a, b) = (&chain[chain.len() - 2], &chain[chain.len() - 1]);
            let scale = b.leading().abs().pow((a.degree() - b.degree() + 1) as u32);
            let mut rest = a * &Polynomial::constant(scale);
            while !rest.is_zero() && rest.degree() >= b.degree() {
                let factor = rest.leading() / b.leading();
                let shift = Polynomial::power(rest.degree() - b.degree());
                rest = &rest - &(&(b * &shift) * &Polynomial::constant(factor));
            }
            if rest.is_zero() {
                break;
            }
            chain.push((-rest).primitive_part());
        }
        let variations = |x: &Rational| {
            let signs: Vec<i32> = chain.iter().map(|p| p.sign_at(x)).filter(|&s| s != 0).collect();
            signs.windows(2).filter(|s| s[0] != s[1]).count()
        };
        variations(low) - variations(high)
    }

    #[test]
    fn recognises_fractions_and_leaves_the_others() {
        // (3z - 2)(z^2 - 2): roots 2/3 and sqrt 2.
        let p = &Polynomial::from_descending(&[3, -2]) * &Polynomial::from_descending(&[1, 0, -2]);
        let roots = positive_roots(&p);
        assert_eq!(roots.len(), 2);
        assert_eq!(roots[0].rational_value(), Some(fraction(2, 3)));
        assert_eq!(roots[1].rational_value(), None);
        assert!((roots[1].to_f64() - 2_f64.sqrt()).abs() < 1e-15);
    }

    #[test]
    fn separates_roots_a_hair_apart() {
        let tiny = fraction(1, 1_000_000_000_000);
        let near = |at: Rational| Polynomial::from_rationals_descending(&[Rational::one(), -at]);
        let p = &near(fraction(1, 3)) * &near(fraction(1, 3) + &tiny);
        let roots = positive_roots(&p);
        assert_eq!(roots.len(), 2);
        assert_eq!(
            roots[0].compare(&(fraction(1, 3) + tiny / Rational::from_integer(2.into()))),
            Ordering::Less
        );
    }

    #[test]
    fn has_no_root_where_there_is_none() {
        assert!(positive_roots(&Polynomial::from_descending(&[1, 1, 1])).is_empty());
        assert!(positive_roots(&Polynomial::default()).is_empty());
        assert!(
            real_roots_between(&Polynomial::from_descending(&[1, 0]), &fraction(0, 1), &fraction(1, 1))
                .is_empty()
        );
    }

    proptest! {
        #[test]
        fn counts_as_sturm_does(c in proptest::collection::vec(-20_i64..=20, 2..8), low in -6_i64..0, high in 0_i64..6) {
            let p = Polynomial::from_ascending(c);
            let (low, high) = (fraction(low, 1), fraction(high, 1));
            prop_assume!(p.degree() > 0 && low < high);
            prop_assume!(p.sign_at(&high) != 0 && p.sign_at(&low) != 0);
            prop_assert_eq!(real_roots_between(&p, &low, &high).len(), sturm_count(&p, &low, &high));
        }

        #[test]
        fn finds_the_roots_it_was_built_from(mut roots in proptest::collection::vec((1_i64..60, 1_i64..20), 1..6)) {
            let mut product = Polynomial::constant(1);
            for (n, d) in &roots {
                product = &product * &Polynomial::from_descending(&[*d, -*n]);
            }
            roots.sort_by_key(|(n, d)| fraction(*n, *d));
            roots.dedup_by_key(|(n, d)| fraction(*n, *d));
            let found = positive_roots(&product);
            let exact: Vec<_> = found.iter().map(RealRoot::rational_value).collect();
            let expected: Vec<_> = roots.iter().map(|(n, d)| Some(fraction(*n, *d))).collect();
            prop_assert_eq!(exact, expected);
        }
    }
}
