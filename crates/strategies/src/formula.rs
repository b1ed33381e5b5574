//! Random formulas of a known order, by construction.

use super::rational::{binomial, explicit_beta, product, ratio, whole};
use kinstep::formula::{Coefficients, Formula, FormulaTable, Row};
use kinstep::math::Rational;
use num_traits::{One, Zero};
use proptest::prelude::*;
use proptest::sample::select;
use std::fmt;

/// The highest order of the random formulas.
const HIGHEST_ORDER: usize = 6;
/// Steps and order of the look-ahead formulas drawn.
const LOOK_AHEAD: [(usize, usize); 7] = [(1, 1), (2, 1), (3, 2), (4, 2), (4, 3), (5, 3), (6, 4)];

/// A formula that prints as the row it was read from.
#[derive(Clone)]
pub struct FormulaCase {
    formula: Formula,
}

impl FormulaCase {
    /// The formula of coefficients, through the door for rows: what the numbers say is written into a finished row,
    /// and the row is read and checked again. `None` for numbers that make no formula.
    pub fn of(id: &str, coefficients: Coefficients) -> Option<Self> {
        let text = Row::new(id, coefficients).ok()?.check().to_toml();
        let table = FormulaTable::from_toml(&text).ok()?;
        table.get(id).ok().cloned().map(Self::from)
    }

    /// The formula.
    pub fn formula(&self) -> &Formula {
        &self.formula
    }

    /// The row as text with one order more than it has: everything that reads rows has to refuse it.
    pub fn lying_row(&self) -> String {
        let order = self.formula.order();
        self.to_string().replace(&format!("order = {order}\n"), &format!("order = {}\n", order + 1))
    }

    fn is_for_control(&self) -> bool {
        let formula = &self.formula;
        formula.order() <= HIGHEST_ORDER && formula.is_explicit() && formula.is_strictly_zero_stable()
    }
}

impl From<Formula> for FormulaCase {
    fn from(formula: Formula) -> Self {
        Self { formula }
    }
}

impl fmt::Display for FormulaCase {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.formula.row().clone().check().to_toml())
    }
}

impl fmt::Debug for FormulaCase {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

/// Strictly zero-stable explicit formulas of order 1 to 6: the three kinds below.
pub fn formulas() -> impl Strategy<Value = FormulaCase> + Clone {
    prop_oneof![2 => from_table(), 3 => adams_like(), 2 => look_ahead()]
}

/// Rows of the built-in table.
pub fn from_table() -> impl Strategy<Value = FormulaCase> + Clone {
    let rows = FormulaTable::builtin().iter().cloned().map(FormulaCase::from);
    select(rows.filter(FormulaCase::is_for_control).collect::<Vec<_>>())
}

/// Formulas of as many steps as their order: rho has a simple root at 1 and the others, real or in pairs, within 7/10 of
/// the origin; beta_1, ..., beta_s solve the order conditions; the feedback acts on the newest state only or like f.
pub fn adams_like() -> impl Strategy<Value = FormulaCase> + Clone {
    let real = prop::collection::vec(-7_i64..=7, 0..4);
    let pairs = prop::collection::vec((1_i64..=7, -9_i64..=9), 0..3);
    (real, pairs, any::<bool>()).prop_filter_map("a formula of order up to six", |(real, pairs, split)| {
        let alpha = alpha_of_roots(&real, &pairs);
        let beta = explicit_beta(&alpha);
        let newest = |j| if j == 1 { Rational::one() } else { Rational::zero() };
        let gamma = split.then(|| (0..alpha.len()).map(newest).collect());
        FormulaCase::of("random-adams-like", Coefficients::General { alpha, beta, gamma })
            .filter(FormulaCase::is_for_control)
    })
}

/// Formulas like [`adams_like`] that are not zero-stable: rho has one more real root outside the circle, between 11/10 and 2, or a
/// double one at -1. They declare it honestly; it is for whatever runs them to refuse.
pub fn unstable_formulas() -> impl Strategy<Value = FormulaCase> + Clone {
    let real = prop::collection::vec(-7_i64..=7, 0..3);
    let bad = prop_oneof![(11_i64..=20).prop_map(|r| vec![r]), Just(vec![-10, -10])];
    (real, bad).prop_filter_map("a formula of order up to six", |(real, bad)| {
        let alpha = alpha_of_roots(&[real, bad].concat(), &[]);
        let beta = explicit_beta(&alpha);
        FormulaCase::of("random-unstable", Coefficients::General { alpha, beta, gamma: None })
            .filter(|case| case.formula.order() <= HIGHEST_ORDER && !case.formula.is_zero_stable())
    })
}

/// (z - 1) times (z - r/10) for every real root and (z^2 - 2 (m/10)(n/10) z + (m/10)^2) for every pair of modulus m/10.
fn alpha_of_roots(real: &[i64], pairs: &[(i64, i64)]) -> Vec<Rational> {
    let factors = real.iter().map(|&r| vec![Rational::one(), ratio(-r, 10)]);
    let pairs = pairs.iter().map(|&(m, n)| vec![Rational::one(), ratio(-m * n, 50), ratio(m * m, 100)]);
    factors.chain(pairs).fold(vec![Rational::one(), -Rational::one()], |rho, factor| product(&rho, &factor))
}

/// Look-ahead difference formulas with random free parameters: in `zeta = (z-1)/(z+1)` the coefficients of the root polynomial
/// are `r_0, ..., r_{s-1}`, of which the order fixes the first p and the rest is drawn.
pub fn look_ahead() -> impl Strategy<Value = FormulaCase> + Clone {
    let free = prop::collection::vec(1_i64..=48, 2);
    (select(&LOOK_AHEAD[..]), free).prop_filter_map("a zero-stable choice", |((steps, order), free)| {
        let numerators = look_ahead_weights(steps, order, &free);
        if numerators[0].is_zero() {
            return None;
        }
        let coefficients = Coefficients::Difference { numerators, denominator: Rational::one() };
        FormulaCase::of("random-look-ahead", coefficients).filter(FormulaCase::is_for_control)
    })
}

/// The weights `a_j` of `sum_m c_m nabla^m`: `c_1 = 1` and `c_m = -1/(m (m-1))` up to the order, then such that
/// `r_{m-1} = sum_i 2^{i-1} C(s-i, m-i) c_i` is the next free number over 12.
fn look_ahead_weights(steps: usize, order: usize, free: &[i64]) -> Vec<Rational> {
    let mut c: Vec<Rational> = Vec::with_capacity(steps);
    for m in 1..=steps {
        c.push(if m == 1 {
            Rational::one()
        } else if m <= order {
            -whole(m * (m - 1)).recip()
        } else {
            let known = (1..m).map(|i| &c[i - 1] * whole(1_u64 << (i - 1)) * binomial(steps - i, m - i));
            (ratio(free[m - order - 1], 12) - known.sum::<Rational>()) / whole(1_u64 << (m - 1))
        });
    }
    let sign = |j: usize| whole(if j.is_multiple_of(2) { 1 } else { -1 });
    (0..=steps).map(|j| (1..=steps).map(|m| &c[m - 1] * sign(j) * binomial(m, j)).sum()).collect()
}

/// Feedback steps inside the range of a formula, evenly spread, at which errors decay by `radius` a step or faster.
pub fn feedback_steps(formula: &Formula, radius: f64) -> Vec<f64> {
    const STEPS: u32 = 20;
    let range = formula.feedback_range();
    let end = range.value().min(4.0);
    let candidate = |k: u32| (1000.0 * end * f64::from(k) / f64::from(STEPS)).floor() / 1000.0;
    (1..STEPS).map(candidate).filter(|&h| range.contains(h) && formula.spectral_radius(h) <= radius).collect()
}

/// Feedback steps beyond the range at which errors grow by `radius` a step or faster.
pub fn overshooting_steps(formula: &Formula, radius: f64) -> Vec<f64> {
    let end = formula.feedback_range().value();
    [1.05, 1.1, 1.2, 1.4, 1.7, 2.0]
        .map(|factor| (1000.0 * end * factor).ceil() / 1000.0)
        .into_iter()
        .filter(|&h| h.is_finite() && formula.spectral_radius(h) >= radius)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_parametrisation_finds_published_rows() {
        // Its range ends at sigma k = 2/3, which is twice r_4: the second number over 12 has to be 4.
        let published = [12, -3, -4, -6, 0, 1].map(|a| ratio(a, 24));
        let mut found =
            (1..=48).map(|free| [free, 4]).filter(|free| look_ahead_weights(5, 3, free) == published);
        assert_eq!(found.next(), Some([16, 4]));
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]

        #[test]
        fn formulas_made_from_roots_have_the_order_of_their_steps(case in adams_like()) {
            prop_assert!(case.formula().order() >= case.formula().steps(), "{}", case);
            prop_assert!(case.formula().is_strictly_zero_stable());
        }

        #[test]
        fn bad_formulas_are_refused_by_whatever_would_run_them(case in unstable_formulas(), good in formulas()) {
            prop_assert!(case.formula().runnable().is_err());
            prop_assert!(good.formula().runnable().is_ok());
            prop_assert!(FormulaTable::from_toml(&good.to_string()).is_ok());
            prop_assert!(FormulaTable::from_toml(&good.lying_row()).is_err(), "{}", good.lying_row());
        }

        #[test]
        fn look_ahead_formulas_have_an_order_of_the_list(case in look_ahead()) {
            let formula = case.formula();
            prop_assert!(LOOK_AHEAD.iter().any(|&(s, p)| formula.steps() == s && formula.order() >= p), "{}", case);
            prop_assert!(!formula.is_split() && formula.is_strictly_zero_stable());
        }

        #[test]
        fn feedback_steps_keep_their_promise(case in formulas()) {
            for h in feedback_steps(case.formula(), 0.95) {
                prop_assert!(case.formula().feedback_range().contains(h));
                prop_assert!(case.formula().spectral_radius(h) <= 0.95);
            }
            for h in overshooting_steps(case.formula(), 1.02) {
                prop_assert!(!case.formula().feedback_range().contains(h));
            }
        }
    }
}
