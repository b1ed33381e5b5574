//! A capsule around points in space, along one of their principal axes.

use nalgebra::{Matrix3, SymmetricEigen, Vector3};

use super::enclosing::{Enclosing, enclosing};
use crate::collision::{Capsule, ShapeError};

/// Steps towards the middle of the smallest circle around points.
const STEPS: usize = 100;

/// Returns the smallest capsule along a principal axis of the points that contains them all.
///
/// # Errors
/// [`ShapeError`] where the points are too far away for any arm.
pub(super) fn around(points: &[Vector3<f64>]) -> Result<Capsule, ShapeError> {
    let middle = points.iter().sum::<Vector3<f64>>() / points.len().max(1) as f64;
    let spread: Matrix3<f64> =
        points.iter().map(|point| (point - middle) * (point - middle).transpose()).sum();
    let axes = if spread.iter().all(|entry| entry.is_finite()) {
        SymmetricEigen::new(spread).eigenvectors
    } else {
        Matrix3::identity()
    };
    let candidates = [0, 1, 2].map(|axis| along(points, &middle, &axes, axis));
    let [first, others @ ..] = candidates;
    let mut best = first?;
    for other in others {
        let other = other?;
        if other.volume() < best.volume() {
            best = other;
        }
    }
    Ok(best)
}

/// The smallest capsule along the line with the direction of one of three axes through the middle of the points' shadow.
fn along(
    points: &[Vector3<f64>],
    middle: &Vector3<f64>,
    axes: &Matrix3<f64>,
    axis: usize,
) -> Result<Capsule, ShapeError> {
    let [z, x, y] = [0, 1, 2].map(|i| axes.column((axis + i) % 3).into_owned());
    let shadow = |point: &Vector3<f64>| [(point - middle).dot(&x), (point - middle).dot(&y)];
    let center = middle_of_circle(&points.iter().map(shadow).collect::<Vec<_>>());
    let place = |point: &Vector3<f64>| {
        let [x, y] = shadow(point);
        ((point - middle).dot(&z), (x - center[0]).hypot(y - center[1]))
    };
    let Enclosing { from, to, radius } = enclosing(&points.iter().map(place).collect::<Vec<_>>());
    let foot = middle + x * center[0] + y * center[1];
    // Rounding of the axes and of places far from the origin.
    let slack = 1e-12 * (middle.norm() + from.abs() + to.abs() + radius);
    Capsule::new(foot + z * from, foot + z * to, radius + slack)
}

/// The middle of about the smallest circle around points (Badoiu and Clarkson): ever shorter steps to the farthest of them.
fn middle_of_circle(points: &[[f64; 2]]) -> [f64; 2] {
    let mut center = [0.0; 2];
    for step in 1..=STEPS {
        let square = |point: &[f64; 2]| (point[0] - center[0]).powi(2) + (point[1] - center[1]).powi(2);
        let Some(far) = points.iter().max_by(|a, b| square(a).total_cmp(&square(b))) else { break };
        for i in 0..2 {
            center[i] += (far[i] - center[i]) / (step as f64 + 1.0);
        }
    }
    center
}
