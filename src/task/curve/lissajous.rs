use super::{CurveKind, MakeCurve, PlanarCurve};
use crate::kind::{Form, Kind, Parameter, Parameters};

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

pub(super) const KIND: CurveKind = Kind::new(
    "lissajous",
    "(a_x sin(f_x a + phase), a_y sin(f_y a)).",
    &[
        Parameter::required("amplitudes", Form::Pair, "m", "Half width and half height."),
        Parameter::required("frequencies", Form::Pair, "", "Periods per turn of the angle, in x and in y."),
        Parameter::optional("phase", Form::Number, "rad", "Phase of the x part. Default: 0."),
    ],
    MakeCurve::Planar(|given| {
        let pair = |name| given.numbers(name).and_then(|pair| pair.try_into().ok()).unwrap_or([0.0; 2]);
        let phase = given.number("phase").unwrap_or(0.0);
        Box::new(Lissajous { amplitudes: pair("amplitudes"), frequencies: pair("frequencies"), phase })
    }),
)
.with_draw(|size, whole| {
    let frequencies = [f64::from(whole(1, 2)), f64::from(whole(1, 3))];
    Parameters::new().with("amplitudes", [size, size]).with("frequencies", frequencies).with("phase", 0.5)
});

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_phase_is_that_of_x() {
        let curve = Lissajous { amplitudes: [0.3, 0.5], frequencies: [3.0, 2.0], phase: 0.4 };
        assert_eq!(curve.point(0.0).0, [0.3 * 0.4_f64.sin(), 0.0]);
    }
}
