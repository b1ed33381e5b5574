//! All formulas of a stencil and an order.

use std::fmt;

use num_bigint::BigInt;
use num_traits::{One, Signed, Zero};

use crate::formula::{Coefficients, Row};
use crate::math::Rational;

use super::conditions::{Addition, AffineSpace, Echelon};
use super::error::DeriveError;
use super::stencil::{Stencil, Unknown};

/// Beyond twice the steps plus two no row has an order, so no more conditions need be tried.
const MOST_CONDITIONS: usize = 2 * crate::formula::MAX_STEPS + 4;

/// The exact family sum_i a_i x(t_n + o_i sigma) = sigma sum_j b_j x'(t_n + d_j sigma) of an order: affine in its parameters.
///
/// One coefficient sets the scale: with one derivative b = 1, so that the a_i are a difference formula for it; with several the
/// weight of the newest sample is 1. The parameters are coefficients themselves, the oldest that the conditions leave free.
#[derive(Debug, Clone)]
pub struct DerivedFamily {
    stencil: Stencil,
    order: usize,
    space: AffineSpace,
}

/// A number that depends on the parameters of a family: constant + slopes_1 p1 + slopes_2 p2 + ...
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Affine {
    /// The value where all parameters are zero.
    pub constant: Rational,
    /// The slopes, one for each parameter.
    pub slopes: Vec<Rational>,
}

impl DerivedFamily {
    /// Returns the family of all formulas of the stencil that have at least this order.
    ///
    /// # Errors
    /// [`DeriveError::Infeasible`] with the highest order that the stencil allows, [`DeriveError::OrderZero`].
    pub fn of_order(stencil: Stencil, order: usize) -> Result<Self, DeriveError> {
        let unknowns = stencil.unknowns().len();
        Self::solved_for(stencil, order, (0..unknowns).collect())
    }

    /// The family with the unknowns solved for in the order of `preference`; what is last is what stays free.
    pub(crate) fn solved_for(
        stencil: Stencil,
        order: usize,
        preference: Vec<usize>,
    ) -> Result<Self, DeriveError> {
        if order == 0 {
            return Err(DeriveError::OrderZero);
        }
        let mut echelon = Echelon::new(preference);
        echelon.add(scale(&stencil));
        for q in 0..=order {
            if q > MOST_CONDITIONS || echelon.add(condition(&stencil, q)) == Addition::Contradictory {
                return Err(DeriveError::Infeasible {
                    order,
                    conditions: order + 1,
                    unknowns: stencil.unknowns().len() - 1,
                    highest: q.checked_sub(1).filter(|order| *order > 0),
                });
            }
        }
        Ok(Self { stencil, order, space: echelon.solutions() })
    }

    /// Returns the stencil.
    pub fn stencil(&self) -> &Stencil {
        &self.stencil
    }

    /// Returns the order that every member has at least.
    pub fn order(&self) -> usize {
        self.order
    }

    /// Returns the coefficients that are free: the parameters p1, p2, ... are their values.
    pub fn parameters(&self) -> Vec<Unknown> {
        let unknowns = self.stencil.unknowns();
        self.space.free.iter().map(|&k| unknowns[k]).collect()
    }

    /// Returns every coefficient as a polynomial of degree one in the parameters: those of the states, then of the derivatives.
    pub fn coefficients(&self) -> Vec<(Unknown, Affine)> {
        let affine = |k: usize| Affine {
            constant: self.space.particular[k].clone(),
            slopes: self.space.directions.iter().map(|direction| direction[k].clone()).collect(),
        };
        self.stencil.unknowns().into_iter().enumerate().map(|(k, unknown)| (unknown, affine(k))).collect()
    }

    /// Returns E_(p+1)/(p+1)! at this scale: for a difference formula the error constant c, else the constant C of one step.
    ///
    /// Where it is zero for some parameters, that member has a higher order.
    pub fn error_constant(&self) -> Affine {
        let next = self.order + 1;
        let equation = condition(&self.stencil, next);
        let factorial: BigInt = (1..=next).map(BigInt::from).product();
        let value = |solution: &[Rational]| {
            equation.iter().zip(solution).map(|(c, x)| c * x).sum::<Rational>() / &factorial
        };
        Affine {
            constant: value(&self.space.particular),
            slopes: self.space.directions.iter().map(|direction| value(direction)).collect(),
        }
    }

    /// Returns the row of the member with these values of the parameters; it declares nothing and is to be checked.
    ///
    /// # Errors
    /// [`DeriveError`] for a wrong number of values and for a member whose newest sample has no weight.
    pub fn row(&self, id: &str, values: &[Rational]) -> Result<Row, DeriveError> {
        let (expected, found) = (self.space.free.len(), values.len());
        if expected != found {
            return Err(DeriveError::ParameterCount { expected, found });
        }
        let solution = self.space.at(values);
        if solution[0].is_zero() {
            return Err(DeriveError::NothingToSolveFor);
        }
        Ok(Row::new(id, self.spelt(&solution))?)
    }

    /// A look-ahead difference formula over one denominator, anything else by its two lists of weights.
    fn spelt(&self, solution: &[Rational]) -> Coefficients {
        let newest = self.stencil.newest();
        let (mut alpha, mut beta) = (self.stencil.no_weights(), self.stencil.no_weights());
        for (unknown, value) in self.stencil.unknowns().iter().zip(solution) {
            match unknown {
                Unknown::State(offset) => alpha[newest.abs_diff(*offset) as usize] = value.clone(),
                Unknown::Derivative(offset) => beta[newest.abs_diff(*offset) as usize] = value.clone(),
            }
        }
        if self.stencil.is_difference() && beta.get(1).is_some_and(One::is_one) {
            return over_one_denominator(&alpha);
        }
        let lead = alpha[0].clone();
        alpha.iter_mut().chain(&mut beta).for_each(|c| *c /= &lead);
        Coefficients::General { alpha, beta, gamma: None }
    }

    pub(crate) fn space(&self) -> &AffineSpace {
        &self.space
    }
}

impl Stencil {
    fn no_weights(&self) -> Vec<Rational> {
        vec![Rational::zero(); self.steps() + 1]
    }
}

/// Numerators over their least common denominator.
pub(crate) fn over_one_denominator(weights: &[Rational]) -> Coefficients {
    let denominator = crate::math::common_denominator(weights);
    Coefficients::Difference {
        numerators: weights.iter().map(|a| a * &denominator).collect(),
        denominator: Rational::from_integer(denominator),
    }
}

/// The equation that sets the scale.
fn scale(stencil: &Stencil) -> Vec<Rational> {
    let unknowns = stencil.unknowns().len();
    let mut equation = vec![Rational::zero(); unknowns + 1];
    equation[if stencil.is_difference() { unknowns - 1 } else { 0 }] = Rational::one();
    equation[unknowns] = Rational::one();
    equation
}

/// E_q = sum_i a_i o_i^q - q sum_j b_j d_j^(q-1) = 0, with 0^0 = 1.
fn condition(stencil: &Stencil, q: usize) -> Vec<Rational> {
    let power = |offset: i64, power: usize| Rational::from_integer(BigInt::from(offset).pow(power as u32));
    let states = stencil.samples().iter().map(|&offset| power(offset, q));
    let derivatives = stencil.derivatives().iter().map(|&offset| match q.checked_sub(1) {
        Some(below) => -power(offset, below) * BigInt::from(q),
        None => Rational::zero(),
    });
    states.chain(derivatives).chain([Rational::zero()]).collect()
}

/// Writes `1/3 - 2 p1 + p2`.
impl fmt::Display for Affine {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut empty = self.constant.is_zero();
        if !empty {
            write!(f, "{}", self.constant)?;
        }
        for (k, slope) in self.slopes.iter().enumerate().filter(|(_, slope)| !slope.is_zero()) {
            match (empty, slope.is_negative()) {
                (true, true) => f.write_str("-")?,
                (true, false) => {}
                (false, true) => f.write_str(" - ")?,
                (false, false) => f.write_str(" + ")?,
            }
            let size = slope.abs();
            if !size.is_one() {
                write!(f, "{size} ")?;
            }
            write!(f, "p{}", k + 1)?;
            empty = false;
        }
        if empty { f.write_str("0") } else { Ok(()) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::parse_rational;

    fn family(samples: &[i64], derivatives: &[i64], order: usize) -> Result<DerivedFamily, DeriveError> {
        DerivedFamily::of_order(Stencil::new(samples, derivatives)?, order)
    }

    fn weights(row: Row) -> (Vec<String>, Vec<String>) {
        let text = |list: &[Rational]| list.iter().map(ToString::to_string).collect();
        let checked = row.check();
        (text(checked.analysis().alpha()), text(checked.analysis().beta()))
    }

    #[test]
    fn textbook_methods_are_members_without_parameters() {
        let adams =
            family(&[1, 0], &[0, -1, -2], 3).and_then(|f| f.row("ab3", &[])).expect("Adams-Bashforth");
        assert_eq!(weights(adams).1, ["0", "23/12", "-4/3", "5/12"]);
        let bdf = family(&[0, -1, -2], &[0], 2).and_then(|f| f.row("bdf2", &[])).expect("BDF");
        assert_eq!(weights(bdf).0, ["1", "-4/3", "1/3"]);
        let simpson = family(&[1, -1], &[1, 0, -1], 4).and_then(|f| f.row("simpson", &[])).expect("Simpson");
        assert_eq!(weights(simpson).1, ["1/3", "4/3", "1/3"]);
    }

    #[test]
    fn an_order_beyond_reach_says_how_far_one_gets() {
        let error = family(&[1, 0, -1], &[0], 3).expect_err("three samples reach order two");
        assert_eq!(error, DeriveError::Infeasible { order: 3, conditions: 4, unknowns: 3, highest: Some(2) });
        assert!(error.to_string().contains("sets 4 conditions, and the 3 unknown coefficients"));
        let far = family(&[1, 0], &[0], usize::MAX - 1).expect_err("no such order");
        assert!(matches!(far, DeriveError::Infeasible { highest: Some(1), .. }));
    }

    #[test]
    fn gaps_in_the_stencil_are_kept() {
        let row = family(&[1, 0, -2], &[0], 2).and_then(|f| f.row("gap", &[])).expect("a family of one");
        let (alpha, beta) = weights(row);
        assert_eq!((alpha[2].as_str(), alpha.len()), ("0", 4));
        assert_ne!(beta[1], "0");
    }

    #[test]
    fn a_member_that_can_not_be_solved_is_refused() {
        let family = family(&[1, 0, -1], &[0], 1).expect("one parameter");
        let zero_lead = parse_rational("-1").expect("a number");
        assert_eq!(family.parameters(), [Unknown::State(-1)]);
        assert_eq!(family.row("x", &[zero_lead]).expect_err("no new state"), DeriveError::NothingToSolveFor);
        assert!(matches!(family.row("x", &[]), Err(DeriveError::ParameterCount { expected: 1, found: 0 })));
    }

    #[test]
    fn polynomials_read_as_people_write_them() {
        let family = family(&[1, 0, -1, -2], &[0], 2).expect("one parameter");
        let texts: Vec<String> = family.coefficients().iter().map(|(_, a)| a.to_string()).collect();
        assert_eq!(texts, ["1/2 - p1", "3 p1", "-1/2 - 3 p1", "p1", "1"]);
    }
}
