use super::kind::RowKind;
use std::fmt::Debug;

/// Where a row of varying steps writes its coefficients, newest sample first; each list has `steps + 1` entries, zero before.
#[derive(Debug)]
pub struct RatioRow<'a, T> {
    /// The weights of the states; the first one is not zero.
    pub alpha: &'a mut [T],
    /// The weights of `f`, to be multiplied by the step from `t_n` to `t_{n+1}`.
    pub beta: &'a mut [T],
    /// The weights of `g`, where the row [is split](RatioCoefficients::is_split).
    pub gamma: &'a mut [T],
}

/// A row whose coefficients depend on the ratios of the last steps: a multistep formula for varying steps.
///
/// With `h_m = t_m - t_{m-1}` it is
/// `sum_j alpha_j x_{n+1-j} = h_{n+1} sum_j (beta_j f_{n+1-j} + gamma_j g_{n+1-j})`, where `alpha`, `beta` and `gamma` are
/// functions of the `steps - 1` ratios `h_{n+1}/h_n, h_n/h_{n-1}, ...`, newest first. At equal steps all ratios are one.
///
/// The Adams-Bashforth formula of two steps, `x_{n+1} = x_n + h_{n+1} ((1 + w/2) f_n - (w/2) f_{n-1})` with
/// `w = h_{n+1}/h_n` (Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I, section III.5):
///
/// ```
/// use kinstep::integrate::{RatioCoefficients, RatioRow};
///
/// #[derive(Debug)]
/// struct AdamsBashforth2;
///
/// impl RatioCoefficients<f64> for AdamsBashforth2 {
///     fn id(&self) -> &str {
///         "ab2-varying"
///     }
///     fn steps(&self) -> usize {
///         2
///     }
///     fn order(&self) -> usize {
///         2
///     }
///     fn write(&self, ratios: &[f64], row: RatioRow<'_, f64>) {
///         row.alpha[..2].copy_from_slice(&[1.0, -1.0]);
///         row.beta[1..].copy_from_slice(&[1.0 + ratios[0] / 2.0, -ratios[0] / 2.0]);
///     }
///     fn per_step_constant(&self, ratios: &[f64]) -> f64 {
///         1.0 / 6.0 + 1.0 / (4.0 * ratios[0])
///     }
/// }
///
/// assert!((AdamsBashforth2.per_step_constant(&[1.0]) - 5.0 / 12.0).abs() < 1e-15);
/// ```
pub trait RatioCoefficients<T>: Debug + Send + Sync {
    /// Returns the name, for messages.
    fn id(&self) -> &str;

    /// Returns the number of steps: how many past states are needed.
    fn steps(&self) -> usize;

    /// Returns the order: on any bounded ratios the step errs by a multiple of `h_{n+1}^(order + 1)`.
    fn order(&self) -> usize;

    /// Returns what the row needs at the new state: nothing, unless overridden.
    fn kind(&self) -> RowKind {
        RowKind::Explicit
    }

    /// Returns whether `g` has weights of its own; otherwise `gamma` becomes `beta`.
    fn is_split(&self) -> bool {
        false
    }

    /// Writes the coefficients for these ratios. It is called once for each attempt of a step and should not allocate.
    fn write(&self, ratios: &[T], row: RatioRow<'_, T>);

    /// Returns C of the local error `x(t_{n+1}) - x_{n+1} = C h_{n+1}^(p+1) x^(p+1)`, p the order, for these ratios.
    fn per_step_constant(&self, ratios: &[T]) -> T;
}
