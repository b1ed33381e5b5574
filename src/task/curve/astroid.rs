use super::{CurveKind, MakeCurve, PlanarCurve};
use crate::kind::{Form, Kind, Parameter, Parameters};

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

pub(super) const KIND: CurveKind = Kind::new(
    "astroid",
    "radius (cos^3 a, sin^3 a): four cusps.",
    &[Parameter::required(
        "radius",
        Form::Positive { noun: "radius" },
        "m",
        "Distance of the cusps from the centre.",
    )],
    MakeCurve::Planar(|given| Box::new(Astroid { radius: given.number("radius").unwrap_or_default() })),
)
.with_draw(|size, _| Parameters::new().with("radius", size));

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_rests_at_its_cusps() {
        let ([x, y], [dx, dy]) = Astroid { radius: 0.6 }.point(std::f64::consts::FRAC_PI_2);
        assert!(x.abs() < 1e-15 && (y - 0.6).abs() < 1e-15 && dx.abs() + dy.abs() < 1e-15);
    }
}
