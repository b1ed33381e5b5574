use super::axes::{Axes, MovingAxes};
use super::mask::{Mask, Row};
use super::path_axes::PathAxes;
use crate::task::{Motion, Reference};
use nalgebra::{IsometryMatrix3, Rotation3};

/// The masked rows of a pose that follows a motion.
#[derive(Debug)]
pub(in crate::task) struct PoseRows {
    pub(in crate::task) mask: Mask,
    motion: Motion,
    base: Rotation3<f64>,
    path_axes: Option<PathAxes>,
}

impl PoseRows {
    /// The rows of that mask, with base axes that are turned by `base` in the frame in which the motion is given.
    ///
    /// # Errors
    /// The end of a sentence that begins with the path, where path axes are asked for and not defined.
    pub(in crate::task) fn new(mask: Mask, motion: Motion, base: Rotation3<f64>) -> Result<Self, String> {
        let path_axes = (mask.axes() == Axes::Path).then(|| PathAxes::of(&motion)).transpose()?;
        Ok(Self { mask, motion, base, path_axes })
    }

    /// The rows of a mask whose axes are those of the frame in which the motion is given.
    pub(in crate::task) fn in_base_axes(mask: Mask, motion: Motion) -> Self {
        Self { mask, motion, base: Rotation3::identity(), path_axes: None }
    }

    /// Where the pose shall be at time `t` \[s\], and the axes then.
    pub(in crate::task) fn at(&self, t: f64) -> (Reference, MovingAxes) {
        let axes =
            self.path_axes.map_or_else(|| MovingAxes::fixed(self.base), |axes| axes.at(&self.motion, t));
        (self.motion.at(t), axes)
    }

    /// Hands out the rows of the pose at time `t` \[s\].
    pub(in crate::task) fn write(&self, t: f64, pose: &IsometryMatrix3<f64>, write: impl FnMut(usize, Row)) {
        let (reference, axes) = self.at(t);
        self.mask.write(pose, &reference, &axes, write);
    }
}
