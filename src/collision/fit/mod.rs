//! Capsules around what a robot's file gives its links.

mod enclosing;
mod points;

use std::collections::HashSet;
use std::f64::consts::PI;
use std::path::Path;

use nalgebra::{IsometryMatrix3, Vector3};

use super::{Capsule, ShapeError};
use crate::robot::{Mesh, Shape, find_mesh};
use enclosing::enclosing;

/// A capsule and how well it stands for a shape.
pub(super) struct Fitted {
    pub(super) capsule: Capsule,
    /// Volume of the capsule over that of the shape; `None` where the shape has none that is known.
    pub(super) volume_ratio: Option<f64>,
}

/// Returns the smallest capsule around a shape of a robot's file that stands at `origin`: exact for spheres and capsules, along the
/// axis of a cylinder, along the longest side of a box, along a principal axis of a mesh, which is looked for from `folder`.
///
/// # Errors
/// A sentence that says why there is none.
pub(super) fn fitted(
    shape: &Shape,
    origin: &IsometryMatrix3<f64>,
    folder: Option<&Path>,
) -> Result<Fitted, String> {
    let upright = Vector3::z();
    let (capsule, volume) = match shape {
        Shape::Sphere { radius } => (Capsule::sphere(Vector3::zeros(), *radius), Some(ball(*radius))),
        Shape::Capsule { radius, length } => {
            let end = upright * (length / 2.0);
            (Capsule::new(-end, end, *radius), Some(ball(*radius) + PI * radius * radius * length))
        }
        Shape::Cylinder { radius, length } => {
            (around_prism(upright, *length, *radius), Some(PI * radius * radius * length))
        }
        Shape::Box { sides } => (around_box(*sides), Some(sides.iter().product())),
        Shape::Mesh { reference, scale } => {
            let (points, volume) = mesh(reference, *scale, folder)?;
            (points::around(&points), volume)
        }
    };
    let capsule = capsule.map_err(|error| error.to_string())?.placed(origin);
    Ok(Fitted {
        capsule,
        volume_ratio: volume.filter(|volume| *volume > 0.0).map(|volume| capsule.volume() / volume),
    })
}

fn ball(radius: f64) -> f64 {
    4.0 / 3.0 * PI * radius.powi(3)
}

/// A capsule about an axis, around a prism or cylinder about its middle whose corners are at that distance from the axis.
fn around_prism(axis: Vector3<f64>, length: f64, distance: f64) -> Result<Capsule, ShapeError> {
    let tightest = enclosing(&[(-length / 2.0, distance), (length / 2.0, distance)]);
    Capsule::new(axis * tightest.from, axis * tightest.to, tightest.radius)
}

fn around_box(sides: [f64; 3]) -> Result<Capsule, ShapeError> {
    let longest = Vector3::from(sides).imax();
    let [one, other] = [1, 2].map(|i| sides[(longest + i) % 3] / 2.0);
    around_prism(Vector3::ith(longest, 1.0), sides[longest], one.hypot(other))
}

/// The corners of a mesh, and the volume that it encloses where it is closed.
fn mesh(
    reference: &str,
    scale: [f64; 3],
    folder: Option<&Path>,
) -> Result<(Vec<Vector3<f64>>, Option<f64>), String> {
    let Some(folder) = folder else {
        return Err(format!("the mesh {reference} is in a file, and from where to look for it is not known"));
    };
    let path = find_mesh(reference, folder).ok_or_else(|| {
        format!("the mesh {reference} is in no file that was found; give the link a capsule")
    })?;
    let mesh = Mesh::read(&path).map_err(|error| error.to_string())?;
    let scaled = |corner: &[f32; 3]| Vector3::from_fn(|i, _| f64::from(corner[i]) * scale[i]);
    let triangles = || mesh.parts.iter().flat_map(|part| &part.triangles);
    let mut seen = HashSet::new();
    let corners = triangles().flatten().filter(|corner| seen.insert(corner.map(f32::to_bits)));
    let corners = corners.map(scaled).collect();
    let volume: f64 = triangles()
        .map(|triangle| {
            let [a, b, c] = triangle.each_ref().map(scaled);
            a.cross(&b).dot(&c) / 6.0
        })
        .sum();
    Ok((corners, is_closed(&mesh).then_some(volume.abs())))
}

/// Whether every edge of a mesh is passed as often in one direction as in the other.
fn is_closed(mesh: &Mesh) -> bool {
    let mut edges = std::collections::HashMap::<_, i32>::new();
    for triangle in mesh.parts.iter().flat_map(|part| &part.triangles) {
        let corners = triangle.map(|corner| corner.map(f32::to_bits));
        for i in 0..3 {
            let (a, b) = (corners[i], corners[(i + 1) % 3]);
            *edges.entry((a.min(b), a.max(b))).or_default() += if a < b { 1 } else { -1 };
        }
    }
    edges.values().all(|count| *count == 0)
}
