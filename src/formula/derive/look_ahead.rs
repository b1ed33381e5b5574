//! All look-ahead difference formulas of a number of steps and an order, in coordinates that know about stability.

use num_bigint::BigInt;
use num_integer::binomial;
use num_traits::{One, Zero};

use crate::formula::{DefectKind, Row};
use crate::math::Rational;

use super::family::over_one_denominator;

/// The look-ahead formulas x'(t_n) ~ (1/sigma) sum_(m=1..s) c_m nabla^m x_(n+1) of s steps with at least order p.
///
/// Order p fixes c_1 = 1 and c_m = -1/(m (m - 1)) for m = 2..p, and leaves c_(p+1), ..., c_s free. All weights are multiples
/// of 1/D exactly when all c_m are. With zeta = (z - 1)/(z + 1) the roots of rho other than z = 1 are inside the circle
/// exactly when R(zeta) = sum_(i<s) r_i zeta^i has degree s - 1 and all its roots in the left half-plane, with
/// r_i = sum_(m=1..i+1) 2^(m-1) C(s-m, i-m+1) c_m.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct LookAhead {
    steps: usize,
    order: usize,
}

impl LookAhead {
    /// Returns the formulas of `steps` steps and at least `order`, `None` unless 1 <= order <= steps.
    pub fn new(steps: usize, order: usize) -> Option<Self> {
        (1..=steps).contains(&order).then_some(Self { steps, order })
    }

    /// Returns the number of free coordinates, s - p.
    pub fn freedom(&self) -> usize {
        self.steps - self.order
    }

    /// Returns c_1, ..., c_p, which the order fixes.
    pub fn fixed_differences(&self) -> Vec<Rational> {
        let c = |m: usize| match m {
            1 => Rational::one(),
            _ => -Rational::new(BigInt::one(), BigInt::from(m * (m - 1))),
        };
        (1..=self.order).map(c).collect()
    }

    /// Returns the least common denominator of c_1, ..., c_p: every formula's denominator is a multiple of it.
    pub fn least_denominator(&self) -> BigInt {
        crate::math::common_denominator(&self.fixed_differences())
    }

    /// Returns r_0, ..., r_(p-1), which the order fixes.
    pub fn fixed_image(&self) -> Vec<Rational> {
        self.image(&self.fixed_differences())
    }

    /// Returns r_0, r_1, ... as far as the given c_1, c_2, ... decide them.
    pub fn image(&self, differences: &[Rational]) -> Vec<Rational> {
        let r = |i: usize| (1..=i + 1).map(|m| &differences[m - 1] * self.weight(i, m)).sum();
        (0..differences.len()).map(r).collect()
    }

    /// Returns c_1, ..., c_s from r_0, ..., r_(s-1): the inverse of [`LookAhead::image`].
    pub fn differences(&self, image: &[Rational]) -> Vec<Rational> {
        let mut c: Vec<Rational> = Vec::with_capacity(image.len());
        for (i, r) in image.iter().enumerate() {
            let known: Rational = c.iter().enumerate().map(|(k, c)| c * self.weight(i, k + 1)).sum();
            c.push((r - known) / self.weight(i, i + 1));
        }
        c
    }

    /// 2^(m-1) C(s-m, i-m+1): what c_m adds to r_i.
    fn weight(&self, i: usize, m: usize) -> BigInt {
        binomial(BigInt::from(self.steps - m), BigInt::from(i + 1 - m)) << (m - 1)
    }

    /// Returns a_0, ..., a_s, the weights of x_(n+1), x_n, ..., for c_1, ..., c_s.
    pub fn weights(&self, differences: &[Rational]) -> Vec<Rational> {
        let mut weights = vec![Rational::zero(); self.steps + 1];
        for (m, c) in (1..).zip(differences) {
            for (j, a) in weights.iter_mut().enumerate().take(m + 1) {
                let size = c * binomial(BigInt::from(m), BigInt::from(j));
                *a += if j % 2 == 0 { size } else { -size };
            }
        }
        weights
    }

    /// Returns the row of the formula whose free c_(p+1), ..., c_s are these, numerators over one denominator.
    ///
    /// # Errors
    /// [`DefectKind`] where the weight of the new state vanishes or the numbers are too long.
    pub fn row(&self, id: &str, free: &[Rational]) -> Result<Row, DefectKind> {
        let differences: Vec<Rational> =
            self.fixed_differences().into_iter().chain(free.iter().cloned()).collect();
        Row::new(id, over_one_denominator(&self.weights(&differences)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Polynomial;
    use proptest::prelude::*;

    fn small(values: &[i64]) -> Vec<Rational> {
        values.iter().map(|&v| Rational::new(v.into(), 12.into())).collect()
    }

    proptest! {
        #[test]
        fn every_member_has_the_order_by_construction(
            (s, p, free) in (1_usize..9).prop_flat_map(|s| (Just(s), 1..=s))
                .prop_flat_map(|(s, p)| (Just(s), Just(p), proptest::collection::vec(-9_i64..9, s - p))),
        ) {
            let family = LookAhead::new(s, p).expect("p is at most s");
            if let Ok(row) = family.row("random", &small(&free)) {
                prop_assert!(row.check().analysis().order() >= Some(p));
            }
        }

        #[test]
        fn the_image_is_that_of_the_half_plane(
            (s, c) in (1_usize..8).prop_flat_map(|s| (Just(s), proptest::collection::vec(-9_i64..9, s))),
        ) {
            let family = LookAhead::new(s, 1).expect("one is at most s");
            let c = small(&c);
            let image = family.image(&c);
            prop_assert_eq!(family.differences(&image), c.clone());
            // rho(z) = z^s A with nabla = (z - 1)/z; z = (1 + zeta)/(1 - zeta), and z + 1 = 2/(1 - zeta): rho/(z - 1) at
            // zeta = 1/3, z = 2 is 2^(s-1) R(1/3) / (1 - zeta)^(s-1) / 2^(s-1) times 1; both sides by their sums.
            let rho: Rational = family.weights(&c).iter().zip((0..=s).rev())
                .map(|(a, power)| a * BigInt::from(2).pow(power as u32)).sum();
            let third = Rational::new(1.into(), 3.into());
            let mut power = Rational::one();
            let mut sum = Rational::zero();
            for r in &image {
                sum += r * &power;
                power *= &third;
            }
            let scale = Rational::new(3.into(), 2.into()).pow(i32::try_from(s - 1).expect("few steps"));
            prop_assert_eq!(rho, sum * scale);
        }
    }

    #[test]
    fn the_six_instant_formula_is_a_member() {
        let family = LookAhead::new(5, 3).expect("three is at most five");
        let c: Vec<Rational> = [(11, 48), (-1, 16)]
            .iter()
            .map(|&(n, d): &(i64, i64)| Rational::new(n.into(), d.into()))
            .collect();
        let checked = family.row("paper", &c).expect("a row").check();
        let rho = Polynomial::from_descending(&[24, -5, -12, -6, -4, 3]);
        assert_eq!(checked.analysis().rho(), &rho);
    }
}
