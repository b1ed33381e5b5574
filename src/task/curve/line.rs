use super::super::{Path, PathPoint};
use super::{CurveKind, MakeCurve};
use crate::kind::{Form, Kind, Parameter, Parameters};
use nalgebra::Vector3;

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

pub(super) const KIND: CurveKind = Kind::new(
    "line",
    "A straight line.",
    &[
        Parameter::optional("to", Form::Point, "m", "End in world coordinates."),
        Parameter::optional("displacement", Form::Point, "m", "End from the beginning, along world axes."),
    ],
    MakeCurve::FromTip(|given, tip| Box::new(Line { displacement: displacement(given, tip) })),
)
.with_objection(|given| {
    let ends = ["to", "displacement"].into_iter().filter(|name| given.get(name).is_some()).count();
    (ends != 1)
        .then(|| "a line ends at one of `to` (world) and `displacement` (from the tip); give one".to_owned())
})
.with_draw(|size, whole| {
    let direction = [(); 3].map(|()| f64::from(whole(-10, 10)) * size);
    Parameters::new().with("displacement", direction)
});

/// From the tip to the end; what is not said of it stays as it is.
fn displacement(given: &Parameters, tip: &Vector3<f64>) -> Vector3<f64> {
    let vector = |numbers: &[f64]| {
        let number = |axis: usize| numbers.get(axis).copied().unwrap_or(0.0);
        Vector3::new(number(0), number(1), number(2))
    };
    match (given.numbers("displacement"), given.numbers("to")) {
        (Some(displacement), _) => vector(&displacement),
        (None, Some(to)) => {
            let mut displacement = vector(&to) - tip;
            if to.len() == 2 {
                displacement.z = 0.0;
            }
            displacement
        }
        (None, None) => Vector3::zeros(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_ends_where_either_parameter_says() {
        let tip = Vector3::new(1.0, 2.0, 3.0);
        let end = |given: Parameters| displacement(&given, &tip) + tip;
        assert_eq!(end(Parameters::new().with("to", [5.0, 6.0, 7.0])), Vector3::new(5.0, 6.0, 7.0));
        assert_eq!(end(Parameters::new().with("to", [5.0, 6.0])), Vector3::new(5.0, 6.0, 3.0));
        assert_eq!(end(Parameters::new().with("displacement", [1.0, 0.0])), Vector3::new(2.0, 2.0, 3.0));
    }

    #[test]
    fn it_has_one_end() {
        let objection = KIND.objection.unwrap();
        let (none, one) = (Parameters::new(), Parameters::new().with("to", [1.0, 1.0]));
        assert!(objection(&none).is_some() && objection(&one).is_none());
        assert!(objection(&one.with("displacement", [1.0, 1.0])).is_some());
    }
}
