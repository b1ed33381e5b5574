//! The one rule for the size of lengths and angles.

/// Largest length \[m\], angle \[rad\] or offset that is believed: beyond it nothing of the arithmetic would be left.
pub(super) const MAX_SIZE: f64 = 1e6;

/// Returns what is wrong with a number that is no length \[m\] and no angle \[rad\] of any arm: not finite, or more than 1e6 in
/// size. `None` for all others.
pub fn unbelievable(number: f64) -> Option<String> {
    if number.abs() <= MAX_SIZE {
        None
    } else if number.is_finite() {
        Some(format!(
            "{number:e} is beyond any arm; lengths [m] and angles [rad] are at most {MAX_SIZE:e} in size"
        ))
    } else {
        Some(format!("{number} is not a finite number"))
    }
}
