//! Polynomials in two unknowns, and the elimination of one of them.

use num_bigint::BigInt;
use num_traits::{One, Zero};

use super::interpolation::interpolate;
use super::polynomial::Polynomial;
use super::rational::Rational;

/// sum_k p_k(x) y^k with exact integer coefficients.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Bivariate {
    /// p_0, p_1, ..., the last one not zero.
    in_y: Vec<Polynomial>,
}

impl Bivariate {
    /// Returns sum_k in_y[k](x) y^k.
    pub(crate) fn new(mut in_y: Vec<Polynomial>) -> Self {
        while in_y.last().is_some_and(Polynomial::is_zero) {
            in_y.pop();
        }
        Self { in_y }
    }

    /// Returns the same polynomial with the unknowns exchanged.
    pub(crate) fn exchanged(&self) -> Self {
        let of_power = |power| Polynomial::from_ascending(self.in_y.iter().map(|p| p.coefficient(power)));
        Self::new((0..=self.degree_x()).map(of_power).collect())
    }

    pub(crate) fn degree_x(&self) -> usize {
        self.in_y.iter().map(Polynomial::degree).max().unwrap_or(0)
    }

    pub(crate) fn degree_y(&self) -> usize {
        self.in_y.len().saturating_sub(1)
    }

    pub(crate) fn is_zero(&self) -> bool {
        self.in_y.is_empty()
    }

    /// Returns the derivative with respect to y.
    pub(crate) fn derivative_y(&self) -> Self {
        let times = |(k, p): (usize, &Polynomial)| p * &Polynomial::constant(BigInt::from(k));
        Self::new(self.in_y.iter().enumerate().skip(1).map(times).collect())
    }

    /// Returns the derivative with respect to x.
    pub(crate) fn derivative_x(&self) -> Self {
        Self::new(self.in_y.iter().map(Polynomial::derivative).collect())
    }

    /// Returns self^2 - y other^2.
    pub(crate) fn norm_over_root_of_y(&self, other: &Self) -> Self {
        let square = |p: &Self, shift: usize| {
            let mut product = vec![Polynomial::default(); 2 * p.in_y.len() + shift];
            for (i, a) in p.in_y.iter().enumerate() {
                for (j, b) in p.in_y.iter().enumerate() {
                    product[i + j + shift] = &product[i + j + shift] + &(a * b);
                }
            }
            product
        };
        let (mut left, mut right) = (square(self, 0), square(other, 1));
        let length = left.len().max(right.len());
        left.resize(length, Polynomial::default());
        right.resize(length, Polynomial::default());
        Self::new(left.iter().zip(&right).map(|(a, b)| a - b).collect())
    }

    /// The coefficients in y at an integer x, lowest power first, as many as there are for a general x.
    fn at(&self, x: i64) -> Vec<BigInt> {
        let x = Rational::from_integer(x.into());
        self.in_y.iter().map(|p| p.value_at(&x).to_integer()).collect()
    }
}

/// How many multiplications the resultant takes, about.
pub(crate) fn resultant_cost(a: &Bivariate, b: &Bivariate) -> usize {
    let size = a.degree_y() + b.degree_y();
    (degree_bound(a, b) + 1) * size * size * size / 3
}

fn degree_bound(a: &Bivariate, b: &Bivariate) -> usize {
    a.degree_x() * b.degree_y() + b.degree_x() * a.degree_y()
}

/// Returns a multiple of the resultant that eliminates y: a polynomial in x that is zero at every x for which
/// both polynomials have a common zero y. Zero when they share a factor.
pub(crate) fn resultant(a: &Bivariate, b: &Bivariate) -> Polynomial {
    if a.is_zero() || b.is_zero() {
        return Polynomial::default();
    }
    let nodes = (0..).map(|k: i64| if k % 2 == 0 { k / 2 } else { -(k + 1) / 2 });
    let samples: Vec<(i64, BigInt)> =
        nodes.take(degree_bound(a, b) + 1).map(|x| (x, determinant(sylvester(&a.at(x), &b.at(x))))).collect();
    interpolate(&samples).0.primitive_part()
}

/// The matrix of Sylvester for two lists of coefficients, lowest power first.
fn sylvester(a: &[BigInt], b: &[BigInt]) -> Vec<Vec<BigInt>> {
    let (m, n) = (a.len() - 1, b.len() - 1);
    let shifted = |list: &[BigInt], shift: usize| {
        let mut row = vec![BigInt::zero(); m + n];
        for (k, c) in list.iter().rev().enumerate() {
            row[shift + k].clone_from(c);
        }
        row
    };
    (0..n).map(|i| shifted(a, i)).chain((0..m).map(|i| shifted(b, i))).collect()
}

/// The determinant by fraction-free elimination (Bareiss): every division is exact.
fn determinant(mut rows: Vec<Vec<BigInt>>) -> BigInt {
    let n = rows.len();
    let mut last = BigInt::one();
    let mut negative = false;
    for k in 0..n {
        let Some(pivot) = (k..n).find(|&i| !rows[i][k].is_zero()) else { return BigInt::zero() };
        if pivot != k {
            rows.swap(pivot, k);
            negative = !negative;
        }
        let (above, below) = rows.split_at_mut(k + 1);
        let top = &above[k];
        for row in below {
            let head = std::mem::take(&mut row[k]);
            for j in k + 1..n {
                let mut value = &row[j] * &top[k];
                if !head.is_zero() {
                    value -= &head * &top[j];
                }
                row[j] = value / &last;
            }
        }
        last.clone_from(&above[k][k]);
    }
    if negative { -last } else { last }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn line(c: &[i64]) -> Polynomial {
        Polynomial::from_ascending(c.iter().copied())
    }

    #[test]
    fn eliminates_the_common_zero() {
        // y - x^2 and y - 2 meet where x^2 = 2.
        let parabola = Bivariate::new(vec![line(&[0, 0, -1]), line(&[1])]);
        let level = Bivariate::new(vec![line(&[-2]), line(&[1])]);
        assert_eq!(resultant(&parabola, &level).normalised(), line(&[-2, 0, 1]));
    }

    #[test]
    fn the_discriminant_of_a_quadratic_is_known() {
        // y^2 + x y + 1 has a double zero where x^2 = 4.
        let p = Bivariate::new(vec![line(&[1]), line(&[0, 1]), line(&[1])]);
        assert_eq!(resultant(&p, &p.derivative_y()).normalised(), line(&[-4, 0, 1]));
        assert!(resultant(&p, &p).is_zero());
    }

    proptest! {
        #[test]
        fn exchanging_twice_changes_nothing(c in proptest::collection::vec(proptest::collection::vec(-9_i64..=9, 1..4), 1..4)) {
            let p = Bivariate::new(c.iter().map(|row| line(row)).collect());
            prop_assert_eq!(p.exchanged().exchanged(), p);
        }

        #[test]
        fn is_zero_exactly_where_both_have_the_root(x in -5_i64..=5, y in -5_i64..=5, a in -4_i64..=4, b in 1_i64..=4) {
            // (a x' + b y' + ...) and (y' - x'^2 + ...), both through the point (x, y).
            let p = Bivariate::new(vec![line(&[-(a * x + b * y), a]), line(&[b])]);
            let q = Bivariate::new(vec![line(&[x * x - y, 0, -1]), line(&[1])]);
            prop_assert_eq!(resultant(&p, &q).sign_at(&Rational::from_integer(x.into())), 0);
        }
    }
}
