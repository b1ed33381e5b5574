//! Joints held at a position: from then on constants.

use nalgebra::{IsometryMatrix3, Rotation3, Translation3, Vector3};
use thiserror::Error;

use super::displacement::displacement;
use super::size::unbelievable;
use super::{Defect, Joint, JointKind, Limits, Robot, names};

/// Why a joint can not be locked.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum LockError {
    /// A joint that the robot does not have.
    #[error("the robot has no joint {} to lock{}{}", names::quote(.name), names::suggestion(.nearest), .hint)]
    UnknownJoint {
        /// The name asked for.
        name: String,
        /// The joints whose names look like it, nearest first.
        nearest: Vec<String>,
        /// What else the name may be.
        hint: String,
    },
    /// A joint whose values could not be read.
    #[error("joint {} can not be locked, because it is defective (line {}): {}", names::quote(.joint), .defect.line, .defect.reason)]
    Defective {
        /// Name of the joint.
        joint: String,
        /// What is wrong with the joint.
        defect: Defect,
    },
    /// A joint that is fixed already.
    #[error("joint {} is fixed already; lock a joint that moves", names::quote(.joint))]
    Fixed {
        /// Name of the joint.
        joint: String,
    },
    /// Too few or too many numbers for the kind of joint.
    #[error("joint {} is {kind} and is locked at {}, not at {count} numbers", names::quote(.joint), wanted(*.kind))]
    Count {
        /// Name of the joint.
        joint: String,
        /// Type of the joint.
        kind: JointKind,
        /// How many numbers were given.
        count: usize,
    },
    /// A position that the joint does not reach, or no number.
    #[error("joint {} can not be locked at {value}: it moves between {lower} and {upper}", names::quote(.joint))]
    OutsideLimits {
        /// Name of the joint.
        joint: String,
        /// The position asked for [rad or m].
        value: f64,
        /// The smallest position that the joint allows [rad or m].
        lower: f64,
        /// The largest position that the joint allows [rad or m].
        upper: f64,
    },
    /// A pose that the joint can not take.
    #[error("joint {} can not be locked there: it is {kind}, and {problem}", names::quote(.joint))]
    Pose {
        /// Name of the joint.
        joint: String,
        /// Type of the joint.
        kind: JointKind,
        /// How the joint moves, which the pose does not fit.
        problem: &'static str,
    },
    /// A position, or a number of a pose, that no arm has.
    #[error("joint {} can not be locked there: {problem}", names::quote(.joint))]
    Size {
        /// Name of the joint that would stand there: the one to be locked, or one that follows it.
        joint: String,
        /// What is wrong with the number.
        problem: String,
    },
    /// A position at which a joint that follows would leave its own limits.
    #[error("joint {} can not be locked at {position}: {}, which follows it, would stand at {value}, and moves between \
             {lower} and {upper}", names::quote(.joint), names::quote(.follower))]
    Follower {
        /// Name of the joint.
        joint: String,
        /// The position asked for [rad or m].
        position: f64,
        /// The joint that follows it.
        follower: String,
        /// Where the follower would stand [rad or m].
        value: f64,
        /// The smallest position that the follower allows [rad or m].
        lower: f64,
        /// The largest position that the follower allows [rad or m].
        upper: f64,
    },
}

fn wanted(kind: JointKind) -> &'static str {
    if kind.is_movable() {
        "one number"
    } else {
        "a finite pose, six numbers x y z roll pitch yaw, or at 0 for none"
    }
}

impl Robot {
    /// Returns the robot with a joint held still: chains pass through it as through a fixed joint, and joints that
    /// follow it, at first hand or through others, stand still with it. A joint that follows another follows it no longer
    /// once it is held: the other moves on without it.
    ///
    /// A joint with one degree of freedom is held at one position \[rad\] or \[m\], within its limits. A floating, planar
    /// or spherical joint is held at the pose of its child, `x y z roll pitch yaw` \[m, rad\] as in URDF, after its
    /// origin; the single number 0 is the pose that moves nothing.
    ///
    /// # Errors
    /// [`LockError`]: no such joint (with the nearest names), a defective or a fixed one, too few or too many numbers, a
    /// position outside its limits or those of a joint that follows it, or a number beyond any arm.
    ///
    /// ```
    /// use kinstep::robot::embedded;
    /// let robot = embedded::get("panda")?.with_locked("panda_joint1", &[0.5])?;
    /// assert_eq!(robot.chain("panda_link0", "panda_hand")?.dof(), 6);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn with_locked(&self, joint: &str, values: &[f64]) -> Result<Robot, LockError> {
        let index = self.joint_index(joint).ok_or_else(|| self.no_such_joint(joint))?;
        let own = &self.joints[index];
        if let Some(defect) = own.defect.clone() {
            return Err(LockError::Defective { joint: joint.to_owned(), defect });
        }
        if own.kind == JointKind::Fixed {
            return Err(LockError::Fixed { joint: joint.to_owned() });
        }
        let held = held(own, values)?;
        let mut robot = self.clone();
        fix(&mut robot.joints[index], &held);
        if let [position] = *values {
            robot.still_followers(index, position)?;
        }
        Ok(robot)
    }

    /// Fixes the joints that follow a joint which stands at `position`, at first hand or through others.
    fn still_followers(&mut self, driver: usize, position: f64) -> Result<(), LockError> {
        let followers = self.followers();
        let mut standing = vec![(driver, position)];
        while let Some((followed, at)) = standing.pop() {
            for &index in &followers[followed] {
                let joint = &self.joints[index];
                let own = joint.follows.map_or(0.0, |follows| follows.multiplier * at + follows.offset);
                let Limits { lower, upper, .. } = joint.limits;
                // The follower's position carries the rounding of its ratio.
                let slack = 1e-12 * own.abs().max(1.0);
                if !(lower - slack <= own && own <= upper + slack) {
                    let (joint, follower) = (self.joints[driver].name.clone(), joint.name.clone());
                    return Err(LockError::Follower { joint, position, follower, value: own, lower, upper });
                }
                if unbelievable(own).is_some() {
                    return Err(too_large(joint, own));
                }
                let held = displacement(joint.kind, joint.axis, own);
                fix(&mut self.joints[index], &held);
                standing.push((index, own));
            }
        }
        Ok(())
    }

    fn no_such_joint(&self, name: &str) -> LockError {
        if let Some(stray) = self.strays.iter().find(|stray| stray.name == name) {
            return LockError::Defective { joint: name.to_owned(), defect: stray.defect.clone() };
        }
        let above = self.link(name).and_then(|link| link.parent_joint).map(|joint| &self.joints[joint].name);
        let nearest = self.joints_like(name);
        let hint = match above {
            Some(above) => {
                format!("; {} is a link, the joint above it is {}", names::quote(name), names::quote(above))
            }
            None if nearest.is_empty() => {
                let moving = self.joints.iter().filter(|joint| joint.kind != JointKind::Fixed);
                let moving: Vec<&str> = moving.map(|joint| joint.name.as_str()).collect();
                format!("; the joints that move are {}", names::short_list(&moving, "and"))
            }
            None => String::new(),
        };
        LockError::UnknownJoint { name: name.to_owned(), nearest, hint }
    }
}

/// The motion at which a joint is held.
fn held(joint: &Joint, values: &[f64]) -> Result<IsometryMatrix3<f64>, LockError> {
    let is_large = |value: &f64| value.is_finite() && unbelievable(*value).is_some();
    if let Some(&value) = values.iter().find(|value| is_large(value)) {
        return Err(too_large(joint, value));
    }
    let count = || LockError::Count { joint: joint.name.clone(), kind: joint.kind, count: values.len() };
    match *values {
        [value] if joint.kind.is_movable() => {
            let Limits { lower, upper, .. } = joint.limits;
            if !joint.limits.contains(value) {
                return Err(LockError::OutsideLimits { joint: joint.name.clone(), value, lower, upper });
            }
            Ok(displacement(joint.kind, joint.axis, value))
        }
        [0.0] if !joint.kind.is_movable() => Ok(IsometryMatrix3::identity()),
        [x, y, z, roll, pitch, yaw] if !joint.kind.is_movable() && values.iter().all(|v| v.is_finite()) => {
            let turn = Rotation3::from_euler_angles(roll, pitch, yaw);
            let pose = IsometryMatrix3::from_parts(Translation3::from(Vector3::new(x, y, z)), turn);
            match pose_problem(joint, &pose) {
                Some(problem) => {
                    Err(LockError::Pose { joint: joint.name.clone(), kind: joint.kind, problem })
                }
                None => Ok(pose),
            }
        }
        _ => Err(count()),
    }
}

/// Says where a joint with several degrees of freedom can not be brought.
fn pose_problem(joint: &Joint, pose: &IsometryMatrix3<f64>) -> Option<&'static str> {
    /// How far a pose may be off for its few digits \[m\] or \[rad\].
    const SLACK: f64 = 1e-6;
    let (shift, normal) = (pose.translation.vector, joint.axis);
    match joint.kind {
        JointKind::Planar if shift.dot(&normal).abs() > SLACK => {
            Some("moves in the plane normal to its axis alone")
        }
        JointKind::Planar if (pose.rotation * normal - normal).norm() > SLACK => {
            Some("turns about the normal of its plane, its axis, alone")
        }
        JointKind::Spherical if shift.norm() > SLACK => {
            Some("turns about its origin, which stays in its place")
        }
        _ => None,
    }
}

fn too_large(joint: &Joint, value: f64) -> LockError {
    LockError::Size { joint: joint.name.clone(), problem: unbelievable(value).unwrap_or_default() }
}

fn fix(joint: &mut Joint, held: &IsometryMatrix3<f64>) {
    joint.place(joint.origin * held);
    joint.kind = JointKind::Fixed;
    joint.axis = Vector3::x();
    joint.limits = Limits::UNLIMITED;
    (joint.mimic, joint.follows) = (None, None);
}
