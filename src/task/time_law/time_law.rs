/// How the progress `u` along a path runs with the time: `u(tau)` on `tau = t / T` in [0, 1].
///
/// A start of multistep formulas is smooth to the order to which `u` begins at rest.
pub trait TimeLaw: Send + Sync {
    /// The progress `u` and its derivative `du / dtau`.
    fn progress(&self, tau: f64) -> (f64, f64);

    /// How many derivatives of `u` are continuous on the way from 0 to 1; `None` where all are, as unless overridden.
    ///
    /// With `k` of them the errors of a run fall like `sigma^(k+1)` at best, whatever the order of its formula.
    fn smoothness(&self) -> Option<usize> {
        None
    }
}

impl TimeLaw for Box<dyn TimeLaw> {
    fn progress(&self, tau: f64) -> (f64, f64) {
        (**self).progress(tau)
    }

    fn smoothness(&self) -> Option<usize> {
        (**self).smoothness()
    }
}
