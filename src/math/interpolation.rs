//! The polynomial through exact values at integer points.

use num_bigint::BigInt;
use num_integer::Integer;
use num_traits::One;

use super::polynomial::Polynomial;

/// Returns a multiple of the polynomial of least degree through the samples (Newton's divided differences), and the
/// factor by which it is too large. The nodes must differ.
///
/// Differences of order k are kept multiplied by a common multiple of all gaps so far, so that everything stays an integer.
pub(crate) fn interpolate(samples: &[(i64, BigInt)]) -> (Polynomial, BigInt) {
    let mut differences: Vec<BigInt> = samples.iter().map(|(_, value)| value.clone()).collect();
    let mut multiples = vec![BigInt::one()];
    for order in 1..samples.len() {
        let gap = |k: usize| BigInt::from(samples[k].0 - samples[k - order].0);
        let multiple = (order..samples.len()).fold(BigInt::one(), |lcm, k| lcm.lcm(&gap(k)));
        for k in (order..samples.len()).rev() {
            differences[k] = (&differences[k] - &differences[k - 1]) * (&multiple / gap(k));
        }
        multiples.push(multiple);
    }
    // Horner in the nodes; the differences of lower orders still lack the multiples of the higher ones.
    let (mut polynomial, mut scale) = (Polynomial::default(), BigInt::one());
    for ((difference, multiple), (node, _)) in differences.iter().zip(&multiples).zip(samples).rev() {
        let factor = Polynomial::from_ascending([-node, 1]);
        polynomial = &(&polynomial * &factor) + &Polynomial::constant(difference * &scale);
        scale *= multiple;
    }
    (polynomial, scale)
}

#[cfg(test)]
mod tests {
    use super::super::rational::Rational;
    use super::*;

    #[test]
    fn a_polynomial_is_found_again_from_its_values() {
        let p = Polynomial::from_descending(&[32, 108, -81, 0, 7]);
        let nodes = [1, -1, 2, 5, -3];
        let value = |node: i64| p.value_at(&Rational::from_integer(node.into())).to_integer();
        let samples: Vec<(i64, BigInt)> = nodes.into_iter().map(|node| (node, value(node))).collect();
        let (multiple, factor) = interpolate(&samples);
        assert_eq!(multiple, &p * &Polynomial::constant(factor));
    }
}
