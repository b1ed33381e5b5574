use crate::task::{Reference, TaskKind};
use nalgebra::{IsometryMatrix3, Rotation3, Translation3, Unit, Vector3, Vector6};

/// Where a tip is asked to be, in the axes that the chain's poses are given in.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target {
    kind: Kind,
    reference: Reference,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Task(TaskKind),
    /// Position, and the direction of the tip's z: the third column of the reference's rotation.
    Axis,
}

impl Target {
    /// The x and y coordinates of the tip \[m\]; everything else is free.
    pub fn position_xy(x: f64, y: f64) -> Self {
        Self::at(TaskKind::PositionXy, Vector3::new(x, y, 0.0), Rotation3::identity())
    }

    /// The tip's position \[m\]; its orientation is free.
    pub fn position(position: Vector3<f64>) -> Self {
        Self::at(TaskKind::Position, position, Rotation3::identity())
    }

    /// The tip's position \[m\] and the direction of its z axis; the turn about that axis is free.
    pub fn axis(position: Vector3<f64>, direction: Unit<Vector3<f64>>) -> Self {
        let least = direction.iamin();
        let x = Vector3::ith(least, 1.0).cross(&direction).normalize();
        let columns = [x, direction.cross(&x), direction.into_inner()];
        let rotation = Rotation3::from_matrix_unchecked(nalgebra::Matrix3::from_columns(&columns));
        Self { kind: Kind::Axis, ..Self::at(TaskKind::Pose, position, rotation) }
    }

    /// The tip's whole pose.
    pub fn pose(pose: &IsometryMatrix3<f64>) -> Self {
        Self::at(TaskKind::Pose, pose.translation.vector, pose.rotation)
    }

    /// What a task asks of the tip while the reference stands at `reference`.
    pub fn of_task(task: TaskKind, reference: &Reference) -> Self {
        Self { kind: Kind::Task(task), reference: *reference }
    }

    fn at(task: TaskKind, position: Vector3<f64>, rotation: Rotation3<f64>) -> Self {
        Self::of_task(task, &Reference { position, rotation, twist: Vector6::zeros() })
    }

    /// The pose asked for; what is free in it is set to zero.
    pub fn reference(&self) -> IsometryMatrix3<f64> {
        IsometryMatrix3::from_parts(Translation3::from(self.reference.position), self.reference.rotation)
    }

    /// How far a tip in this pose is from the target: (linear \[m\]; angular \[rad\]), zero in what is free.
    ///
    /// For an axis `a` that should point along `d` the angular part is the rotation vector that turns `d` onto `a`.
    pub fn error(&self, tip: &IsometryMatrix3<f64>) -> Vector6<f64> {
        match self.kind {
            Kind::Task(task) => task.error(tip, &self.reference),
            Kind::Axis => {
                let offset = tip.translation.vector - self.reference.position;
                let turn = turn_onto(&self.direction(), &z_of(&tip.rotation));
                Vector6::new(offset.x, offset.y, offset.z, turn.x, turn.y, turn.z)
            }
        }
    }

    /// Number of leading rows of the error that count.
    pub(super) fn rows(&self) -> usize {
        match self.kind {
            Kind::Task(task) => task.rows(),
            Kind::Axis => 6,
        }
    }

    /// Takes out of the Jacobian's columns what does not change the error: turns about the tip's own axis.
    pub(super) fn drop_free_turns(&self, tip: &IsometryMatrix3<f64>, columns: &mut [Vector6<f64>]) {
        if self.kind != Kind::Axis {
            return;
        }
        let axis = z_of(&tip.rotation);
        for column in columns {
            let along = axis.dot(&column.fixed_rows::<3>(3));
            column.fixed_rows_mut::<3>(3).axpy(-along, &axis, 1.0);
        }
    }

    /// Whether every number of it is finite.
    pub(super) fn is_finite(&self) -> bool {
        let Reference { position, rotation, .. } = &self.reference;
        position.iter().chain(rotation.matrix().iter()).all(|number| number.is_finite())
    }

    /// The size of the lengths in it \[m\].
    pub(super) fn length(&self) -> f64 {
        self.reference.position.norm()
    }

    fn direction(&self) -> Vector3<f64> {
        z_of(&self.reference.rotation)
    }
}

fn z_of(rotation: &Rotation3<f64>) -> Vector3<f64> {
    rotation.matrix().column(2).into()
}

/// The rotation vector, of length at most pi, that turns the unit vector `from` onto the unit vector `onto`.
fn turn_onto(from: &Vector3<f64>, onto: &Vector3<f64>) -> Vector3<f64> {
    let cross = from.cross(onto);
    let (sine, cosine) = (cross.norm(), from.dot(onto));
    if sine > 0.0 {
        return cross * (sine.atan2(cosine) / sine);
    }
    if cosine > 0.0 {
        return Vector3::zeros();
    }
    // Opposite directions: any half turn about a perpendicular axis will do.
    Vector3::ith(from.iamin(), 1.0).cross(from).normalize() * std::f64::consts::PI
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn unit(v: [f64; 3]) -> Unit<Vector3<f64>> {
        Unit::new_normalize(Vector3::from(v))
    }

    proptest! {
        #[test]
        fn an_axis_that_points_there_has_no_error_whatever_its_turn(
            direction in proptest::array::uniform3(0.1..1.0_f64), turn in -3.0..3.0_f64,
        ) {
            let direction = unit(direction);
            let target = Target::axis(Vector3::new(1.0, 2.0, 3.0), direction);
            let turned = Rotation3::from_axis_angle(&direction, turn) * target.reference().rotation;
            let tip = IsometryMatrix3::from_parts(Translation3::new(1.0, 2.0, 3.0), turned);
            prop_assert!(target.error(&tip).norm() < 1e-15);
        }

        #[test]
        fn the_angular_error_of_an_axis_turns_the_wanted_direction_onto_it(
            from in proptest::array::uniform3(-1.0..1.0_f64), onto in proptest::array::uniform3(-1.0..1.0_f64),
        ) {
            prop_assume!(Vector3::from(from).norm() > 0.1 && Vector3::from(onto).norm() > 0.1);
            let (from, onto) = (unit(from), unit(onto));
            let turn = turn_onto(&from, &onto);
            prop_assert!((Rotation3::new(turn) * *from - *onto).norm() < 1e-14);
            prop_assert!(turn.dot(&onto).abs() < 1e-14, "no turn about the axis itself");
        }
    }

    #[test]
    fn opposite_directions_are_half_a_turn_apart() {
        for axis in 0..3 {
            let from = Vector3::ith(axis, 1.0);
            let turn = turn_onto(&from, &-from);
            assert!((turn.norm() - std::f64::consts::PI).abs() < 1e-15 && turn.dot(&from) == 0.0);
        }
        assert_eq!(turn_onto(&Vector3::x(), &Vector3::x()), Vector3::zeros());
    }
}
