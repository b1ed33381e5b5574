use super::{CurveKind, MakeCurve, PlanarCurve};
use crate::kind::{Form, Kind, Parameter, Parameters};

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

pub(super) const KIND: CurveKind = Kind::new(
    "rose",
    "radius cos(petals a) (cos a, sin a).",
    &[
        Parameter::required("radius", Form::Positive { noun: "radius" }, "m", "Length of a petal."),
        Parameter::required(
            "petals",
            Form::Number,
            "",
            "Factor of the angle: odd numbers draw that many petals, even ones twice as many.",
        ),
    ],
    MakeCurve::Planar(|given| {
        let number = |name| given.number(name).unwrap_or_default();
        Box::new(Rose { radius: number("radius"), petals: number("petals") })
    }),
)
.with_draw(|size, whole| Parameters::new().with("radius", size).with("petals", f64::from(whole(2, 3))));

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_odd_rose_is_drawn_twice_in_a_turn() {
        let (rose, half) = (Rose { radius: 0.3, petals: 3.0 }, std::f64::consts::PI);
        let (here, there) = (rose.point(0.4).0, rose.point(0.4 + half).0);
        assert!((here[0] - there[0]).abs() + (here[1] - there[1]).abs() < 1e-15);
    }
}
