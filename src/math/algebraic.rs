//! Real algebraic numbers as people write them: fractions, surds, or a polynomial with an interval.

use std::fmt;

use num_bigint::BigInt;
use num_integer::Integer;
use num_traits::{One, Signed, ToPrimitive, Zero};

use super::factor_degrees::possible_factor_degrees;
use super::lattice;
use super::polynomial::Polynomial;
use super::rational::{Rational, rational_to_f64};
use super::real_roots::RealRoot;

/// The number (a + b sqrt m)/d in lowest terms: d > 0, b not zero, m > 1 free of small squares.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Surd {
    /// The a of (a + b sqrt m)/d.
    pub rational: BigInt,
    /// The b of (a + b sqrt m)/d.
    pub coefficient: BigInt,
    /// The m of (a + b sqrt m)/d.
    pub radicand: BigInt,
    /// The d of (a + b sqrt m)/d.
    pub denominator: BigInt,
}

/// A real algebraic number, exact.
#[derive(Debug, Clone)]
pub enum AlgebraicNumber {
    /// A fraction.
    Rational(Rational),
    /// An irrational root of a quadratic.
    Surd(Surd),
    /// A root of a polynomial of higher degree.
    Root(RealRoot),
}

/// The highest degree of the polynomials that are looked for.
const MOST_DEGREE: usize = 8;

impl AlgebraicNumber {
    /// Returns a root by its simplest description: a fraction, a surd, or the polynomial of least degree that was found.
    ///
    /// Candidates come from a short vector in the lattice of the root's powers, and count only if they divide the root's
    /// polynomial exactly and have their own root in the same interval. Degrees up to 8 are tried, unless primes rule them out;
    /// [`AlgebraicNumber::is_minimal`] tells whether nothing can have been missed.
    pub fn of_root(mut root: RealRoot) -> Self {
        if let Some(value) = root.rational_value() {
            return Self::Rational(value);
        }
        let mut least = possible_factor_degrees(root.polynomial())
            .into_iter()
            .filter(|degree| (2..=MOST_DEGREE).contains(degree))
            .find_map(|degree| factor_of_degree(&mut root, degree))
            .unwrap_or(root);
        if least.polynomial().degree() == 2
            && let Some(surd) = Surd::of_root(&mut least)
        {
            return Self::Surd(surd);
        }
        let width = least.interval().1.abs() / Rational::from_integer(BigInt::from(10).pow(19));
        if width.is_positive() {
            least.refine(&width);
        }
        Self::Root(least)
    }

    /// Returns the double nearest to the number.
    pub fn to_f64(&self) -> f64 {
        match self {
            Self::Rational(value) => rational_to_f64(value),
            Self::Surd(surd) => surd.to_f64(),
            Self::Root(root) => root.to_f64(),
        }
    }

    /// Returns the degree of the polynomial that describes the number.
    pub fn degree(&self) -> usize {
        match self {
            Self::Rational(_) => 1,
            Self::Surd(_) => 2,
            Self::Root(root) => root.polynomial().degree(),
        }
    }

    /// Returns the integer polynomial that describes the number: primitive, with positive leading coefficient.
    pub fn polynomial(&self) -> Polynomial {
        match self {
            Self::Rational(value) => Polynomial::from_ascending([-value.numer(), value.denom().clone()]),
            Self::Surd(surd) => surd.polynomial(),
            Self::Root(root) => root.polynomial().normalised(),
        }
    }

    /// Returns whether [`polynomial`](Self::polynomial) is proved irreducible, and so the minimal one; `false` leaves
    /// it open.
    pub fn is_minimal(&self) -> bool {
        match self {
            Self::Rational(_) | Self::Surd(_) => true,
            Self::Root(root) => possible_factor_degrees(root.polynomial()).is_empty(),
        }
    }

    /// Returns the number in closed form, such as `2/3` or `(15 sqrt 33 - 71)/48`; `None` above degree two.
    pub fn closed_form(&self) -> Option<String> {
        match self {
            Self::Rational(value) => Some(value.to_string()),
            Self::Surd(surd) => Some(surd.to_string()),
            Self::Root(_) => None,
        }
    }

    /// Returns the number in LaTeX; `None` above degree two.
    pub fn latex(&self) -> Option<String> {
        match self {
            Self::Rational(value) => Some(latex_fraction(value)),
            Self::Surd(surd) => Some(surd.latex()),
            Self::Root(_) => None,
        }
    }
}

/// Returns a fraction in LaTeX.
pub(crate) fn latex_fraction(value: &Rational) -> String {
    if value.is_integer() {
        return value.numer().to_string();
    }
    let sign = if value.is_negative() { "-" } else { "" };
    format!("{sign}\\frac{{{}}}{{{}}}", value.numer().abs(), value.denom())
}

/// A factor of this degree of the root's polynomial with the same root, if there is one with coefficients below about 2^60.
fn factor_of_degree(root: &mut RealRoot, degree: usize) -> Option<RealRoot> {
    let bits = 64 * (degree + 1);
    root.refine(&Rational::new(BigInt::one(), BigInt::one() << bits));
    let (low, high) = root.interval();
    let scale = Rational::from_integer(BigInt::one() << bits);
    let mut power = scale;
    let mut basis: Vec<Vec<BigInt>> = (0..=degree)
        .map(|i| {
            let mut row = vec![BigInt::zero(); degree + 2];
            row[i] = BigInt::one();
            row[degree + 1] = power.round().to_integer();
            // Rounding keeps the powers from growing; the error is below one unit of the last place.
            power = Rational::from_integer((&power * low).round().to_integer());
            row
        })
        .collect();
    lattice::reduce(&mut basis);
    let candidate = Polynomial::from_ascending(basis[0][..=degree].iter().cloned()).normalised();
    if candidate.degree() == 0 || root.polynomial().exact_quotient(&candidate).is_none() {
        return None;
    }
    let changes_sign = candidate.sign_at(low) * candidate.sign_at(high) < 0;
    let (low, high) = (low.clone(), high.clone());
    changes_sign.then(|| super::real_roots_between(&candidate, &low, &high).into_iter().next()).flatten()
}

impl Surd {
    /// Returns the root of an irreducible quadratic as a surd.
    fn of_root(root: &mut RealRoot) -> Option<Self> {
        let p = root.polynomial().normalised();
        let (a, b, c) = (p.coefficient(2), p.coefficient(1), p.coefficient(0));
        let (outside, radicand) = without_squares(&(&b * &b - &a * &c * 4));
        let axis = Rational::new(-&b, &a * 2);
        // The two roots lie on either side of the axis, which is no root itself.
        let sign = match root.compare(&axis) {
            std::cmp::Ordering::Less => -1,
            _ => 1,
        };
        let denominator = &a * 2;
        let coefficient = outside * sign;
        let common = b.gcd(&coefficient).gcd(&denominator);
        (!radicand.is_one() && radicand.is_positive()).then(|| Self {
            rational: -b / &common,
            coefficient: coefficient / &common,
            radicand,
            denominator: denominator / common,
        })
    }

    /// d^2 x^2 - 2 a d x + a^2 - b^2 m, primitive.
    fn polynomial(&self) -> Polynomial {
        let Self { rational: a, coefficient: b, radicand: m, denominator: d } = self;
        Polynomial::from_ascending([a * a - b * b * m, a * d * BigInt::from(-2), d * d]).normalised()
    }

    /// Returns the double nearest to the surd, worked out in integers.
    pub fn to_f64(&self) -> f64 {
        let bits = 200_u32;
        let root = ((&self.coefficient * &self.coefficient * &self.radicand) << (2 * bits)).sqrt();
        let root = if self.coefficient.is_negative() { -root } else { root };
        let numerator = (&self.rational << bits) + root;
        Rational::new(numerator, &self.denominator << bits).to_f64().unwrap_or(f64::NAN)
    }

    /// The two terms of the numerator with their signs, positive first.
    fn terms(&self, root: &str) -> String {
        let magnitude = self.coefficient.abs();
        let root =
            if magnitude.is_one() { root.trim_start().to_owned() } else { format!("{magnitude}{root}") };
        match (self.rational.is_zero(), self.rational.is_negative(), self.coefficient.is_negative()) {
            (true, _, false) => root,
            (true, _, true) => format!("-{root}"),
            (false, true, false) => format!("{root} - {}", self.rational.abs()),
            (false, false, false) => format!("{} + {root}", self.rational),
            (false, _, true) => format!("{} - {root}", self.rational),
        }
    }

    fn latex(&self) -> String {
        let terms = self.terms(&format!("\\sqrt{{{}}}", self.radicand));
        if self.denominator.is_one() { terms } else { format!("\\frac{{{terms}}}{{{}}}", self.denominator) }
    }
}

/// `(15 sqrt 33 - 71)/48`, `3 - sqrt 5`, `(sqrt 2)/2`.
impl fmt::Display for Surd {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let terms = self.terms(&format!(" sqrt {}", self.radicand));
        if self.denominator.is_one() {
            f.write_str(&terms)
        } else {
            write!(f, "({terms})/{}", self.denominator)
        }
    }
}

/// Returns s and m with n = s^2 m, m free of squares of primes below 10,000, and of itself being a square.
fn without_squares(n: &BigInt) -> (BigInt, BigInt) {
    let (mut outside, mut rest) = (BigInt::one(), n.clone());
    for p in 2_u32..10_000 {
        let square = BigInt::from(p) * p;
        if square > rest {
            break;
        }
        while rest.is_multiple_of(&square) {
            rest /= &square;
            outside *= p;
        }
    }
    let root = if rest.is_positive() { rest.sqrt() } else { BigInt::zero() };
    if &root * &root == rest && !root.is_one() && !root.is_zero() {
        return (outside * root, BigInt::one());
    }
    (outside, rest)
}

#[cfg(test)]
mod tests {
    use super::super::positive_roots;
    use super::*;
    use proptest::prelude::*;

    fn positive_root(descending: &[i64]) -> AlgebraicNumber {
        let roots = positive_roots(&Polynomial::from_descending(descending));
        AlgebraicNumber::of_root(roots.into_iter().next_back().expect("it has a positive root"))
    }

    #[test]
    fn writes_numbers_as_people_do() {
        for (p, text) in [
            (&[3, -2][..], "2/3"),
            (&[1, 0, -2], "sqrt 2"),
            (&[2, 0, -1], "(sqrt 2)/2"),
            (&[1, -1, -1], "(1 + sqrt 5)/2"),
            (&[1, 2, -1], "sqrt 2 - 1"),
            (&[48 * 48, 2 * 48 * 71, 71 * 71 - 225 * 33], "(15 sqrt 33 - 71)/48"),
        ] {
            assert_eq!(positive_root(p).closed_form().as_deref(), Some(text));
        }
        assert_eq!(positive_root(&[1, -1, -1]).latex().as_deref(), Some("\\frac{1 + \\sqrt{5}}{2}"));
    }

    #[test]
    fn says_nothing_closed_of_a_cubic() {
        let cube_root = positive_root(&[1, 0, 0, -2]);
        assert_eq!((cube_root.degree(), cube_root.closed_form()), (3, None));
        assert!(cube_root.is_minimal());
        assert!((cube_root.to_f64() - 2_f64.cbrt()).abs() < 1e-15);
    }

    #[test]
    fn finds_the_surd_inside_a_large_polynomial() {
        // (z^2 - z - 1) times an irreducible septic without nearby roots.
        let golden = Polynomial::from_descending(&[1, -1, -1]);
        let other = Polynomial::from_descending(&[1, 0, 3, 0, 0, 5, 1, 11]);
        let roots = positive_roots(&(&golden * &other));
        let found = AlgebraicNumber::of_root(roots.into_iter().next().expect("the golden ratio"));
        assert_eq!(found.closed_form().as_deref(), Some("(1 + sqrt 5)/2"));
    }

    proptest! {
        #[test]
        fn a_surd_is_the_root_it_came_from(a in 1_i64..50, b in -200_i64..200, c in -200_i64..-1) {
            let number = positive_root(&[a, b, c]);
            let expected = (-b as f64 + ((b * b - 4 * a * c) as f64).sqrt()) / (2 * a) as f64;
            prop_assert!((number.to_f64() - expected).abs() <= 1e-12 * (1.0 + expected.abs() + b.abs() as f64));
            prop_assert!(number.degree() <= 2);
            let whole = Polynomial::from_descending(&[a, b, c]);
            prop_assert!(whole.exact_quotient(&number.polynomial()).is_some() || number.polynomial() == whole.normalised());
        }
    }
}
