use super::ObstacleKind;
use super::obstacle_kind::vector;
use crate::collision::HalfSpace;
use crate::kind::{Form, Kind, Parameter};

pub(super) const KIND: ObstacleKind = Kind::new(
    "half-space",
    "Everything below a plane: a floor, a wall, a ceiling.",
    &[
        Parameter::required("point", Form::Point, "m", "A point of the plane."),
        Parameter::required(
            "normal",
            Form::Point,
            "",
            "The direction that points out of the solid, of any length.",
        ),
    ],
    |given| Ok(HalfSpace::new(vector(given, "point"), vector(given, "normal"))?.into()),
);
