//! Numbers that are likely to be in another unit than the one that is read.

use crate::math::number_text;

/// Beyond a full turn, whole numbers up to this are more likely degrees than radians.
const MOST_DEGREES: f64 = 720.0;
/// No link of an arm is as long as this \[m\]; in millimetres many are, and none is as long as the other.
const LONG: std::ops::RangeInclusive<f64> = 20.0..=1e5;

/// Returns what makes angles look like degrees where radians \[rad\] are read: a whole number beyond a full turn, such as 90 or
/// -180. `None` where nothing does.
///
/// ```
/// use kinstep::robot::degrees_suspected;
/// assert!(degrees_suspected(&[0.0, 90.0, 0.0]).is_some());
/// assert!(degrees_suspected(&[3.14, -6.0, 7.5]).is_none());
/// ```
pub fn degrees_suspected(angles: &[f64]) -> Option<String> {
    let is_odd = |angle: &&f64| {
        angle.abs() > std::f64::consts::TAU && angle.abs() <= MOST_DEGREES && angle.fract() == 0.0
    };
    let angle = angles.iter().find(is_odd)?;
    let radians = format!("{:.6}", angle.to_radians());
    Some(format!(
        "{} looks like degrees where radians are read ({} degrees are {} rad)",
        number_text(*angle),
        number_text(*angle),
        radians.trim_end_matches('0')
    ))
}

/// Returns what makes lengths look like millimetres where metres \[m\] are read: one of 20 m and more. `None` where nothing does.
///
/// ```
/// use kinstep::robot::millimetres_suspected;
/// assert!(millimetres_suspected(&[0.0, 0.0, 333.0]).is_some());
/// assert!(millimetres_suspected(&[0.0, 0.0, 0.333]).is_none());
/// ```
pub fn millimetres_suspected(lengths: &[f64]) -> Option<String> {
    let length = lengths.iter().find(|length| LONG.contains(&length.abs()))?;
    Some(format!(
        "{} m is long for an arm: millimetres where metres are read ({} mm are {} m)?",
        number_text(*length),
        number_text(*length),
        number_text(length / 1000.0)
    ))
}
