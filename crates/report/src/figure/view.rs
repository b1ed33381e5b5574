//! Directions to look from.

use nalgebra::Vector3;

use super::axis::{Axis, Scale};

/// A direction to look from: what is to the right and what is up in the picture.
#[derive(Debug, Clone, Copy)]
pub(super) struct View {
    pub(super) name: &'static str,
    pub(super) title: &'static str,
    pub(super) labels: [&'static str; 2],
    pub(super) right: Vector3<f64>,
    pub(super) up: Vector3<f64>,
}

impl View {
    /// Slanting, from the front, from the side, from above.
    pub(super) fn all() -> [Self; 4] {
        let [x, y, z] = [Vector3::x(), Vector3::y(), Vector3::z()];
        let top = Self { name: "top", title: "from above", labels: ["x [m]", "y [m]"], right: x, up: y };
        let side = Self { name: "side", title: "along y", labels: ["x [m]", "z [m]"], right: x, up: z };
        let front = Self { name: "front", title: "against x", labels: ["y [m]", "z [m]"], right: y, up: z };
        [Self::slanted(), front, side, top]
    }

    fn slanted() -> Self {
        let (azimuth, elevation) = ((-55.0_f64).to_radians(), 25.0_f64.to_radians());
        let right = Vector3::new(-azimuth.sin(), azimuth.cos(), 0.0);
        let (across, along) = (azimuth.cos() * elevation.cos(), azimuth.sin() * elevation.cos());
        let eye = Vector3::new(across, along, elevation.sin());
        let labels = ["across [m]", "up [m]"];
        Self { name: "slanted", title: "slanting", labels, right, up: eye.cross(&right) }
    }

    /// Where a point is seen \[m\].
    pub(super) fn at(&self, point: &Vector3<f64>) -> (f64, f64) {
        (self.right.dot(point), self.up.dot(point))
    }

    /// The axes of a drawing with these ranges.
    pub(super) fn axes(&self, x: (f64, f64), y: (f64, f64)) -> [Axis; 2] {
        let axis = |label: &str, range| {
            let column = label.split(' ').next().unwrap_or_default();
            Axis::new(label, column, Scale::Linear, range)
        };
        [axis(self.labels[0], x), axis(self.labels[1], y)]
    }
}

/// How far values are apart; of none nothing that is positive.
pub(super) fn spread(values: impl Iterator<Item = f64>) -> f64 {
    let (low, high) =
        values.fold((f64::MAX, f64::MIN), |(low, high), value| (low.min(value), high.max(value)));
    high - low
}
