//! Sound rows that an inconsistent one was probably meant to be.

use std::fmt;

use num_traits::{One, Signed, ToPrimitive, Zero};

use crate::math::Rational;

use super::row::{Coefficients, Row};

/// The most digits behind a decimal point of a coefficient that may have been rounded.
const MOST_DECIMALS: u32 = 15;
/// Digits from which on a decimal may have been rounded: 0.25 and 0.125 are what they are.
const LEAST_DECIMALS: u32 = 3;
/// The largest denominator that a rounded coefficient is taken to have had.
const MOST_DENOMINATOR: i64 = 10_000;

/// What was probably done to a row.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Slip {
    /// It was written oldest sample first.
    Reversed,
    /// Its fractions were rounded to decimals.
    Rounded,
    /// One number was mistyped.
    Typo {
        /// Which one, such as `coefficient 6` or `beta[2]`.
        place: String,
        /// What stands there.
        written: Rational,
        /// What would do.
        meant: Rational,
    },
}

/// A zero-stable row near to an inconsistent one.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Hint {
    /// How the one became the other.
    pub slip: Slip,
    /// The coefficients that would do.
    pub coefficients: Coefficients,
    /// The order of that row.
    pub order: usize,
}

impl fmt::Display for Hint {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.slip {
            Slip::Reversed => {
                f.write_str("the row reads as if written oldest sample first; newest first it is ")?;
            }
            Slip::Rounded => {
                f.write_str("the numbers look like rounded fractions; with these it is ")?;
            }
            Slip::Typo { place, written, meant } => {
                write!(f, "with {meant} in place of {written} as {place} it is ")?;
            }
        }
        let list =
            |weights: &[Rational]| weights.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ");
        match &self.coefficients {
            Coefficients::Difference { numerators, denominator } => {
                write!(f, "({}) / {denominator}", list(numerators))?;
            }
            Coefficients::General { alpha, beta, .. } => {
                write!(f, "alpha ({}); beta ({})", list(alpha), list(beta))?;
            }
        }
        write!(f, ", consistent, zero-stable and of order {}", self.order)
    }
}

impl Row {
    /// Returns the zero-stable rows that an inconsistent one was probably meant to be, highest order first: read from its other end,
    /// with fractions in place of rounded decimals, or with one number changed. None for a consistent row.
    ///
    /// ```
    /// use kinstep::formula::Row;
    /// let typo = Row::from_difference("typo", "24,-5,-12,-6,-4,4", "48")?;
    /// let hints = typo.hints();
    /// assert!(hints[0].to_string().starts_with("with 3 in place of 4 as coefficient 6 it is (24, -5, -12, -6, -4, 3) / 48"));
    /// assert_eq!(hints[0].order, 3);
    /// # Ok::<(), kinstep::formula::DefectKind>(())
    /// ```
    pub fn hints(&self) -> Vec<Hint> {
        if self.clone().check().analysis().order().is_some() {
            return Vec::new();
        }
        let written = self.coefficients();
        let candidates = [(Slip::Reversed, reversed(written))].into_iter();
        let candidates =
            candidates.chain(fractions(written).map(|row| (Slip::Rounded, row))).chain(retyped(written));
        let mut hints: Vec<Hint> =
            candidates.filter_map(|(slip, coefficients)| sound(slip, coefficients)).collect();
        // A change of beta can always make a row consistent; only more than that is a sign.
        let any = hints.iter().any(|hint| hint.order > 1);
        hints.retain(|hint| match &hint.slip {
            Slip::Typo { place, .. } => hint.order > 1 || !any && !place.starts_with("beta"),
            Slip::Reversed | Slip::Rounded => true,
        });
        hints.sort_by_key(|hint| std::cmp::Reverse(hint.order));
        hints
    }
}

/// The hint of these coefficients, where they are sound.
fn sound(slip: Slip, coefficients: Coefficients) -> Option<Hint> {
    let checked = Row::new("hint", coefficients.clone()).ok()?.check();
    let analysis = checked.analysis();
    let order = analysis.order().filter(|_| analysis.is_zero_stable())?;
    Some(Hint { slip, coefficients, order })
}

fn reversed(written: &Coefficients) -> Coefficients {
    let turned = |weights: &Vec<Rational>| weights.iter().rev().cloned().collect::<Vec<_>>();
    match written {
        Coefficients::Difference { numerators, denominator } => {
            Coefficients::Difference { numerators: turned(numerators), denominator: denominator.clone() }
        }
        Coefficients::General { alpha, beta, gamma } => Coefficients::General {
            alpha: turned(alpha),
            beta: turned(beta),
            gamma: gamma.as_ref().map(turned),
        },
    }
}

/// The same with the simplest fractions in place of long decimals; nothing where there are none.
fn fractions(written: &Coefficients) -> Option<Coefficients> {
    let simple = |weights: &Vec<Rational>| weights.iter().map(simplest).collect::<Vec<_>>();
    let found = match written {
        Coefficients::Difference { numerators, denominator } => {
            Coefficients::Difference { numerators: simple(numerators), denominator: denominator.clone() }
        }
        Coefficients::General { alpha, beta, gamma } => Coefficients::General {
            alpha: simple(alpha),
            beta: simple(beta),
            gamma: gamma.as_ref().map(simple),
        },
    };
    (found != *written).then_some(found)
}

/// The fraction of the smallest denominator that rounds to a decimal; the number itself where it has few digits or is none.
fn simplest(written: &Rational) -> Rational {
    let ten = Rational::from_integer(10.into());
    let mut unit = Rational::one();
    let decimals = (0..=MOST_DECIMALS).find(|_| {
        let is_whole = (written / &unit).is_integer();
        if !is_whole {
            unit = &unit / &ten;
        }
        is_whole
    });
    if decimals.is_none_or(|decimals| decimals < LEAST_DECIMALS) {
        return written.clone();
    }
    let half = &unit / Rational::from_integer(2.into());
    let near = |denominator: i64| {
        let numerator = (written * Rational::from_integer(denominator.into())).round();
        let fraction = numerator / Rational::from_integer(denominator.into());
        ((&fraction - written).abs() <= half).then_some(fraction)
    };
    (1..=MOST_DENOMINATOR).find_map(near).unwrap_or_else(|| written.clone())
}

/// Every way to change one number so that the two conditions of consistency can hold.
fn retyped(written: &Coefficients) -> Vec<(Slip, Coefficients)> {
    match written {
        Coefficients::Difference { numerators, denominator } => retyped_difference(numerators, denominator),
        Coefficients::General { alpha, beta, gamma } => retyped_general(alpha, beta, gamma.as_ref()),
    }
}

fn typo(place: String, written: &Rational, meant: &Rational) -> Slip {
    Slip::Typo { place, written: written.clone(), meant: meant.clone() }
}

/// The sum must vanish, and sum (1 - j) a_j be the denominator.
fn retyped_difference(numerators: &[Rational], denominator: &Rational) -> Vec<(Slip, Coefficients)> {
    let sum: Rational = numerators.iter().sum();
    let mut found = Vec::new();
    for (j, number) in numerators.iter().enumerate() {
        let mut changed = numerators.to_vec();
        changed[j] = number - &sum;
        let slip = typo(format!("coefficient {}", j + 1), number, &changed[j]);
        found
            .push((slip, Coefficients::Difference { numerators: changed, denominator: denominator.clone() }));
    }
    let moment = moment(numerators);
    if !moment.is_zero() {
        let slip = typo("the denominator".to_owned(), denominator, &moment);
        found.push((slip, Coefficients::Difference { numerators: numerators.to_vec(), denominator: moment }));
    }
    found
}

fn retyped_general(
    alpha: &[Rational],
    beta: &[Rational],
    gamma: Option<&Vec<Rational>>,
) -> Vec<(Slip, Coefficients)> {
    let general = |alpha: &[Rational], beta: &[Rational]| Coefficients::General {
        alpha: alpha.to_vec(),
        beta: beta.to_vec(),
        gamma: gamma.cloned(),
    };
    let sum: Rational = alpha.iter().sum();
    let slope = moment(alpha) - beta.iter().sum::<Rational>();
    let mut found = Vec::new();
    for (j, number) in alpha.iter().enumerate() {
        let mut changed = alpha.to_vec();
        changed[j] = number - &sum;
        found.push((typo(format!("alpha[{j}]"), number, &changed[j]), general(&changed, beta)));
    }
    for (j, number) in beta.iter().enumerate().skip(usize::from(beta.first().is_some_and(Zero::is_zero))) {
        let mut changed = beta.to_vec();
        changed[j] = number + &slope;
        found.push((typo(format!("beta[{j}]"), number, &changed[j]), general(alpha, &changed)));
    }
    found
}

/// sum (1 - j) a_j.
fn moment(weights: &[Rational]) -> Rational {
    let weight = |j: usize| Rational::from_integer((1 - j.to_i64().unwrap_or(0)).into());
    weights.iter().enumerate().map(|(j, a)| a * weight(j)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formula::FormulaTable;

    /// Every explicit row of the table: reversed, with one number changed, and rounded, it is found again.
    #[test]
    fn the_rows_of_the_table_are_found_behind_their_slips() {
        let mut found = 0;
        for formula in FormulaTable::builtin().iter().filter(|row| row.order() >= 2 && row.is_zero_stable()) {
            let coefficients = formula.row().coefficients();
            let hints = |coefficients: Coefficients| {
                Row::new("slip", coefficients).map(|row| row.hints()).unwrap_or_default()
            };
            let is_it = |hint: &Hint| hint.coefficients == *coefficients && hint.order == formula.order();
            let turned = reversed(coefficients);
            if Row::new("turned", turned.clone()).is_ok_and(|row| row.check().analysis().order().is_none()) {
                assert!(hints(turned).iter().any(is_it), "{}", formula.id());
            }
            let mut typed = coefficients.clone();
            let numbers = match &mut typed {
                Coefficients::Difference { numerators, .. } => numerators,
                Coefficients::General { alpha, .. } => alpha,
            };
            let last = numbers.len() - 1;
            numbers[last] += Rational::one();
            assert!(hints(typed).iter().any(is_it), "{}", formula.id());
            assert!(formula.row().hints().is_empty(), "{}", formula.id());
            found += 1;
        }
        assert!(found > 50);
    }

    #[test]
    fn rounded_decimals_are_taken_for_the_fractions_that_they_were() {
        let row = Row::from_weights("r", "1,-1.3333,0.33333", "0,0.6667,0", None);
        let hints = row.expect("readable").hints();
        assert!(
            hints.iter().any(|hint| hint.slip == Slip::Rounded && hint.to_string().contains("-4/3, 1/3")),
            "{hints:?}"
        );
        let exact = Row::from_weights("e", "1,-0.5,-0.25", "0,1.125,0", None).expect("readable");
        assert!(exact.hints().iter().all(|hint| hint.slip != Slip::Rounded));
    }
}
