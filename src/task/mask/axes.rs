use nalgebra::{Rotation3, Vector3};

/// The axes in which the rows of a task are counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Axes {
    /// Those of the frame in which the path is laid, which do not move: of an arm its base as it is mounted, of a relative pose the
    /// first tip.
    #[default]
    Base,
    /// Those of the tip, which turn with it.
    Tip,
    /// Those of the path: x along its tangent, y and z across it. y is `k x tangent` with the first of z, y and x of the frame in
    /// which the path is laid that it never comes near to as `k`: for a path in the plane of x and y, z points up.
    Path,
}

impl Axes {
    /// All of them, for listings.
    pub const ALL: [Self; 3] = [Self::Base, Self::Tip, Self::Path];

    /// The name in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Base => "base",
            Self::Tip => "tip",
            Self::Path => "path",
        }
    }

    /// The axes of that name.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|axes| axes.name() == name)
    }
}

/// Axes at an instant, and how they turn by themselves.
#[derive(Clone, Copy, Debug)]
pub(in crate::task) struct MovingAxes {
    /// Its columns are the axes.
    pub(super) columns: Rotation3<f64>,
    /// Their angular velocity [rad/s].
    pub(super) rate: Vector3<f64>,
}

impl MovingAxes {
    /// Axes that stay.
    pub(super) fn fixed(columns: Rotation3<f64>) -> Self {
        Self { columns, rate: Vector3::zeros() }
    }
}
