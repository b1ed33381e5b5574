//! Short vectors in lattices, by which an algebraic number is recognised from its digits.

use num_bigint::BigInt;
use num_integer::Integer;
use num_traits::{One, Signed, Zero};

/// Reduces a basis of integer vectors in place (Lenstra, Lenstra and Lovasz with factor 3/4): the first vector is
/// then about as short as any. The vectors must be linearly independent.
///
/// All-integer version (Cohen, A Course in Computational Algebraic Number Theory, algorithm 2.6.7): `lambda` and
/// `minors` are the Gram-Schmidt coefficients times the minors of the Gram matrix, so every division is exact.
pub(crate) fn reduce(basis: &mut [Vec<BigInt>]) {
    let n = basis.len();
    let mut state = Reduction {
        lambda: vec![vec![BigInt::zero(); n]; n],
        minors: vec![BigInt::one(); n + 1],
        known: 0,
        basis,
    };
    state.orthogonalise(0);
    let mut k = 1;
    while k < n {
        if k > state.known {
            state.known = k;
            state.orthogonalise(k);
        }
        state.subtract(k, k - 1);
        if state.swaps(k) {
            state.swap(k);
            k = (k - 1).max(1);
        } else {
            for l in (0..k - 1).rev() {
                state.subtract(k, l);
            }
            k += 1;
        }
    }
}

struct Reduction<'b> {
    basis: &'b mut [Vec<BigInt>],
    lambda: Vec<Vec<BigInt>>,
    /// minors[i] belongs to the first i vectors.
    minors: Vec<BigInt>,
    known: usize,
}

impl Reduction<'_> {
    fn orthogonalise(&mut self, k: usize) {
        for j in 0..=k {
            let mut u: BigInt = self.basis[k].iter().zip(&self.basis[j]).map(|(a, b)| a * b).sum();
            for i in 0..j {
                u = (&self.minors[i + 1] * u - &self.lambda[k][i] * &self.lambda[j][i]) / &self.minors[i];
            }
            if j < k {
                self.lambda[k][j] = u;
            } else {
                self.minors[k + 1] = u;
            }
        }
    }

    /// Takes the nearest multiple of vector l from vector k.
    fn subtract(&mut self, k: usize, l: usize) {
        let (lambda, minor) = (&self.lambda[k][l], &self.minors[l + 1]);
        if lambda.abs() * 2 <= *minor {
            return;
        }
        let q = (lambda * BigInt::from(2) + minor).div_floor(&(minor * BigInt::from(2)));
        let taken: Vec<BigInt> = self.basis[l].iter().map(|b| &q * b).collect();
        self.basis[k].iter_mut().zip(taken).for_each(|(a, b)| *a -= b);
        let shift = &q * &self.minors[l + 1];
        self.lambda[k][l] -= shift;
        for i in 0..l {
            let shift = &q * &self.lambda[l][i];
            self.lambda[k][i] -= shift;
        }
    }

    /// Lovasz' condition fails.
    fn swaps(&self, k: usize) -> bool {
        let lambda = &self.lambda[k][k - 1];
        let left = &self.minors[k + 1] * &self.minors[k - 1] * 4;
        left < &self.minors[k] * &self.minors[k] * 3 - lambda * lambda * 4
    }

    fn swap(&mut self, k: usize) {
        self.basis.swap(k, k - 1);
        let (before, from_k) = self.lambda.split_at_mut(k);
        before[k - 1][..k - 1].swap_with_slice(&mut from_k[0][..k - 1]);
        let lambda = self.lambda[k][k - 1].clone();
        let minor = (&self.minors[k - 1] * &self.minors[k + 1] + &lambda * &lambda) / &self.minors[k];
        for i in k + 1..=self.known {
            let t = self.lambda[i][k].clone();
            self.lambda[i][k] =
                (&self.minors[k + 1] * &self.lambda[i][k - 1] - &lambda * &t) / &self.minors[k];
            self.lambda[i][k - 1] = (&minor * t + &lambda * &self.lambda[i][k]) / &self.minors[k + 1];
        }
        self.minors[k] = minor;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn vectors(rows: &[&[i64]]) -> Vec<Vec<BigInt>> {
        rows.iter().map(|row| row.iter().map(|&c| c.into()).collect()).collect()
    }

    #[test]
    fn finds_the_short_vectors_of_known_lattices() {
        let mut basis = vectors(&[&[1, 1, 1], &[-1, 0, 2], &[3, 5, 6]]);
        reduce(&mut basis);
        assert_eq!(basis, vectors(&[&[0, 1, 0], &[1, 0, 1], &[-1, 0, 2]]));
    }

    #[test]
    fn recognises_the_golden_ratio() {
        // 1, x, x^2 to nine digits: the relation is x^2 - x - 1.
        let mut basis =
            vectors(&[&[1, 0, 0, 1_000_000_000], &[0, 1, 0, 1_618_033_989], &[0, 0, 1, 2_618_033_989]]);
        reduce(&mut basis);
        let relation: Vec<BigInt> = basis[0][..3].to_vec();
        let expected = vectors(&[&[1, 1, -1], &[-1, -1, 1]]);
        assert!(expected.contains(&relation), "{relation:?}");
    }
}
