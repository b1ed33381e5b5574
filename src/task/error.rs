use super::Reference;
use crate::math::rotation_vector;
use nalgebra::{IsometryMatrix3, Vector6};
use serde::{Deserialize, Serialize};

/// Which components of the tip's pose a task asks for.
///
/// Every kind takes the leading rows of the geometric Jacobian (linear first, then angular).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "cli", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum TaskKind {
    /// The x and y coordinates of the tip in the world \[m\].
    PositionXy,
    /// The tip's position in the world \[m\].
    Position,
    /// Position \[m\] and orientation \[rad\].
    Pose,
}

impl TaskKind {
    /// Every kind, for listings.
    pub const ALL: [Self; 3] = [Self::PositionXy, Self::Position, Self::Pose];

    /// The name used in scenario files.
    pub fn name(self) -> &'static str {
        match self {
            Self::PositionXy => "position-xy",
            Self::Position => "position",
            Self::Pose => "pose",
        }
    }

    /// Number of components.
    pub fn rows(self) -> usize {
        match self {
            Self::PositionXy => 2,
            Self::Position => 3,
            Self::Pose => 6,
        }
    }

    /// The task error `(p - p_d; log(R R_d^T)^vee)`, cut to the rows of the kind (the rest is zero).
    ///
    /// The orientation part has length at most pi and lies in the same axes as the angular rows of the Jacobian.
    pub fn error(self, tip: &IsometryMatrix3<f64>, reference: &Reference) -> Vector6<f64> {
        let offset = tip.translation.vector - reference.position;
        match self {
            Self::PositionXy => Vector6::new(offset.x, offset.y, 0.0, 0.0, 0.0, 0.0),
            Self::Position => Vector6::new(offset.x, offset.y, offset.z, 0.0, 0.0, 0.0),
            Self::Pose => {
                let turn = rotation_vector(&(tip.rotation * reference.rotation.inverse()));
                Vector6::new(offset.x, offset.y, offset.z, turn.x, turn.y, turn.z)
            }
        }
    }
}
