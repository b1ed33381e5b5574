//! How much noise the closed loop lets through: H2 norms, by the recursion of Astrom, Jury and Agniel.

use num_traits::Zero;

use crate::math::{Rational, Real, Wide, is_schur, rational_from_f64};

use super::feedback_range::ClosedLoop;
use super::weights::Weights;

/// What white noise of unit strength in one place makes of the residual e, as a root mean square.
///
/// Each gain is the l2 norm of the impulse response to e in sum_j (alpha_j + h gamma_j/gamma(1)) e_(n+1-j) = input.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NoiseGain {
    /// The feedback step that the gains belong to.
    pub h: f64,
    /// The gain from noise in the measured residual: input -h gamma(z)/gamma(1) times the noise.
    pub residual: f64,
    /// The gain from noise in the feedforward velocity, per unit of sigma: input beta(z) times the noise.
    pub feedforward_per_sigma: f64,
    /// The gain from noise in the joint states of the history (encoders): it enters through alpha_1, alpha_2, ... and,
    /// as the residual is computed from the same states, through gamma too. Input z^s - pi_h(z) times the noise, with
    /// pi_h's own leading coefficient in place of 1 for an implicit row.
    pub state: f64,
}

/// Returns the gains at h, `None` when the loop is not strictly stable there (decided exactly).
pub(crate) fn noise_gain(weights: &Weights, closed_loop: &ClosedLoop, h: f64) -> Option<NoiseGain> {
    let exact = rational_from_f64(h)?;
    let polynomial = closed_loop.at(&exact);
    if polynomial.degree() + 1 < weights.alpha.len() || !is_schur(&polynomial) {
        return None;
    }
    let gamma_sum: Rational = weights.gamma.iter().sum();
    let feedback: Vec<Rational> = weights.gamma.iter().map(|g| -(&exact * g / &gamma_sum)).collect();
    let closed: Vec<Rational> = weights.alpha.iter().zip(&feedback).map(|(a, f)| a - f).collect();
    let history: Vec<Rational> =
        closed.iter().enumerate().map(|(j, c)| if j == 0 { Rational::zero() } else { -c }).collect();
    Some(NoiseGain {
        h,
        residual: h2_norm(&feedback, &closed),
        feedforward_per_sigma: h2_norm(&weights.beta, &closed),
        state: h2_norm(&history, &closed),
    })
}

/// The l2 norm of the impulse response of numerator(z)/denominator(z), both highest power first and of one length.
///
/// The denominator must have all roots inside the circle. Works in 192 significant bits, so the double is good to its last digits
/// unless a root is within about 1e-20 of the circle.
fn h2_norm(numerator: &[Rational], denominator: &[Rational]) -> f64 {
    let fixed = |row: &[Rational]| -> Vec<Wide> {
        row.iter().map(|c| Wide::from_rational(&(c / &denominator[0]))).collect()
    };
    let (mut a, mut b) = (fixed(denominator), fixed(numerator));
    let mut sum = Wide::from_f64(0.0);
    while let (Some(a_last), Some(b_last)) = (a.last().cloned(), b.last().cloned()) {
        let head = a[0].clone();
        let (alpha, beta) = (a_last / head.clone(), b_last.clone() / head);
        sum = sum + b_last * beta.clone();
        let mirrored: Vec<Wide> = a.iter().rev().cloned().collect();
        let reduce = |row: &[Wide], factor: &Wide| -> Vec<Wide> {
            let kept = row.len() - 1;
            row.iter()
                .zip(&mirrored)
                .take(kept)
                .map(|(x, m)| x.clone() - factor.clone() * m.clone())
                .collect()
        };
        (b, a) = (reduce(&b, &beta), reduce(&a, &alpha));
    }
    sum.to_f64().sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(numbers: &[f64]) -> Vec<Rational> {
        numbers.iter().map(|x| rational_from_f64(*x).expect("finite")).collect()
    }

    #[test]
    fn the_norm_is_that_of_the_summed_impulse_response() {
        // 0.5^n, and a second-order response summed term by term.
        assert!((h2_norm(&row(&[1.0, 0.0]), &row(&[1.0, -0.5])) - (4.0_f64 / 3.0).sqrt()).abs() < 1e-15);
        let (a, b) = ([1.0, -0.9, 0.5, 0.1], [0.3, 0.0, -2.0, 1.0]);
        let mut response: Vec<f64> = Vec::new();
        for n in 0..400 {
            let past: f64 = (1..4).filter(|k| n >= *k).map(|k| a[k] * response[n - k]).sum();
            response.push(b.get(n).copied().unwrap_or(0.0) - past);
        }
        let norm = response.iter().map(|x| x * x).sum::<f64>().sqrt();
        assert!((h2_norm(&row(&b), &row(&a)) - norm).abs() < 1e-13 * norm);
    }
}
