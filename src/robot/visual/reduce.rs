//! Meshes with fewer triangles.

use std::collections::{HashMap, HashSet};

use super::mesh::{Mesh, MeshPart, Triangle};

/// Finest and coarsest grids that are tried [cells along the longest side].
const GRIDS: [u32; 12] = [512, 384, 256, 192, 144, 108, 80, 60, 44, 32, 22, 14];

impl Mesh {
    /// Returns the mesh with at most `most` triangles, or with few where `most` is very small: corners that are near each
    /// other become one, in the finest grid that is coarse enough. A mesh that is small enough stays as it is.
    #[must_use]
    pub fn reduced(self, most: usize) -> Self {
        if self.triangles() <= most {
            return self;
        }
        let (low, side) = self.cube();
        let coarse = |cells: u32| Self {
            parts: self.parts.iter().map(|part| clustered(part, low, side / cells as f32)).collect(),
        };
        let mut mesh = Self::default();
        for cells in GRIDS {
            mesh = coarse(cells);
            if mesh.triangles() <= most {
                break;
            }
        }
        mesh.parts.retain(|part| !part.triangles.is_empty());
        mesh
    }

    /// The lowest corner of all, and the length of the longest side \[m\].
    fn cube(&self) -> ([f32; 3], f32) {
        let corners = || self.parts.iter().flat_map(|part| &part.triangles).flatten();
        let fold = |first: f32, pick: fn(f32, f32) -> f32| -> [f32; 3] {
            std::array::from_fn(|axis| corners().map(|corner| corner[axis]).fold(first, pick))
        };
        let (low, high) = (fold(f32::MAX, f32::min), fold(f32::MIN, f32::max));
        let side = (0..3).map(|axis| high[axis] - low[axis]).fold(f32::MIN_POSITIVE, f32::max);
        (low, side)
    }
}

/// The triangles that are left when all corners of one cell stand at their common middle.
fn clustered(part: &MeshPart, low: [f32; 3], cell: f32) -> MeshPart {
    let cell_of = |corner: &[f32; 3]| -> [u32; 3] {
        std::array::from_fn(|axis| ((corner[axis] - low[axis]) / cell) as u32)
    };
    let mut middles: HashMap<[u32; 3], ([f64; 3], f64)> = HashMap::new();
    for corner in part.triangles.iter().flatten() {
        let (sum, count) = middles.entry(cell_of(corner)).or_default();
        (0..3).for_each(|axis| sum[axis] += f64::from(corner[axis]));
        *count += 1.0;
    }
    let mut seen = HashSet::new();
    let mut kept = |triangle: &Triangle| {
        let cells = triangle.each_ref().map(cell_of);
        let [a, b, c] = cells;
        let mut sorted = cells;
        sorted.sort_unstable();
        (a != b && b != c && a != c && seen.insert(sorted)).then(|| {
            cells.map(|cell| {
                let (sum, count) = middles[&cell];
                sum.map(|sum| (sum / count) as f32)
            })
        })
    };
    MeshPart { colour: part.colour, triangles: part.triangles.iter().filter_map(&mut kept).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A closed band of small triangles around a circle of radius one.
    fn band(count: usize) -> Mesh {
        let at = |i: usize, z: f32| {
            let (sine, cosine) = (std::f32::consts::TAU * i as f32 / count as f32).sin_cos();
            [cosine, sine, z]
        };
        let pair = |i: usize| {
            [[at(i, 0.0), at(i + 1, 0.0), at(i, 1.0)], [at(i, 1.0), at(i + 1, 0.0), at(i + 1, 1.0)]]
        };
        Mesh { parts: vec![MeshPart { colour: None, triangles: (0..count).flat_map(pair).collect() }] }
    }

    #[test]
    fn a_reduced_mesh_stays_near_the_surface() {
        let reduced = band(20_000).reduced(300);
        assert!((20..=300).contains(&reduced.triangles()), "{}", reduced.triangles());
        for [x, y, _] in reduced.parts[0].triangles.iter().flatten() {
            assert!((x.hypot(*y) - 1.0).abs() < 0.1);
        }
        assert_eq!(reduced, band(20_000).reduced(300), "the same every time");
    }

    #[test]
    fn a_small_mesh_stays_as_it_is() {
        assert_eq!(band(10).reduced(20), band(10));
    }
}
