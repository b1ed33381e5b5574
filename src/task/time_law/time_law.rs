/// How the progress `u` along a path runs with the time: `u(tau)` on `tau = t / T` in [0, 1].
///
/// A start of multistep formulas is smooth to the order to which `u` begins at rest.
pub trait TimeLaw: Send + Sync {
    /// The progress `u` and its derivative `du / dtau`.
    fn progress(&self, tau: f64) -> (f64, f64);
}

impl TimeLaw for Box<dyn TimeLaw> {
    fn progress(&self, tau: f64) -> (f64, f64) {
        (**self).progress(tau)
    }
}
