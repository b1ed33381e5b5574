//! How large the round-off is in a series of samples, read from the series itself.

/// The order of the differences; a smooth series of `w` radians a sample is damped by `(w/2)^8`.
const DIFFERENCES: usize = 8;
/// Square root of the sum of the squared binomials of 8: what eighth differences make of white noise.
const WHITE_NOISE_GAIN: f64 = 113.446_022_407_134_22;
/// The median of the absolute value of a standard normal variable.
const NORMAL_MEDIAN: f64 = 0.674_489_750_196_081_7;

/// Returns the standard deviation of the part of a series that is rough from sample to sample: its round-off, when
/// everything else in it is smooth. `None` below 32 samples.
///
/// The median of the absolute eighth differences, scaled to what white noise would give (differencing after R. W. Hamming; J. J. Moré
/// and S. M. Wild, SIAM J. Sci. Comput. 33, 2011). In a series that is not well resolved by its samples it reports more than
/// the round-off, never less.
///
/// ```
/// use kinstep_study::jitter;
/// let noise = |n: usize| if n * n % 7 < 3 { 1e-9 } else { -1e-9 };
/// let series: Vec<f64> = (0..200).map(|n| (0.05 * n as f64).sin() + noise(n)).collect();
/// let found = jitter(&series).unwrap();
/// assert!(found > 2e-10 && found < 5e-9);
/// ```
pub fn jitter(series: &[f64]) -> Option<f64> {
    if series.len() < 32 {
        return None;
    }
    let mut rough = series.to_vec();
    for k in 0..DIFFERENCES {
        for n in 0..series.len() - 1 - k {
            rough[n] = rough[n + 1] - rough[n];
        }
    }
    rough.truncate(series.len() - DIFFERENCES);
    for entry in &mut rough {
        *entry = entry.abs();
    }
    let middle = rough.len() / 2;
    let (_, median, _) = rough.select_nth_unstable_by(middle, f64::total_cmp);
    Some(*median / NORMAL_MEDIAN / WHITE_NOISE_GAIN)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_gain_is_that_of_eighth_differences() {
        let mut binomial = 1.0_f64;
        let mut sum = 0.0;
        for k in 0..=DIFFERENCES {
            sum += binomial * binomial;
            binomial *= (DIFFERENCES - k) as f64 / (k + 1) as f64;
        }
        assert!((sum.sqrt() - WHITE_NOISE_GAIN).abs() < 1e-12);
    }

    #[test]
    fn finds_the_noise_below_a_smooth_series_over_many_decades() {
        for exponent in 2..14 {
            let size = 10_f64.powi(-exponent);
            // A linear congruence gives noise that no difference scheme resolves, uniform on (-1, 1).
            let mut seed = 12_345_u64;
            let series: Vec<f64> = (0..400)
                .map(|n| {
                    seed =
                        seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                    let uniform = (seed >> 11) as f64 / (1_u64 << 52) as f64 - 1.0;
                    (0.02 * f64::from(n)).cos() + size * uniform
                })
                .collect();
            let found = jitter(&series).unwrap() / (size / 3_f64.sqrt());
            assert!((0.6..1.7).contains(&found), "{size:e}: {found}");
        }
    }

    #[test]
    fn says_nothing_of_short_series() {
        assert_eq!(jitter(&[1.0; 31]), None);
        assert_eq!(jitter(&[1.0; 32]), Some(0.0));
    }
}
