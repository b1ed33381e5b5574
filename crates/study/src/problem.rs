//! Ordinary differential equations with known solutions, on which formulas show their own order.

/// An initial value problem `x' = f(t, x)` from t = 0 with its exact solution.
#[derive(Clone, Copy, Debug)]
pub struct Problem {
    /// What reports call it.
    pub name: &'static str,
    /// How far it is followed.
    pub duration: f64,
    /// Entries of the state.
    pub dimension: usize,
    /// Writes `f(t, x)`.
    pub derivative: fn(f64, &[f64], &mut [f64]),
    /// Writes the solution at `t`.
    pub exact: fn(f64, &mut [f64]),
}

impl Problem {
    /// `x' = x cos t`, whose solution `exp(sin t)` is analytic, swings, and neither grows nor dies out.
    pub const SWING: Self = Self {
        name: "swing",
        duration: 6.0,
        dimension: 1,
        derivative: |t, x, f| f[0] = x[0] * t.cos(),
        exact: |t, x| x[0] = t.sin().exp(),
    };

    /// `x' = x^2 cos t`, nonlinear, whose solution `1 / (2 - sin t)` has a pulse in every period.
    pub const PULSE: Self = Self {
        name: "pulse",
        duration: 6.0,
        dimension: 1,
        derivative: |t, x, f| f[0] = x[0] * x[0] * t.cos(),
        exact: |t, x| x[0] = (2.0 - t.sin()).recip(),
    };

    /// The problems on which every row of the formula table is tried.
    pub const SMOOTH: [Self; 2] = [Self::SWING, Self::PULSE];

    /// The initial state.
    pub fn initial(&self) -> Vec<f64> {
        let mut x = vec![0.0; self.dimension];
        (self.exact)(0.0, &mut x);
        x
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn solutions_satisfy_their_equations(t in 0.0..6.0_f64) {
            let step = 1e-5;
            for problem in Problem::SMOOTH {
                let at = |t| {
                    let mut x = vec![0.0; problem.dimension];
                    (problem.exact)(t, &mut x);
                    x
                };
                let mut f = vec![0.0; problem.dimension];
                (problem.derivative)(t, &at(t), &mut f);
                for (i, f) in f.iter().enumerate() {
                    prop_assert!(((at(t + step)[i] - at(t - step)[i]) / (2.0 * step) - f).abs() < 1e-8);
                }
            }
        }
    }
}
