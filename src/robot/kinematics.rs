//! Pose and geometric Jacobian of a chain, in one pass over folded constants.

use fearless_simd::{Level, Simd, f64x4};
use nalgebra::{IsometryMatrix3, Vector3, Vector6};

use super::Chain;
use super::segment::{Folded, Frame, Motion, Single, Twist};
use crate::math::{Kernel, Lane, Lanes, level, sines_and_cosines, sines_and_cosines_of, with_instructions};

/// The origin of a moving axis's frame, then the axis's direction, both in the base's axes: where the column of the Jacobian
/// will stand, which has the direction at the same place.
pub(super) type Axis<A> = [A; 6];

/// The sines and cosines of the joint positions of a chain in the order of its segments: lane by lane, filled up to whole
/// vectors of four.
#[derive(Debug, Clone)]
pub(super) struct Motions {
    pub(super) sines: Vec<f64>,
    pub(super) cosines: Vec<f64>,
}

/// Working memory of [`Chain::forward`]. It belongs to no robot: one per thread will do.
#[derive(Debug, Clone)]
pub struct ChainScratch {
    level: Level,
    motions: Motions,
    axes: Vec<Axis<Single>>,
    tip: Frame<f64>,
}

/// A chain whose kinematics have been run, as [`Chain::forward`] returns it: whoever holds one may ask for pose and
/// Jacobian.
#[derive(Debug, Clone, Copy)]
pub struct Posed<'a> {
    chain: &'a Chain,
    scratch: &'a ChainScratch,
}

impl Motions {
    pub(super) fn with_length(length: usize) -> Motions {
        let zeros = vec![0.0; length.next_multiple_of(4)];
        Motions { sines: zeros.clone(), cosines: zeros }
    }

    /// Fills in the sines and cosines of the positions that `position` gives by index.
    #[inline(always)]
    pub(super) fn turn<S: Simd>(&mut self, simd: S, position: impl Fn(usize) -> f64) {
        sines_and_cosines::<f64x4<S>>(simd, position, &mut self.sines, &mut self.cosines);
    }

    /// The same for positions that lie one after the other, filled up to whole vectors of four.
    #[inline(always)]
    pub(super) fn turn_to<S: Simd>(&mut self, simd: S, positions: &[f64]) {
        sines_and_cosines_of::<f64x4<S>>(simd, positions, &mut self.sines, &mut self.cosines);
    }
}

/// An axis that moves a tip: what a joint does by itself, or makes a joint do that follows it.
///
/// The column of a joint in the geometric Jacobian is the sum of the twists of its axes. Axes stand in their order from the
/// base to the tip, so their derivatives follow from themselves: for an axis `a` before `b` it is
/// `d twist_b / dq_a = (w_a x v_b; w_a x w_b)`, and for an axis `a` that is `b` or comes after it `(w_b x v_a; 0)`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct MovingAxis {
    /// The place of the joint in the chain.
    pub joint: usize,
    /// The twist (linear; angular) of the tip per unit of the joint's motion, in the base's axes.
    pub twist: Vector6<f64>,
}

impl<V: Lanes> Frame<V> {
    /// Turns the frame about its own z.
    #[inline(always)]
    fn turn_about_z(&mut self, sine: V, cosine: V) {
        let (x, y) = (self.x, self.y);
        for i in 0..3 {
            self.x[i] = x[i].times_plus(cosine, y[i] * sine);
            self.y[i] = y[i].times_less(cosine, x[i] * sine);
        }
    }

    /// Turns the frame about its own x.
    #[inline(always)]
    fn twist(&mut self, token: V::Token, twist: &Twist<V::Array>) {
        let (y, z) = (self.y, self.z);
        match twist {
            Twist::None => {}
            Twist::Quarter => (self.y, self.z) = (z, [-y[0], -y[1], -y[2]]),
            Twist::BackQuarter => (self.y, self.z) = ([-z[0], -z[1], -z[2]], y),
            Twist::Any([sine, cosine]) => {
                let (sine, cosine) = (V::load(token, sine), V::load(token, cosine));
                for i in 0..3 {
                    self.y[i] = y[i].times_plus(cosine, z[i] * sine);
                    self.z[i] = z[i].times_less(cosine, y[i] * sine);
                }
            }
        }
    }

    /// Shifts the frame along one of its own axes.
    #[inline(always)]
    fn shift(&mut self, axis: [V; 3], by: V) {
        for i in 0..3 {
            self.p[i] = axis[i].times_plus(by, self.p[i]);
        }
    }
}

/// Runs along the chain at the positions that `position` gives by segment, leaves every moving axis in `axes` and returns the tip.
#[inline(always)]
pub(super) fn forward<'a, V: Lanes>(
    token: V::Token,
    folded: &Folded<V::Array>,
    motions: &'a Motions,
    position: impl Fn(usize) -> V,
    axes: &mut [Axis<V::Array>],
) -> Frame<V> {
    let mut frame = folded.start.load::<V>(token);
    let lanes = |values: &'a [f64]| values.chunks_exact(V::WIDTH);
    let turns = lanes(&motions.sines).zip(lanes(&motions.cosines));
    for (k, ((segment, axis), (sine, cosine))) in folded.segments.iter().zip(axes).zip(turns).enumerate() {
        for i in 0..3 {
            frame.p[i].store(&mut axis[i]);
            frame.z[i].store(&mut axis[3 + i]);
        }
        match segment.motion {
            Motion::Turn => frame.turn_about_z(V::load_slice(token, sine), V::load_slice(token, cosine)),
            Motion::Shift => frame.shift(frame.z, position(k)),
        }
        if let Some([sine, cosine]) = &segment.offset {
            frame.turn_about_z(V::load(token, sine), V::load(token, cosine));
        }
        if segment.is_shifted[0] {
            frame.shift(frame.x, V::load(token, &segment.translation[0]));
        }
        if segment.is_shifted[1] {
            frame.shift(frame.y, V::load(token, &segment.translation[1]));
        }
        if segment.is_shifted[2] {
            frame.shift(frame.z, V::load(token, &segment.translation[2]));
        }
        frame.twist(token, &segment.twist);
    }
    if let Some([sine, cosine]) = &folded.finish {
        frame.turn_about_z(V::load(token, sine), V::load(token, cosine));
    }
    frame
}

/// Puts in the place of an axis the twist of the tip at `p` per unit of its motion: `(z x (p - o); z)` for a turning one,
/// `(z; 0)` for a sliding one.
#[inline(always)]
pub(super) fn into_twist<V: Lanes>(token: V::Token, axis: &mut Axis<V::Array>, motion: Motion, p: &[V; 3]) {
    let load = |i: usize| V::load(token, &axis[i]);
    let z = [load(3), load(4), load(5)];
    if motion == Motion::Shift {
        for i in 0..3 {
            z[i].store(&mut axis[i]);
            V::splat(token, 0.0).store(&mut axis[3 + i]);
        }
        return;
    }
    let d = [p[0] - load(0), p[1] - load(1), p[2] - load(2)];
    z[1].times_less(d[2], z[2] * d[1]).store(&mut axis[0]);
    z[2].times_less(d[0], z[0] * d[2]).store(&mut axis[1]);
    z[0].times_less(d[1], z[1] * d[0]).store(&mut axis[2]);
}

impl ChainScratch {
    fn with_length(length: usize) -> ChainScratch {
        ChainScratch {
            level: level(),
            motions: Motions::with_length(length),
            axes: vec![[[0.0]; 6]; length],
            tip: Frame::IDENTITY,
        }
    }
}

/// One pass over one chain.
struct Pass<'a> {
    chain: &'a Chain,
    q: &'a [f64],
    motions: &'a mut Motions,
    axes: &'a mut [Axis<Single>],
}

impl Kernel for Pass<'_> {
    type Output = Frame<f64>;

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> Frame<f64> {
        let places = &self.chain.places;
        // The vectors of four may reach beyond the last segment.
        let position = |k: usize| places.get(k).map_or(0.0, |place| place.multiplier * self.q[place.column]);
        self.motions.turn(simd, position);
        let real = |k: usize| Lane::splat(simd, position(k));
        forward::<Lane<S>>(simd, &self.chain.folded, self.motions, real, self.axes).map(|entry| entry.value)
    }
}

/// The moving axes of a chain that was posed.
struct Axes<'a> {
    posed: Posed<'a>,
    axes: &'a mut [MovingAxis],
}

impl Kernel for Axes<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Posed { chain, scratch } = self.posed;
        let p = scratch.tip.p.map(|entry| Lane::splat(simd, entry));
        let all = chain.folded.segments.iter().zip(&chain.places).zip(&scratch.axes);
        for (((segment, place), axis), out) in all.zip(self.axes) {
            let mut axis = *axis;
            into_twist::<Lane<S>>(simd, &mut axis, segment.motion, &p);
            let twist = Vector6::from(axis.map(|[entry]| entry * place.multiplier));
            *out = MovingAxis { joint: place.column, twist };
        }
    }
}

/// The Jacobian of a chain that was posed.
struct Columns<'a> {
    posed: Posed<'a>,
    columns: &'a mut [Vector6<f64>],
}

impl Kernel for Columns<'_> {
    type Output = ();

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Posed { chain, scratch } = self.posed;
        let p = scratch.tip.p.map(|entry| Lane::splat(simd, entry));
        for ((segment, place), axis) in chain.folded.segments.iter().zip(&chain.places).zip(&scratch.axes) {
            let mut axis = *axis;
            into_twist::<Lane<S>>(simd, &mut axis, segment.motion, &p);
            let twist = Vector6::from(axis.map(|[entry]| entry * place.multiplier));
            let column = &mut self.columns[place.column];
            if place.opens_column { *column = twist } else { *column += twist }
        }
    }
}

impl Chain {
    /// Returns working memory for [`Chain::forward`]: one per thread.
    pub fn scratch(&self) -> ChainScratch {
        ChainScratch::with_length(self.places.len())
    }

    /// Runs the kinematics at joint positions `q` \[rad\] or \[m\] (one per [`Chain::joints`]) and returns the
    /// chain posed there. Allocates nothing, unless `scratch` was made for a chain with fewer moving axes.
    ///
    /// # Panics
    /// When `q` has not [`Chain::dof`] entries.
    pub fn forward<'a>(&'a self, q: &[f64], scratch: &'a mut ChainScratch) -> Posed<'a> {
        assert_eq!(q.len(), self.dof(), "one position per joint of the chain");
        if scratch.axes.len() < self.places.len() {
            *scratch = self.scratch();
        }
        let pass = Pass { chain: self, q, motions: &mut scratch.motions, axes: &mut scratch.axes };
        scratch.tip = with_instructions(scratch.level, pass);
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
        self.scratch.tip.p.into()
    }

    /// Returns the number of columns of the Jacobian: [`Chain::dof`].
    pub fn dof(&self) -> usize {
        self.chain.dof()
    }

    /// Writes the axes that move the tip, from the base to the tip: [`Chain::moving_axes`] of them.
    ///
    /// # Panics
    /// When `axes` has another length.
    pub fn axes(&self, axes: &mut [MovingAxis]) {
        assert_eq!(axes.len(), self.chain.moving_axes(), "one entry per moving axis of the chain");
        with_instructions(self.scratch.level, Axes { posed: *self, axes });
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
        with_instructions(self.scratch.level, Columns { posed: *self, columns });
    }
}
