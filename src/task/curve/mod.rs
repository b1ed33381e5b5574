//! Curves: one file each, one row in [`CURVES`].

mod astroid;
mod circle;
mod curve_kind;
mod fourier;
mod hold;
mod line;
mod lissajous;
mod planar_curve;
mod polyline;
mod rose;
mod spline;
mod tricuspid;

pub use astroid::Astroid;
pub use circle::Circle;
pub use curve_kind::{CurveKind, MakeCurve};
pub use fourier::Fourier;
pub use hold::Hold;
pub use line::Line;
pub use lissajous::Lissajous;
pub use planar_curve::PlanarCurve;
pub use polyline::Polyline;
pub use rose::Rose;
pub use spline::Spline;
pub use tricuspid::Tricuspid;

/// Every built-in curve.
pub const CURVES: &[CurveKind] = &[
    circle::KIND,
    tricuspid::KIND,
    astroid::KIND,
    line::KIND,
    lissajous::KIND,
    rose::KIND,
    fourier::KIND,
    hold::KIND,
    spline::KIND,
    polyline::KIND,
];

#[cfg(test)]
mod tests {
    use super::super::{Path, Planar};
    use super::*;
    use nalgebra::Vector3;
    use proptest::prelude::*;

    /// A path of every curve that draws parameters, and whether it has to close.
    fn paths(numbers: &[i32]) -> Vec<(&'static str, Box<dyn Path>, bool)> {
        let path = |kind: &CurveKind| {
            let mut numbers = numbers.iter().cycle();
            let mut whole = |low: i32, high: i32| low + numbers.next().map_or(0, |n| n % (high - low + 1));
            let given = (kind.draw?)(0.4, &mut whole);
            Some(match kind.make {
                MakeCurve::Planar(make) => {
                    (kind.name, Box::new(Planar::whole(make(&given))) as Box<dyn Path>, true)
                }
                MakeCurve::Centered(make) => {
                    // Paths through waypoints end at the last of them.
                    let path = make(&given);
                    let closes = path.smoothness().is_none();
                    (kind.name, path, closes)
                }
                MakeCurve::FromTip(make) => (kind.name, make(&given, &Vector3::new(0.1, 0.2, 0.3)), false),
            })
        };
        CURVES.iter().filter_map(path).collect()
    }

    proptest! {
        #[test]
        fn tangents_are_the_derivatives(numbers in prop::collection::vec(0..1000_i32, 24), u in -1.0..1.0_f64) {
            let step = 1e-6;
            for (name, path, _) in paths(&numbers) {
                let difference = (path.point(u + step).position - path.point(u - step).position) / (2.0 * step);
                let tangent = path.point(u).tangent;
                prop_assert!((difference - tangent).norm() < 1e-7 * (1.0 + tangent.norm()), "{name}");
            }
        }

        #[test]
        fn curves_close_after_a_turn(numbers in prop::collection::vec(0..1000_i32, 24), u in 0.0..1.0_f64) {
            for (name, path, _) in paths(&numbers).iter().filter(|(_, _, closes)| *closes) {
                let gap = (path.point(u).position - path.point(u + 1.0).position).norm();
                prop_assert!(gap < 1e-12, "{name}");
            }
        }
    }

    #[test]
    fn every_curve_draws_what_it_takes() {
        for kind in CURVES {
            let given = kind.draw.expect(kind.name)(0.3, &mut |low, _| low);
            for (name, value) in given.iter() {
                let parameter = kind.parameter(name).expect(kind.name);
                assert_eq!(parameter.form.read(value).as_ref(), Ok(value), "{}.{name}", kind.name);
                assert_eq!(parameter.objection(value), None, "{}.{name}", kind.name);
            }
            let missing =
                kind.parameters.iter().find(|known| known.is_required && given.get(known.name).is_none());
            assert_eq!(missing, None, "{}", kind.name);
        }
    }
}
