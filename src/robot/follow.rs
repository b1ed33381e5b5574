//! Joints that follow others: what each declares, folded to the joint that drives it in the end.

use super::{Joint, Mimic, Robot};

impl Robot {
    /// Works out [`Joint::mimic`] of every joint from what it [follows](Joint::follows), in linear time.
    pub(super) fn fold_followers(&mut self) {
        let mut is_folded = vec![false; self.joints.len()];
        let mut waiting = Vec::new();
        for start in 0..self.joints.len() {
            waiting.push(start);
            while let Some(&index) = waiting.last() {
                let followed = self.joints[index].follows.map(|follows| follows.driver);
                if let Some(followed) = followed.filter(|&followed| !is_folded[followed]) {
                    waiting.push(followed);
                    continue;
                }
                self.joints[index].mimic = folded(&self.joints, index);
                is_folded[index] = true;
                waiting.pop();
            }
        }
    }

    /// Returns the joint that a joint follows at first hand: the one that its `<mimic>` names. `None` for a joint that
    /// follows none, or that the robot does not have.
    pub fn joint_followed_by(&self, joint: &str) -> Option<&Joint> {
        self.joint(joint)?.follows.map(|follows| &self.joints[follows.driver])
    }

    /// Returns the joints that follow a joint at first hand, by index.
    pub(super) fn followers(&self) -> Vec<Vec<usize>> {
        let mut followers = vec![Vec::new(); self.joints.len()];
        for (index, joint) in self.joints.iter().enumerate() {
            if let Some(follows) = joint.follows {
                followers[follows.driver].push(index);
            }
        }
        followers
    }
}

/// How a joint moves with its driver, when that is known of the joint that it follows.
fn folded(joints: &[Joint], index: usize) -> Option<Mimic> {
    let follows = joints[index].follows?;
    Some(joints[follows.driver].mimic.map_or(follows, |followed| follows.through(followed)))
}
