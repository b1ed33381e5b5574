//! A capsule and a half-space.

use super::{Capsule, HalfSpace, Separation};

/// Differences of height below this part of the length are rounding.
const LEVEL: f64 = 1e-12;

/// Returns the separation of a capsule and a half-space: the lower end of the segment decides, the middle of one that is level.
pub(super) fn separation(capsule: &Capsule, solid: &HalfSpace) -> Separation {
    let along = capsule.to() - capsule.from();
    let rise = along.dot(&solid.normal());
    let p = if rise.abs() <= LEVEL * along.norm() {
        capsule.middle()
    } else if rise > 0.0 {
        capsule.from()
    } else {
        capsule.to()
    };
    let distance = solid.height_of(&p);
    let core = Separation { distance, normal: solid.normal(), points: [p, p - solid.normal() * distance] };
    core.inflated(capsule.radius(), 0.0)
}
