//! How much of a sequence of values is noise.

/// How many times the usual noise is allowed for.
const MOST: f64 = 4.0;

/// Returns what noise may do to one of the values: four times their usual second difference, where third differences are larger
/// than second ones. Of a smooth motion that is sampled closely they are smaller: then it is nothing.
pub(super) fn noise(values: &[f64]) -> f64 {
    let [second, third] = higher_differences(values).map(median);
    if third > second { MOST * second } else { 0.0 }
}

/// Returns the second and the third differences of values.
pub(super) fn higher_differences(values: &[f64]) -> [Vec<f64>; 2] {
    let second: Vec<f64> = values.windows(3).map(|v| v[2] - 2.0 * v[1] + v[0]).collect();
    let third = second.windows(2).map(|pair| pair[1] - pair[0]).collect();
    [second, third]
}

fn median(values: Vec<f64>) -> f64 {
    let mut values: Vec<f64> = values.into_iter().map(f64::abs).collect();
    let middle = values.len() / 2;
    if values.is_empty() { 0.0 } else { *values.select_nth_unstable_by(middle, f64::total_cmp).1 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_is_told_from_motion() {
        let smooth = |n: i32| (0.05 * f64::from(n)).sin();
        assert_eq!(noise(&(0..200).map(smooth).collect::<Vec<_>>()), 0.0);
        let noisy = |n: i32| smooth(n) + 1e-2 * f64::from(n * n * 7919 % 13 - 6) / 6.0;
        let found = noise(&(0..200).map(noisy).collect::<Vec<_>>());
        assert!(found > 1e-2 && found < 1e-1, "{found}");
    }
}
