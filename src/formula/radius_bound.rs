//! Whether a spectral radius can be had at all, decided exactly: what the numeric optimum is held against.

use num_bigint::BigInt;
use num_traits::{One, Zero};

use crate::math::{Polynomial, Rational, RealRoot, is_schur, is_schur_within, positive_roots};

use super::feedback_range::{ClosedLoop, FeedbackRange, stability_boundary};

/// Returns whether some h inside the range brings every root strictly within a positive radius.
///
/// The loop is scaled so that the radius becomes the unit circle. Its roots enter and leave there only at the zeros of finitely many
/// polynomials in h, so one exact test between any two of them decides for all h.
pub(crate) fn is_radius_reached(closed_loop: &ClosedLoop, range: &FeedbackRange, radius: &Rational) -> bool {
    let (moving, fixed) = closed_loop.split();
    if range.is_empty() || !is_schur_within(&fixed, radius) {
        return false;
    }
    let scaled = moving.scaled(radius);
    let Some((at_minus_one, pairs)) = stability_boundary(&scaled) else { return false };
    // h n/d, a root at z = -1, and the h with a root at z = 1.
    let minus_one = at_minus_one
        .map_or_else(Polynomial::default, |h| Polynomial::from_ascending([-h.numer(), h.denom().clone()]));
    let one = Rational::one();
    let plus_one =
        Polynomial::from_rationals_descending(&[scaled.gamma().value_at(&one), scaled.rho().value_at(&one)]);
    let boundary = [minus_one, plus_one, pairs]
        .iter()
        .filter(|p| !p.is_zero())
        .fold(Polynomial::constant(1), |all, p| &all * p);
    // An interval that straddles the end of the range has a root on a larger circle inside it, and is not stable.
    points_between(positive_roots(&boundary))
        .iter()
        .any(|h| range.contains_exact(h) && is_schur(&scaled.at(h)))
}

/// A positive point before, between and after ascending positive roots.
fn points_between(mut roots: Vec<RealRoot>) -> Vec<Rational> {
    let half = Rational::new(BigInt::one(), 2.into());
    let Some(first) = roots.first_mut() else { return vec![Rational::one()] };
    while first.interval().0.is_zero() {
        halve(first);
    }
    let mut points = vec![first.interval().0 * &half];
    for i in 1..roots.len() {
        while roots[i - 1].interval().1 >= roots[i].interval().0 {
            halve(&mut roots[i - 1]);
            halve(&mut roots[i]);
        }
        points.push((roots[i - 1].interval().1 + roots[i].interval().0) * &half);
    }
    points.extend(roots.last().map(|last| last.interval().1 + Rational::one()));
    points
}

fn halve(root: &mut RealRoot) {
    let (low, high) = root.interval();
    let width = (high - low) / Rational::from_integer(2.into());
    root.refine(&width);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formula::FormulaTable;
    use crate::math::rational_from_f64;

    /// The optimum comes from a search in floating point; here it is held against exact decisions, for the whole table.
    #[test]
    fn no_row_of_the_table_decays_faster_than_its_optimum_says() {
        let mut decided = 0;
        for formula in FormulaTable::builtin().iter().filter(|formula| formula.steps() <= 10) {
            let (Some(optimum), Some(closed_loop)) = (formula.optimum(), formula.analysis().closed_loop())
            else {
                continue;
            };
            let reached = |radius: f64| {
                let radius = rational_from_f64(radius).expect("a finite radius");
                is_radius_reached(closed_loop, formula.feedback_range(), &radius)
            };
            let r = optimum.radius;
            assert!(reached(r.mul_add(1.0 + 1e-6, 1e-6)), "{}: {r} is too small", formula.id());
            assert!(r < 1e-9 || !reached(r * (1.0 - 1e-9)), "{}: {r} is not the least", formula.id());
            decided += 1;
        }
        assert!(decided > 80, "only {decided}");
    }

    #[test]
    fn a_loop_that_is_stable_again_beyond_its_range_keeps_the_optimum_of_its_range() {
        let formula = FormulaTable::builtin().get("la6-touch").expect("a built-in row");
        assert!(formula.spectral_radius(1.6) < 1.0);
        let bound = formula.analysis().radius_bound().expect("a proof");
        assert!((bound - 0.897).abs() < 1e-3, "{bound}");
    }
}
