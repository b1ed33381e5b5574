use super::Reference;
use crate::math::{
    Kernel, Lane, LaneArray, Lanes, level, relative_rotation, rotation_vector, small_rotation_vector,
    with_instructions,
};
use fearless_simd::Simd;
use nalgebra::{IsometryMatrix3, Matrix3, Rotation3, Vector6};
use serde::{Deserialize, Serialize};

/// Which components of the tip's pose a task asks for.
///
/// Every kind takes the leading rows of the geometric Jacobian (linear first, then angular).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
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
    /// Every kind of task, for listings.
    pub const ALL: [Self; 3] = [Self::PositionXy, Self::Position, Self::Pose];

    /// Returns the name of the kind in scenario files.
    pub fn name(self) -> &'static str {
        match self {
            Self::PositionXy => "position-xy",
            Self::Position => "position",
            Self::Pose => "pose",
        }
    }

    /// Returns the number of components that the task asks for: 2, 3 or 6.
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
                let columns = |rotation: &Rotation3<f64>| rotation.matrix().data.0;
                let (tip, reference) = (columns(&tip.rotation), columns(&reference.rotation));
                let turn = with_instructions(level(), OrientationError(&tip, &reference));
                Vector6::new(offset.x, offset.y, offset.z, turn[0], turn[1], turn[2])
            }
        }
    }
}

/// The columns of a rotation matrix.
type Columns<T> = [[T; 3]; 3];

/// `log(R R_d^T)^vee`, both rotations given by their columns.
struct OrientationError<'a>(&'a Columns<f64>, &'a Columns<f64>);

impl Kernel for OrientationError<'_> {
    type Output = [f64; 3];

    #[inline(always)]
    fn run<S: Simd>(self, simd: S) -> [f64; 3] {
        let reals =
            |columns: &Columns<f64>| columns.map(|column| column.map(|entry| Lane::splat(simd, entry)));
        let (sine, cosine) = relative_rotation(&reals(self.0), &reals(self.1));
        match small_rotation_vector(&sine, cosine) {
            Some(turn) => turn.map(|entry| entry.value),
            None => large_orientation_error(self.0, self.1),
        }
    }
}

#[cold]
fn large_orientation_error(r: &Columns<f64>, d: &Columns<f64>) -> [f64; 3] {
    let matrix = |columns: &Columns<f64>| Matrix3::from_fn(|row, column| columns[column][row]);
    rotation_vector(&Rotation3::from_matrix_unchecked(matrix(r) * matrix(d).transpose())).into()
}

/// The first `M` rows (2, 3 or 6) of the task errors of all lanes: the same as [`TaskKind::error`] in each.
#[inline(always)]
pub(crate) fn pose_error<V: Lanes<Array: LaneArray>, const M: usize>(
    (tip, tip_rotation): (&[V; 3], &Columns<V>),
    (wanted, wanted_rotation): (&[V; 3], &Columns<V>),
    token: V::Token,
) -> [V; M] {
    let mut error = [wanted[0]; M];
    for i in 0..M.min(3) {
        error[i] = tip[i] - wanted[i];
    }
    if M == 6 {
        let (sine, cosine) = relative_rotation(tip_rotation, wanted_rotation);
        let turn = match small_rotation_vector(&sine, cosine) {
            Some(turn) => turn,
            None => turn_one_by_one(token, tip_rotation, wanted_rotation),
        };
        error[3..].copy_from_slice(&turn);
    }
    error
}

/// The orientation errors of lanes of which not all are small.
#[cold]
#[inline(never)]
fn turn_one_by_one<V: Lanes<Array: LaneArray>>(token: V::Token, r: &Columns<V>, d: &Columns<V>) -> [V; 3] {
    let stored = |columns: &Columns<V>| columns.map(|column| column.map(Lanes::to_array));
    let (r, d) = (stored(r), stored(d));
    let mut turns = [V::Array::ZERO; 3];
    for lane in 0..V::WIDTH {
        let own =
            |columns: &Columns<V::Array>| columns.map(|column| column.map(|entry| entry.as_ref()[lane]));
        let error = OrientationError(&own(&r), &own(&d)).run(token);
        for (turn, entry) in turns.iter_mut().zip(error) {
            turn.as_mut()[lane] = entry;
        }
    }
    turns.map(|turn| V::load(token, &turn))
}
