//! The rows that a search may choose from: exact in their order, free in the rest.

use std::fmt;

use num_bigint::BigInt;
use num_traits::{One, ToPrimitive, Zero};

use crate::formula::derive::{BarrierProof, DerivedFamily, LookAhead, Stencil, barrier};
use crate::formula::{Coefficients, MAX_STEPS, Row};
use crate::math::{Rational, rational_to_f64};

use super::error::SearchError;
use super::evolve::Random;
use super::figures::FloatRow;

/// A kind of explicit rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Family {
    /// One derivative: difference formulas for x'(t_n).
    LookAhead,
    /// A history of derivatives too, the same weights for feedforward and feedback.
    General,
    /// A history of derivatives for the feedforward, feedback on the newest state alone: gamma = e_1.
    Split,
    /// A history of derivatives for the feedforward, and gamma_j = -alpha_j: every past state is corrected by its own residual, so
    /// that h = 1 is deadbeat whatever alpha is.
    Corrected,
}

impl Family {
    /// All families.
    pub const ALL: [Self; 4] = [Self::LookAhead, Self::General, Self::Split, Self::Corrected];

    /// Returns the family of a word.
    ///
    /// # Errors
    /// [`SearchError::UnknownFamily`] with the known words.
    pub fn parse(word: &str) -> Result<Self, SearchError> {
        let known = || Self::ALL.map(|family| family.to_string()).join(", ");
        Self::ALL
            .into_iter()
            .find(|family| family.to_string() == word)
            .ok_or_else(|| SearchError::UnknownFamily { word: crate::math::shortened(word), known: known() })
    }
}

impl fmt::Display for Family {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::LookAhead => "look-ahead",
            Self::General => "general",
            Self::Split => "split",
            Self::Corrected => "corrected",
        })
    }
}

/// All rows of a family, steps and order, by their free coefficients u: the c_m of a look-ahead formula, or alpha_1 to alpha_(s-1)
/// and the oldest weights of f.
#[derive(Debug, Clone)]
pub(super) struct Space {
    pub(super) family: Family,
    pub(super) steps: usize,
    pub(super) order: usize,
    kind: Kind,
    /// alpha and beta in doubles for u = 0, and their changes with u; not yet normalised.
    base: Weights,
    slopes: Vec<Weights>,
}

#[derive(Debug, Clone)]
enum Kind {
    /// With the r_i that the order fixes, and 2^(m-1) C(s-m, i-m+1) for the others.
    LookAhead {
        family: LookAhead,
        fixed: Vec<f64>,
        mixing: Vec<Vec<f64>>,
        fixed_c: Vec<f64>,
    },
    General(Box<DerivedFamily>),
}

#[derive(Debug, Clone)]
struct Weights {
    alpha: Vec<f64>,
    beta: Vec<f64>,
}

impl Space {
    pub(super) fn new(family: Family, steps: usize, order: usize) -> Result<Self, SearchError> {
        if !(1..=steps).contains(&order) || steps > MAX_STEPS {
            return Err(SearchError::OutOfReach { steps, order });
        }
        let nothing = SearchError::NothingFree { steps, order };
        if family == Family::LookAhead {
            return Self::look_ahead(LookAhead::new(steps, order).ok_or(nothing)?, steps, order);
        }
        if steps < 2 {
            return Err(nothing);
        }
        let derived = derived(steps, order).ok_or(SearchError::OutOfReach { steps, order })?;
        let weights = |solution: &[Rational]| {
            let (alpha, beta) = solution.split_at(steps + 1);
            Weights {
                alpha: alpha.iter().map(rational_to_f64).collect(),
                beta: [0.0].into_iter().chain(beta.iter().map(rational_to_f64)).collect(),
            }
        };
        let space = derived.space();
        let (base, slopes) =
            (weights(&space.particular), space.directions.iter().map(|d| weights(d)).collect());
        Ok(Self { family, steps, order, kind: Kind::General(Box::new(derived)), base, slopes })
    }

    fn look_ahead(look: LookAhead, steps: usize, order: usize) -> Result<Self, SearchError> {
        if let BarrierProof::Sign { index, value } = BarrierProof::of(steps, order) {
            let highest = barrier(steps).map_or(0, |barrier| barrier.order);
            return Err(SearchError::Barrier { steps, order, index, value: value.to_string(), highest });
        }
        if look.freedom() == 0 {
            return Err(SearchError::NothingFree { steps, order });
        }
        let unit = |m: usize| {
            let mut c = vec![Rational::zero(); steps];
            c[m] = Rational::one();
            c
        };
        let doubles = |row: Vec<Rational>| row.iter().map(rational_to_f64).collect::<Vec<f64>>();
        let weights = |c: &[Rational]| Weights { alpha: doubles(look.weights(c)), beta: Vec::new() };
        let base = weights(&look.fixed_differences());
        let slopes = (order..steps).map(|m| weights(&unit(m))).collect();
        let mut mixing = vec![vec![0.0; steps]; steps];
        for m in 0..steps {
            for (i, value) in doubles(look.image(&unit(m))).into_iter().enumerate() {
                mixing[i][m] = value;
            }
        }
        let kind = Kind::LookAhead {
            family: look,
            fixed: doubles(look.fixed_image()),
            fixed_c: doubles(look.fixed_differences()),
            mixing,
        };
        Ok(Self { family: Family::LookAhead, steps, order, kind, base, slopes })
    }

    /// The number of free coefficients.
    pub(super) fn dimension(&self) -> usize {
        self.slopes.len()
    }

    /// A random point to begin at, in coordinates without bounds: ln r_i of a look-ahead formula; else hyperbolic
    /// angles of the reflection coefficients of rho/(z - 1), so that every point is strictly zero-stable, and weights of f.
    pub(super) fn start(&self, random: &mut Random) -> Vec<f64> {
        match &self.kind {
            Kind::LookAhead { fixed, .. } => {
                let mut logs: Vec<f64> = fixed.iter().map(|r| r.ln()).collect();
                let bend = 3.0 * random.uniform();
                for _ in 0..self.dimension() {
                    let last = logs[logs.len() - 1];
                    let slope = if logs.len() > 1 { last - logs[logs.len() - 2] } else { 0.0 };
                    logs.push(last + slope - bend + 0.7 * random.normal());
                }
                logs.split_off(fixed.len())
            }
            Kind::General(_) => (0..self.dimension())
                .map(|k| if k < self.steps - 1 { 0.7 } else { 0.3 } * random.normal())
                .collect(),
        }
    }

    /// The free coefficients of a point.
    pub(super) fn free(&self, point: &[f64]) -> Vec<f64> {
        match &self.kind {
            Kind::LookAhead { fixed_c, mixing, .. } => {
                let mut c = fixed_c.clone();
                for (row, log) in mixing[fixed_c.len()..].iter().zip(point) {
                    let known: f64 = c.iter().zip(row).map(|(c, w)| c * w).sum();
                    c.push((log.exp() - known) / row[c.len()]);
                }
                c.split_off(fixed_c.len())
            }
            Kind::General(_) => {
                let (angles, tail) = point.split_at(self.steps - 1);
                let parasitic = from_reflections(angles);
                // rho = (z - 1) times the rest; alpha_s is left to the conditions.
                let alpha = (1..self.steps).map(|j| parasitic[j] - parasitic[j - 1]);
                alpha.chain(tail.iter().copied()).collect()
            }
        }
    }

    /// The normalised row of these free coefficients; `None` where the new state has no positive weight.
    pub(super) fn float_row(&self, free: &[f64]) -> Option<FloatRow> {
        let mixed = |part: fn(&Weights) -> &Vec<f64>| {
            let mut sum = part(&self.base).clone();
            for (u, slope) in free.iter().zip(&self.slopes) {
                sum.iter_mut().zip(part(slope)).for_each(|(x, s)| *x += u * s);
            }
            sum
        };
        let mut alpha = mixed(|w| &w.alpha);
        let unit = || {
            let mut unit = vec![0.0; self.steps + 1];
            unit[1] = 1.0;
            unit
        };
        if self.family == Family::LookAhead {
            let lead = alpha[0];
            if !(lead > 0.0) {
                return None;
            }
            for a in &mut alpha {
                *a /= lead;
            }
            let beta = unit().iter().map(|b| b / lead).collect();
            return Some(FloatRow { alpha, beta, feedback: unit() });
        }
        let beta = mixed(|w| &w.beta);
        let feedback = match self.family {
            Family::Split => unit(),
            Family::Corrected => [0.0].into_iter().chain(alpha[1..].iter().map(|a| -a)).collect(),
            _ => {
                let sum: f64 = beta.iter().sum();
                beta.iter().map(|b| b / sum).collect()
            }
        };
        Some(FloatRow { alpha, beta, feedback })
    }

    /// The step between the denominators that the free coefficients may have.
    pub(super) fn least_denominator(&self) -> BigInt {
        match &self.kind {
            Kind::LookAhead { family, .. } => family.least_denominator(),
            Kind::General(_) => BigInt::one(),
        }
    }

    /// The denominators up to a bound: all where they are few, beyond that each a fixed part larger than the one before, so that the list of a
    /// larger bound begins with that of a smaller one.
    pub(super) fn denominators(&self, bound: u32) -> Result<Vec<u32>, SearchError> {
        const ALL: u32 = 96;
        const GROWTH: f64 = 1.06;
        let least = self.least_denominator();
        let refuse = || SearchError::Denominator { bound, least: least.to_string() };
        let unit = least.to_u32().filter(|unit| (1..=bound).contains(unit)).ok_or_else(refuse)?;
        let next = |&k: &u32| {
            let grown = if k < ALL { k + 1 } else { (f64::from(k) * GROWTH).round() as u32 };
            Some(grown).filter(|&grown| grown <= bound / unit)
        };
        Ok(std::iter::successors(Some(1), next).map(|k| k * unit).collect())
    }

    /// The exact row of the free coefficients numerators/denominator.
    pub(super) fn row(&self, id: &str, numerators: &[i64], denominator: u32) -> Option<Row> {
        let free: Vec<Rational> =
            numerators.iter().map(|&n| Rational::new(n.into(), denominator.into())).collect();
        let mut row = match &self.kind {
            Kind::LookAhead { family, .. } => family.row(id, &free).ok()?,
            Kind::General(family) => {
                let row = family.row(id, &free).ok()?;
                Row::new(id, self.with_feedback(row.coefficients())?).ok()?
            }
        };
        row.family = Some(self.family.to_string());
        row.source = Some("kinstep".to_owned());
        row.attribution = Some("derived".to_owned());
        Some(row)
    }

    fn with_feedback(&self, coefficients: &Coefficients) -> Option<Coefficients> {
        let Coefficients::General { alpha, beta, .. } = coefficients else { return None };
        let gamma = match self.family {
            Family::Split => {
                let mut unit = vec![Rational::zero(); alpha.len()];
                unit[1] = Rational::one();
                Some(unit)
            }
            Family::Corrected => {
                Some([Rational::zero()].into_iter().chain(alpha[1..].iter().map(|a| -a)).collect())
            }
            _ => None,
        };
        Some(Coefficients::General { alpha: alpha.clone(), beta: beta.clone(), gamma })
    }
}

/// Explicit rows with alpha_s and the p newest weights of f solved for.
fn derived(steps: usize, order: usize) -> Option<DerivedFamily> {
    let s = i64::try_from(steps).ok()?;
    let samples: Vec<i64> = (0..=s).map(|j| 1 - j).collect();
    let stencil = Stencil::new(&samples, &samples[1..]).ok()?;
    let (states, slopes) = (1..=steps, steps + 1..2 * steps + 1);
    let newest = slopes.clone().take(order);
    let preference = [0].into_iter().chain(newest).chain(states.rev()).chain(slopes.skip(order)).collect();
    DerivedFamily::solved_for(stencil, order, preference).ok()
}

/// The monic polynomial whose reflection coefficients are tanh of these, highest power first: all roots inside the circle.
fn from_reflections(angles: &[f64]) -> Vec<f64> {
    let mut polynomial = vec![1.0];
    for angle in angles {
        let k = angle.tanh();
        let mirrored: Vec<f64> = [0.0].into_iter().chain(polynomial.iter().rev().copied()).collect();
        polynomial.push(0.0);
        polynomial.iter_mut().zip(&mirrored).for_each(|(p, m)| *p += k * m);
    }
    polynomial
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn points_and_rows_agree_in_every_family() {
        for family in Family::ALL {
            let space = Space::new(family, 5, 3).expect("a space");
            let mut random = Random::new(7, 1);
            for _ in 0..20 {
                let point = space.start(&mut random);
                let numerators: Vec<i64> =
                    space.free(&point).iter().map(|u| (u * 60.0).round() as i64).collect();
                let free: Vec<f64> = numerators.iter().map(|n| *n as f64 / 60.0).collect();
                let (Some(float), Some(row)) = (space.float_row(&free), space.row("r", &numerators, 60))
                else {
                    continue;
                };
                let checked = row.check();
                let analysis = checked.analysis();
                // Rounding may bring a second root to z = 1; such a row is inconsistent.
                let Some(order) = analysis.order() else { continue };
                assert!(order >= 3, "{family}");
                for (exact, quick) in [(analysis.alpha(), &float.alpha), (analysis.beta(), &float.beta)] {
                    for (e, q) in exact.iter().zip(quick) {
                        assert!((rational_to_f64(e) - q).abs() < 1e-9 * (1.0 + q.abs()), "{family}: {e} {q}");
                    }
                }
            }
        }
    }

    #[test]
    fn a_point_of_a_general_family_is_always_stable() {
        let space = Space::new(Family::General, 6, 4).expect("a space");
        let mut random = Random::new(1, 2);
        for _ in 0..50 {
            let free = space.free(&space.start(&mut random));
            assert!(space.float_row(&free).expect("a row").parasitic_radius() < 1.0);
        }
    }

    #[test]
    fn a_larger_bound_has_the_denominators_of_a_smaller_one() {
        let space = Space::new(Family::LookAhead, 4, 3).expect("a space");
        let all = space.denominators(1_000_000).expect("denominators");
        assert!(all.len() < 300 && all.contains(&48));
        for bound in [6, 48, 480, 577, 2000, 100_000, 999_999] {
            assert!(all.starts_with(&space.denominators(bound).expect("denominators")), "{bound}");
        }
    }

    #[test]
    fn what_can_not_be_searched_is_refused() {
        let refusal = |family, s, p| Space::new(family, s, p).expect_err("no space").to_string();
        assert!(
            refusal(Family::LookAhead, 5, 4)
                .contains("r_3 = -1, which must be positive; the highest possible order is 3")
        );
        assert!(refusal(Family::LookAhead, 1, 1).contains("nothing to search"));
        assert!(refusal(Family::Split, 4, 5).contains("orders 1 to 4"));
        assert!(refusal(Family::Split, 65, 5).contains("64 steps at most"));
        let space = Space::new(Family::LookAhead, 5, 3).expect("a space");
        assert!(space.denominators(5).expect_err("too small").to_string().contains("multiples of 6"));
    }
}
