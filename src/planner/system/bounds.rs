//! The bounds of a task error, and what counts as near a singularity.

use crate::law::Resolution;
use nalgebra::Vector6;

/// The task error at which a run is stopped, as a fraction of the chain's reach.
const LOST_FRACTION_OF_REACH: f64 = 0.1;
/// The orientation error at which a run is stopped \[rad\].
const LOST_ORIENTATION: f64 = 1.0;
/// The fraction of those bounds that an arm with fewer joints than task components is held to: the error of a path that it
/// can not follow does not grow, it just stays.
const WITH_TOO_FEW_JOINTS: f64 = 0.01;
/// Within this many thresholds a configuration counts as near a singularity.
const NEAR: f64 = 10.0;

/// The squared lengths of a task error.
#[derive(Clone, Copy, Debug)]
pub(in crate::planner) struct Deviation {
    /// \[m^2\]
    pub(in crate::planner) position: f64,
    /// \[rad^2\]
    pub(in crate::planner) orientation: f64,
}

impl Deviation {
    pub(in crate::planner) fn of(e: &Vector6<f64>) -> Self {
        Self {
            position: e[0] * e[0] + e[1] * e[1] + e[2] * e[2],
            orientation: e[3] * e[3] + e[4] * e[4] + e[5] * e[5],
        }
    }

    /// Whether neither part is larger than that of the other; false for NaN.
    pub(in crate::planner) fn is_within(&self, largest: &Self) -> bool {
        self.position <= largest.position && self.orientation <= largest.orientation
    }
}

/// What a task error is measured by.
#[derive(Clone, Copy, Debug)]
pub(in crate::planner) struct Bounds {
    /// The reach of the tips \[m\].
    pub(in crate::planner) length: f64,
    /// Whether the system has fewer joints than task rows.
    pub(in crate::planner) has_too_few_joints: bool,
}

impl Bounds {
    /// The largest deviation that lies within this fraction of the bounds.
    pub(in crate::planner) fn largest(&self, fraction: f64) -> Deviation {
        let fraction = if self.has_too_few_joints { WITH_TOO_FEW_JOINTS * fraction } else { fraction };
        Deviation {
            position: (fraction * (LOST_FRACTION_OF_REACH * self.length)).powi(2),
            orientation: (fraction * LOST_ORIENTATION).powi(2),
        }
    }
}

/// What tells that a sample needs no closer look: the arm is within its bounds and not near a singularity.
#[derive(Clone, Copy, Debug)]
pub(in crate::planner) struct StopCriteria {
    /// The least bound of the smallest singular value.
    pub(in crate::planner) conditioning: f64,
    /// The largest task error.
    pub(in crate::planner) deviation: Deviation,
}

impl StopCriteria {
    /// The criteria of an arm whose law calls a configuration singular below `threshold`.
    pub(in crate::planner) fn new(bounds: &Bounds, threshold: f64) -> Self {
        Self { conditioning: NEAR * threshold, deviation: bounds.largest(1.0) }
    }

    /// Whether a resolution was near a singularity.
    pub(in crate::planner) fn is_near_singular(&self, resolution: &Resolution) -> bool {
        resolution.smallest_singular_value < self.conditioning
    }
}
