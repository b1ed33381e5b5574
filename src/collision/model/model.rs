//! The capsules of a robot's links, and the pairs of links that are not checked.

use std::collections::HashSet;

use super::{CollisionError, Fit};
use crate::collision::Capsule;
use crate::robot::{DisabledPair, JointKind, Robot, names};

/// A capsule in the axes of the link that it stands for.
#[derive(Debug, Clone, PartialEq)]
pub struct LinkCapsule {
    /// Name of the link.
    pub link: String,
    /// The capsule, in the link's own axes.
    pub capsule: Capsule,
}

/// A link's shape for which there is no capsule, and why.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Missing {
    /// Name of the link; empty where the file does not say.
    pub link: String,
    /// Why there is none.
    pub reason: String,
}

/// The capsules of a robot's links, and the pairs of links that are not checked against each other.
///
/// Links that a joint joins are left out from the beginning, where links that are fixed to each other count as one: neighbours
/// touch at their joint. [`with_srdf`](CollisionModel::with_srdf) and [`with_allowed`](CollisionModel::with_allowed) leave out
/// more.
///
/// ```
/// use kinstep::collision::{Capsule, CollisionModel};
/// use kinstep::nalgebra::Vector3;
/// use kinstep::robot::embedded;
/// let panda = embedded::get("panda")?;
/// let camera = Capsule::sphere(Vector3::new(0.08, 0.0, 0.05), 0.04)?;
/// let model = CollisionModel::embedded("panda")?.with_capsule("panda_hand", camera)?;
/// assert!(!model.checks("panda_link3", "panda_link4"), "they are neighbours");
/// assert!(model.checks("panda_link1", "panda_hand"));
/// let error = CollisionModel::new(&panda).with_capsule("panda_hnad", camera).unwrap_err();
/// assert!(error.to_string().contains("did you mean `panda_hand`"));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct CollisionModel {
    names: Vec<String>,
    /// For every link the first of those that are fixed to each other.
    group: Vec<usize>,
    /// Pairs of such groups that a joint joins, and of links that are left out; the smaller number first.
    joined: HashSet<[usize; 2]>,
    allowed: HashSet<[usize; 2]>,
    pub(super) capsules: Vec<LinkCapsule>,
    pub(super) fits: Vec<Fit>,
    pub(super) missing: Vec<Missing>,
}

impl CollisionModel {
    /// Returns a model without capsules, in which neighbours are left out.
    pub fn new(robot: &Robot) -> CollisionModel {
        let names = robot.links().iter().map(|link| link.name.clone()).collect();
        let mut group: Vec<usize> = (0..robot.links().len()).collect();
        let mut joined = HashSet::new();
        // Parents stand before their children.
        for joint in robot.joints() {
            if joint.kind == JointKind::Fixed {
                group[joint.child] = group[joint.parent];
            } else {
                joined.insert(sorted(group[joint.parent], group[joint.child]));
            }
        }
        let (capsules, fits, missing) = (Vec::new(), Vec::new(), Vec::new());
        CollisionModel { names, group, joined, allowed: HashSet::new(), capsules, fits, missing }
    }

    /// Returns the model with one more capsule of a link, given in the link's own axes.
    ///
    /// # Errors
    /// [`CollisionError::UnknownLink`], with the nearest names.
    pub fn with_capsule(mut self, link: &str, capsule: Capsule) -> Result<CollisionModel, CollisionError> {
        self.index(link)?;
        self.capsules.push(LinkCapsule { link: link.to_owned(), capsule });
        Ok(self)
    }

    /// Returns the model in which two links are not checked against each other.
    ///
    /// # Errors
    /// [`CollisionError`]: a link that the robot does not have, or one link twice.
    pub fn with_allowed(mut self, link: &str, other: &str) -> Result<CollisionModel, CollisionError> {
        if link == other {
            return Err(CollisionError::SameLink { link: link.to_owned() });
        }
        let pair = sorted(self.index(link)?, self.index(other)?);
        self.allowed.insert(pair);
        Ok(self)
    }

    /// Returns the model in which pairs of an [`Srdf`](crate::robot::Srdf) are not checked.
    ///
    /// # Errors
    /// As [`CollisionModel::with_allowed`], where the file was read for another robot.
    pub fn with_srdf(self, pairs: &[DisabledPair]) -> Result<CollisionModel, CollisionError> {
        pairs.iter().try_fold(self, |model, pair| model.with_allowed(&pair.links[0], &pair.links[1]))
    }

    /// Returns whether two links are checked against each other: they are neither one body nor neighbours, and nothing leaves
    /// them out. False for links that the robot does not have.
    pub fn checks(&self, link: &str, other: &str) -> bool {
        let (Ok(link), Ok(other)) = (self.index(link), self.index(other)) else { return false };
        let groups = sorted(self.group[link], self.group[other]);
        groups[0] != groups[1]
            && !self.joined.contains(&groups)
            && !self.allowed.contains(&sorted(link, other))
    }

    /// Returns the capsules, in the axes of their links.
    pub fn capsules(&self) -> &[LinkCapsule] {
        &self.capsules
    }

    /// Returns which capsules were fitted to what shape, and how well.
    pub fn fits(&self) -> &[Fit] {
        &self.fits
    }

    /// Returns the shapes of links for which there is no capsule, and why.
    pub fn missing(&self) -> &[Missing] {
        &self.missing
    }

    fn index(&self, link: &str) -> Result<usize, CollisionError> {
        self.names.iter().position(|name| name == link).ok_or_else(|| CollisionError::UnknownLink {
            name: link.to_owned(),
            nearest: names::nearest(link, self.names.iter().map(String::as_str))
                .into_iter()
                .map(str::to_owned)
                .collect(),
            known: self.names.clone(),
        })
    }
}

fn sorted(one: usize, other: usize) -> [usize; 2] {
    [one.min(other), one.max(other)]
}
