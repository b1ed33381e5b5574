//! Order and error constant of a row, from its defining sums.

use num_bigint::BigInt;
use num_traits::{One, Zero};

use crate::math::Rational;

/// Returns E_q = sum_j alpha_j (1-j)^q - q sum_j weights_j (1-j)^(q-1), with 0^0 = 1.
///
/// The method that pairs these weights with alpha has order p exactly when E_0, ..., E_p are zero and E_(p+1) is not.
pub fn order_defect(alpha: &[Rational], weights: &[Rational], q: usize) -> Rational {
    let power_sum = |row: &[Rational], power: usize| -> Rational {
        row.iter().enumerate().map(|(j, a)| a * node_power(j, power)).sum()
    };
    let states = power_sum(alpha, q);
    match q.checked_sub(1) {
        Some(below) => states - Rational::from_integer(q.into()) * power_sum(weights, below),
        None => states,
    }
}

/// (1 - j)^power.
fn node_power(j: usize, power: usize) -> Rational {
    Rational::from_integer((BigInt::one() - BigInt::from(j)).pow(power as u32))
}

/// The order of a consistent pair (alpha, weights) and what is left of the first condition it misses.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Order {
    /// p, at least 1.
    pub(crate) order: usize,
    /// C = E_(p+1)/(p+1)!, the error of one step in units of sigma^(p+1) x^(p+1).
    pub(crate) per_step: Rational,
}

/// Returns the order of (alpha, weights), `None` where E_0 or E_1 is not zero or there is nothing to integrate with.
pub(crate) fn order_of(alpha: &[Rational], weights: &[Rational]) -> Option<Order> {
    if weights.iter().sum::<Rational>().is_zero() {
        return None;
    }
    // A row of s steps has 2 s + 2 coefficients, one of them a scale: no more than 2 s + 1 conditions can hold.
    let most = 2 * alpha.len();
    let (first, defect) =
        (0..=most).map(|q| (q, order_defect(alpha, weights, q))).find(|(_, defect)| !defect.is_zero())?;
    let factorial: BigInt = (1..=first).map(BigInt::from).product();
    (first >= 2).then(|| Order { order: first - 1, per_step: defect / factorial })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::parse_rational;

    fn row(texts: &[&str]) -> Vec<Rational> {
        texts.iter().map(|t| parse_rational(t).expect("a number of this test")).collect()
    }

    #[test]
    fn the_six_instant_formula_has_order_three() {
        let alpha = row(&["1", "-5/24", "-1/2", "-1/4", "-1/6", "1/8"]);
        let beta = row(&["0", "2", "0", "0", "0", "0"]);
        let order = order_of(&alpha, &beta).expect("a consistent row");
        assert_eq!((order.order, order.per_step.to_string()), (3, "5/8".to_owned()));
    }

    #[test]
    fn an_inconsistent_row_has_no_order() {
        assert_eq!(order_of(&row(&["1", "-1"]), &row(&["0", "2"])), None);
        assert_eq!(order_of(&row(&["1", "1"]), &row(&["0", "1"])), None);
        assert_eq!(order_of(&row(&["1", "-2", "1"]), &row(&["0", "1", "-1"])), None, "weights sum to zero");
    }
}
