/// A planar curve `(x, y)` by an angle \[rad\].
pub trait PlanarCurve: Send + Sync {
    /// The point \[m\] and its derivative by the angle [m/rad].
    fn point(&self, angle: f64) -> ([f64; 2], [f64; 2]);
}

impl PlanarCurve for Box<dyn PlanarCurve> {
    fn point(&self, angle: f64) -> ([f64; 2], [f64; 2]) {
        (**self).point(angle)
    }
}
