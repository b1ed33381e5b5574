use super::super::{Path, PathPoint};
use super::{CurveKind, MakeCurve};
use crate::kind::{Form, Kind, Parameter, Parameters};
use nalgebra::Vector3;
use std::f64::consts::TAU;

/// A closed path in space by its Fourier coefficients \[m\]:
/// `p(u) = sum_m a_m (cos 2 pi m u - 1) + b_m sin 2 pi m u`, m = 1, 2, ...; it begins and ends in its origin.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Fourier {
    /// The coefficients `a_1, a_2, ...` of the cosines \[m\].
    pub cosines: Vec<Vector3<f64>>,
    /// The coefficients `b_1, b_2, ...` of the sines \[m\].
    pub sines: Vec<Vector3<f64>>,
}

impl Path for Fourier {
    fn point(&self, u: f64) -> PathPoint {
        let mut point = PathPoint { position: Vector3::zeros(), tangent: Vector3::zeros() };
        let zero = Vector3::zeros();
        for k in 0..self.cosines.len().max(self.sines.len()) {
            let (a, b) = (self.cosines.get(k).unwrap_or(&zero), self.sines.get(k).unwrap_or(&zero));
            let rate = TAU * (k + 1) as f64;
            let (sine, cosine) = (rate * u).sin_cos();
            point.position += a * (cosine - 1.0) + b * sine;
            point.tangent += (b * cosine - a * sine) * rate;
        }
        point
    }
}

pub(super) const KIND: CurveKind = Kind::new(
    "fourier",
    "sum of a_m (cos 2 pi m u - 1) + b_m sin 2 pi m u: any smooth closed path in space.",
    &[
        Parameter::required("cosines", Form::Vectors, "m", "Vectors a_1, a_2, ... in world axes."),
        Parameter::required("sines", Form::Vectors, "m", "Vectors b_1, b_2, ... in world axes."),
    ],
    MakeCurve::Centered(|given| {
        let vectors = |name| given.vectors(name).into_iter().flatten().map(Vector3::from).collect();
        Box::new(Fourier { cosines: vectors("cosines"), sines: vectors("sines") })
    }),
)
.with_draw(|size, whole| {
    let modes = whole(1, 3);
    let mut vectors = || {
        let vector =
            |m: i32| [(); 3].map(|()| f64::from(whole(-10, 10)) / 10.0 * size / f64::from(m).powi(3));
        (1..=modes).map(vector).collect::<Vec<[f64; 3]>>()
    };
    Parameters::new().with("cosines", vectors()).with("sines", vectors())
});

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_begins_in_its_origin_with_the_sum_of_the_sines() {
        let fourier = Fourier { cosines: vec![Vector3::x()], sines: vec![Vector3::y(), Vector3::z()] };
        let begin = fourier.point(0.0);
        assert_eq!(begin.position, Vector3::zeros());
        assert!((begin.tangent - Vector3::new(0.0, TAU, 2.0 * TAU)).norm() < 1e-12);
    }
}
