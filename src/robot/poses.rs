//! Where every link stands: the whole robot at once, for drawings and checks.

use nalgebra::IsometryMatrix3;

use super::displacement::displacement;
use super::{Joint, Robot};

impl Robot {
    /// Returns the pose of every link in its root, in the order of [`Robot::links`], at `positions` \[rad\] or \[m\], one
    /// per joint in the order of [`Robot::joints`].
    ///
    /// The position of a joint that follows another is worked out, whatever `positions` says of it; joints without a
    /// single position (floating, planar, spherical) and defective ones stand at rest, and missing positions are 0. A
    /// chain ([`Robot::chain`]) is the faster way to the pose of one link.
    pub fn link_poses(&self, positions: &[f64]) -> Vec<IsometryMatrix3<f64>> {
        let given = |index: usize| positions.get(index).copied().unwrap_or(0.0);
        let mut poses = vec![IsometryMatrix3::identity(); self.links.len()];
        for (index, joint) in self.joints.iter().enumerate() {
            let position = match joint.mimic {
                Some(mimic) => mimic.multiplier * given(mimic.driver) + mimic.offset,
                None => given(index),
            };
            poses[joint.child] =
                poses[joint.parent] * joint.origin * displacement(joint.kind, joint.axis, position);
        }
        poses
    }

    /// Returns the joints that move on their own, in the order of [`Robot::joints`]: one degree of freedom, following
    /// no other.
    pub fn movable_joints(&self) -> impl Iterator<Item = &Joint> {
        self.joints.iter().filter(|joint| joint.kind.is_movable() && joint.mimic.is_none())
    }
}
