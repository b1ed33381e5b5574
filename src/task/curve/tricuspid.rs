use super::{CurveKind, MakeCurve, PlanarCurve};
use crate::kind::{Form, Kind, Parameter, Parameters};

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

pub(super) const KIND: CurveKind = Kind::new(
    "tricuspid",
    "radius (2 cos a + cos 2a, 2 sin a - sin 2a): three cusps.",
    &[Parameter::required(
        "radius",
        Form::Positive { noun: "radius" },
        "m",
        "Radius of the rolling circle; the cusps lie three radii from the centre.",
    )],
    MakeCurve::Planar(|given| Box::new(Tricuspid { radius: given.number("radius").unwrap_or_default() })),
)
.with_draw(|size, _| Parameters::new().with("radius", size));

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_rests_at_its_cusps() {
        let ([x, y], [dx, dy]) = Tricuspid { radius: 1.0 }.point(0.0);
        assert!((x - 3.0).abs() + y.abs() < 1e-15 && dx.abs() + dy.abs() < 1e-15);
    }
}
