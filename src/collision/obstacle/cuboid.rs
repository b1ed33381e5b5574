use super::ObstacleKind;
use super::obstacle_kind::vector;
use crate::collision::Cuboid;
use crate::kind::{Form, Kind, Parameter};
use nalgebra::{IsometryMatrix3, Rotation3};

pub(super) const KIND: ObstacleKind = Kind::new(
    "box",
    "A box about `center` with sides of the lengths `size`, turned by `rpy`.",
    &[
        Parameter::required("center", Form::Point, "m", "Its middle."),
        Parameter::required("size", Form::Point, "m", "The lengths of its sides along its own x, y and z."),
        Parameter::optional(
            "rpy",
            Form::Point,
            "rad",
            "Roll, pitch and yaw about the world's axes. Default: none.",
        ),
    ],
    |given| {
        let turn = vector(given, "rpy");
        let turn = Rotation3::from_euler_angles(turn.x, turn.y, turn.z);
        let pose = IsometryMatrix3::from_parts(vector(given, "center").into(), turn);
        Ok(Cuboid::new(pose, vector(given, "size"))?.into())
    },
);
