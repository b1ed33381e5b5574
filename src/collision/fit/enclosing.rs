//! The smallest capsule along a line around points.

use std::f64::consts::PI;

/// How many radii are tried, and then again around the best.
const RADII: usize = 48;
/// What is added to a radius so that rounding leaves no point outside.
const ROUNDING: f64 = 1e-12;

/// A capsule along a line: where its segment begins and ends on it, and its radius.
#[derive(Debug, Clone, Copy)]
pub(super) struct Enclosing {
    pub(super) from: f64,
    pub(super) to: f64,
    pub(super) radius: f64,
}

/// Returns the capsule of least volume along a line that contains points, each given by its place on the line and its distance
/// from it.
///
/// For a given radius R a point at (z, rho) is inside where the segment comes within sqrt(R^2 - rho^2) of z, so the shortest
/// segment is known. A larger radius makes a shorter one: radii are tried between that of the points about the line and that of
/// the sphere around all.
pub(super) fn enclosing(points: &[(f64, f64)]) -> Enclosing {
    let least = points.iter().map(|point| point.1).fold(0.0, f64::max);
    let (low, high) = points
        .iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), (z, _)| (low.min(*z), high.max(*z)));
    let middle = f64::midpoint(low, high);
    let most = points.iter().map(|(z, rho)| (z - middle).hypot(*rho)).fold(0.0, f64::max);
    let step = (most - least) / RADII as f64;
    let coarse = best(points, least, step);
    let fine = best(points, (coarse.radius - step).max(least), 2.0 * step / RADII as f64);
    let tightest = if volume(&fine) < volume(&coarse) { fine } else { coarse };
    Enclosing { radius: tightest.radius * (1.0 + ROUNDING), ..tightest }
}

fn best(points: &[(f64, f64)], first: f64, step: f64) -> Enclosing {
    let mut best = of_radius(points, first);
    for number in 1..=RADII {
        let other = of_radius(points, first + step * number as f64);
        if volume(&other) < volume(&best) {
            best = other;
        }
    }
    best
}

/// The shortest capsule of that radius.
fn of_radius(points: &[(f64, f64)], radius: f64) -> Enclosing {
    let (mut from, mut to) = (f64::INFINITY, f64::NEG_INFINITY);
    for (z, rho) in points {
        let reach = (radius * radius - rho * rho).max(0.0).sqrt();
        from = from.min(z + reach);
        to = to.max(z - reach);
    }
    if from > to {
        (from, to) = (f64::midpoint(from, to), f64::midpoint(from, to));
    }
    Enclosing { from, to, radius }
}

fn volume(capsule: &Enclosing) -> f64 {
    let Enclosing { from, to, radius } = capsule;
    PI * radius * radius * (to - from + 4.0 / 3.0 * radius)
}
