//! A joint as the file gives it, before it has a place in a tree.

use nalgebra::UnitQuaternion;

use crate::robot::names::quote;
use crate::robot::report::Report;
use crate::robot::{Defect, JointKind};

/// A name that the file uses, and where.
pub(super) struct Reference {
    pub(super) name: String,
    pub(super) offset: usize,
}

/// A joint as the file gives it.
pub(super) struct RawJoint {
    /// Empty when the file gives none.
    pub(super) name: String,
    pub(super) offset: usize,
    pub(super) kind: Option<JointKind>,
    pub(super) parent: Option<Reference>,
    pub(super) child: Option<Reference>,
    pub(super) mimic: Option<Reference>,
    /// The orientation, when it is given as a quaternion: urdf-rs turns one into angles and loses up to
    /// 4.5e-3 rad near a pitch of 90 degrees, so it is kept from it.
    pub(super) quaternion: Option<UnitQuaternion<f64>>,
    /// Limits that urdf-rs does not know: acceleration and jerk, infinite where the file gives none.
    pub(super) acceleration: f64,
    pub(super) jerk: f64,
    /// The elements that carry values, written for urdf-rs.
    pub(super) values: String,
    /// What urdf-rs read.
    pub(super) read: Option<urdf_rs::Joint>,
    pub(super) defect: Option<Defect>,
}

impl RawJoint {
    /// How messages call it.
    pub(super) fn label(&self) -> String {
        if self.name.is_empty() { "a joint".to_owned() } else { format!("joint {}", quote(&self.name)) }
    }

    /// Reports an error, which makes the joint defective.
    pub(super) fn fail(&mut self, offset: usize, reason: String, report: &mut Report<'_>) {
        report.error(offset, format!("{}: {reason}", self.label()));
        self.defect.get_or_insert_with(|| report.defect(offset, reason));
    }

    pub(super) fn warn(&self, offset: usize, reason: &str, report: &mut Report<'_>) {
        report.warning(offset, format!("{}: {reason}", self.label()));
    }

    pub(super) fn note(&self, offset: usize, reason: &str, report: &mut Report<'_>) {
        report.note(offset, format!("{}: {reason}", self.label()));
    }

    pub(super) fn is_movable(&self) -> bool {
        self.kind.is_some_and(JointKind::is_movable)
    }
}
