//! Robots with other limits than their files give.

use thiserror::Error;

use super::{JointKind, Limits, Robot, names};

/// Why limits do not fit a robot.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum LimitsError {
    /// A joint that the robot does not have.
    #[error("the robot has no joint {}{}", names::quote(.name), known_joints(.nearest, .known))]
    UnknownJoint {
        /// The name asked for.
        name: String,
        /// The joints whose names look like it, nearest first.
        nearest: Vec<String>,
        /// The names of all joints of the robot.
        known: Vec<String>,
    },
    /// A joint that has no single position.
    #[error("joint {} is {kind}: it has no position that could be limited", names::quote(.joint))]
    NoPosition {
        /// Name of the joint.
        joint: String,
        /// Type of the joint.
        kind: JointKind,
    },
    /// Limits that leave a joint no motion, or are not numbers.
    #[error("joint {}: {problem}", names::quote(.joint))]
    Impossible {
        /// Name of the joint.
        joint: String,
        /// What is wrong with the limits.
        problem: String,
    },
}

fn known_joints(nearest: &[String], known: &[String]) -> String {
    if nearest.is_empty() {
        format!("; its joints are {}", names::short_list(known, "and"))
    } else {
        names::suggestion(nearest)
    }
}

impl Robot {
    /// Returns the robot with these limits of a joint in place of its own. A continuous joint whose range is finite then is
    /// revolute.
    ///
    /// # Errors
    /// [`LimitsError`]: a joint that the robot does not have (with the nearest names) or that has no single position, a range
    /// without a position in it, a NaN, or a velocity, acceleration or jerk that is not positive.
    ///
    /// ```
    /// use kinstep::robot::{Limits, embedded};
    /// let panda = embedded::get("panda")?;
    /// let own = panda.joint("panda_joint1").expect("it is there").limits;
    /// let slow = panda.with_limits("panda_joint1", Limits { acceleration: 3.75, ..own })?;
    /// assert_eq!(slow.chain("panda_link0", "panda_link8")?.joints()[0].limits.acceleration, 3.75);
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn with_limits(&self, joint: &str, limits: Limits) -> Result<Robot, LimitsError> {
        let index = self.joint_index(joint).ok_or_else(|| LimitsError::UnknownJoint {
            name: joint.to_owned(),
            nearest: self.joints_like(joint),
            known: self.joints.iter().map(|joint| joint.name.clone()).collect(),
        })?;
        let mut robot = self.clone();
        let own = &mut robot.joints[index];
        if !own.kind.is_movable() {
            return Err(LimitsError::NoPosition { joint: joint.to_owned(), kind: own.kind });
        }
        if let Some(problem) = problem(&limits) {
            return Err(LimitsError::Impossible { joint: joint.to_owned(), problem });
        }
        let is_bounded = limits.lower.is_finite() || limits.upper.is_finite();
        if own.kind == JointKind::Continuous && is_bounded {
            own.kind = JointKind::Revolute;
        }
        own.limits = limits;
        Ok(robot)
    }
}

fn problem(limits: &Limits) -> Option<String> {
    let Limits { lower, upper, velocity, acceleration, jerk } = *limits;
    if !(lower <= upper && lower < f64::INFINITY && upper > f64::NEG_INFINITY) {
        return Some(format!("no position lies between {lower} and {upper}"));
    }
    let motion = [("velocity", velocity), ("acceleration", acceleration), ("jerk", jerk)];
    let held = motion.into_iter().find(|(_, limit)| !(*limit > 0.0));
    held.map(|(what, limit)| format!("a {what} limit of {limit} lets it never move; give a positive one"))
}
