//! Planar curves by angle, each with its exact derivative.

use super::{Path, PathPoint};
use nalgebra::Vector3;

/// A planar curve `(x, y)` by an angle \[rad\].
pub trait PlanarCurve: Send + Sync {
    /// The point \[m\] and its derivative by the angle [m/rad].
    fn point(&self, angle: f64) -> ([f64; 2], [f64; 2]);
}

impl PlanarCurve for Box<dyn PlanarCurve> {
    fn point(&self, angle: f64) -> ([f64; 2], [f64; 2]) {
        (**self).point(angle)
    }
}

/// The circle `radius (cos a, sin a)`.
#[derive(Clone, Copy, Debug)]
pub struct Circle {
    /// Radius \[m\].
    pub radius: f64,
}

impl PlanarCurve for Circle {
    fn point(&self, angle: f64) -> ([f64; 2], [f64; 2]) {
        let (sine, cosine) = angle.sin_cos();
        let r = self.radius;
        ([r * cosine, r * sine], [-r * sine, r * cosine])
    }
}

/// The tricuspid (deltoid) `radius (2 cos a + cos 2a, 2 sin a - sin 2a)`, with cusps at 0 and at 120 degrees to either side.
#[derive(Clone, Copy, Debug)]
pub struct Tricuspid {
    /// Radius of the rolling circle \[m\]; the cusps lie three radii from the centre.
    pub radius: f64,
}

impl PlanarCurve for Tricuspid {
    fn point(&self, angle: f64) -> ([f64; 2], [f64; 2]) {
        let (s1, c1) = angle.sin_cos();
        let (s2, c2) = (2.0 * angle).sin_cos();
        let r = self.radius;
        ([r * (2.0 * c1 + c2), r * (2.0 * s1 - s2)], [-2.0 * r * (s1 + s2), 2.0 * r * (c1 - c2)])
    }
}

/// The astroid `radius (cos^3 a, sin^3 a)`, with cusps on the axes.
#[derive(Clone, Copy, Debug)]
pub struct Astroid {
    /// Distance of the cusps from the centre \[m\].
    pub radius: f64,
}

impl PlanarCurve for Astroid {
    fn point(&self, angle: f64) -> ([f64; 2], [f64; 2]) {
        let (s, c) = angle.sin_cos();
        let r = self.radius;
        ([r * c * c * c, r * s * s * s], [-3.0 * r * c * c * s, 3.0 * r * s * s * c])
    }
}

/// The Lissajous figure `(a_x sin(f_x a + phase), a_y sin(f_y a))`.
#[derive(Clone, Copy, Debug)]
pub struct Lissajous {
    /// Half width and half height \[m\].
    pub amplitudes: [f64; 2],
    /// Periods per turn, in x and in y.
    pub frequencies: [f64; 2],
    /// Phase of the x part \[rad\].
    pub phase: f64,
}

impl PlanarCurve for Lissajous {
    fn point(&self, angle: f64) -> ([f64; 2], [f64; 2]) {
        let ([ax, ay], [fx, fy]) = (self.amplitudes, self.frequencies);
        let (sx, cx) = (fx * angle + self.phase).sin_cos();
        let (sy, cy) = (fy * angle).sin_cos();
        ([ax * sx, ay * sy], [ax * fx * cx, ay * fy * cy])
    }
}

/// The rose `radius cos(petals a) (cos a, sin a)`.
#[derive(Clone, Copy, Debug)]
pub struct Rose {
    /// Length of a petal \[m\].
    pub radius: f64,
    /// The factor of the angle: odd numbers draw that many petals, even ones twice as many.
    pub petals: f64,
}

impl PlanarCurve for Rose {
    fn point(&self, angle: f64) -> ([f64; 2], [f64; 2]) {
        let (s, c) = angle.sin_cos();
        let (ps, pc) = (self.petals * angle).sin_cos();
        let (r, dr) = (self.radius * pc, -self.radius * self.petals * ps);
        ([r * c, r * s], [dr * c - r * s, dr * s + r * c])
    }
}

/// The straight line from the start over a displacement.
#[derive(Clone, Copy, Debug)]
pub struct Line {
    /// From the start to the end, in world axes \[m\].
    pub displacement: Vector3<f64>,
}

impl Path for Line {
    fn point(&self, u: f64) -> PathPoint {
        PathPoint { position: self.displacement * u, tangent: self.displacement }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn curves() -> Vec<Box<dyn PlanarCurve>> {
        vec![
            Box::new(Circle { radius: 0.7 }),
            Box::new(Tricuspid { radius: 0.4 }),
            Box::new(Astroid { radius: 0.8 }),
            Box::new(Lissajous { amplitudes: [0.3, 0.5], frequencies: [3.0, 2.0], phase: 0.4 }),
            Box::new(Rose { radius: 0.3, petals: 5.0 }),
        ]
    }

    proptest! {
        #[test]
        fn tangents_are_the_derivatives(angle in -7.0..7.0_f64) {
            let step = 1e-5;
            for curve in curves() {
                let ([xp, yp], _) = curve.point(angle + step);
                let ([xm, ym], _) = curve.point(angle - step);
                let (_, [dx, dy]) = curve.point(angle);
                prop_assert!(((xp - xm) / (2.0 * step) - dx).abs() < 1e-8);
                prop_assert!(((yp - ym) / (2.0 * step) - dy).abs() < 1e-8);
            }
        }

        #[test]
        fn curves_close_after_a_turn(angle in 0.0..6.0_f64) {
            for curve in curves() {
                let (a, b) = (curve.point(angle).0, curve.point(angle + std::f64::consts::TAU).0);
                prop_assert!((a[0] - b[0]).abs() < 1e-12 && (a[1] - b[1]).abs() < 1e-12);
            }
        }
    }

    #[test]
    fn cusps_are_where_the_text_says() {
        let (_, [dx, dy]) = Tricuspid { radius: 1.0 }.point(0.0);
        assert!(dx.abs() + dy.abs() < 1e-15);
        let ([x, y], [dx, dy]) = Astroid { radius: 0.6 }.point(std::f64::consts::FRAC_PI_2);
        assert!(x.abs() < 1e-15 && (y - 0.6).abs() < 1e-15 && dx.abs() + dy.abs() < 1e-15);
    }
}
