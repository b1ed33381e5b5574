//! Why a collision model can not be made or extended.

use std::path::PathBuf;

use thiserror::Error;

use crate::robot::names::{quote, short_list, suggestion};
use crate::robot::{Diagnostic, summary};

/// Why a collision model can not be made or extended.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum CollisionError {
    /// A link that the robot does not have.
    #[error("the robot has no link {}{}", quote(.name), known_links(.nearest, .known))]
    UnknownLink {
        /// The name asked for.
        name: String,
        /// The links whose names look like it, nearest first.
        nearest: Vec<String>,
        /// The names of all links of the robot.
        known: Vec<String>,
    },
    /// A pair of a link and itself.
    #[error("the pair names {} twice; a pair has two links", quote(.link))]
    SameLink {
        /// The link.
        link: String,
    },
    /// A file of capsules that can not be used: every finding, by place.
    #[error("{}", summary(.0))]
    Text(Vec<Diagnostic>),
    /// A robot that comes without capsules.
    #[error("the embedded robot {} has no capsules; give it some in a file of capsules ([[capsule]] with link, from, to and \
             radius), or name a URDF with `<collision>`", quote(.name))]
    NoCapsules {
        /// Name of the robot.
        name: String,
    },
    /// A file that can not be read.
    #[error("can not read {}: {reason}", crate::robot::names::shown(.path))]
    File {
        /// Path of the file.
        path: PathBuf,
        /// What the operating system says.
        reason: String,
    },
}

fn known_links(nearest: &[String], known: &[String]) -> String {
    if nearest.is_empty() {
        format!("; its links are {}", short_list(known, "and"))
    } else {
        suggestion(nearest)
    }
}
