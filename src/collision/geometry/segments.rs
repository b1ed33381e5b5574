//! Two capsules.

use nalgebra::Vector3;

use super::{Capsule, Separation};

/// Sines of angles between segments below this count as zero, so that the rounding of parallel ones decides nothing.
const PARALLEL: f64 = 1e-12;
/// What is closer than this part of the coordinates has no direction that could be told from rounding.
const ROUNDING: f64 = 1e-14;

/// Returns the separation of two capsules, from the nearest points of their segments.
///
/// The squared distance is a convex quadratic on a square: its least value lies inside, where the segments are not parallel, or
/// on a side, where it is the distance of an end from the other segment. The least of all these candidates is the distance.
/// Parallel segments have many nearest points; the middle of the part where they face each other is taken. Segments that cross
/// part soonest along their common normal.
pub(super) fn separation(a: &Capsule, b: &Capsule) -> Separation {
    let [p, q] = nearest_points(a, b);
    let between = p - q;
    let distance = between.norm();
    let size = p.amax().max(q.amax());
    let core = if distance > ROUNDING * size {
        Separation { distance, normal: between / distance, points: [p, q] }
    } else {
        let normal = common_normal(&(a.to() - a.from()), &(b.to() - b.from()));
        Separation { distance: 0.0, normal, points: [p, p] }
    };
    core.inflated(a.radius(), b.radius())
}

/// Returns the nearest points of the segments of `a` and `b`.
pub(super) fn nearest_points(a: &Capsule, b: &Capsule) -> [Vector3<f64>; 2] {
    let on_b = |p: Vector3<f64>| [p, b.nearest(&p)];
    let on_a = |q: Vector3<f64>| [a.nearest(&q), q];
    let square = |[p, q]: &[Vector3<f64>; 2]| (p - q).norm_squared();
    let mut best = on_b(a.from());
    for pair in [on_b(a.to()), on_a(b.from()), on_a(b.to())] {
        if square(&pair) < square(&best) {
            best = pair;
        }
    }
    match inner(a, b) {
        Some(Inner::Crossing(p)) => {
            // A step back and forth takes out what rounding has left.
            let [_, q] = on_b(p);
            let pair = on_a(q);
            if square(&pair) < square(&best) { pair } else { best }
        }
        Some(Inner::Facing(p)) => {
            let pair = on_b(p);
            let slack = 1.0 + PARALLEL;
            if square(&pair) <= square(&best) * slack * slack { pair } else { best }
        }
        None => best,
    }
}

/// Where the nearest points may lie inside of both segments, as a point of the first.
enum Inner {
    /// The foot of the common perpendicular.
    Crossing(Vector3<f64>),
    /// The middle of what faces the other, where they are parallel.
    Facing(Vector3<f64>),
}

fn inner(a: &Capsule, b: &Capsule) -> Option<Inner> {
    let (u, v) = (a.to() - a.from(), b.to() - b.from());
    let (length_u, length_v) = (u.norm(), v.norm());
    if !(length_u > 0.0 && length_v > 0.0) {
        return None;
    }
    let (e, f) = (u / length_u, v / length_v);
    let cross = e.cross(&f);
    let between = b.from() - a.from();
    if cross.norm() > PARALLEL {
        let along = between.cross(&f).dot(&cross) / cross.norm_squared();
        return (0.0..=length_u).contains(&along).then(|| Inner::Crossing(a.from() + e * along));
    }
    let ends = [between.dot(&e), (b.to() - a.from()).dot(&e)];
    let (low, high) = (ends[0].min(ends[1]).max(0.0), ends[0].max(ends[1]).min(length_u));
    (low <= high).then(|| Inner::Facing(a.from() + e * f64::midpoint(low, high)))
}

/// Returns a unit vector at right angles to both vectors, whatever they are.
pub(super) fn common_normal(u: &Vector3<f64>, v: &Vector3<f64>) -> Vector3<f64> {
    let (u, v) = (unit(u), unit(v));
    let cross = u.cross(&v);
    if cross.norm() > PARALLEL {
        return cross.normalize();
    }
    let along = if u == Vector3::zeros() { v } else { u };
    if along == Vector3::zeros() {
        return Vector3::z();
    }
    along.cross(&Vector3::ith(along.iamin(), 1.0)).normalize()
}

/// The vector scaled to length one, or zero.
fn unit(vector: &Vector3<f64>) -> Vector3<f64> {
    vector.try_normalize(0.0).unwrap_or_else(Vector3::zeros)
}
