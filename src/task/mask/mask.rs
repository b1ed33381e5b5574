use super::axes::{Axes, MovingAxes};
use crate::math::{rotation_vector, rotation_vector_rate};
use crate::task::{Component, Reference, TaskKind};
use nalgebra::{IsometryMatrix3, Matrix3, Rotation3, Vector3, Vector6};

/// Which rows of a pose a task asks for, and in which axes: any of the six, and the direction of one axis of the tip.
///
/// With the offset `d = p - p_d`, the turn `phi = log(R R_d^T)^vee` and the axes `a_i` the rows are
///
/// - linear: `e = a_i . d`,
/// - angular: `e = a_i . phi`,
/// - pointing along the tip's axis `n` (`n_d` that of the reference, `theta` between them), for the two other axes `b_j` of the
///   reference: `e = (theta / sin theta) b_j . (n_d x n)`, whatever the tip's turn about `n`.
///
/// Their derivatives are exact off the path too, those of axes that turn with the tip or along the path among them: rows that are
/// left out may grow large. Two limits come with angles: where angular rows are left out, `phi` must stay below a half turn, and
/// `n` must not come to point opposite to `n_d`.
///
/// ```
/// use kinstep::task::{Axes, Component, Mask};
///
/// let across = Mask::of([Component::Linear(1), Component::Linear(2)], Axes::Path).with_pointing(2);
/// assert_eq!((across.rows(), across.name()), (4, "y z in path axes, pointing along z".to_owned()));
/// ```
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mask {
    components: Vec<Component>,
    axes: Axes,
    point: Option<usize>,
}

/// A row of a task about a pose.
#[derive(Clone, Copy, Debug)]
pub(in crate::task) struct Row {
    /// The error [m or rad].
    pub(in crate::task) error: f64,
    /// Its derivative by the twist of the pose (linear; angular).
    pub(in crate::task) direction: Vector6<f64>,
    /// Minus its derivative in time while the pose stays [m/s or rad/s].
    pub(in crate::task) feedforward: f64,
}

impl Mask {
    /// The rows of these components in those axes, in the order x, y, z, rx, ry, rz.
    pub fn of(components: impl IntoIterator<Item = Component>, axes: Axes) -> Self {
        let asked: Vec<Component> = components.into_iter().collect();
        let components = Component::ALL.into_iter().filter(|component| asked.contains(component)).collect();
        Self { components, axes, point: None }
    }

    /// All six rows, in base axes.
    pub fn pose() -> Self {
        Self::of(Component::ALL, Axes::Base)
    }

    /// The same with two more rows: the tip's axis of that index (0, 1, 2 for x, y, z) points where that of the reference does.
    ///
    /// # Panics
    /// If angular rows are asked for already, or the index is none.
    #[must_use]
    pub fn with_pointing(mut self, axis: usize) -> Self {
        assert!(axis < 3, "an axis is 0, 1 or 2");
        assert!(!self.components.iter().any(|own| own.is_angular()), "angular rows say where axes point");
        self.point = Some(axis);
        self
    }

    /// How many rows there are.
    pub fn rows(&self) -> usize {
        self.components.len() + if self.point.is_some() { 2 } else { 0 }
    }

    /// The axes in which they are counted.
    pub fn axes(&self) -> Axes {
        self.axes
    }

    /// Whether it asks for anything of the orientation.
    pub fn turns(&self) -> bool {
        self.point.is_some() || self.components.iter().any(|own| own.is_angular())
    }

    /// What a row measures, in the axes of the mask. The rows of a pointing axis are the turns about the two others.
    pub fn component(&self, row: usize) -> Component {
        let pointing = |i: usize| Component::Angular((self.point.unwrap_or(0) + 1 + i) % 3);
        self.components
            .get(row)
            .copied()
            .unwrap_or_else(|| pointing(row.saturating_sub(self.components.len())))
    }

    /// The rows in words.
    pub fn name(&self) -> String {
        let names: Vec<&str> = self.components.iter().map(|own| own.name()).collect();
        let rows = (!names.is_empty()).then(|| format!("{} in {} axes", names.join(" "), self.axes.name()));
        let pointing = self.point.map(|axis| format!("pointing along {}", Component::NAMES[axis]));
        rows.into_iter().chain(pointing).collect::<Vec<_>>().join(", ")
    }

    /// The kind of task that asks for the same, if there is one, in base axes that are turned like this.
    pub fn plain(&self, base: &Rotation3<f64>) -> Option<TaskKind> {
        let is_plain = self.point.is_none() && self.axes == Axes::Base && *base == Rotation3::identity();
        let leads = |kind: &TaskKind| self.components == Component::ALL[..kind.rows()];
        TaskKind::ALL.into_iter().find(leads).filter(|_| is_plain)
    }

    /// Hands out the rows of a pose that shall be at `reference`; both are given in the frame in which the path is laid, and
    /// `axes` are those of the mask unless they are the tip's.
    pub(in crate::task) fn write(
        &self,
        pose: &IsometryMatrix3<f64>,
        reference: &Reference,
        axes: &MovingAxes,
        mut write: impl FnMut(usize, Row),
    ) {
        let of_tip = MovingAxes::fixed(pose.rotation);
        let axes = if self.axes == Axes::Tip { &of_tip } else { axes };
        let offset = Offset::of(pose, reference, axes, self.axes == Axes::Tip);
        let turn = self.components.iter().any(|own| own.is_angular()).then(|| Turn::of(pose, reference));
        for (place, component) in self.components.iter().enumerate() {
            let row = match (component, &turn) {
                (Component::Angular(axis), Some(turn)) => offset.angular_row(turn, *axis),
                (Component::Linear(axis) | Component::Angular(axis), _) => offset.linear_row(*axis),
            };
            write(place, row);
        }
        if let Some(axis) = self.point {
            let rows = pointing_rows(&pose.rotation, reference, axis);
            rows.into_iter().enumerate().for_each(|(i, row)| write(self.components.len() + i, row));
        }
    }
}

/// The offset of a position from its reference, and the axes that it is seen in.
struct Offset<'a> {
    d: Vector3<f64>,
    velocity: Vector3<f64>,
    spin: Vector3<f64>,
    axes: &'a MovingAxes,
    turns_with_tip: bool,
}

impl<'a> Offset<'a> {
    fn of(
        pose: &IsometryMatrix3<f64>,
        reference: &Reference,
        axes: &'a MovingAxes,
        turns_with_tip: bool,
    ) -> Self {
        let d = pose.translation.vector - reference.position;
        let (velocity, spin) = halves(&reference.twist);
        Self { d, velocity, spin, axes, turns_with_tip }
    }

    fn axis(&self, axis: usize) -> Vector3<f64> {
        self.axes.columns.matrix().column(axis).into_owned()
    }

    /// The derivative of `a . x` by the turn of the tip that the axis `a` turns with.
    fn of_turning(&self, a: &Vector3<f64>, x: &Vector3<f64>) -> Vector3<f64> {
        if self.turns_with_tip { a.cross(x) } else { Vector3::zeros() }
    }

    fn linear_row(&self, axis: usize) -> Row {
        let a = self.axis(axis);
        Row {
            error: a.dot(&self.d),
            direction: joined(&a, &self.of_turning(&a, &self.d)),
            feedforward: a.dot(&(self.velocity + self.axes.rate.cross(&self.d))),
        }
    }

    fn angular_row(&self, turn: &Turn, axis: usize) -> Row {
        let a = self.axis(axis);
        let along = turn.rate.tr_mul(&a);
        Row {
            error: a.dot(&turn.phi),
            direction: joined(&Vector3::zeros(), &(along + self.of_turning(&a, &turn.phi))),
            feedforward: along.dot(&(turn.rotation * self.spin)) + a.dot(&self.axes.rate.cross(&turn.phi)),
        }
    }
}

/// The turn from a reference to a tip.
struct Turn {
    rotation: Rotation3<f64>,
    phi: Vector3<f64>,
    /// `d phi / dt = rate (omega - rotation omega_d)`.
    rate: Matrix3<f64>,
}

impl Turn {
    fn of(pose: &IsometryMatrix3<f64>, reference: &Reference) -> Self {
        let rotation = pose.rotation * reference.rotation.inverse();
        let phi = rotation_vector(&rotation);
        Self { rotation, phi, rate: rotation_vector_rate(&phi) }
    }
}

/// The two rows of an axis of the tip that points where that of the reference does.
fn pointing_rows(rotation: &Rotation3<f64>, reference: &Reference, axis: usize) -> [Row; 2] {
    let column = |of: &Rotation3<f64>, axis: usize| of.matrix().column(axis % 3).into_owned();
    let (n, wanted) = (column(rotation, axis), column(&reference.rotation, axis));
    let sine = wanted.cross(&n);
    let theta = sine.norm().atan2(wanted.dot(&n));
    let (_, spin) = halves(&reference.twist);
    // theta / sin theta, and its derivative by theta over sin theta.
    let (factor, slope) = if theta < 1e-2 {
        let square = theta * theta;
        (1.0 + square * (1.0 / 6.0 + square * (7.0 / 360.0)), 1.0 / 3.0 + square * (2.0 / 15.0))
    } else {
        let (s, c) = theta.sin_cos();
        (theta / s, (s - theta * c) / (s * s * s))
    };
    [1, 2].map(|next| {
        let across = column(&reference.rotation, axis + next);
        let along = n.cross(&across.cross(&wanted)) * factor + sine * (slope * across.dot(&sine));
        Row {
            error: factor * across.dot(&sine),
            direction: joined(&Vector3::zeros(), &along),
            feedforward: along.dot(&spin),
        }
    })
}

fn halves(twist: &Vector6<f64>) -> (Vector3<f64>, Vector3<f64>) {
    (twist.fixed_rows::<3>(0).into_owned(), twist.fixed_rows::<3>(3).into_owned())
}

fn joined(linear: &Vector3<f64>, angular: &Vector3<f64>) -> Vector6<f64> {
    Vector6::new(linear.x, linear.y, linear.z, angular.x, angular.y, angular.z)
}
