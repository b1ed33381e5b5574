use crate::integrate::field::Field;
use crate::integrate::solve::ErrorNorm;
use crate::math::Scalar;

/// The part of the step with the allowed error that is begun with.
const CAUTION: f64 = 0.5;
/// How far, in units of the state, a first look goes.
const LOOK: f64 = 0.01;

/// The length of the first step from `(t, x)` by a row of order one, whose error is `h^2 / 2 x''`; `x''` is seen from a short step of
/// Euler. It takes one evaluation. (After Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I, section II.4.)
pub(super) fn initial_step<T: Scalar>(
    field: &mut impl Field<T>,
    norm: &ErrorNorm,
    t: T,
    (x, derivative): (&[T], &[T]),
    range: T,
) -> T {
    let whole = range.to_f64();
    let (size, speed) = (norm.of(|i| x[i]), norm.of(|i| derivative[i]));
    let look = if size < 1e-5 || speed < 1e-5 { 1e-6 } else { LOOK * size / speed };
    let look = look.min(0.1 * whole.abs()).copysign(whole);
    let h = T::from_f64(look);
    let ahead: Vec<T> = x.iter().zip(derivative).map(|(&x, &derivative)| x + h * derivative).collect();
    let mut there = derivative.to_vec();
    field.evaluate(t + h, &ahead, &mut there, &mut []);
    let bend = norm.of(|i| there[i] - derivative[i]) / look.abs();
    let steepest = bend.max(1e-3 * speed / whole.abs());
    let length =
        if steepest > 0.0 && steepest.is_finite() { CAUTION * (2.0 / steepest).sqrt() } else { look.abs() };
    T::from_f64(length.min(100.0 * look.abs()).min(whole.abs()).copysign(whole))
}
