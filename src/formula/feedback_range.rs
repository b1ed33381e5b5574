//! The interval of feedback steps h for which the closed loop is stable, decided exactly.

use std::cmp::Ordering;
use std::fmt;

use num_bigint::BigInt;
use num_traits::{One, Signed, Zero};

use crate::math::{
    AlgebraicNumber, Polynomial, Rational, RealRoot, common_denominator, half_plane_image, interpolate,
    is_schur, last_hurwitz_determinant, positive_roots, rational_from_f64, rational_roots, rational_to_f64,
};

/// The closed loop of a row: pi_h(z) = rho(z) + h gamma(z)/gamma(1), as an exact polynomial for every exact h.
#[derive(Debug, Clone)]
pub(crate) struct ClosedLoop {
    /// rho times a common denominator.
    rho: Polynomial,
    /// gamma/gamma(1) times the same.
    gamma: Polynomial,
}

impl ClosedLoop {
    /// Returns the loop of a row; `gamma` must not sum to zero.
    pub(crate) fn new(alpha: &[Rational], gamma: &[Rational]) -> Self {
        let sum: Rational = gamma.iter().sum();
        let gamma: Vec<Rational> = gamma.iter().map(|g| g / &sum).collect();
        let denominator = common_denominator(alpha.iter().chain(&gamma));
        let integers = |row: &[Rational]| {
            Polynomial::from_ascending(row.iter().rev().map(|c| c.numer() * (&denominator / c.denom())))
        };
        Self { rho: integers(alpha), gamma: integers(&gamma) }
    }

    /// Returns a positive multiple of pi_h.
    pub(crate) fn at(&self, h: &Rational) -> Polynomial {
        let part = |p: &Polynomial, factor: &BigInt| p * &Polynomial::constant(factor.clone());
        &part(&self.rho, h.denom()) + &part(&self.gamma, h.numer())
    }

    /// Returns the loop without the roots that no h moves, and the polynomial of those roots.
    pub(crate) fn split(&self) -> (Self, Polynomial) {
        let fixed = self.rho.gcd(&self.gamma);
        // Both are primitive multiples apart from one common content, which the quotients keep.
        match (self.rho.exact_quotient(&fixed), self.gamma.exact_quotient(&fixed)) {
            (Some(rho), Some(gamma)) => (Self { rho, gamma }, fixed),
            _ => (self.clone(), Polynomial::constant(1)),
        }
    }

    /// Returns the loop whose roots are those of this one divided by a positive radius.
    pub(crate) fn scaled(&self, radius: &Rational) -> Self {
        let n = self.degree();
        let scaled = |p: &Polynomial| {
            let coefficient = |k: usize| {
                p.coefficient(k) * radius.numer().pow(k as u32) * radius.denom().pow((n - k) as u32)
            };
            Polynomial::from_ascending((0..=n).map(coefficient))
        };
        Self { rho: scaled(&self.rho), gamma: scaled(&self.gamma) }
    }

    pub(crate) fn rho(&self) -> &Polynomial {
        &self.rho
    }

    pub(crate) fn gamma(&self) -> &Polynomial {
        &self.gamma
    }

    /// The number of roots for almost every h.
    pub(crate) fn degree(&self) -> usize {
        self.rho.degree().max(self.gamma.degree())
    }
}

/// The open interval (0, h_max) of feedback steps for which every root of pi_h is strictly inside the unit circle.
///
/// Its end is the first h at which a root touches the circle, even where the loop is stable again above it.
#[derive(Debug, Clone)]
pub struct FeedbackRange {
    end: End,
}

#[derive(Debug, Clone)]
enum End {
    /// No h is stable, however small.
    Empty,
    /// Every h is.
    Unbounded,
    /// Up to a fraction.
    Rational(Rational),
    /// Up to an irrational algebraic number, narrowed to less than 1e-18 of its size.
    Algebraic(RealRoot),
}

impl End {
    /// A positive fraction inside the range; 1 where there is no positive end.
    fn point_below(&self) -> Rational {
        let half = Rational::new(1.into(), 2.into());
        match self {
            Self::Empty | Self::Unbounded => Rational::one(),
            Self::Rational(value) => value * half,
            Self::Algebraic(root) => {
                let mut point = Rational::one();
                while root.compare(&point) != Ordering::Greater {
                    point *= &half;
                }
                point
            }
        }
    }

    /// The same end, an irrational one narrowed to less than 1e-18 of its size.
    fn narrowed(mut self) -> Self {
        if let Self::Algebraic(root) = &mut self {
            let mut width = Rational::one();
            while root.compare(&width) == Ordering::Less {
                width /= Rational::from_integer(2.into());
            }
            root.refine(&(width / Rational::from_integer(BigInt::from(10).pow(18))));
        }
        self
    }
}

impl FeedbackRange {
    /// Returns the range of a closed loop.
    ///
    /// A root on the circle makes a pair of roots with product 1 or is z = -1, and pi_h(1) = h: so the boundary lies among the
    /// positive zeros of pi_h(-1) times the last Hurwitz determinant of the loop in the half-plane. Between two of them the
    /// loop is stable throughout or nowhere, which one exact test tells.
    pub(crate) fn of(closed_loop: &ClosedLoop) -> Self {
        let (moving, fixed) = closed_loop.split();
        let Some((crossing, pairs)) = stability_boundary(&moving).filter(|_| is_schur(&fixed)) else {
            return Self { end: End::Empty };
        };
        let (fractions, rest) = without_rational_roots(&pairs);
        let fraction = fractions.into_iter().chain(crossing).filter(Signed::is_positive).min();
        let first = match (fraction, positive_roots(&rest).into_iter().next()) {
            (Some(h), Some(root)) if root.compare(&h) == Ordering::Greater => End::Rational(h),
            (_, Some(root)) => End::Algebraic(root),
            (Some(h), None) => End::Rational(h),
            (None, None) => End::Unbounded,
        };
        let end = if is_schur(&moving.at(&first.point_below())) { first.narrowed() } else { End::Empty };
        Self { end }
    }

    /// Returns whether the loop is stable at no h.
    pub fn is_empty(&self) -> bool {
        matches!(self.end, End::Empty)
    }

    /// Returns whether the loop is stable at every positive h.
    pub fn is_unbounded(&self) -> bool {
        matches!(self.end, End::Unbounded)
    }

    /// Returns h_max where it is a fraction; 0 for an empty range.
    pub fn exact(&self) -> Option<Rational> {
        match &self.end {
            End::Empty => Some(Rational::zero()),
            End::Rational(value) => Some(value.clone()),
            End::Unbounded | End::Algebraic(_) => None,
        }
    }

    /// Returns an irrational h_max as an algebraic number: a surd, or a root of a polynomial that
    /// [`AlgebraicNumber::is_minimal`] may prove irreducible. Computed anew at every call.
    pub fn irrational(&self) -> Option<AlgebraicNumber> {
        match &self.end {
            End::Algebraic(root) => Some(AlgebraicNumber::of_root(root.clone())),
            _ => None,
        }
    }

    /// Returns the integer polynomial in h of which an irrational h_max is a root, such as `32 h^2 + 108 h - 81`.
    ///
    /// It is primitive and of the least degree that was found ([`FeedbackRange::irrational`]).
    pub fn polynomial(&self) -> Option<String> {
        self.irrational().map(|number| number.polynomial().to_text("h"))
    }

    /// Returns an exact interval that holds an irrational h_max, narrower than 1e-18 of it.
    pub fn certified_interval(&self) -> Option<(&Rational, &Rational)> {
        match &self.end {
            End::Algebraic(root) => Some(root.interval()),
            _ => None,
        }
    }

    /// Returns h_max as a double: 0 for an empty range, infinity for an unbounded one.
    pub fn value(&self) -> f64 {
        match &self.end {
            End::Empty => 0.0,
            End::Unbounded => f64::INFINITY,
            End::Rational(value) => rational_to_f64(value),
            End::Algebraic(root) => root.to_f64(),
        }
    }

    /// Returns whether h is inside the range, decided for the exact value of the double.
    ///
    /// The double nearest to the end is how the end itself is written down, so it counts as the end: outside.
    pub fn contains(&self, h: f64) -> bool {
        h < self.value() && rational_from_f64(h).is_some_and(|h| self.contains_exact(&h))
    }

    /// Returns whether an exact h is inside the range.
    pub fn contains_exact(&self, h: &Rational) -> bool {
        h.is_positive()
            && match &self.end {
                End::Empty => false,
                End::Unbounded => true,
                End::Rational(end) => h < end,
                End::Algebraic(root) => root.compare(h) == Ordering::Greater,
            }
    }
}

/// Writes the range as people do: `(0, 2/3)`, `(0, 0.6317469144...)`, `(0, inf)` or `empty`.
impl fmt::Display for FeedbackRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.end {
            End::Empty => f.write_str("empty"),
            End::Unbounded => f.write_str("(0, inf)"),
            End::Rational(value) => write!(f, "(0, {value})"),
            End::Algebraic(root) => write!(f, "(0, {:.12}...)", root.to_f64()),
        }
    }
}

/// The h that puts a root at z = -1, if any, and a polynomial whose positive zeros include every h at which a pair of
/// roots is on the circle; `None` when no h is stable.
pub(super) fn stability_boundary(closed_loop: &ClosedLoop) -> Option<(Option<Rational>, Polynomial)> {
    let minus_one = -Rational::one();
    let (constant, slope) = (closed_loop.rho.value_at(&minus_one), closed_loop.gamma.value_at(&minus_one));
    let crossing = match (constant.is_zero(), slope.is_zero()) {
        (true, true) => return None,
        (_, true) => None,
        (_, false) => Some(-constant / slope),
    };
    let pairs = pair_polynomial(closed_loop, closed_loop.degree())?;
    (!pairs.is_zero()).then_some((crossing, pairs))
}

/// The rational roots of a polynomial, and its square-free part without them.
fn without_rational_roots(polynomial: &Polynomial) -> (Vec<Rational>, Polynomial) {
    let fractions = rational_roots(polynomial);
    let square_free = polynomial.square_free_part();
    let rest = fractions.iter().fold(square_free, |rest, fraction| rest.without_root(fraction).0);
    (fractions, rest)
}

/// The Hurwitz determinant of order n - 1 as a polynomial in h, by values at small integers.
///
/// `None` when a smaller one vanishes for every h, which no stable loop allows.
fn pair_polynomial(closed_loop: &ClosedLoop, n: usize) -> Option<Polynomial> {
    let rho = half_plane_image(&closed_loop.rho, n);
    let gamma = half_plane_image(&closed_loop.gamma, n);
    // Determinants of orders below n have degrees below n in h: fewer than n^2 points spoil one of them.
    let candidates = (1..).flat_map(|k: i64| [k, -k]).take(2 * n + n * n);
    let samples: Vec<(i64, BigInt)> = candidates
        .filter_map(|h| {
            let image: Vec<BigInt> = rho.iter().zip(&gamma).map(|(r, g)| r + g * h).collect();
            last_hurwitz_determinant(&image).map(|value| (h, value))
        })
        .take(n.max(1))
        .collect();
    (samples.len() == n.max(1)).then(|| interpolate(&samples).0.primitive_part())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_loop_of_no_stable_h_has_an_empty_range() {
        // Roots 1 and -1 that feedback pushes apart, a fixed root on the circle, and a palindromic loop for every h.
        let row =
            |numbers: &[i64]| numbers.iter().map(|n| Rational::from_integer((*n).into())).collect::<Vec<_>>();
        for (alpha, gamma) in [([1, 0, -1], [0, 2, 0]), ([1, 0, -1], [0, 1, 1]), ([1, -2, 1], [0, 1, 0])] {
            let range = FeedbackRange::of(&ClosedLoop::new(&row(&alpha), &row(&gamma)));
            assert!(range.is_empty() && !range.contains(1e-9), "{alpha:?}: {range}");
        }
    }

    #[test]
    fn an_implicit_loop_may_be_unbounded() {
        let row =
            |numbers: &[i64]| numbers.iter().map(|n| Rational::from_integer((*n).into())).collect::<Vec<_>>();
        let range = FeedbackRange::of(&ClosedLoop::new(&row(&[1, -1]), &row(&[1, 0])));
        assert!(range.is_unbounded() && range.contains(1e300) && range.exact().is_none());
        assert_eq!(range.to_string(), "(0, inf)");
    }
}
