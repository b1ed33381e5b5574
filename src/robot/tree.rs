//! The tree as people draw it.

use super::{Joint, Link, Robot};

impl Robot {
    /// Returns the tree as people draw it: one row per link, depth first, with the joint above the link.
    pub fn tree(&self) -> TreeRows<'_> {
        TreeRows::new(self)
    }
}

/// One row of the drawn tree: a link, the joint above it and where it stands.
#[derive(Debug, Clone, Copy)]
pub struct TreeRow<'a> {
    /// The link of the row.
    pub link: &'a Link,
    /// The joint above the link; `None` for a root.
    pub joint: Option<&'a Joint>,
    /// The joint that `joint` follows, where that is a mimic joint.
    pub driver: Option<&'a Joint>,
    /// Number of joints between the link and its root.
    pub depth: usize,
    /// Whether the link is the last child of its parent (a drawn branch ends here).
    pub is_last: bool,
}

/// Iterator over the rows of [`Robot::tree`], depth first, children in the order of the file.
#[derive(Debug, Clone)]
pub struct TreeRows<'a> {
    robot: &'a Robot,
    next: usize,
    depths: Vec<usize>,
    last_child: Vec<usize>,
}

impl<'a> TreeRows<'a> {
    fn new(robot: &'a Robot) -> TreeRows<'a> {
        let mut depths = vec![0; robot.links.len()];
        let mut last_child = vec![usize::MAX; robot.links.len()];
        for joint in &robot.joints {
            depths[joint.child] = depths[joint.parent] + 1;
            last_child[joint.parent] = joint.child;
        }
        TreeRows { robot, next: 0, depths, last_child }
    }
}

impl<'a> Iterator for TreeRows<'a> {
    type Item = TreeRow<'a>;

    fn next(&mut self) -> Option<TreeRow<'a>> {
        let index = self.next;
        let link = self.robot.links.get(index)?;
        self.next += 1;
        let joint = link.parent_joint.map(|joint| &self.robot.joints[joint]);
        Some(TreeRow {
            link,
            joint,
            driver: joint.and_then(|joint| joint.mimic).map(|mimic| &self.robot.joints[mimic.driver]),
            depth: self.depths[index],
            is_last: joint.is_some_and(|joint| self.last_child[joint.parent] == index),
        })
    }
}
