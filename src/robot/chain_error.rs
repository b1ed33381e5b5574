//! Why there is no chain between two links.

use thiserror::Error;

use super::{Defect, JointKind, names};

/// Why there is no chain between two links.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum ChainError {
    /// A link that the robot does not have.
    #[error("the robot has no link {}{}{}", names::quote(.name), names::suggestion(.nearest), .hint)]
    UnknownLink {
        /// The name asked for.
        name: String,
        /// The links whose names look like it, nearest first.
        nearest: Vec<String>,
        /// What else the name may be, or the names of the robot's links.
        hint: String,
    },
    /// Base and tip are the same link.
    #[error("base and tip are both {}: a chain needs two links, because nothing moves in between", names::quote(.link))]
    SameLink {
        /// The link that is both base and tip.
        link: String,
    },
    /// No joints connect base and tip.
    #[error("no joints connect {} and {}: {reason}", names::quote(.base), names::quote(.tip))]
    NotConnected {
        /// The link where the path would begin.
        base: String,
        /// The link where the path would end.
        tip: String,
        /// What separates the two links.
        reason: String,
    },
    /// A joint on the path is defective.
    #[error("the path from {} to {} passes joint {}, which is defective (line {}): {}",
            names::quote(.base), names::quote(.tip), names::quote(.joint), .defect.line, .defect.reason)]
    DefectiveJoint {
        /// The link where the path begins.
        base: String,
        /// The link where the path ends.
        tip: String,
        /// The joint on the path.
        joint: String,
        /// What is wrong with the joint.
        defect: Defect,
    },
    /// A link on the path is defective.
    #[error("the path from {} to {} passes link {}, which is defective (line {}): {}",
            names::quote(.base), names::quote(.tip), names::quote(.link), .defect.line, .defect.reason)]
    DefectiveLink {
        /// The link where the path begins.
        base: String,
        /// The link where the path ends.
        tip: String,
        /// The link on the path.
        link: String,
        /// What is wrong with the link.
        defect: Defect,
    },
    /// A joint on the path has more than one degree of freedom.
    #[error("the path from {} to {} passes joint {} of type {kind}, which a chain can not carry; choose base and \
             tip on one side of it", names::quote(.base), names::quote(.tip), names::quote(.joint))]
    UnsupportedJoint {
        /// The link where the path begins.
        base: String,
        /// The link where the path ends.
        tip: String,
        /// The joint on the path.
        joint: String,
        /// Type of the joint.
        kind: JointKind,
    },
    /// The limits of a joint and of its followers on the path exclude each other.
    #[error("no position of joint {} satisfies its own limits and those of {}, which follows it",
            names::quote(.joint), names::quote(.follower))]
    EmptyRange {
        /// The joint that is followed.
        joint: String,
        /// The mimic joint whose own limits leave the followed joint no position.
        follower: String,
    },
}
