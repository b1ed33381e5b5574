use super::axes::MovingAxes;
use crate::task::{Component, Motion};
use nalgebra::{Matrix3, Rotation3, Vector3};

/// At how many places a path is looked at before its axes are taken to be defined.
const PLACES: u32 = 1000;
/// The sine of the least angle that the tangent keeps from the direction that y and z are found by.
const LEAST_SINE: f64 = 0.1;
/// A tangent this much shorter than the longest one has no direction.
const NO_LENGTH: f64 = 1e-9;
/// The gap of the differences of tangents, in progress.
const GAP: f64 = 1.0 / 1024.0;

/// The axes of a path: x along the tangent, y and z across it.
#[derive(Clone, Copy, Debug)]
pub(super) struct PathAxes {
    /// The direction `k` of `y = k x tangent`.
    k: Vector3<f64>,
}

impl PathAxes {
    /// The axes of the path of a motion.
    ///
    /// # Errors
    /// A sentence's end where they are not defined all along: the path has no tangent, turns back on the spot, or runs along all
    /// the directions that y and z could be found by.
    pub(super) fn of(motion: &Motion) -> Result<Self, String> {
        let tangents: Vec<Vector3<f64>> = (0..=PLACES).filter_map(|n| motion.tangent(progress(n))).collect();
        let longest = tangents.iter().map(Vector3::norm).fold(0.0, f64::max);
        if tangents.is_empty() || longest == 0.0 {
            return Err(
                "has no tangent, and so no axes of its own: count the rows in base or tip axes".to_owned()
            );
        }
        let turns_back = |n: usize| n > 0 && tangents[n].dot(&tangents[n - 1]) <= 0.0;
        let stands = |n: usize| tangents[n].norm() <= NO_LENGTH * longest || turns_back(n);
        if let Some(place) = (0..tangents.len()).find(|&n| stands(n)) {
            return Err(format!(
                "has a cusp near u = {:.3}, where its tangent has no direction: count the rows in base or tip axes",
                progress(place as u32)
            ));
        }
        let least_sine = |k: &Vector3<f64>| {
            tangents.iter().map(|tangent| k.cross(tangent).norm() / tangent.norm()).fold(1.0, f64::min)
        };
        [Vector3::z(), Vector3::y(), Vector3::x()]
            .into_iter()
            .find(|k| least_sine(k) >= LEAST_SINE)
            .map(|k| Self { k })
            .ok_or_else(|| {
                format!(
                    "runs along each of {} somewhere, so that there is no telling its y from its z: count the rows in base or tip axes",
                    Component::NAMES[..3].join(", ")
                )
            })
    }

    /// The axes at time `t` \[s\].
    pub(super) fn at(&self, motion: &Motion, t: f64) -> MovingAxes {
        let (u, rate) = motion.progress(t).unwrap_or_default();
        let tangent = motion.tangent(u).unwrap_or_else(Vector3::x);
        let (x, dx) = unit(&tangent, &(bend(motion, u) * rate));
        let (y, dy) = unit(&self.k.cross(&x), &self.k.cross(&dx));
        let (z, dz) = (x.cross(&y), dx.cross(&y) + x.cross(&dy));
        MovingAxes {
            columns: Rotation3::from_matrix_unchecked(Matrix3::from_columns(&[x, y, z])),
            rate: (x.cross(&dx) + y.cross(&dy) + z.cross(&dz)) * 0.5,
        }
    }
}

fn progress(place: u32) -> f64 {
    f64::from(place) / f64::from(PLACES)
}

/// `d tangent / du` \[m\], by central differences of order six: paths say their tangents, not how these bend.
fn bend(motion: &Motion, u: f64) -> Vector3<f64> {
    let across = |n: f64| {
        let ends = [u + n * GAP, u - n * GAP].map(|u| motion.tangent(u).unwrap_or_default());
        ends[0] - ends[1]
    };
    (across(1.0) * 45.0 - across(2.0) * 9.0 + across(3.0)) / (60.0 * GAP)
}

/// A vector of length one, and its derivative, from a vector and its derivative.
fn unit(vector: &Vector3<f64>, derivative: &Vector3<f64>) -> (Vector3<f64>, Vector3<f64>) {
    let length = vector.norm();
    let unit = vector / length;
    (unit, (derivative - unit * unit.dot(derivative)) / length)
}
