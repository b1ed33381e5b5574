//! The kinematics of random trees worked out frame by frame: nothing is folded.

use kinstep::nalgebra::{Isometry3, IsometryMatrix3, Translation3, UnitQuaternion, Vector3};
use kinstep::robot::JointKind;
use kinstep_strategies::{TreeCase, TreeJoint};

/// Poses of all links in the root, with quaternions and one frame per joint.
pub(crate) fn poses(tree: &TreeCase) -> Vec<IsometryMatrix3<f64>> {
    poses_at(tree, |i| tree.position(i))
}

/// As [`poses`], at other positions of the joints, by their places in the tree.
pub(crate) fn poses_at(tree: &TreeCase, position: impl Fn(usize) -> f64) -> Vec<IsometryMatrix3<f64>> {
    let mut poses = vec![Isometry3::identity()];
    for (i, joint) in tree.joints.iter().enumerate() {
        poses.push(poses[joint.parent] * origin(joint) * motion(joint, position(i)));
    }
    let with_matrix = |pose: Isometry3<f64>| {
        IsometryMatrix3::from_parts(pose.translation, pose.rotation.to_rotation_matrix())
    };
    poses.into_iter().map(with_matrix).collect()
}

fn origin(joint: &TreeJoint) -> Isometry3<f64> {
    let [roll, pitch, yaw] = joint.rpy.map(|tenths| f64::from(tenths) / 10.0);
    let turn = UnitQuaternion::from_scaled_axis(Vector3::z() * yaw)
        * UnitQuaternion::from_scaled_axis(Vector3::y() * pitch)
        * UnitQuaternion::from_scaled_axis(Vector3::x() * roll);
    let place = Vector3::from(joint.xyz.map(|twentieths| f64::from(twentieths) / 20.0));
    Isometry3::from_parts(place.into(), turn)
}

fn motion(joint: &TreeJoint, position: f64) -> Isometry3<f64> {
    let along = Vector3::from(joint.axis.map(f64::from)).normalize() * position;
    match joint.kind {
        JointKind::Fixed => Isometry3::identity(),
        JointKind::Prismatic => Isometry3::from_parts(along.into(), UnitQuaternion::identity()),
        _ => Isometry3::from_parts(Translation3::identity(), UnitQuaternion::from_scaled_axis(along)),
    }
}

pub(crate) fn distance(a: &IsometryMatrix3<f64>, b: &IsometryMatrix3<f64>) -> f64 {
    (a.translation.vector - b.translation.vector).norm() + (a.rotation.matrix() - b.rotation.matrix()).norm()
}
