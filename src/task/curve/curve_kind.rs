use super::super::Path;
use super::PlanarCurve;
use crate::kind::{Kind, Parameters};
use nalgebra::Vector3;

/// A curve that files can name.
pub type CurveKind = Kind<MakeCurve>;

/// How a curve is made of its parameters, and how it is laid into the world.
#[derive(Clone, Copy, Debug)]
pub enum MakeCurve {
    /// A planar curve by an angle: it is laid by a plane, a rotation, the angles it runs over, and a centre.
    Planar(fn(&Parameters) -> Box<dyn PlanarCurve>),
    /// A path in space about an origin of its own: it is laid by a centre.
    Centered(fn(&Parameters) -> Box<dyn Path>),
    /// A path that begins at the tip, which stands there \[m\].
    FromTip(fn(&Parameters, &Vector3<f64>) -> Box<dyn Path>),
}
