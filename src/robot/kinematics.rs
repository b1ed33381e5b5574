//! Pose and geometric Jacobian of a chain, in one pass over flat constants.

use nalgebra::{IsometryMatrix3, Matrix3, Rotation3, Translation3, Vector3, Vector6};

use super::Chain;

/// Three components and an idle fourth, so that two 128-bit or one 256-bit register hold a column.
type Column = [f64; 4];

/// A pose as the columns of its rotation matrix and its origin.
#[derive(Debug, Clone, Copy)]
pub(super) struct Frame {
    x: Column,
    y: Column,
    z: Column,
    p: Column,
}

/// A moving axis of a chain and the constant that follows it.
#[derive(Debug, Clone)]
pub(super) struct Segment {
    pub(super) after: Frame,
    pub(super) multiplier: f64,
    pub(super) column: usize,
    /// Whether it is the first of its column on the path.
    pub(super) opens_column: bool,
    pub(super) motion: Motion,
}

/// How a segment moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Motion {
    /// About z \[rad\].
    Turn,
    /// Along z \[m\].
    Shift,
}

/// A moving axis with the origin of its frame, both in the base's axes.
#[derive(Debug, Clone, Copy)]
struct Axis {
    direction: Column,
    origin: Column,
}

/// Working memory of [`Chain::forward`]. It belongs to no robot: one per thread will do.
#[derive(Debug, Clone)]
pub struct ChainScratch {
    motions: Vec<(f64, f64)>,
    axes: Vec<Axis>,
    tip: Frame,
}

/// A chain whose kinematics have been run: the proof is that you hold it.
#[derive(Debug, Clone, Copy)]
pub struct Posed<'a> {
    chain: &'a Chain,
    scratch: &'a ChainScratch,
}

/// Returns `a + b s`.
#[inline]
fn add_scaled(a: Column, b: Column, s: f64) -> Column {
    [a[0] + b[0] * s, a[1] + b[1] * s, a[2] + b[2] * s, a[3] + b[3] * s]
}

#[inline]
fn scale(a: Column, s: f64) -> Column {
    [a[0] * s, a[1] * s, a[2] * s, a[3] * s]
}

fn column(v: Vector3<f64>) -> Column {
    [v.x, v.y, v.z, 0.0]
}

fn vector(c: Column) -> Vector3<f64> {
    Vector3::new(c[0], c[1], c[2])
}

impl Frame {
    const IDENTITY: Frame = Frame {
        x: [1.0, 0.0, 0.0, 0.0],
        y: [0.0, 1.0, 0.0, 0.0],
        z: [0.0, 0.0, 1.0, 0.0],
        p: [0.0, 0.0, 0.0, 0.0],
    };

    pub(super) fn new(pose: &IsometryMatrix3<f64>) -> Frame {
        let rotation = pose.rotation.matrix();
        Frame {
            x: column(rotation.column(0).into()),
            y: column(rotation.column(1).into()),
            z: column(rotation.column(2).into()),
            p: column(pose.translation.vector),
        }
    }

    pub(super) fn isometry(&self) -> IsometryMatrix3<f64> {
        let rotation = Matrix3::from_columns(&[vector(self.x), vector(self.y), vector(self.z)]);
        IsometryMatrix3::from_parts(
            Translation3::from(vector(self.p)),
            Rotation3::from_matrix_unchecked(rotation),
        )
    }

    /// Returns `R v`.
    #[inline]
    fn turn(&self, v: &Column) -> Column {
        add_scaled(add_scaled(scale(self.x, v[0]), self.y, v[1]), self.z, v[2])
    }

    /// Returns the product of two poses.
    #[inline]
    fn then(&self, next: &Frame) -> Frame {
        let moved = self.turn(&next.p);
        Frame {
            x: self.turn(&next.x),
            y: self.turn(&next.y),
            z: self.turn(&next.z),
            p: add_scaled(self.p, moved, 1.0),
        }
    }

    /// Turns the frame about its own z.
    #[inline]
    fn turn_about_z(&mut self, sine: f64, cosine: f64) {
        let (x, y) = (self.x, self.y);
        self.x = add_scaled(scale(x, cosine), y, sine);
        self.y = add_scaled(scale(y, cosine), x, -sine);
    }
}

impl ChainScratch {
    pub(super) fn with_length(length: usize) -> ChainScratch {
        let nowhere = Axis { direction: [0.0; 4], origin: [0.0; 4] };
        ChainScratch { motions: vec![(0.0, 1.0); length], axes: vec![nowhere; length], tip: Frame::IDENTITY }
    }
}

impl Chain {
    /// Runs the kinematics at joint positions `q` \[rad\] or \[m\] (one per [`Chain::joints`]) and returns the
    /// chain posed there. Allocates nothing, unless `scratch` was made for a chain with fewer moving axes.
    ///
    /// # Panics
    /// When `q` has not [`Chain::dof`] entries.
    pub fn forward<'a>(&'a self, q: &[f64], scratch: &'a mut ChainScratch) -> Posed<'a> {
        assert_eq!(q.len(), self.dof(), "one position per joint of the chain");
        if scratch.axes.len() < self.segments.len() {
            *scratch = self.scratch();
        }
        for (segment, motion) in self.segments.iter().zip(&mut scratch.motions) {
            let value = segment.multiplier * q[segment.column];
            *motion = match segment.motion {
                Motion::Turn => value.sin_cos(),
                Motion::Shift => (value, 0.0),
            };
        }
        let mut frame = self.start;
        let moving = self.segments.iter().zip(&scratch.motions).zip(&mut scratch.axes);
        for ((segment, &(first, second)), axis) in moving {
            *axis = Axis { direction: frame.z, origin: frame.p };
            match segment.motion {
                Motion::Turn => frame.turn_about_z(first, second),
                Motion::Shift => frame.p = add_scaled(frame.p, frame.z, first),
            }
            frame = frame.then(&segment.after);
        }
        scratch.tip = frame;
        Posed { chain: self, scratch }
    }
}

impl Posed<'_> {
    /// Returns the pose of the tip in the base (after [`Chain::mounted`]: in the world).
    pub fn pose(&self) -> IsometryMatrix3<f64> {
        self.scratch.tip.isometry()
    }

    /// Returns the tip's position in the base \[m\].
    pub fn position(&self) -> Vector3<f64> {
        vector(self.scratch.tip.p)
    }

    /// Returns the number of columns: [`Chain::dof`].
    pub fn dof(&self) -> usize {
        self.chain.dof()
    }

    /// Writes the geometric Jacobian, one column per joint of the chain: rows `vx vy vz wx wy wz`, the twist
    /// (linear; angular) of the tip relative to the base, taken at the tip's origin, in the base's axes (after
    /// [`Chain::mounted`]: the world's), per unit of joint velocity.
    ///
    /// A turning axis `z` through `o` gives `(z x (p - o); z)`, a sliding one `(z; 0)`; a mimic joint adds its
    /// multiple to the column of its driver.
    ///
    /// # Panics
    /// When `columns` has not [`Chain::dof`] entries.
    pub fn geometric_jacobian(&self, columns: &mut [Vector6<f64>]) {
        assert_eq!(columns.len(), self.dof(), "one column per joint of the chain");
        let p = self.scratch.tip.p;
        for (segment, axis) in self.chain.segments.iter().zip(&self.scratch.axes) {
            let z = scale(axis.direction, segment.multiplier);
            let twist = match segment.motion {
                Motion::Turn => {
                    let d = add_scaled(p, axis.origin, -1.0);
                    let v = [z[1] * d[2] - z[2] * d[1], z[2] * d[0] - z[0] * d[2], z[0] * d[1] - z[1] * d[0]];
                    Vector6::new(v[0], v[1], v[2], z[0], z[1], z[2])
                }
                Motion::Shift => Vector6::new(z[0], z[1], z[2], 0.0, 0.0, 0.0),
            };
            let column = &mut columns[segment.column];
            if segment.opens_column { *column = twist } else { *column += twist }
        }
    }
}
