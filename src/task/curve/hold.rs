use super::super::{Path, PathPoint};
use super::{CurveKind, MakeCurve};
use crate::kind::{Kind, Parameters};
use nalgebra::Vector3;

/// No path at all: what follows it stays where it is.
#[derive(Clone, Copy, Debug)]
pub struct Hold;

impl Path for Hold {
    fn point(&self, _u: f64) -> PathPoint {
        PathPoint { position: Vector3::zeros(), tangent: Vector3::zeros() }
    }
}

pub(super) const KIND: CurveKind = Kind::new(
    "hold",
    "Stays where it is; a `turn` turns it there.",
    &[],
    MakeCurve::FromTip(|_, _| Box::new(Hold)),
)
.with_draw(|_, _| Parameters::new());
