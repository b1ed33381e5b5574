//! A directed path between two links, folded for kinematics.

use nalgebra::IsometryMatrix3;

use super::segment::{Folded, Frame, Single};
use super::{JointKind, Limits};

/// A joint of a chain: one column of its Jacobian.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct ChainJoint {
    /// The joint's name; where mimic joints are on the path, the name of the joint that drives them.
    pub name: String,
    /// How the joint moves.
    pub kind: JointKind,
    /// The joint's limits, narrowed by those of the mimic joints on the path that follow it; infinite where unknown.
    pub limits: Limits,
}

/// A joint position outside its limits, or not a number.
#[derive(Debug, Clone, PartialEq)]
pub struct LimitViolation {
    /// Index of the joint in [`Chain::joints`].
    pub index: usize,
    /// The joint's name.
    pub joint: String,
    /// The position \[rad\] or \[m\].
    pub value: f64,
    /// The smallest position that the joint allows \[rad\] or \[m\].
    pub lower: f64,
    /// The largest position that the joint allows \[rad\] or \[m\].
    pub upper: f64,
}

/// The directed path from one link (`base`) to another (`tip`): what a task moves.
///
/// The path runs up and down the tree through the common ancestor. Fixed joints are merged into constants and
/// every moving axis is turned onto z, so that the pose of the tip in the base is
/// `C_0 M_1 C_1 M_2 ... M_k C_k` with constants `C_i` and `M_i` a turn about z or a shift along z by
/// `multiplier * q_column`. The constants are brought into a form in which parallel and perpendicular axes and zero
/// offsets cost nothing. Mimic joints share the column of the joint that drives them.
///
/// ```
/// use kinstep::robot::Robot;
/// let robot = Robot::from_urdf(
///     r#"<robot name="pendulum">
///          <link name="base"/> <link name="rod"/> <link name="bob"/>
///          <joint name="pivot" type="continuous">
///            <parent link="base"/> <child link="rod"/> <axis xyz="0 1 0"/>
///          </joint>
///          <joint name="length" type="fixed">
///            <parent link="rod"/> <child link="bob"/> <origin xyz="0 0 -2"/>
///          </joint>
///        </robot>"#,
/// )?;
/// let chain = robot.chain("base", "bob")?;
/// let mut scratch = chain.scratch();
/// let posed = chain.forward(&[std::f64::consts::FRAC_PI_2], &mut scratch);
/// assert!((posed.pose().translation.x + 2.0).abs() < 1e-15);
/// assert_eq!(chain.reach(), 2.0);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct Chain {
    pub(super) base: String,
    pub(super) tip: String,
    pub(super) joints: Vec<ChainJoint>,
    pub(super) reach: f64,
    pub(super) folded: Folded<Single>,
    pub(super) places: Vec<Place>,
}

/// Which joint moves a segment: by `multiplier q_column`.
#[derive(Debug, Clone)]
pub(super) struct Place {
    pub(super) multiplier: f64,
    pub(super) column: usize,
    /// Whether it is the first of its column on the path.
    pub(super) opens_column: bool,
}

impl Chain {
    /// Returns the number of joints: the length of `q` and the number of Jacobian columns.
    pub fn dof(&self) -> usize {
        self.joints.len()
    }

    /// Returns the number of axes that move: those of its joints, and of joints on the way that follow one of them.
    pub fn moving_axes(&self) -> usize {
        self.places.len()
    }

    /// Returns the joints that the pose depends on, one per Jacobian column, in path order. A joint off the path that
    /// moves joints on the path takes the place of the first of them.
    pub fn joints(&self) -> &[ChainJoint] {
        &self.joints
    }

    /// Returns the name of the link where the path begins.
    pub fn base(&self) -> &str {
        &self.base
    }

    /// Returns the name of the link where the path ends.
    pub fn tip(&self) -> &str {
        &self.tip
    }

    /// Returns an upper bound \[m\] of the distance from the first moving joint to the tip: the lengths of all
    /// constant translations after that joint plus the travel of the prismatic joints within their limits.
    /// Infinite when a prismatic joint has no limits, zero when nothing moves.
    pub fn reach(&self) -> f64 {
        self.reach
    }

    /// Returns the same chain with the pose of its base in the world folded in front: poses and Jacobians are
    /// then those of the tip in the world, in the world's axes.
    #[must_use]
    pub fn mounted(&self, world_from_base: &IsometryMatrix3<f64>) -> Chain {
        let mut mounted = self.clone();
        let start = self.folded.start.map(|[entry]| entry).isometry();
        mounted.folded.start = Frame::new(&(world_from_base * start)).map(|entry| [entry]);
        mounted
    }

    /// Returns the smallest and largest position of each joint \[rad\] or \[m\], in the order of `q`.
    pub fn position_limits(&self) -> impl Iterator<Item = (f64, f64)> {
        self.joints.iter().map(|joint| (joint.limits.lower, joint.limits.upper))
    }

    /// Returns whether every position of `q` is within its joint's limits; false for NaN and for a `q` of another
    /// length.
    pub fn within_limits(&self, q: &[f64]) -> bool {
        q.len() == self.dof() && self.joints.iter().zip(q).all(|(joint, &q)| joint.limits.contains(q))
    }

    /// Returns the joints whose positions lie outside their limits, in the order of `q`.
    pub fn limit_violations<'a>(&'a self, q: &'a [f64]) -> impl Iterator<Item = LimitViolation> + 'a {
        let outside = |&(_, (joint, &q)): &(usize, (&ChainJoint, &f64))| !joint.limits.contains(q);
        self.joints.iter().zip(q).enumerate().filter(outside).map(|(index, (joint, &value))| LimitViolation {
            index,
            joint: joint.name.clone(),
            value,
            lower: joint.limits.lower,
            upper: joint.limits.upper,
        })
    }
}
