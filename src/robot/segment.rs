//! The constants of a folded chain, in the form that is cheapest to run.

use nalgebra::{IsometryMatrix3, Matrix3, Rotation3, Translation3, Vector3};

use crate::math::{LaneArray, Lanes};

/// A pose as the columns of its rotation matrix and its origin.
#[derive(Debug, Clone, Copy)]
pub(super) struct Frame<T> {
    pub(super) x: [T; 3],
    pub(super) y: [T; 3],
    pub(super) z: [T; 3],
    pub(super) p: [T; 3],
}

/// A motion about or along z and the constant that follows it: `Rz(offset) T(translation) Rx(twist)`.
///
/// Every constant between two axes has this form up to a turn about the next axis, which commutes with the motion of
/// that axis and joins its offset. Unlike the four numbers of Denavit and Hartenberg, which place the frames on the
/// common normals of the axes, it is as accurate for axes that are nearly parallel as for others.
#[derive(Debug, Clone)]
pub(super) struct Segment<A> {
    pub(super) motion: Motion,
    /// Sine and cosine of a constant turn about z, where there is one.
    pub(super) offset: Option<[A; 2]>,
    pub(super) translation: [A; 3],
    /// Which components of the translation are not zero (in every lane).
    pub(super) is_shifted: [bool; 3],
    pub(super) twist: Twist<A>,
}

/// How a segment moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Motion {
    /// About z \[rad\].
    Turn,
    /// Along z \[m\].
    Shift,
}

/// A constant turn about x. Most robots have axes that are parallel or at right angles.
#[derive(Debug, Clone, Copy)]
pub(super) enum Twist<A> {
    /// None at all.
    None,
    /// By pi/2.
    Quarter,
    /// By -pi/2.
    BackQuarter,
    /// By any angle, given by its sine and cosine.
    Any([A; 2]),
}

/// All constants of a chain: where it starts, its segments, and the turn about z that is left at its end.
#[derive(Debug, Clone)]
pub(super) struct Folded<A> {
    pub(super) start: Frame<A>,
    pub(super) segments: Vec<Segment<A>>,
    pub(super) finish: Option<[A; 2]>,
}

/// The constants of one chain.
pub(super) type Single = [f64; 1];

impl<T: Copy> Frame<T> {
    pub(super) fn map<U>(&self, change: impl Fn(T) -> U) -> Frame<U> {
        Frame {
            x: self.x.map(&change),
            y: self.y.map(&change),
            z: self.z.map(&change),
            p: self.p.map(&change),
        }
    }
}

impl Frame<f64> {
    pub(super) const IDENTITY: Frame<f64> =
        Frame { x: [1.0, 0.0, 0.0], y: [0.0, 1.0, 0.0], z: [0.0, 0.0, 1.0], p: [0.0; 3] };

    pub(super) fn new(pose: &IsometryMatrix3<f64>) -> Self {
        let [x, y, z] = pose.rotation.matrix().data.0;
        Frame { x, y, z, p: pose.translation.vector.into() }
    }

    pub(super) fn isometry(&self) -> IsometryMatrix3<f64> {
        let rotation = Matrix3::from_columns(&[self.x, self.y, self.z].map(Vector3::from));
        IsometryMatrix3::from_parts(
            Translation3::from(Vector3::from(self.p)),
            Rotation3::from_matrix_unchecked(rotation),
        )
    }
}

impl<A> Frame<A> {
    /// The frame as numbers to compute with.
    #[inline(always)]
    pub(super) fn load<V: Lanes<Array = A>>(&self, token: V::Token) -> Frame<V> {
        Frame {
            x: load_three(token, &self.x),
            y: load_three(token, &self.y),
            z: load_three(token, &self.z),
            p: load_three(token, &self.p),
        }
    }
}

/// Three numbers to compute with.
#[inline(always)]
fn load_three<V: Lanes>(token: V::Token, values: &[V::Array; 3]) -> [V; 3] {
    [V::load(token, &values[0]), V::load(token, &values[1]), V::load(token, &values[2])]
}

impl Folded<Single> {
    /// Folds the constants `start M_1 constants[0] M_2 constants[1] ...` around motions about and along z.
    pub(super) fn new(start: &IsometryMatrix3<f64>, moving: &[(Motion, IsometryMatrix3<f64>)]) -> Self {
        let mut carried = Turn::NONE;
        let mut segments = Vec::with_capacity(moving.len());
        for (motion, constant) in moving {
            let parts = Parts::of(constant, carried);
            let translation = parts.translation;
            segments.push(Segment {
                motion: *motion,
                offset: parts.offset.stored(),
                translation: [[translation.x], [translation.y], [translation.z]],
                is_shifted: [translation.x, translation.y, translation.z].map(|component| component != 0.0),
                twist: parts.twist.into_twist(),
            });
            carried = parts.left_over;
        }
        Self { start: Frame::new(start).map(|entry| [entry]), segments, finish: carried.stored() }
    }
}

impl<A: LaneArray> Folded<A> {
    /// Lays chains side by side, one in each lane (the last fills what is left); `None` unless all move in the same way.
    pub(super) fn side_by_side(chains: &[&Folded<Single>]) -> Option<Self> {
        let first = chains.first()?;
        let moves_alike = |other: &Folded<Single>| {
            let pairs = || first.segments.iter().zip(&other.segments);
            first.segments.len() == other.segments.len() && pairs().all(|(a, b)| a.motion == b.motion)
        };
        if chains.len() > A::WIDTH || !chains.iter().all(|chain| moves_alike(chain)) {
            return None;
        }
        let segments = (0..first.segments.len()).map(|i| {
            let lanes: Vec<&Segment<Single>> = chains.iter().map(|chain| &chain.segments[i]).collect();
            Segment {
                motion: lanes[0].motion,
                offset: turns(&lanes.iter().map(|lane| lane.offset).collect::<Vec<_>>()),
                translation: std::array::from_fn(|k| gather(lanes.iter().map(|lane| lane.translation[k][0]))),
                is_shifted: std::array::from_fn(|k| lanes.iter().any(|lane| lane.is_shifted[k])),
                twist: twists(&lanes),
            }
        });
        let column = |pick: fn(&Frame<Single>) -> &[Single; 3]| {
            std::array::from_fn(|k| gather(chains.iter().map(|chain| pick(&chain.start)[k][0])))
        };
        let start =
            Frame { x: column(|f| &f.x), y: column(|f| &f.y), z: column(|f| &f.z), p: column(|f| &f.p) };
        let finish = turns(&chains.iter().map(|chain| chain.finish).collect::<Vec<_>>());
        Some(Self { start, segments: segments.collect(), finish })
    }
}

/// One real per lane; the last real fills the lanes that are left.
fn gather<A: LaneArray>(reals: impl Iterator<Item = f64>) -> A {
    let mut array = A::ZERO;
    let mut last = 0.0;
    let mut reals = reals.fuse();
    for lane in array.as_mut() {
        last = reals.next().unwrap_or(last);
        *lane = last;
    }
    array
}

/// The turns of all lanes, if any lane turns.
fn turns<A: LaneArray>(lanes: &[Option<[Single; 2]>]) -> Option<[A; 2]> {
    let at = |k: usize| gather(lanes.iter().map(|turn| turn.map_or([0.0, 1.0][k], |turn| turn[k][0])));
    lanes.iter().any(Option::is_some).then(|| [at(0), at(1)])
}

fn twists<A: LaneArray>(lanes: &[&Segment<Single>]) -> Twist<A> {
    let all = |like: fn(&Twist<Single>) -> bool| lanes.iter().all(|lane| like(&lane.twist));
    let pair = |twist: &Twist<Single>| match *twist {
        Twist::None => [0.0, 1.0],
        Twist::Quarter => [1.0, 0.0],
        Twist::BackQuarter => [-1.0, 0.0],
        Twist::Any([sine, cosine]) => [sine[0], cosine[0]],
    };
    match () {
        () if all(|twist| matches!(twist, Twist::None)) => Twist::None,
        () if all(|twist| matches!(twist, Twist::Quarter)) => Twist::Quarter,
        () if all(|twist| matches!(twist, Twist::BackQuarter)) => Twist::BackQuarter,
        () => Twist::Any(std::array::from_fn(|k| gather(lanes.iter().map(|lane| pair(&lane.twist)[k])))),
    }
}

/// What counts as zero beside one: less than the rounding of one operation on the entries of a rotation matrix.
const NEGLIGIBLE: f64 = f64::EPSILON;

/// A turn by a constant angle, as sine and cosine.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Turn {
    sine: f64,
    cosine: f64,
}

impl Turn {
    const NONE: Turn = Turn { sine: 0.0, cosine: 1.0 };

    /// The turn whose sine and cosine are in this proportion; exact for quarter turns.
    fn new(sine: f64, cosine: f64) -> Turn {
        let length = sine.hypot(cosine);
        let (sine, cosine) = (sine / length, cosine / length);
        match () {
            () if sine.abs() < NEGLIGIBLE => Turn { sine: 0.0, cosine: cosine.signum() },
            () if cosine.abs() < NEGLIGIBLE => Turn { sine: sine.signum(), cosine: 0.0 },
            () => Turn { sine, cosine },
        }
    }

    fn inverse(self) -> Turn {
        Turn { sine: -self.sine, cosine: self.cosine }
    }

    fn then(self, next: Turn) -> Turn {
        let sine = self.sine * next.cosine + self.cosine * next.sine;
        let cosine = self.cosine * next.cosine - self.sine * next.sine;
        Turn::new(sine, cosine)
    }

    fn about_z(self) -> Rotation3<f64> {
        let Turn { sine: s, cosine: c } = self;
        Rotation3::from_matrix_unchecked(Matrix3::new(c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0))
    }

    fn about_x(self) -> Rotation3<f64> {
        let Turn { sine: s, cosine: c } = self;
        Rotation3::from_matrix_unchecked(Matrix3::new(1.0, 0.0, 0.0, 0.0, c, -s, 0.0, s, c))
    }

    fn stored(self) -> Option<[Single; 2]> {
        (self != Turn::NONE).then_some([[self.sine], [self.cosine]])
    }

    fn into_twist(self) -> Twist<Single> {
        match (self.sine, self.cosine) {
            (0.0, 1.0) => Twist::None,
            (1.0, 0.0) => Twist::Quarter,
            (-1.0, 0.0) => Twist::BackQuarter,
            (sine, cosine) => Twist::Any([[sine], [cosine]]),
        }
    }
}

/// A constant after a motion: `Rz(carried) constant = Rz(offset) T(translation) Rx(twist) Rz(left_over)`.
struct Parts {
    offset: Turn,
    translation: Vector3<f64>,
    twist: Turn,
    left_over: Turn,
}

impl Parts {
    fn of(constant: &IsometryMatrix3<f64>, carried: Turn) -> Parts {
        let next_z = constant.rotation.matrix().column(2).into_owned();
        let slope = next_z.x.hypot(next_z.y);
        // Axes in parallel leave the offset open: none at all is best. Else the sign of the twist is open: the one
        // with the smaller offset is better.
        let own = if slope < NEGLIGIBLE { carried.inverse() } else { Turn::new(next_z.x, -next_z.y) };
        let is_opposite = carried.then(own).cosine < 0.0;
        let (own, slope) = if is_opposite { (own.then(HALF_TURN), -slope) } else { (own, slope) };
        let twist = Turn::new(slope, next_z.z);
        let rest = twist.about_x().inverse() * own.about_z().inverse() * constant.rotation;
        let left_over = Turn::new(rest[(1, 0)], rest[(0, 0)]);
        // The largest part says how long it is, and can not overflow as a sum of squares does.
        let length = constant.translation.vector.amax();
        let turned = own.about_z().inverse() * constant.translation.vector;
        let translation = turned.map(|part| if part.abs() < NEGLIGIBLE * length { 0.0 } else { part });
        Parts { offset: carried.then(own), translation, twist, left_over }
    }
}

const HALF_TURN: Turn = Turn { sine: 0.0, cosine: -1.0 };

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn pose_of(parts: &Parts) -> IsometryMatrix3<f64> {
        let turn = |rotation| IsometryMatrix3::from_parts(Translation3::identity(), rotation);
        turn(parts.offset.about_z())
            * Translation3::from(parts.translation)
            * turn(parts.twist.about_x())
            * turn(parts.left_over.about_z())
    }

    proptest! {
        #[test]
        fn the_parts_of_a_constant_make_it_up_again(
            turn in proptest::array::uniform3(-2.0..2.0_f64), shift in proptest::array::uniform3(-1.0..1.0_f64),
            carried in -3.0..3.0_f64, exponent in -18.0..0.5_f64,
        ) {
            // Also axes that are parallel but for a hair.
            let slight = Rotation3::new(Vector3::from(turn) * 10_f64.powf(exponent));
            for rotation in [slight, slight * Rotation3::from_axis_angle(&Vector3::x_axis(), std::f64::consts::PI)] {
                let constant = IsometryMatrix3::from_parts(Translation3::from(Vector3::from(shift)), rotation);
                let carried = Turn::new(carried.sin(), carried.cos());
                let again = pose_of(&Parts::of(&constant, carried));
                let whole = IsometryMatrix3::from_parts(Translation3::identity(), carried.about_z()) * constant;
                prop_assert!((again.to_homogeneous() - whole.to_homogeneous()).norm() < 2e-15);
            }
        }
    }

    #[test]
    fn no_length_is_too_great_to_be_taken_apart() {
        // A power of two changes no digit.
        let scale = 2.0_f64.powi(600);
        for shift in [[0.3, -0.2, 0.5], [1.0, 1e-20, 0.0], [0.0, 0.0, -2.0]].map(Vector3::from) {
            let parts = |scale: f64| {
                let rotation = Rotation3::from_euler_angles(0.3, -1.1, 2.0);
                let constant = IsometryMatrix3::from_parts((shift * scale).into(), rotation);
                Parts::of(&constant, Turn::new(0.6, 0.8)).translation
            };
            assert_eq!(parts(scale), parts(1.0) * scale);
            assert!(parts(scale).amax() > 0.1 * scale);
        }
    }

    #[test]
    fn right_angles_stay_exact() {
        for (i, j) in [(0, 1), (1, 0), (2, 1), (0, 2), (1, 2), (2, 0)] {
            for signs in [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]] {
                let (x, y) = (Vector3::ith(i, signs[0]), Vector3::ith(j, signs[1]));
                let rotation = Matrix3::from_columns(&[x, y, x.cross(&y)]);
                let constant = IsometryMatrix3::from_parts(
                    Translation3::new(1.0, 2.0, 3.0),
                    Rotation3::from_matrix_unchecked(rotation),
                );
                let parts = Parts::of(&constant, Turn::NONE);
                assert_eq!(pose_of(&parts), constant);
            }
        }
    }

    #[test]
    fn parallel_axes_cost_no_turn() {
        let shift = IsometryMatrix3::translation(0.5, 0.0, 0.0);
        let folded = Folded::new(&shift, &[(Motion::Turn, shift), (Motion::Turn, shift)]);
        for segment in &folded.segments {
            assert!(segment.offset.is_none() && matches!(segment.twist, Twist::None));
            assert_eq!(segment.is_shifted, [true, false, false]);
        }
        assert!(folded.finish.is_none());
    }
}
