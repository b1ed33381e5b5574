use crate::collision::{Shape, ShapeError};
use crate::kind::{Kind, Parameters, Value};
use nalgebra::Vector3;

/// A kind of obstacle that files can name.
pub type ObstacleKind = Kind<MakeObstacle>;

/// Makes an obstacle of its parameters, in the axes of the world.
pub type MakeObstacle = fn(&Parameters) -> Result<Shape, ShapeError>;

/// The three numbers of a parameter; zeros where it is not given.
pub(super) fn vector(given: &Parameters, name: &str) -> Vector3<f64> {
    let list = given.get(name).and_then(Value::list).unwrap_or_default();
    Vector3::from_fn(|axis, _| list.get(axis).and_then(Value::number).unwrap_or(0.0))
}
