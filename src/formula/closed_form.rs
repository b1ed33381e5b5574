//! The best feedback step as an algebraic number.
//!
//! Inside the feedback range the spectral radius is least at one of five kinds of points: all roots meet at zero, two real
//! roots meet, two roots or pairs have equal moduli, or the modulus of one pair is stationary. Each kind is a common
//! zero of two polynomials in h and R = |z|^2, and a resultant eliminates either.

use num_bigint::BigInt;
use num_traits::{One, Zero};

use crate::math::{
    AlgebraicNumber, Bivariate, Polynomial, Rational, RealRoot, interpolate, rational_from_f64,
    real_roots_between, resultant, resultant_cost, root_moduli,
};

use super::feedback_range::{ClosedLoop, FeedbackRange};
use super::radius::{Optimum, deadbeat};

/// What makes the spectral radius least.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cause {
    /// Every root that depends on h is zero.
    Deadbeat,
    /// Two real roots meet.
    DoubleRoot,
    /// A root and its negative.
    OppositeRoots,
    /// A real root and a complex pair of equal moduli.
    RealRootAndPair,
    /// The modulus of a complex pair has its least value.
    StationaryPair,
    /// Two complex pairs of equal moduli.
    TwoPairs,
}

impl Cause {
    /// Returns the cause in words.
    pub fn words(self) -> &'static str {
        match self {
            Self::Deadbeat => "every moving root is zero",
            Self::DoubleRoot => "two real roots meet",
            Self::OppositeRoots => "two real roots of opposite sign have equal moduli",
            Self::RealRootAndPair => "a real root and a pair have equal moduli",
            Self::StationaryPair => "the modulus of a pair is stationary",
            Self::TwoPairs => "two pairs have equal moduli",
        }
    }
}

/// The best feedback step and the squared spectral radius there, exact.
///
/// The numbers are roots of exact resultants; which root it is was decided by agreement with the numeric optimum to nine digits.
#[derive(Debug, Clone)]
pub struct ClosedForm {
    /// The feedback step h_opt.
    pub h: AlgebraicNumber,
    /// The squared spectral radius r_opt^2; `None` where the largest root does not depend on h, or the elimination was
    /// out of reach.
    pub radius_squared: Option<AlgebraicNumber>,
    /// What makes the spectral radius least at h_opt.
    pub cause: Cause,
}

/// Resultants that take more multiplications than this are left alone: seconds, not minutes.
const MOST_WORK: usize = 1_500_000;

/// The longest row whose products of pairs are formed.
const MOST_PAIRED: usize = 8;

/// How far a root may lie from the numeric optimum, relative to it.
const AGREEMENT: f64 = 1e-9;

pub(crate) fn closed_form(
    closed_loop: &ClosedLoop,
    range: &FeedbackRange,
    optimum: Optimum,
) -> Option<ClosedForm> {
    let (moving, fixed) = closed_loop.split();
    let floor = root_moduli(&fixed).first().copied().unwrap_or(0.0);
    if let Some(h) = deadbeat(&moving).filter(|h| range.contains_exact(h)) {
        let radius_squared = (floor == 0.0).then(|| AlgebraicNumber::Rational(Rational::zero()));
        return Some(ClosedForm { h: AlgebraicNumber::Rational(h), radius_squared, cause: Cause::Deadbeat });
    }
    let target = optimum.radius * optimum.radius;
    let elimination = Elimination::new(&moving);
    CAUSES.into_iter().find_map(|cause| {
        let h = eliminated(elimination.for_h(cause), optimum.h)?;
        let squared =
            (floor < optimum.radius).then(|| eliminated(elimination.for_radius(cause), target)).flatten();
        Some(ClosedForm {
            h: AlgebraicNumber::of_root(h),
            radius_squared: squared.map(AlgebraicNumber::of_root),
            cause,
        })
    })
}

/// What is looked for, the cheapest elimination first.
const CAUSES: [Cause; 5] =
    [Cause::DoubleRoot, Cause::OppositeRoots, Cause::StationaryPair, Cause::RealRootAndPair, Cause::TwoPairs];

/// The one root of the resultant beside a numeric value; the unknown y is eliminated.
fn eliminated((p, q): (Bivariate, Bivariate), near: f64) -> Option<RealRoot> {
    if resultant_cost(&p, &q) > MOST_WORK {
        return None;
    }
    let polynomial = resultant(&p, &q);
    let (value, slack) = (rational_from_f64(near)?, rational_from_f64(near.abs().max(1e-3) * AGREEMENT)?);
    let mut roots = real_roots_between(&polynomial, &(&value - &slack), &(&value + &slack)).into_iter();
    let root = roots.next()?;
    roots.next().is_none().then_some(root)
}

/// The polynomials in x = h and y that have a common zero at the optimum; y is R, or z for a double root.
struct Elimination {
    /// pi_h(z) = even(R) + z odd(R) with R = z^2.
    even: Bivariate,
    odd: Bivariate,
    /// pi_h(z) itself.
    whole: Bivariate,
    /// rho'(z) gamma(z) - rho(z) gamma'(z): zero where two roots meet for some h.
    meeting: Polynomial,
    /// pi_h(sqrt R) pi_h(-sqrt R): zero when a real or imaginary root has modulus sqrt R.
    real: Bivariate,
    /// The product of R - z_i z_j over all pairs, times a power of the leading coefficient.
    pairs: Bivariate,
}

impl Elimination {
    fn new(closed_loop: &ClosedLoop) -> Self {
        let (rho, gamma, n) = (closed_loop.rho(), closed_loop.gamma(), closed_loop.degree());
        let coefficient = |k: usize| Polynomial::from_ascending([rho.coefficient(k), gamma.coefficient(k)]);
        let every_second = |start: usize| Bivariate::new((start..=n).step_by(2).map(coefficient).collect());
        let (even, odd) = (every_second(0), every_second(1));
        Self {
            real: even.norm_over_root_of_y(&odd),
            whole: Bivariate::new((0..=n).map(coefficient).collect()),
            meeting: &(&rho.derivative() * gamma) - &(rho * &gamma.derivative()),
            // Zero, and so without candidates, where nothing that needs it would be within reach.
            pairs: if n <= MOST_PAIRED { pair_products(closed_loop) } else { Bivariate::new(Vec::new()) },
            even,
            odd,
        }
    }

    /// Two polynomials with a common zero y exactly at the h of this kind.
    fn for_h(&self, cause: Cause) -> (Bivariate, Bivariate) {
        match cause {
            Cause::Deadbeat | Cause::DoubleRoot => (self.whole.clone(), self.whole.derivative_y()),
            Cause::OppositeRoots => (self.even.clone(), self.odd.clone()),
            Cause::RealRootAndPair => (self.real.clone(), self.pairs.clone()),
            Cause::StationaryPair => (self.pairs.clone(), self.pairs.derivative_x()),
            Cause::TwoPairs => (self.pairs.clone(), self.pairs.derivative_y()),
        }
    }

    /// The same with R as the unknown that stays.
    fn for_radius(&self, cause: Cause) -> (Bivariate, Bivariate) {
        if cause == Cause::DoubleRoot {
            // z^2 - R, and what z satisfies.
            let square = Bivariate::new(vec![
                Polynomial::from_ascending([0, -1]),
                Polynomial::default(),
                Polynomial::constant(1),
            ]);
            let constants = self.meeting.ascending().iter().cloned().map(Polynomial::constant);
            return (Bivariate::new(constants.collect()), square);
        }
        let (p, q) = self.for_h(cause);
        (p.exchanged(), q.exchanged())
    }
}

/// Returns a_n^(n-1) times the product over i < j of R - z_i z_j, as a polynomial in x = h and y = R.
///
/// Its coefficients are polynomials in h of degree n - 1 at most, so n values fix them; at one h they follow from the power sums
/// of the roots: the products z_i z_j have the power sums (p_k^2 - p_2k)/2.
fn pair_products(closed_loop: &ClosedLoop) -> Bivariate {
    let n = closed_loop.degree();
    let count = n * n.saturating_sub(1) / 2;
    let values: Vec<(i64, Vec<BigInt>)> = (1_i64..)
        .map(|h| (h, closed_loop.at(&Rational::from_integer(h.into()))))
        .filter(|(_, polynomial)| polynomial.degree() == n)
        .take(n.max(1))
        .map(|(h, polynomial)| (h, pair_products_at(&polynomial, count)))
        .collect();
    let coefficient = |k: usize| {
        let samples: Vec<(i64, BigInt)> = values.iter().map(|(h, list)| (*h, list[k].clone())).collect();
        // The values are those of an integer polynomial: the division leaves nothing.
        let (multiple, factor) = interpolate(&samples);
        Polynomial::from_ascending(multiple.ascending().iter().map(|c| c / &factor))
    };
    Bivariate::new((0..=count).map(coefficient).collect())
}

/// The coefficients in R, lowest power first, at one h.
fn pair_products_at(polynomial: &Polynomial, count: usize) -> Vec<BigInt> {
    let n = polynomial.degree();
    let lead = polynomial.leading();
    let monic: Vec<Rational> =
        (0..=n).rev().map(|k| Rational::new(polynomial.coefficient(k), lead.clone())).collect();
    let sums = power_sums(&monic, 2 * count);
    let products: Vec<Rational> = (1..=count)
        .map(|k| (&sums[k] * &sums[k] - &sums[2 * k]) / Rational::from_integer(2.into()))
        .collect();
    let scale = Rational::from_integer(lead.pow(n.saturating_sub(1) as u32));
    let mut descending = from_power_sums(&products);
    descending.reverse();
    descending.iter().map(|c| (c * &scale).to_integer()).collect()
}

/// p_0, p_1, ..., p_last of the roots of a monic polynomial, highest power first (Newton's identities).
fn power_sums(monic: &[Rational], last: usize) -> Vec<Rational> {
    let n = monic.len() - 1;
    let mut sums = vec![Rational::from_integer(n.into())];
    for k in 1..=last {
        let mut sum = Rational::zero();
        for i in 1..k.min(n + 1) {
            sum -= &monic[i] * &sums[k - i];
        }
        if k <= n {
            sum -= &monic[k] * Rational::from_integer(k.into());
        }
        sums.push(sum);
    }
    sums
}

/// The monic polynomial, highest power first, whose roots have the power sums p_1, p_2, ...
fn from_power_sums(sums: &[Rational]) -> Vec<Rational> {
    let mut monic = vec![Rational::one()];
    for k in 1..=sums.len() {
        let total: Rational = (1..=k).map(|i| &monic[k - i] * &sums[i - 1]).sum();
        monic.push(-total / Rational::from_integer(k.into()));
    }
    monic
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formula::FormulaTable;

    fn closed_form_of(id: &str) -> ClosedForm {
        let formula = FormulaTable::builtin().get(id).expect("a built-in row");
        formula.analysis().closed_form().expect("within reach")
    }

    #[test]
    fn the_papers_row_has_its_surds() {
        let form = closed_form_of("la6-wang-guo");
        assert_eq!(form.h.closed_form().as_deref(), Some("(15 sqrt 33 - 71)/48"));
        let squared = form.radius_squared.and_then(|squared| squared.closed_form());
        assert_eq!(squared.as_deref(), Some("(3 + sqrt 33)/12"));
    }

    #[test]
    fn a_deadbeat_loop_has_radius_zero_at_one() {
        let form = closed_form_of("split-ab6");
        assert_eq!(form.cause, Cause::Deadbeat);
        assert_eq!(form.h.closed_form().as_deref(), Some("1"));
        assert_eq!(form.radius_squared.and_then(|squared| squared.closed_form()).as_deref(), Some("0"));
    }

    #[test]
    fn products_of_pairs_are_the_roots_of_their_polynomial() {
        // Roots 1, 2, 3: products 2, 3, 6.
        let cubic = Polynomial::from_descending(&[1, -6, 11, -6]);
        let expected = Polynomial::from_descending(&[1, -11, 36, -36]);
        assert_eq!(Polynomial::from_ascending(pair_products_at(&cubic, 3)), expected);
    }

    #[test]
    fn every_closed_form_is_the_numeric_optimum() {
        let mut found = 0;
        for formula in FormulaTable::builtin().iter().filter(|formula| formula.steps() <= 4) {
            let (Some(optimum), Some(form)) = (formula.optimum(), formula.analysis().closed_form()) else {
                continue;
            };
            found += 1;
            assert!((form.h.to_f64() - optimum.h).abs() < 1e-8 * optimum.h, "{}", formula.id());
            if let Some(squared) = form.radius_squared {
                assert!((squared.to_f64().sqrt() - optimum.radius).abs() < 1e-8, "{}", formula.id());
            }
        }
        assert!(found > 15, "only {found}");
    }
}
