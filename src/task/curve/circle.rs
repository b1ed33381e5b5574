use super::{CurveKind, MakeCurve, PlanarCurve};
use crate::kind::{Form, Kind, Parameter, Parameters};

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

pub(super) const KIND: CurveKind = Kind::new(
    "circle",
    "radius (cos a, sin a).",
    &[Parameter::required("radius", Form::Positive { noun: "radius" }, "m", "Radius.")],
    MakeCurve::Planar(|given| Box::new(Circle { radius: given.number("radius").unwrap_or_default() })),
)
.with_draw(|size, _| Parameters::new().with("radius", size));
