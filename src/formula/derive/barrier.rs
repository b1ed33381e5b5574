//! Which orders strictly zero-stable look-ahead formulas can have, decided exactly.

use num_traits::{One, Signed};

use crate::formula::{MAX_STEPS, Row};
use crate::math::{Rational, RootCondition};

use super::look_ahead::LookAhead;

/// Whether there are look-ahead formulas of an order with only z = 1 on the unit circle, and why.
#[derive(Debug, Clone)]
pub enum BarrierProof {
    /// There are such formulas: this row is one.
    Witness(Box<Row>),
    /// There are none: the order fixes this coefficient r_i of R(zeta) at zero or below, and a polynomial with all
    /// roots in the left half-plane and r_0 = 1 has only positive coefficients.
    Sign {
        /// The index i of the coefficient.
        index: usize,
        /// The coefficient r_i, zero or negative.
        value: Rational,
    },
    /// There are none: s steps have no formula of any kind beyond order s, as c_(s+1) would have to vanish and does not.
    TooFewSteps,
    /// Neither proof succeeds.
    Open,
}

/// The highest order with a witness, and what is known of the next.
#[derive(Debug, Clone)]
pub struct Barrier {
    /// The number of steps s.
    pub steps: usize,
    /// The highest order for which there is a formula with only z = 1 on the unit circle.
    pub order: usize,
    /// A formula of that order.
    pub witness: Row,
    /// Why there is no formula of the next order; [`BarrierProof::Open`] where that is not decided.
    pub beyond: BarrierProof,
}

impl BarrierProof {
    /// Returns the proof for formulas of s steps and at least order p.
    ///
    /// The fixed r_0, ..., r_(p-1) must be positive. Conversely, where they are the coefficients of a polynomial with all roots
    /// in the left half-plane, so are they with sufficiently small positive r_p, r_(p+1), ... appended: a new root comes in from
    /// minus infinity and the others move a little. The small numbers are tried, and the row decides exactly.
    pub fn of(steps: usize, order: usize) -> Self {
        let Some(family) = LookAhead::new(steps, order) else { return Self::TooFewSteps };
        let fixed = family.fixed_image();
        if let Some((index, value)) = fixed.iter().enumerate().find(|(_, r)| !r.is_positive()) {
            return Self::Sign { index, value: value.clone() };
        }
        (0..MOST_HALVINGS)
            .find_map(|halvings| witness(&family, &fixed, halvings))
            .map_or(Self::Open, |row| Self::Witness(Box::new(row)))
    }
}

/// How often the appended coefficients are halved, each time together and the later ones more.
const MOST_HALVINGS: usize = 24;

/// The row with r_(i+1) = 2^-k r_i r_i / r_(i-1) appended, if that is strictly zero-stable: each new root is about 2^k times
/// farther out than the last.
fn witness(family: &LookAhead, fixed: &[Rational], halvings: usize) -> Option<Row> {
    let ratio = Rational::new(1.into(), num_bigint::BigInt::one() << halvings);
    let mut image = fixed.to_vec();
    for _ in 0..family.freedom() {
        let last = image[image.len() - 1].clone();
        let step = match image.len() {
            1 => ratio.clone(),
            n => &last / &image[n - 2] * &ratio,
        };
        image.push(last * step);
    }
    let free = &family.differences(&image)[fixed.len()..];
    let row = family.row(&format!("witness-{}-{}", image.len(), fixed.len()), free).ok()?;
    let checked = row.clone().check();
    (checked.analysis().root_condition() == RootCondition::StrictlyStable).then_some(row)
}

/// Returns the highest order of a strictly zero-stable look-ahead formula of s steps; `None` for 0 or more than [`MAX_STEPS`] steps.
///
/// ```
/// use kinstep::formula::derive::barrier;
/// let orders: Vec<usize> = (1..=10).filter_map(barrier).map(|barrier| barrier.order).collect();
/// assert_eq!(orders, [1, 1, 2, 3, 3, 4, 4, 5, 5, 6]);
/// ```
pub fn barrier(steps: usize) -> Option<Barrier> {
    if !(1..=MAX_STEPS).contains(&steps) {
        return None;
    }
    let mut found = None;
    for order in 1..=steps + 1 {
        match BarrierProof::of(steps, order) {
            BarrierProof::Witness(row) => found = Some((order, *row)),
            beyond => return found.map(|(order, witness)| Barrier { steps, order, witness, beyond }),
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_next_order_is_impossible_by_the_sign_of_a_fixed_coefficient() {
        for steps in 2..=10 {
            let barrier = barrier(steps).expect("steps in range");
            assert!(
                matches!(&barrier.beyond, BarrierProof::Sign { value, .. } if !value.is_positive()),
                "{steps} steps: {:?}",
                barrier.beyond
            );
            let analysis = barrier.witness.check().analysis().clone();
            assert_eq!((analysis.steps(), analysis.order()), (steps, Some(barrier.order)));
            assert!(analysis.is_strictly_zero_stable());
        }
    }

    #[test]
    fn two_steps_of_order_two_are_refused_although_leapfrog_is_weakly_stable() {
        let BarrierProof::Sign { index, value } = BarrierProof::of(2, 2) else { panic!("no sign found") };
        assert_eq!((index, value), (1, Rational::from_integer(0.into())));
    }
}
