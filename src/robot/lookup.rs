//! Joints by name, and those whose names look like it.

use super::{Robot, names};

impl Robot {
    /// The place of a joint among [`Robot::joints`].
    pub(super) fn joint_index(&self, name: &str) -> Option<usize> {
        self.joints.iter().position(|joint| joint.name == name)
    }

    /// The joints whose names look like `name`, nearest first.
    pub(super) fn joints_like(&self, name: &str) -> Vec<String> {
        let all = self.joints.iter().map(|joint| joint.name.as_str());
        names::nearest(name, all).into_iter().map(str::to_owned).collect()
    }
}
