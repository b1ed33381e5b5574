use super::ObstacleKind;
use super::obstacle_kind::vector;
use crate::collision::Capsule;
use crate::kind::{Form, Kind, Parameter};

pub(super) const KIND: ObstacleKind = Kind::new(
    "capsule",
    "All points within `radius` of the segment between two points: a post, a pipe, a cable.",
    &[
        Parameter::required("from", Form::Point, "m", "Where the segment begins."),
        Parameter::required("to", Form::Point, "m", "Where it ends."),
        Parameter::required("radius", Form::Positive { noun: "radius" }, "m", "The radius."),
    ],
    |given| {
        let radius = given.number("radius").unwrap_or(0.0);
        Ok(Capsule::new(vector(given, "from"), vector(given, "to"), radius)?.into())
    },
);
