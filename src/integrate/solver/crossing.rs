//! Where functions cross zero between two times.

/// Narrowings before the middle of what is left is taken.
const MOST: usize = 200;

/// Returns the later end of the shortest interval that is found around a change of sign of `f`, which has the values `at` at the
/// `ends`, of different signs. Points are those of regula falsi with the Illinois rule, with bisections where that is slow.
pub(super) fn root(mut ends: [f64; 2], mut at: [f64; 2], mut f: impl FnMut(f64) -> f64) -> f64 {
    let mut width = (ends[1] - ends[0]).abs();
    for n in 0..MOST {
        let resolution = 2.0 * f64::EPSILON * ends[0].abs().max(ends[1].abs());
        let whole = ends[1] - ends[0];
        if whole.abs() <= resolution || at[1] == 0.0 {
            break;
        }
        let falsi = ends[0] - at[0] * whole / (at[1] - at[0]);
        let is_slow = n % 3 == 2 && whole.abs() > 0.5 * width;
        if n % 3 == 2 {
            width = whole.abs();
        }
        let middle = ends[0] + 0.5 * whole;
        let inside = |t: f64| (t - ends[0]) * (t - ends[1]) < 0.0;
        let t = if is_slow || !inside(falsi) { middle } else { falsi };
        if t == ends[0] || t == ends[1] {
            break;
        }
        let value = f(t);
        if value == 0.0 || (value > 0.0) == (at[1] > 0.0) {
            (ends[1], at[1]) = (t, value);
            at[0] *= 0.5;
        } else {
            (ends[0], at[0]) = (t, value);
            at[1] *= 0.5;
        }
    }
    ends[1]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn roots_are_found_to_the_last_digits(zero in 0.01..0.99_f64, power in 1..6_i32, slope in 1e-6..1e6_f64) {
            let f = |t: f64| slope * ((t - zero).signum() * (t - zero).abs().powi(power) + 0.1 * (t - zero));
            let found = root([0.0, 1.0], [f(0.0), f(1.0)], f);
            prop_assert!((found - zero).abs() <= 1e-14, "{found} {zero}");
            let mirrored = root([1.0, 0.0], [f(1.0), f(0.0)], f);
            prop_assert!((mirrored - zero).abs() <= 1e-14, "{mirrored} {zero}");
        }
    }
}
