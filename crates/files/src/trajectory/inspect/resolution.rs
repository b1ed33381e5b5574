//! How finely a file knows its values.

use super::noise::higher_differences;

/// How many decimals count as a rounding: fewer are round numbers that somebody chose, more are those of doubles.
const DECIMALS: std::ops::RangeInclusive<i32> = 2..=9;
/// The largest step of an encoder [rad or m].
const COARSEST: f64 = 1e-2;
/// How far from a whole multiple, as a fraction of it, a difference may be.
const WHOLE: f64 = 0.01;

/// Returns the largest step in which all of the values can have been rounded: a decimal, that of a single-precision number,
/// or that of an encoder; zero where there is none.
pub(super) fn resolution(values: &[f64]) -> f64 {
    written(values).max(encoder(values))
}

/// Returns the larger of the two roundings that a file makes: a decimal, and that of a single-precision number.
pub(super) fn written(values: &[f64]) -> f64 {
    decimal(values).max(single(values))
}

/// Returns what single precision, or else double, makes of values as large as these.
pub(super) fn precision(values: &[f64]) -> f64 {
    let largest = values.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
    single(values).max(8.0 * f64::EPSILON * largest)
}

fn decimal(values: &[f64]) -> f64 {
    let is_rounded = |places: &i32| {
        let scale = 10_f64.powi(*places);
        values.iter().all(|value| {
            let scaled = value * scale;
            (scaled - scaled.round()).abs() <= 4.0 * f64::EPSILON * scaled.abs()
        })
    };
    let places = (0..=*DECIMALS.end()).find(is_rounded).filter(|places| DECIMALS.contains(places));
    places.map_or(0.0, |places| 10_f64.powi(-places))
}

fn single(values: &[f64]) -> f64 {
    let is_single = values.iter().all(|&value| f64::from(value as f32) == value);
    let largest = values.iter().fold(0.0, |largest: f64, value| largest.max(value.abs()));
    if is_single { largest * f64::from(f32::EPSILON) } else { 0.0 }
}

/// The step of which all differences are whole multiples, if the smallest of them is one and they waver as rounding makes them:
/// those of an even acceleration from rest are whole multiples too.
pub(super) fn encoder(values: &[f64]) -> f64 {
    let differences = || values.windows(2).map(|pair| (pair[1] - pair[0]).abs()).filter(|step| *step > 0.0);
    let step = differences().fold(f64::INFINITY, f64::min);
    let is_whole = |difference: f64| (difference / step - (difference / step).round()).abs() <= WHOLE;
    let is_rounded = step <= COARSEST && differences().all(is_whole) && wavers(values);
    if is_rounded { step } else { 0.0 }
}

/// Whether third differences are larger, all in all, than second ones.
fn wavers(values: &[f64]) -> bool {
    let [second, third] =
        higher_differences(values).map(|values| values.into_iter().map(f64::abs).sum::<f64>());
    third > second
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn decimals_singles_and_encoders_are_told_from_doubles() {
        let smooth: Vec<f64> = (0..500).map(|n| (0.01 * f64::from(n)).sin()).collect();
        assert_eq!(resolution(&smooth), 0.0);
        let rounded = |step: f64| -> Vec<f64> { smooth.iter().map(|q| (q / step).round() * step).collect() };
        assert_eq!(resolution(&smooth.iter().map(|q| (q * 1e4).round() / 1e4).collect::<Vec<_>>()), 1e-4);
        let encoder = std::f64::consts::TAU / 4096.0;
        assert!((resolution(&rounded(encoder)) - encoder).abs() < 1e-9);
        let evenly: Vec<f64> = (0..50).map(|n| 3e-4 * f64::from(n * n) / 7.0).collect();
        assert_eq!(resolution(&evenly), 0.0);
        let single = resolution(&smooth.iter().map(|&q| f64::from(q as f32)).collect::<Vec<_>>());
        assert!(single > 1e-8 && single < 1e-6, "{single}");
    }
}
