//! Rotations of space: the logarithm that orientation errors are made of.

use super::lanes::Lanes;
use nalgebra::{Matrix3, Rotation3, Vector3};

/// Returns the rotation vector of `rotation` \[rad\]: `log(R)^vee`, of length at most pi.
///
/// The axis comes from the skew part, whose entries are differences of order `sin(angle)`, so small rotations keep
/// full relative accuracy; within 1e-3 rad of a half turn, where the skew part vanishes, it comes from the symmetric part.
///
/// ```
/// use kinstep::math::rotation_vector;
/// use nalgebra::{Rotation3, Vector3};
/// let turn = Vector3::new(0.3, -0.2, 1e-9);
/// assert!((rotation_vector(&Rotation3::new(turn)) - turn).norm() < 1e-15);
/// ```
pub fn rotation_vector(rotation: &Rotation3<f64>) -> Vector3<f64> {
    let r = rotation.matrix();
    let skew = Vector3::new(r[(2, 1)] - r[(1, 2)], r[(0, 2)] - r[(2, 0)], r[(1, 0)] - r[(0, 1)]) * 0.5;
    let (sine, cosine) = (skew.norm(), (r.trace() - 1.0) * 0.5);
    let angle = sine.atan2(cosine);
    if cosine < 0.0 && sine < 1e-3 {
        return half_turn_axis(rotation, &skew) * angle;
    }
    if sine == 0.0 { skew } else { skew * (angle / sine) }
}

/// Returns the matrix that takes the angular velocity of a rotation `R` (in the axes in which it turns) to the derivative of its
/// rotation vector `phi = log(R)^vee`:
///
/// `d phi / dt = (I - [phi]/2 + (1 - (theta/2) cot(theta/2)) / theta^2 [phi]^2) omega`, `theta = |phi| < 2 pi`,
///
/// the inverse of the left Jacobian of the exponential (F. Bullo and R. Murray, 1995; T. Barfoot, *State Estimation for
/// Robotics*, 2017, eq. 7.76).
///
/// ```
/// use kinstep::math::rotation_vector_rate;
/// use nalgebra::{Matrix3, Vector3};
/// assert_eq!(rotation_vector_rate(&Vector3::zeros()), Matrix3::identity());
/// ```
pub fn rotation_vector_rate(phi: &Vector3<f64>) -> Matrix3<f64> {
    let square = phi.norm_squared();
    let factor = if square < 1e-2 {
        // The series of the same: beyond these terms nothing is left at a tenth of a radian.
        1.0 / 12.0 + square * (1.0 / 720.0 + square * (1.0 / 30240.0 + square * (1.0 / 1_209_600.0)))
    } else {
        let half = 0.5 * square.sqrt();
        (1.0 - half / half.tan()) / square
    };
    let cross = phi.cross_matrix();
    Matrix3::identity() - cross * 0.5 + cross * cross * factor
}

/// The sine times the axis and the cosine of the rotation `R D^T`, both given by their columns.
///
/// The skew part of a sum of dyads `r d^T` is half the sum of the cross products `d x r`; the trace is the sum of the
/// products `r . d`.
#[inline(always)]
pub(crate) fn relative_rotation<V: Lanes>(r: &[[V; 3]; 3], d: &[[V; 3]; 3]) -> ([V; 3], V) {
    let half = r[0][0].like(0.5);
    let mut sine = [half.like(0.0); 3];
    let mut trace = half.like(-1.0);
    for (r, d) in r.iter().zip(d) {
        // Not fused: a column crossed with itself is nothing at all.
        sine[0] = sine[0] + (d[1] * r[2] - d[2] * r[1]);
        sine[1] = sine[1] + (d[2] * r[0] - d[0] * r[2]);
        sine[2] = sine[2] + (d[0] * r[1] - d[1] * r[0]);
        trace = r[0].times_plus(d[0], r[1].times_plus(d[1], r[2].times_plus(d[2], trace)));
    }
    ([sine[0] * half, sine[1] * half, sine[2] * half], trace * half)
}

/// The square of the sine up to which [`small_rotation_vector`] keeps full accuracy.
const SMALL_SINE_SQUARED: f64 = 1.0 / 1024.0;

/// The Taylor coefficients of `asin(s) / s` in `s^2`.
const ARCSINE: [f64; 6] = [1.0, 1.0 / 6.0, 3.0 / 40.0, 5.0 / 112.0, 35.0 / 1152.0, 63.0 / 2816.0];

/// The rotation vector of a small rotation \[rad\], from what [`relative_rotation`] found; `None` unless the rotations of all
/// lanes are small.
#[inline(always)]
pub(crate) fn small_rotation_vector<V: Lanes>(sine: &[V; 3], cosine: V) -> Option<[V; 3]> {
    let square = sine[0].times_plus(sine[0], sine[1].times_plus(sine[1], sine[2] * sine[2]));
    // A cosine within 1/2 of one tells small rotations from those by almost half a turn.
    let is_small = square.all_within(SMALL_SINE_SQUARED) && (cosine - cosine.like(1.0)).all_within(0.5);
    if !is_small {
        return None;
    }
    let mut factor = square.like(ARCSINE[5]);
    for &coefficient in ARCSINE[..5].iter().rev() {
        factor = factor.times_plus(square, square.like(coefficient));
    }
    Some([sine[0] * factor, sine[1] * factor, sine[2] * factor])
}

/// The unit axis of a rotation by almost pi, from the largest column of `(R + R^T) / 2 - cos(angle) I`, signed by the
/// skew part.
fn half_turn_axis(rotation: &Rotation3<f64>, skew: &Vector3<f64>) -> Vector3<f64> {
    let r = rotation.matrix();
    let cosine = (r.trace() - 1.0) * 0.5;
    let symmetric = (r + r.transpose()) * 0.5 - Matrix3::identity() * cosine;
    let largest = (0..3).max_by(|&a, &b| symmetric[(a, a)].total_cmp(&symmetric[(b, b)])).unwrap_or(0);
    let axis: Vector3<f64> = symmetric.column(largest).normalize();
    if axis.dot(skew) < 0.0 { -axis } else { axis }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::lanes::{Kernel, Lane, level, with_instructions};
    use fearless_simd::Simd;
    use proptest::prelude::*;

    /// The vector of `R D^T` by the series.
    struct Small<'a>(&'a Rotation3<f64>, &'a Rotation3<f64>);

    impl Kernel for Small<'_> {
        type Output = Option<[f64; 3]>;

        #[inline(always)]
        fn run<S: Simd>(self, simd: S) -> Self::Output {
            let columns = |rotation: &Rotation3<f64>| {
                rotation.matrix().data.0.map(|column| column.map(|entry| Lane::splat(simd, entry)))
            };
            let (sine, cosine) = relative_rotation(&columns(self.0), &columns(self.1));
            small_rotation_vector(&sine, cosine).map(|turn| turn.map(|entry| entry.value))
        }
    }

    fn small(r: &Rotation3<f64>, d: &Rotation3<f64>) -> Option<[f64; 3]> {
        with_instructions(level(), Small(r, d))
    }

    proptest! {
        #[test]
        fn the_logarithm_undoes_the_exponential(
            x in -1.0..1.0_f64, y in -1.0..1.0_f64, z in -1.0..1.0_f64, exponent in -12.0..0.0_f64,
        ) {
            let axis = Vector3::new(x, y, z);
            prop_assume!(axis.norm() > 0.1);
            let turn = axis.normalize() * (std::f64::consts::PI * 10_f64.powf(exponent));
            let back = rotation_vector(&Rotation3::new(turn));
            // Two rotation vectors name the same half turn.
            let distance = (back - turn).norm().min(if exponent > -1e-12 { (back + turn).norm() } else { f64::MAX });
            prop_assert!(distance < 3e-14 * (1.0 + turn.norm()), "{turn} {back}");
        }

        #[test]
        fn it_stays_accurate_next_to_a_half_turn(
            x in -1.0..1.0_f64, y in -1.0..1.0_f64, z in -1.0..1.0_f64, exponent in -9.0..-1.0_f64,
        ) {
            let axis = Vector3::new(x, y, z);
            prop_assume!(axis.norm() > 0.1);
            let turn = axis.normalize() * (std::f64::consts::PI - 10_f64.powf(exponent));
            prop_assert!((rotation_vector(&Rotation3::new(turn)) - turn).norm() < 1e-11);
        }
    }

    proptest! {
        #[test]
        fn the_series_for_small_rotations_is_the_logarithm(
            x in -1.0..1.0_f64, y in -1.0..1.0_f64, z in -1.0..1.0_f64, exponent in -12.0..-1.9_f64,
            other in proptest::array::uniform3(-3.0..3.0_f64),
        ) {
            let turn = Vector3::new(x, y, z) * 10_f64.powf(exponent);
            let reference = Rotation3::new(Vector3::from(other));
            let back = small(&(Rotation3::new(turn) * reference), &reference).unwrap();
            prop_assert!((Vector3::from(back) - turn).norm() < 4e-16, "{turn} {back:?}");
            prop_assert_eq!(small(&reference, &reference), Some([0.0; 3]));
        }
    }

    proptest! {
        #[test]
        fn the_rate_of_a_rotation_vector_is_its_derivative(
            axis in proptest::array::uniform3(-1.0..1.0_f64), angle in 0.0..3.1_f64,
            omega in proptest::array::uniform3(-1.0..1.0_f64),
        ) {
            prop_assume!(Vector3::from(axis).norm() > 0.1);
            let (phi, omega, step) = (Vector3::from(axis).normalize() * angle, Vector3::from(omega), 1e-6);
            let turned = |by: f64| rotation_vector(&(Rotation3::new(omega * by) * Rotation3::new(phi)));
            let difference = (turned(step) - turned(-step)) / (2.0 * step);
            prop_assert!((difference - rotation_vector_rate(&phi) * omega).norm() < 1e-8);
        }
    }

    #[test]
    fn rotations_by_almost_half_a_turn_are_not_small() {
        let turn = Rotation3::new(Vector3::new(std::f64::consts::PI - 1e-3, 0.0, 0.0));
        assert!(small(&turn, &Rotation3::identity()).is_none());
    }

    #[test]
    fn no_rotation_has_the_zero_vector() {
        assert_eq!(rotation_vector(&Rotation3::identity()), Vector3::zeros());
    }
}
