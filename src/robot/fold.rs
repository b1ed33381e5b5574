//! From the joints along a path to a chain: constants, and motions about z.

use std::collections::{HashMap, HashSet};

use nalgebra::{IsometryMatrix3, Matrix3, Rotation3, Translation3, Vector3};

use super::chain::Place;
use super::path::{self, Step};
use super::segment::{Folded, Motion};
use super::{Chain, ChainError, ChainJoint, Joint, Limits, Robot};

impl Robot {
    /// Returns the directed path from link `base` to link `tip`, in either direction and through a common
    /// ancestor if need be, ready for kinematics. Links with only fixed joints between them make a chain of no joints.
    ///
    /// # Errors
    /// [`ChainError`]: a link that does not exist (with the nearest names), `base` equal to `tip`, links that
    /// no joints connect, or a joint on the way that is defective or of a kind that a chain can not carry.
    pub fn chain(&self, base: &str, tip: &str) -> Result<Chain, ChainError> {
        fold(self, &path::steps(self, base, tip)?, base, tip)
    }
}

/// A moving joint of the path: `|multiplier| q_column + offset` along or about `direction`, in the frame
/// that `before` leads to.
struct Moving {
    before: IsometryMatrix3<f64>,
    motion: Motion,
    column: usize,
    multiplier: f64,
}

/// Returns the chain of a path whose joints are sound.
///
/// Going down a joint is `origin M(axis, x)`; going up is the inverse, `M(-axis, x) origin^-1`. With
/// `M(axis, x) = R M(z, x) R^T`, where R turns z onto the axis, all constants between two motions merge. A
/// negative multiplier turns the axis round, and an offset is a constant motion, so only `|multiplier|` stays.
fn fold(robot: &Robot, steps: &[Step], base: &str, tip: &str) -> Result<Chain, ChainError> {
    let mut columns = Columns::of(robot, steps);
    let mut moving: Vec<Moving> = Vec::new();
    let mut constant = IsometryMatrix3::identity();
    for step in steps {
        let joint = &robot.joints[step.joint];
        if !step.upward {
            constant *= joint.origin;
        }
        if joint.kind.is_movable() {
            let column = columns.place(robot, step.joint)?;
            let (multiplier, offset) =
                joint.mimic.map_or((1.0, 0.0), |mimic| (mimic.multiplier, mimic.offset));
            let sign = if step.upward { -1.0 } else { 1.0 } * multiplier.signum();
            let onto_axis = turn_of_z_onto(joint.axis * sign);
            let motion = if joint.kind.is_rotation() { Motion::Turn } else { Motion::Shift };
            let direction_offset = offset * multiplier.signum();
            let before = constant * onto_axis * constant_motion(motion, direction_offset);
            moving.push(Moving { before, motion, column, multiplier: multiplier.abs() });
            constant = IsometryMatrix3::from_parts(Translation3::identity(), onto_axis.inverse());
        }
        if step.upward {
            constant *= joint.origin.inverse();
        }
    }
    let reach = reach(&moving, &constant, &columns.joints);
    Ok(assemble(&moving, &constant, columns.joints, reach, base, tip))
}

fn assemble(
    moving: &[Moving],
    last: &IsometryMatrix3<f64>,
    joints: Vec<ChainJoint>,
    reach: f64,
    base: &str,
    tip: &str,
) -> Chain {
    let after = moving.iter().skip(1).map(|next| next.before).chain([*last]);
    let constants: Vec<_> = moving.iter().map(|own| own.motion).zip(after).collect();
    let mut open = vec![true; joints.len()];
    let place = |own: &Moving| Place {
        multiplier: own.multiplier,
        column: own.column,
        opens_column: std::mem::take(&mut open[own.column]),
    };
    let places = moving.iter().map(place).collect();
    // Where nothing moves, the whole chain is one constant.
    let start = moving.first().map_or(last, |first| &first.before);
    let folded = Folded::new(start, &constants);
    Chain { base: base.to_owned(), tip: tip.to_owned(), joints, reach, folded, places }
}

/// Returns a rotation whose third column is the unit vector `axis`; exact when the axis is a coordinate axis.
fn turn_of_z_onto(axis: Vector3<f64>) -> Rotation3<f64> {
    let least = axis.iamin();
    let x = Vector3::ith(least, 1.0).cross(&axis).normalize();
    Rotation3::from_matrix_unchecked(Matrix3::from_columns(&[x, axis.cross(&x), axis]))
}

/// Returns the motion about or along z by a constant.
fn constant_motion(motion: Motion, value: f64) -> IsometryMatrix3<f64> {
    match motion {
        _ if value == 0.0 => IsometryMatrix3::identity(),
        Motion::Turn => IsometryMatrix3::from_parts(
            Translation3::identity(),
            Rotation3::from_axis_angle(&Vector3::z_axis(), value),
        ),
        Motion::Shift => IsometryMatrix3::translation(0.0, 0.0, value),
    }
}

/// Returns the sum of the constant lengths after the first motion and of the prismatic travels; zero where nothing moves.
fn reach(moving: &[Moving], last: &IsometryMatrix3<f64>, joints: &[ChainJoint]) -> f64 {
    if moving.is_empty() {
        return 0.0;
    }
    let lengths = moving.iter().skip(1).map(|next| &next.before).chain([last]);
    let constant: f64 = lengths.map(|pose| pose.translation.vector.norm()).sum();
    let travels = moving.iter().filter(|own| own.motion == Motion::Shift).map(|own| {
        let limits = joints[own.column].limits;
        own.multiplier * limits.lower.abs().max(limits.upper.abs())
    });
    constant + travels.sum::<f64>()
}

/// The columns of the chain in path order: every joint that moves on its own has its place; a joint that is followed
/// from elsewhere takes the place of the first of its followers.
struct Columns {
    /// The column of each joint that has one, by the joint's index.
    of_driver: HashMap<usize, usize>,
    joints: Vec<ChainJoint>,
}

impl Columns {
    fn of(robot: &Robot, steps: &[Step]) -> Self {
        let movable = || steps.iter().map(|step| step.joint).filter(|&i| robot.joints[i].kind.is_movable());
        let on_path: HashSet<usize> = movable().collect();
        let mut columns = Self { of_driver: HashMap::new(), joints: Vec::new() };
        for index in movable() {
            let driver = robot.joints[index].mimic.map_or(index, |mimic| mimic.driver);
            let has_own_place = driver != index && on_path.contains(&driver);
            if !has_own_place {
                columns.open(robot, driver);
            }
        }
        columns
    }

    fn open(&mut self, robot: &Robot, driver: usize) {
        self.of_driver.entry(driver).or_insert_with(|| {
            let Joint { name, kind, limits, .. } = &robot.joints[driver];
            self.joints.push(ChainJoint { name: name.clone(), kind: *kind, limits: *limits });
            self.joints.len() - 1
        });
    }

    /// Returns the column of a joint of the path: its own, or that of the joint it follows.
    fn place(&mut self, robot: &Robot, index: usize) -> Result<usize, ChainError> {
        let joint = &robot.joints[index];
        let driver = joint.mimic.map_or(index, |mimic| mimic.driver);
        let known = self.of_driver.get(&driver).copied();
        let column = known.expect("every driver of the path was given a column");
        let limits = &mut self.joints[column].limits;
        *limits = narrowed(*limits, joint);
        if limits.lower > limits.upper {
            return Err(ChainError::EmptyRange {
                joint: robot.joints[driver].name.clone(),
                follower: joint.name.clone(),
            });
        }
        Ok(column)
    }
}

/// Returns a driver's limits narrowed to what one of its followers allows.
fn narrowed(driver: Limits, follower: &Joint) -> Limits {
    let Some(mimic) = follower.mimic else { return driver };
    let at = |position: f64| (position - mimic.offset) / mimic.multiplier;
    let (a, b) = (at(follower.limits.lower), at(follower.limits.upper));
    let ratio = mimic.multiplier.abs();
    driver.narrowed_by(&Limits {
        lower: a.min(b),
        upper: a.max(b),
        velocity: follower.limits.velocity / ratio,
        acceleration: follower.limits.acceleration / ratio,
        jerk: follower.limits.jerk / ratio,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn turns_z_onto_coordinate_axes_exactly() {
        for i in 0..3 {
            for sign in [1.0, -1.0] {
                let axis = Vector3::ith(i, sign);
                let turn = turn_of_z_onto(axis);
                assert_eq!(turn * Vector3::z(), axis);
                assert_eq!(turn.matrix().determinant(), 1.0);
                assert!(turn.matrix().iter().all(|&entry| entry == 0.0 || entry.abs() == 1.0));
            }
        }
    }

    #[test]
    fn turns_z_onto_a_skew_axis() {
        let axis = Vector3::new(1.0, -2.0, 3.0).normalize();
        let turn = turn_of_z_onto(axis);
        assert!((turn * Vector3::z() - axis).norm() < 1e-15);
        assert!((turn.matrix().transpose() * turn.matrix() - Matrix3::identity()).norm() < 1e-15);
    }
}
