//! Repeated roots taken apart: the square-free part and decomposition of a polynomial.

use super::polynomial::Polynomial;

impl Polynomial {
    /// Returns whether no root of the polynomial is repeated.
    pub fn is_square_free(&self) -> bool {
        self.gcd(&self.derivative()).degree() == 0
    }

    /// Returns the polynomial with the same roots, each once.
    pub fn square_free_part(&self) -> Self {
        let normal = self.normalised();
        let repeated = normal.gcd(&normal.derivative());
        normal.exact_quotient(&repeated).unwrap_or(normal)
    }

    /// Returns the factors of the square-free decomposition, each with the multiplicity of its roots (Yun).
    ///
    /// Constant factors are left out, so the product is the polynomial up to an integer factor.
    pub fn square_free_decomposition(&self) -> Vec<(Self, usize)> {
        let mut factors = Vec::new();
        let normal = self.normalised();
        let mut repeated = normal.gcd(&normal.derivative());
        let mut simple = normal.exact_quotient(&repeated).unwrap_or(normal);
        let mut multiplicity = 1;
        while simple.degree() > 0 {
            let next = simple.gcd(&repeated);
            let factor = simple.exact_quotient(&next).unwrap_or_default();
            if factor.degree() > 0 {
                factors.push((factor, multiplicity));
            }
            repeated = repeated.exact_quotient(&next).unwrap_or_default();
            simple = next;
            multiplicity += 1;
        }
        factors
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn small() -> impl Strategy<Value = Polynomial> {
        proptest::collection::vec(-9_i64..=9, 1..5).prop_map(Polynomial::from_ascending)
    }

    #[test]
    fn splits_repeated_roots() {
        let (once, twice) = (Polynomial::from_descending(&[2, 1]), Polynomial::from_descending(&[1, 0, 3]));
        let product = &(&once * &twice) * &twice;
        assert_eq!(product.square_free_decomposition(), vec![(once.clone(), 1), (twice.clone(), 2)]);
        assert_eq!(product.square_free_part(), (&once * &twice));
    }

    proptest! {
        #[test]
        fn the_decomposition_multiplies_back(a in small(), b in small()) {
            prop_assume!(a.degree() > 0 && !b.is_zero());
            let p = &(&a * &a) * &b;
            let mut product = Polynomial::constant(1);
            for (factor, multiplicity) in p.square_free_decomposition() {
                prop_assert!(factor.is_square_free());
                for _ in 0..multiplicity {
                    product = &product * &factor;
                }
            }
            prop_assert_eq!(product.normalised(), p.normalised());
        }
    }
}
