//! Rotations of space: the logarithm that orientation errors are made of.

use nalgebra::{Rotation3, Vector3};

/// The rotation vector of `rotation` \[rad\]: `log(R)^vee`, of length at most pi.
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

/// The unit axis of a rotation by almost pi, from the largest column of `(R + R^T) / 2 - cos(angle) I`, signed by the
/// skew part.
fn half_turn_axis(rotation: &Rotation3<f64>, skew: &Vector3<f64>) -> Vector3<f64> {
    let r = rotation.matrix();
    let cosine = (r.trace() - 1.0) * 0.5;
    let symmetric = (r + r.transpose()) * 0.5 - nalgebra::Matrix3::identity() * cosine;
    let largest = (0..3).max_by(|&a, &b| symmetric[(a, a)].total_cmp(&symmetric[(b, b)])).unwrap_or(0);
    let axis: Vector3<f64> = symmetric.column(largest).normalize();
    if axis.dot(skew) < 0.0 { -axis } else { axis }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

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

    #[test]
    fn no_rotation_has_the_zero_vector() {
        assert_eq!(rotation_vector(&Rotation3::identity()), Vector3::zeros());
    }
}
