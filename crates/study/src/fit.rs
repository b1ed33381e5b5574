//! A power law through the errors of a window, with its confidence.

/// The 97.5 % points of Student's distribution with 1, 2, ... degrees of freedom.
const STUDENT: [f64; 10] = [12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228];

/// `error = constant * sigma^order`, fitted to the logarithms by least squares.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    /// The exponent.
    pub order: f64,
    /// Its standard error, from the scatter about the line.
    pub standard_error: f64,
    /// Half the width of its 95 % confidence interval.
    pub half_width: f64,
    /// The factor.
    pub constant: f64,
    /// The first rung of the window.
    pub from: usize,
    /// One beyond the last rung of the window.
    pub to: usize,
}

impl Fit {
    /// The fit to the rungs `from..to`; `None` below three rungs or where an error has no logarithm.
    ///
    /// ```
    /// use kinstep_study::Fit;
    /// let sigmas = [0.1, 0.05, 0.025, 0.0125];
    /// let fit = Fit::of(&sigmas, &sigmas.map(|sigma: f64| 3.0 * sigma.powi(4)), 0, 4).unwrap();
    /// assert!((fit.order - 4.0).abs() < 1e-12 && (fit.constant - 3.0).abs() < 1e-10);
    /// ```
    ///
    /// # Panics
    /// If the window lies outside the rungs.
    pub fn of(sigmas: &[f64], errors: &[f64], from: usize, to: usize) -> Option<Self> {
        let points: Vec<(f64, f64)> =
            sigmas[from..to].iter().zip(&errors[from..to]).map(|(s, e)| (s.ln(), e.ln())).collect();
        if points.len() < 3 || points.iter().any(|(x, y)| !x.is_finite() || !y.is_finite()) {
            return None;
        }
        let count = points.len() as f64;
        let mean = |pick: fn(&(f64, f64)) -> f64| points.iter().map(pick).sum::<f64>() / count;
        let (x0, y0) = (mean(|p| p.0), mean(|p| p.1));
        let spread: f64 = points.iter().map(|(x, _)| (x - x0).powi(2)).sum();
        let order = points.iter().map(|(x, y)| (x - x0) * (y - y0)).sum::<f64>() / spread;
        let residual: f64 = points.iter().map(|(x, y)| (y - y0 - order * (x - x0)).powi(2)).sum();
        let freedom = points.len() - 2;
        let standard_error = (residual / freedom as f64 / spread).sqrt();
        let student = STUDENT.get(freedom - 1).copied().unwrap_or(1.96 + 2.6 / freedom as f64);
        Some(Self {
            order,
            standard_error,
            half_width: student * standard_error,
            constant: (y0 - order * x0).exp(),
            from,
            to,
        })
    }

    /// The error that the fit gives at a gap \[s\].
    pub fn error_at(&self, sigma: f64) -> f64 {
        self.constant * sigma.powf(self.order)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_known_line_has_its_known_scatter() {
        // y = x with residuals +1, -2, +1 on x = 0, 1, 2: slope 1, residual 6, one degree of freedom, spread 2.
        let sigmas = [0.0, 1.0, 2.0].map(f64::exp);
        let errors = [1.0, -1.0, 3.0].map(f64::exp);
        let fit = Fit::of(&sigmas, &errors, 0, 3).unwrap();
        assert!((fit.order - 1.0).abs() < 1e-12);
        assert!((fit.standard_error - 3.0_f64.sqrt()).abs() < 1e-12);
        assert!((fit.half_width - 12.706 * 3.0_f64.sqrt()).abs() < 1e-9);
        assert_eq!(Fit::of(&sigmas, &errors, 0, 2), None);
        assert_eq!(Fit::of(&sigmas, &[1.0, 0.0, 1.0], 0, 3), None);
    }

    proptest! {
        #[test]
        fn nineteen_of_twenty_intervals_hold_the_order(seed in 0_u64..200) {
            // 200 fits of noisy power laws a case: the share that holds the order is near 95 %.
            let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
            let mut normal = || {
                let mut sum = 0.0;
                for _ in 0..12 {
                    state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                    sum += (state >> 11) as f64 / (1_u64 << 53) as f64;
                }
                sum - 6.0
            };
            let sigmas: Vec<f64> = (0..6).map(|k| 0.1 / f64::from(1 << k)).collect();
            let mut held = 0;
            for _ in 0..200 {
                let errors: Vec<f64> = sigmas.iter().map(|s| s.powi(3) * (0.1 * normal()).exp()).collect();
                let fit = Fit::of(&sigmas, &errors, 0, 6).unwrap();
                held += u32::from((fit.order - 3.0).abs() <= fit.half_width);
            }
            prop_assert!((175..=200).contains(&held), "{held} of 200");
        }
    }
}
