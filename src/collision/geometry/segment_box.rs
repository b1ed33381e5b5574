//! A capsule and a box.

use nalgebra::Vector3;

use super::segments::nearest_points;
use super::{Capsule, Cuboid, Separation};

/// Slopes below this part of what they are made of are rounding.
const FLAT: f64 = 1e-14;
/// Distances below this part of the coordinates have no direction that could be told from rounding.
const TOUCHING: f64 = 1e-13;

/// Returns the separation of a capsule and a box, in the axes in which both are given.
///
/// Apart, the squared distance along the segment is convex and piecewise quadratic: its slope is piecewise linear, and where it
/// changes its sign the segment is nearest. Where the segment enters the box, the box grown by the segment is a polytope with
/// normals along the box's axes and along their cross products with the segment: the nearest of its faces tells how the two part.
pub(super) fn separation(capsule: &Capsule, cuboid: &Cuboid) -> Separation {
    let core = Core { segment: capsule.placed(&cuboid.pose().inverse()), half: cuboid.half_sides() };
    core.separation().inflated(capsule.radius(), 0.0).moved(cuboid.pose())
}

/// A segment in the axes of a box.
struct Core {
    segment: Capsule,
    half: Vector3<f64>,
}

impl Core {
    fn separation(&self) -> Separation {
        let p = self.point(self.nearest_part());
        let q = self.clamped(&p);
        let (between, size) = (p - q, self.half.amax().max(p.amax()));
        let distance = between.norm();
        if distance > TOUCHING * size {
            return Separation { distance, normal: between / distance, points: [p, q] };
        }
        self.overlap()
    }

    fn along(&self) -> Vector3<f64> {
        self.segment.to() - self.segment.from()
    }

    /// The point at a part of the segment, its ends exactly.
    fn point(&self, part: f64) -> Vector3<f64> {
        if part < 0.5 {
            self.segment.from() + self.along() * part
        } else {
            self.segment.to() - self.along() * (1.0 - part)
        }
    }

    /// The point of the box that is nearest.
    fn clamped(&self, point: &Vector3<f64>) -> Vector3<f64> {
        point.zip_map(&self.half, |point, half| point.clamp(-half, half))
    }

    /// Half the slope of the squared distance at a part of the segment; zero where it is rounding.
    fn slope(&self, part: f64) -> f64 {
        let (point, along) = (self.point(part), self.along());
        let beyond = point - self.clamped(&point);
        let slope = beyond.dot(&along);
        if slope.abs() <= FLAT * beyond.norm() * along.norm() { 0.0 } else { slope }
    }

    /// The part of the segment that is nearest to the box, the middle of it where there are many.
    fn nearest_part(&self) -> f64 {
        let knots = self.knots();
        let slopes = knots.map(|knot| self.slope(knot));
        let last_falling = slopes.iter().rposition(|&slope| slope < 0.0);
        let first_rising = slopes.iter().position(|&slope| slope > 0.0);
        let (low, high) =
            (last_falling.map_or(0, |i| i + 1), first_rising.map_or(7, |i| i.saturating_sub(1)));
        match (last_falling, first_rising) {
            (_, Some(0)) => 0.0,
            (Some(7), _) => 1.0,
            // The slope passes through zero between two knots.
            (Some(i), Some(j)) if j == i + 1 => {
                knots[i] + (knots[j] - knots[i]) * (slopes[i] / (slopes[i] - slopes[j]))
            }
            _ => f64::midpoint(knots[low.min(high)], knots[high.max(low)]),
        }
    }

    /// The parts of the segment at which the slope may bend, in order: its ends, and where it crosses the planes of the faces.
    fn knots(&self) -> [f64; 8] {
        let (from, along) = (self.segment.from(), self.along());
        let mut knots = [0.0; 8];
        for axis in 0..3 {
            for (side, sign) in [-1.0, 1.0].into_iter().enumerate() {
                let part = (sign * self.half[axis] - from[axis]) / along[axis];
                knots[2 * axis + side] = if part > 0.0 && part < 1.0 { part } else { 0.0 };
            }
        }
        knots[7] = 1.0;
        knots.sort_unstable_by(f64::total_cmp);
        knots
    }

    /// The least shift that parts the two, where they overlap.
    fn overlap(&self) -> Separation {
        let mut best = self.face_gap(0);
        let mut face = Some(0);
        for axis in 1..3 {
            let gap = self.face_gap(axis);
            if gap.0 > best.0 {
                (best, face) = (gap, Some(axis));
            }
        }
        for axis in 0..3 {
            if let Some(gap) = self.edge_gap(axis).filter(|gap| gap.0 > best.0) {
                (best, face) = (gap, None);
            }
        }
        let (distance, normal) = best;
        match face {
            Some(axis) => self.through_face(axis, distance, normal),
            None => self.over_edge(distance, normal),
        }
    }

    /// The gap along an axis of the box, and the direction in which it opens.
    fn face_gap(&self, axis: usize) -> (f64, Vector3<f64>) {
        self.gap(Vector3::ith(axis, 1.0))
    }

    /// The gap along the common normal of the segment and an edge, where there is one.
    fn edge_gap(&self, axis: usize) -> Option<(f64, Vector3<f64>)> {
        let along = self.along().try_normalize(0.0)?;
        let normal = Vector3::ith(axis, 1.0).cross(&along);
        Some(self.gap(normal.try_normalize(1e-12)?))
    }

    /// The gap between the shadows of segment and box on a unit vector, which is turned towards the segment.
    fn gap(&self, normal: Vector3<f64>) -> (f64, Vector3<f64>) {
        let middle = self.segment.middle().dot(&normal);
        let shadow = self.half.dot(&normal.abs()) + self.along().dot(&normal).abs() / 2.0;
        (middle.abs() - shadow, if middle < 0.0 { -normal } else { normal })
    }

    /// Leaves through a face: the deepest point of the segment comes to lie on it.
    fn through_face(&self, axis: usize, distance: f64, normal: Vector3<f64>) -> Separation {
        let slope = self.along().dot(&normal);
        let part = if slope.abs() <= 1e-12 * self.along().norm() {
            self.middle_over_face(axis)
        } else if slope > 0.0 {
            0.0
        } else {
            1.0
        };
        let p = self.point(part);
        Separation { distance, normal, points: [p, p - normal * distance] }
    }

    /// The middle of the part of the segment that lies over a face.
    fn middle_over_face(&self, axis: usize) -> f64 {
        let (from, along) = (self.segment.from(), self.along());
        let (mut low, mut high): (f64, f64) = (0.0, 1.0);
        for other in (0..3).filter(|&other| other != axis && along[other] != 0.0) {
            let ends = [-1.0, 1.0].map(|sign| (sign * self.half[other] - from[other]) / along[other]);
            low = low.max(ends[0].min(ends[1]));
            high = high.min(ends[0].max(ends[1]));
        }
        f64::midpoint(low, high).clamp(0.0, 1.0)
    }

    /// Leaves over an edge, which the segment comes to cross.
    fn over_edge(&self, distance: f64, normal: Vector3<f64>) -> Separation {
        let corner = normal.zip_map(&self.half, |normal, half| half.copysign(normal));
        let mut other = corner;
        // The edge runs along the axis on which the normal has no part.
        let axis = normal.iamin();
        other[axis] = -corner[axis];
        let p = match Capsule::new(corner, other, 0.0) {
            Ok(edge) => nearest_points(&self.segment, &edge)[0],
            Err(_) => self.segment.middle(),
        };
        Separation { distance, normal, points: [p, p - normal * distance] }
    }
}
