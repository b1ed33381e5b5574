//! Tools: a further link, rigidly below one that is there.

use nalgebra::{IsometryMatrix3, Vector3};
use thiserror::Error;

use super::size::unbelievable;
use super::{Joint, JointKind, Limits, Link, Robot, names};

/// Why a tool can not be put on.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum ToolError {
    /// A link that the robot does not have.
    #[error("the robot has no link {} to put a tool on{}", names::quote(.name), names::suggestion(.nearest))]
    UnknownLink {
        /// The name asked for.
        name: String,
        /// The links whose names look like it, nearest first.
        nearest: Vec<String>,
    },
    /// A name that a link or a joint has already.
    #[error("the name {} is taken by a link or joint of the robot; give the tool another", names::quote(.name))]
    NameTaken {
        /// The name asked for.
        name: String,
    },
    /// A pose with a number that is not finite, or beyond any arm.
    #[error("the tool can not be put there: {problem}")]
    Size {
        /// What is wrong with a number of the pose.
        problem: String,
    },
}

impl Robot {
    /// Returns the robot with one more link, `name`, fixed to `link` at the pose `link_from_tool`: a tool's tip, a camera,
    /// a corrected flange. The joint between them has the same name.
    ///
    /// # Errors
    /// [`ToolError`]: no such link (with the nearest names), a name that is taken, or a pose beyond any arm.
    ///
    /// ```
    /// use kinstep::nalgebra::IsometryMatrix3;
    /// use kinstep::robot::embedded;
    /// let pen = IsometryMatrix3::translation(0.0, 0.0, 0.12);
    /// let robot = embedded::get("ur5e")?.with_tool("tool0", "pen", &pen)?;
    /// assert_eq!(robot.chain("base", "pen")?.dof(), 6);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn with_tool(
        &self,
        link: &str,
        name: &str,
        link_from_tool: &IsometryMatrix3<f64>,
    ) -> Result<Robot, ToolError> {
        let Some(&parent) = self.link_by_name.get(link) else {
            let all = self.links.iter().map(|link| link.name.as_str());
            let nearest = names::nearest(link, all).into_iter().map(str::to_owned).collect();
            return Err(ToolError::UnknownLink { name: link.to_owned(), nearest });
        };
        if self.link(name).is_some() || self.joint(name).is_some() {
            return Err(ToolError::NameTaken { name: name.to_owned() });
        }
        let numbers = link_from_tool.translation.vector.iter().chain(link_from_tool.rotation.matrix());
        if let Some(problem) = numbers.copied().find_map(unbelievable) {
            return Err(ToolError::Size { problem });
        }
        let mut robot = self.clone();
        robot.insert_leaf(parent, name, link_from_tool);
        Ok(robot)
    }

    /// Adds a leaf behind everything that hangs from `parent`, so that the links stay depth first.
    fn insert_leaf(&mut self, parent: usize, name: &str, pose: &IsometryMatrix3<f64>) {
        let place = self.end_of_subtree(parent);
        let joint_place = self.links[..place].iter().filter(|link| link.parent_joint.is_some()).count();
        let moved = |index: usize, from: usize| index + usize::from(index >= from);
        for link in &mut self.links {
            link.parent_joint = link.parent_joint.map(|joint| moved(joint, joint_place));
        }
        for joint in &mut self.joints {
            (joint.parent, joint.child) = (moved(joint.parent, place), moved(joint.child, place));
            for mimic in joint.mimic.iter_mut().chain(&mut joint.follows) {
                mimic.driver = moved(mimic.driver, joint_place);
            }
        }
        let leaf = Link { name: name.to_owned(), parent_joint: Some(joint_place), defect: None };
        self.links.insert(place, leaf);
        let joint = Joint {
            name: name.to_owned(),
            kind: JointKind::Fixed,
            parent,
            child: place,
            origin: *pose,
            axis: Vector3::x(),
            limits: Limits::UNLIMITED,
            mimic: None,
            follows: None,
            defect: None,
            angles: None,
        };
        self.joints.insert(joint_place, joint);
        self.link_by_name = self.links.iter().enumerate().map(|(i, link)| (link.name.clone(), i)).collect();
    }

    /// The index after the last link that hangs from `root`, itself included.
    fn end_of_subtree(&self, root: usize) -> usize {
        let parent = |link: usize| self.links[link].parent_joint.map(|joint| self.joints[joint].parent);
        // Depth first, the subtree is one piece: it ends where a link hangs from something before it.
        let hangs_outside = |&link: &usize| parent(link).is_none_or(|parent| parent < root);
        (root + 1..self.links.len()).find(hangs_outside).unwrap_or(self.links.len())
    }
}
