use super::ObstacleKind;
use super::obstacle_kind::vector;
use crate::collision::Capsule;
use crate::kind::{Form, Kind, Parameter};

pub(super) const KIND: ObstacleKind = Kind::new(
    "sphere",
    "All points within `radius` of `center`.",
    &[
        Parameter::required("center", Form::Point, "m", "Its middle."),
        Parameter::required("radius", Form::Positive { noun: "radius" }, "m", "Its radius."),
    ],
    |given| Ok(Capsule::sphere(vector(given, "center"), given.number("radius").unwrap_or(0.0))?.into()),
);
