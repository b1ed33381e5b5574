//! What obstacles files can name: one file each, one row in [`OBSTACLES`].

mod ball;
mod capsule;
mod cuboid;
mod half_space;
mod obstacle_kind;

pub use obstacle_kind::{MakeObstacle, ObstacleKind};

/// Every built-in kind of obstacle.
pub const OBSTACLES: &[ObstacleKind] = &[ball::KIND, capsule::KIND, cuboid::KIND, half_space::KIND];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::collision::{Capsule, Shape, ShapeError};
    use crate::kind::{Parameters, Value};
    use nalgebra::Vector3;

    fn list(numbers: [f64; 3]) -> Value {
        Value::List(numbers.map(Value::from).to_vec())
    }

    fn made(name: &str, given: &Parameters) -> Result<Shape, ShapeError> {
        let kind = OBSTACLES.iter().find(|kind| kind.name == name).expect(name);
        (kind.make)(given)
    }

    #[test]
    fn every_kind_makes_the_shape_that_it_says() {
        let ball = Capsule::sphere(Vector3::zeros(), 0.1).expect("a ball");
        let height = |shape: Shape| ball.separation_from(&shape).distance;
        let sphere = Parameters::new().with("center", list([0.0, 0.0, 1.0])).with("radius", 0.2);
        assert!((height(made("sphere", &sphere).expect("a sphere")) - 0.7).abs() < 1e-15);
        let ends = Parameters::new().with("from", list([-1.0, 0.0, 1.0])).with("to", list([1.0, 0.0, 1.0]));
        assert!((height(made("capsule", &ends.with("radius", 0.3)).expect("a capsule")) - 0.6).abs() < 1e-15);
        // Lying on its side, the box is as high as it is wide.
        let turned = Parameters::new()
            .with("center", list([0.0, 0.0, 1.0]))
            .with("size", list([0.4, 1.0, 1.6]))
            .with("rpy", list([0.0, std::f64::consts::FRAC_PI_2, 0.0]));
        assert!((height(made("box", &turned).expect("a box")) - 0.7).abs() < 1e-15);
        let floor =
            Parameters::new().with("point", list([5.0, 0.0, -1.0])).with("normal", list([0.0, 0.0, 3.0]));
        assert!((height(made("half-space", &floor).expect("a floor")) - 0.9).abs() < 1e-15);
    }

    #[test]
    fn numbers_that_make_no_shape_are_refused() {
        let flat = Parameters::new().with("center", list([0.0; 3])).with("size", list([1.0, 1.0, 0.0]));
        assert!(matches!(made("box", &flat), Err(ShapeError::NoSide { .. })));
        let nowhere = Parameters::new().with("point", list([0.0; 3])).with("normal", list([0.0; 3]));
        assert_eq!(made("half-space", &nowhere), Err(ShapeError::ZeroNormal));
    }
}
