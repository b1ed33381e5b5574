//! How much of a sequence of values is noise.

/// How many times the usual noise is allowed for.
const MOST: f64 = 4.0;

/// Returns what noise may do to one of the values: four times their usual second difference, where third differences are larger
/// than second ones. Of a smooth motion that is sampled closely they are smaller: then it is nothing.
pub(super) fn noise(values: &[f64]) -> f64 {
    let bends: Vec<f64> = values.windows(3).map(|v| v[2] - 2.0 * v[1] + v[0]).collect();
    let turns: Vec<f64> = bends.windows(2).map(|bend| bend[1] - bend[0]).collect();
    let [second, third] = [bends, turns].map(median);
    if third > second { MOST * second } else { 0.0 }
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
