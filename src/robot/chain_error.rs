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
        /// What else the name may be, or the names there are.
        hint: String,
    },
    /// Base and tip are one link.
    #[error("base and tip are both {}: a chain needs two links, because nothing moves in between", names::quote(.link))]
    SameLink {
        /// The link.
        link: String,
    },
    /// No joints connect the two.
    #[error("no joints connect {} and {}: {reason}", names::quote(.base), names::quote(.tip))]
    NotConnected {
        /// Where the path would begin.
        base: String,
        /// Where it would end.
        tip: String,
        /// What separates them.
        reason: String,
    },
    /// A joint on the path is defective.
    #[error("the path from {} to {} passes joint {}, which is defective (line {}): {}",
            names::quote(.base), names::quote(.tip), names::quote(.joint), .defect.line, .defect.reason)]
    DefectiveJoint {
        /// Where the path begins.
        base: String,
        /// Where it ends.
        tip: String,
        /// The joint.
        joint: String,
        /// What is wrong with it.
        defect: Defect,
    },
    /// A link on the path is defective.
    #[error("the path from {} to {} passes link {}, which is defective (line {}): {}",
            names::quote(.base), names::quote(.tip), names::quote(.link), .defect.line, .defect.reason)]
    DefectiveLink {
        /// Where the path begins.
        base: String,
        /// Where it ends.
        tip: String,
        /// The link.
        link: String,
        /// What is wrong with it.
        defect: Defect,
    },
    /// A joint on the path has more than one degree of freedom.
    #[error("the path from {} to {} passes joint {} of type {kind}, which a chain can not carry; choose base and \
             tip on one side of it", names::quote(.base), names::quote(.tip), names::quote(.joint))]
    UnsupportedJoint {
        /// Where the path begins.
        base: String,
        /// Where it ends.
        tip: String,
        /// The joint.
        joint: String,
        /// Its type.
        kind: JointKind,
    },
    /// The limits of a joint and of its followers on the path exclude each other.
    #[error("no position of joint {} satisfies its own limits and those of {}, which follows it",
            names::quote(.joint), names::quote(.follower))]
    EmptyRange {
        /// The joint that drives.
        joint: String,
        /// The mimic joint that leaves it no room.
        follower: String,
    },
}
