//! The robot as it is computed with: flat arrays, parents before children, indices.

use std::collections::HashMap;
use std::fmt;

use nalgebra::{IsometryMatrix3, Vector3};

use super::Diagnostic;

/// How a joint moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum JointKind {
    /// Turns about its axis between limits \[rad\].
    Revolute,
    /// Turns about its axis without end; the angle is one unwrapped number \[rad\].
    Continuous,
    /// Slides along its axis \[m\].
    Prismatic,
    /// Does not move.
    Fixed,
    /// Six free directions; no chain passes through it.
    Floating,
    /// Two translations and a rotation in a plane; no chain passes through it.
    Planar,
    /// Three rotations; no chain passes through it.
    Spherical,
}

impl JointKind {
    /// Every kind of joint, in the order of the URDF standard.
    pub const ALL: [JointKind; 7] = [
        JointKind::Revolute,
        JointKind::Continuous,
        JointKind::Prismatic,
        JointKind::Fixed,
        JointKind::Floating,
        JointKind::Planar,
        JointKind::Spherical,
    ];

    /// Returns the word that URDF uses for the kind of joint.
    pub fn as_str(self) -> &'static str {
        match self {
            JointKind::Revolute => "revolute",
            JointKind::Continuous => "continuous",
            JointKind::Prismatic => "prismatic",
            JointKind::Fixed => "fixed",
            JointKind::Floating => "floating",
            JointKind::Planar => "planar",
            JointKind::Spherical => "spherical",
        }
    }

    /// Whether the joint has exactly one degree of freedom (revolute, continuous, prismatic).
    pub fn is_movable(self) -> bool {
        matches!(self, JointKind::Revolute | JointKind::Continuous | JointKind::Prismatic)
    }

    /// Whether the joint turns about one axis (revolute, continuous).
    pub fn is_rotation(self) -> bool {
        matches!(self, JointKind::Revolute | JointKind::Continuous)
    }

    /// Whether a chain can carry the joint: one degree of freedom or none.
    pub fn is_supported(self) -> bool {
        self.is_movable() || self == JointKind::Fixed
    }
}

impl fmt::Display for JointKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}

/// The range, the speed, the acceleration and the jerk that a joint allows. What the file does not say is infinite: unknown,
/// and not checked.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Limits {
    /// Smallest position \[rad\] or \[m\].
    pub lower: f64,
    /// Largest position \[rad\] or \[m\].
    pub upper: f64,
    /// Largest speed in either direction [rad/s] or [m/s].
    pub velocity: f64,
    /// Largest acceleration in either direction [rad/s^2] or [m/s^2].
    pub acceleration: f64,
    /// Largest jerk in either direction [rad/s^3] or [m/s^3].
    pub jerk: f64,
}

impl Limits {
    /// The limits of a joint of which none is known: all infinite.
    pub const UNLIMITED: Limits = Limits {
        lower: f64::NEG_INFINITY,
        upper: f64::INFINITY,
        velocity: f64::INFINITY,
        acceleration: f64::INFINITY,
        jerk: f64::INFINITY,
    };

    /// Whether `position` is inside the range; what is not finite never is.
    pub fn contains(&self, position: f64) -> bool {
        position.is_finite() && self.lower <= position && position <= self.upper
    }

    /// Returns what both allow: of two joints that are one, or of a joint of which two files speak.
    ///
    /// ```
    /// use kinstep::robot::Limits;
    /// let slow = Limits { velocity: 1.0, ..Limits::UNLIMITED };
    /// let short = Limits { lower: -0.5, upper: 0.5, velocity: 2.0, ..Limits::UNLIMITED };
    /// assert_eq!(slow.narrowed_by(&short), Limits { velocity: 1.0, ..short });
    /// ```
    #[must_use]
    pub fn narrowed_by(&self, other: &Limits) -> Limits {
        Limits {
            lower: self.lower.max(other.lower),
            upper: self.upper.min(other.upper),
            velocity: self.velocity.min(other.velocity),
            acceleration: self.acceleration.min(other.acceleration),
            jerk: self.jerk.min(other.jerk),
        }
    }
}

/// How a joint follows another: `position = multiplier * driver + offset`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mimic {
    /// Index of the joint that is followed; never a mimic joint itself, because mimic chains are folded.
    pub driver: usize,
    /// Ratio of the positions (and of the velocities), not zero.
    pub multiplier: f64,
    /// Position at driver position zero \[rad\] or \[m\].
    pub offset: f64,
}

impl Mimic {
    /// Returns how a joint that follows another one like this moves with what that one follows:
    /// `m (m' x + o') + o = (m m') x + (m o' + o)`.
    pub(super) fn through(self, followed: Mimic) -> Mimic {
        let Mimic { multiplier, offset, .. } = self;
        Mimic {
            driver: followed.driver,
            multiplier: multiplier * followed.multiplier,
            offset: multiplier * followed.offset + offset,
        }
    }
}

/// Why a joint or a link can not be used, and where the file says so.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Defect {
    /// The reason, as a sentence.
    pub reason: String,
    /// Line of the defect in the file, counted from 1.
    pub line: usize,
    /// Column of the defect in the file, counted from 1.
    pub column: usize,
}

/// A rigid body.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Link {
    /// The link's name, unique in the robot.
    pub name: String,
    /// Index of the joint above the link; `None` for a root.
    pub parent_joint: Option<usize>,
    /// What is wrong with the link; where something is, no chain can pass through it.
    pub defect: Option<Defect>,
}

/// A joint between two links.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Joint {
    /// The joint's name.
    pub name: String,
    /// How the joint moves.
    pub kind: JointKind,
    /// Index of the link above the joint.
    pub parent: usize,
    /// Index of the link below the joint; always greater than `parent`.
    pub child: usize,
    /// Pose of the child's frame in the parent's at joint position zero.
    pub origin: IsometryMatrix3<f64>,
    /// Unit axis in the child's frame; x where the joint is fixed.
    pub axis: Vector3<f64>,
    /// The joint's own limits (of a mimic joint too).
    pub limits: Limits,
    /// How the joint follows another; `None` where it moves by itself, or not at all.
    pub mimic: Option<Mimic>,
    /// What the joint follows by its own `<mimic>`: perhaps a joint that follows another one itself. What is done to that
    /// one reaches this one.
    pub(super) follows: Option<Mimic>,
    /// What is wrong with the joint; where something is, no chain can pass through it.
    pub defect: Option<Defect>,
    /// Roll, pitch and yaw that `origin` was made from, where they are known: bits that the matrix does not give back.
    pub(super) angles: Option<[f64; 3]>,
}

impl Joint {
    /// Moves the joint's origin; the angles stay known where its rotation stays the same.
    pub(super) fn place(&mut self, origin: IsometryMatrix3<f64>) {
        self.angles = self.angles.filter(|_| origin.rotation == self.origin.rotation);
        self.origin = origin;
    }
}

/// A joint that the file has but the tree can not hold (an undefined link, a second parent, a loop).
#[derive(Debug, Clone)]
pub(super) struct Stray {
    pub(super) name: String,
    pub(super) parent: String,
    pub(super) child: String,
    pub(super) defect: Defect,
}

/// A robot: links and joints in flat arrays, every parent before its children.
///
/// A robot never changes; everything that is computed lives in a [`ChainScratch`](super::ChainScratch).
#[derive(Debug, Clone)]
pub struct Robot {
    pub(super) name: String,
    pub(super) links: Vec<Link>,
    pub(super) joints: Vec<Joint>,
    pub(super) strays: Vec<Stray>,
    pub(super) link_by_name: HashMap<String, usize>,
    pub(super) diagnostics: Vec<Diagnostic>,
}

impl Robot {
    /// A robot of links depth first and their joints in that order.
    pub(super) fn assembled(name: String, links: Vec<Link>, joints: Vec<Joint>) -> Robot {
        let link_by_name = links.iter().enumerate().map(|(i, link)| (link.name.clone(), i)).collect();
        Robot { name, links, joints, strays: Vec::new(), link_by_name, diagnostics: Vec::new() }
    }

    /// Returns the robot's name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Returns all links, every parent before its children, children in the order of the file.
    pub fn links(&self) -> &[Link] {
        &self.links
    }

    /// Returns the joints of the tree, in the order of their child links.
    pub fn joints(&self) -> &[Joint] {
        &self.joints
    }

    /// Returns everything that was found in the robot's file, by place.
    pub fn diagnostics(&self) -> &[Diagnostic] {
        &self.diagnostics
    }

    /// Returns the link of that name.
    pub fn link(&self, name: &str) -> Option<&Link> {
        self.link_by_name.get(name).map(|&index| &self.links[index])
    }

    /// Returns the joint of that name.
    pub fn joint(&self, name: &str) -> Option<&Joint> {
        self.joints.iter().find(|joint| joint.name == name)
    }

    /// Returns the links that hang from no joint.
    pub fn roots(&self) -> impl Iterator<Item = &Link> {
        self.links.iter().filter(|link| link.parent_joint.is_none())
    }

    /// Returns the links from which no joint hangs: the usual tips.
    pub fn leaves(&self) -> impl Iterator<Item = &Link> {
        let mut has_child = vec![false; self.links.len()];
        for joint in &self.joints {
            has_child[joint.parent] = true;
        }
        self.links.iter().zip(has_child).filter(|(_, has_child)| !has_child).map(|(link, _)| link)
    }
}
