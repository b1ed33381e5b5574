//! The figures of an explicit row in doubles, fast enough for millions of rows.

use crate::formula::{Analysis, MAX_STEPS};
use crate::math::rational_to_f64;

/// The figures of a row by which a search compares it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Figures {
    /// The end of the feedback range; infinity where there is none.
    pub h_max: f64,
    /// |C|, the error of one step in units of sigma^(p+1).
    pub per_step: f64,
    /// |c|, the error constant.
    pub error_constant: f64,
    /// The best feedback step h_opt.
    pub h_opt: f64,
    /// The spectral radius of the closed loop at h_opt.
    pub r_opt: f64,
    /// The gain of noise in phi' at h_opt, per unit of sigma.
    pub noise: f64,
}

/// A radius below this counts as zero: the loop forgets everything at once.
const LEAST_RADIUS: f64 = 1e-4;

impl Figures {
    /// Returns the exactly decided figures of a row, `None` where it has no range or no best step.
    pub fn exact(analysis: &Analysis) -> Option<Self> {
        let range = analysis.feedback_range().filter(|range| !range.is_empty())?;
        let optimum = analysis.optimum()?;
        Some(Self {
            h_max: range.value(),
            per_step: rational_to_f64(analysis.per_step_constant()?).abs(),
            error_constant: rational_to_f64(&analysis.error_constant()?).abs(),
            h_opt: optimum.h,
            r_opt: optimum.radius,
            noise: analysis.noise_gain(optimum.h).map_or(f64::INFINITY, |gain| gain.feedforward_per_sigma),
        })
    }

    /// Returns C/h_opt, the steady residual.
    pub fn steady(&self) -> f64 {
        self.per_step / self.h_opt
    }

    /// Returns C/(h_max (1 - r_opt)): little error, a wide range and fast decay together.
    pub fn economy(&self) -> f64 {
        self.per_step / (self.h_max * (1.0 - self.r_opt))
    }

    /// Returns r_opt, kept off zero so that it has a logarithm.
    pub(super) fn radius(&self) -> f64 {
        self.r_opt.max(LEAST_RADIUS)
    }
}

/// The weights of an explicit row, alpha_0 = 1, feedback divided by its sum.
#[derive(Debug, Clone)]
pub(super) struct FloatRow {
    pub(super) alpha: Vec<f64>,
    pub(super) beta: Vec<f64>,
    pub(super) feedback: Vec<f64>,
}

impl FloatRow {
    /// Returns rho/(z - 1).
    fn deflated(&self) -> Vec<f64> {
        let add = |sum: &mut f64, a: &f64| {
            *sum += a;
            Some(*sum)
        };
        self.alpha[..self.alpha.len() - 1].iter().scan(0.0, add).collect()
    }

    /// Returns whether only z = 1 is on the circle and nothing outside.
    pub(super) fn is_strictly_stable(&self) -> bool {
        is_schur_within(&self.deflated(), 1.0)
    }

    /// Returns the largest modulus of the roots of rho other than z = 1.
    pub(super) fn parasitic_radius(&self) -> f64 {
        let deflated = self.deflated();
        let mut high = 1.0;
        while !is_schur_within(&deflated, high) {
            high *= 2.0;
            if high > 1e6 {
                return f64::INFINITY;
            }
        }
        radius_below(&deflated, high, 24)
    }

    /// Returns the first h at which a root is on the circle; rho must have only z = 1 there.
    ///
    /// Along z = e^(i phi) the imaginary part of rho times conj(gamma) vanishes where -rho/gamma is real: those are the h sought,
    /// beside that of z = -1.
    pub(super) fn range_end(&self) -> f64 {
        let points = 24 * self.alpha.len();
        let angle = |k: usize| std::f64::consts::PI * (k as f64 + 0.5) / points as f64;
        let mut end =
            positive(-value_at(&self.alpha, (-1.0, 0.0)).0 / value_at(&self.feedback, (-1.0, 0.0)).0);
        let at = |k: usize| (angle(k), self.crossing(angle(k)).0);
        let (mut earlier, mut before) = (None, at(0));
        for k in 1..points {
            let here = at(k);
            if before.1 * here.1 <= 0.0 {
                end = end.min(positive(self.crossing(self.zero_between(before, here)).1));
            } else if let Some(earlier) = earlier {
                end = end.min(self.touch([earlier, before, here], end));
            }
            (earlier, before) = (Some(before), here);
        }
        end
    }

    /// Where roots touch the circle, or cross it and come back, between points that see nothing of it: the h of the vertex of
    /// their parabola, if it is below `end` and roots are at the circle there; else infinity.
    fn touch(&self, [a, b, c]: [(f64, f64); 3], end: f64) -> f64 {
        // Near z = 1 and h = 0 a root is at the circle anyway.
        const LEAST: f64 = 1e-3;
        const ALMOST: f64 = 1.0 - 1e-6;
        if b.1.abs() > a.1.abs() || b.1.abs() > c.1.abs() {
            return f64::INFINITY;
        }
        let step = (c.0 - b.0) / 32.0;
        let rough = vertex([a, b, c]);
        let phi = vertex([rough - step, rough, rough + step].map(|phi| (phi, self.crossing(phi).0)));
        let h = self.crossing(phi).1;
        let touches = (LEAST..end).contains(&h) && !is_schur_within(&self.loop_at(h), ALMOST);
        if touches { h } else { f64::INFINITY }
    }

    /// The coefficients of pi_h, highest power first.
    fn loop_at(&self, h: f64) -> Vec<f64> {
        self.alpha.iter().zip(&self.feedback).map(|(a, g)| a + h * g).collect()
    }

    /// The part that must vanish at z = e^(i phi), and the h there.
    fn crossing(&self, phi: f64) -> (f64, f64) {
        let z = (phi.cos(), phi.sin());
        let (rho, gamma) = (value_at(&self.alpha, z), value_at(&self.feedback, z));
        let size = gamma.0 * gamma.0 + gamma.1 * gamma.1;
        (rho.1 * gamma.0 - rho.0 * gamma.1, -(rho.0 * gamma.0 + rho.1 * gamma.1) / size)
    }

    /// False position with the Illinois correction.
    fn zero_between(&self, mut a: (f64, f64), mut b: (f64, f64)) -> f64 {
        for _ in 0..40 {
            let x = (a.0 * b.1 - b.0 * a.1) / (b.1 - a.1);
            if !x.is_finite() || (b.0 - a.0).abs() < 1e-12 {
                break;
            }
            let here = (x, self.crossing(x).0);
            if here.1 == 0.0 {
                return x;
            }
            if here.1 * b.1 < 0.0 {
                a = b;
            } else {
                a.1 /= 2.0;
            }
            b = here;
        }
        b.0
    }

    /// Returns the best h below `end` and the spectral radius there.
    pub(super) fn optimum(&self, end: f64) -> (f64, f64) {
        const SAMPLES: usize = 64;
        const WIDEST: f64 = 8.0;
        let end = end.min(WIDEST);
        let mut best = (end / 2.0, 1.0);
        // The second, finer walk looks for valleys too narrow for the first; few of its points are worth more than one test.
        for samples in [SAMPLES, 7 * SAMPLES] {
            let step = end / samples as f64;
            for k in 1..samples {
                self.improve(&mut best, step * k as f64, 12);
            }
            self.settle(&mut best, step, end);
        }
        best
    }

    /// Takes smaller and smaller steps downhill; a slope so gentle that many small steps lead down it is left where they end.
    fn settle(&self, best: &mut (f64, f64), mut step: f64, end: f64) {
        const MOST_MOVES: usize = 160;
        for _ in 0..MOST_MOVES {
            if step <= 1e-7 * end || best.1 <= LEAST_RADIUS {
                break;
            }
            let centre = best.0;
            let moved = [centre - step, centre + step]
                .into_iter()
                .filter(|h| (0.0..end).contains(h))
                .any(|h| self.improve(best, h, 30));
            if !moved {
                step /= 2.0;
            }
        }
    }

    /// Takes h where its radius is smaller.
    fn improve(&self, best: &mut (f64, f64), h: f64, halvings: usize) -> bool {
        let loop_at = self.loop_at(h);
        if !is_schur_within(&loop_at, best.1 * (1.0 - 1e-9)) {
            return false;
        }
        *best = (h, radius_below(&loop_at, best.1, halvings));
        true
    }

    /// Returns the gain of noise in phi' at h (Astrom, Jury and Agniel 1970).
    pub(super) fn noise(&self, h: f64) -> f64 {
        let mut a = self.loop_at(h);
        let mut b = self.beta.clone();
        let mut sum = 0.0;
        while let (Some(&a_last), Some(&b_last)) = (a.last(), b.last()) {
            let (alpha, beta) = (a_last / a[0], b_last / a[0]);
            sum += b_last * beta;
            let mirrored: Vec<f64> = a.iter().rev().copied().collect();
            b = b.iter().zip(&mirrored).take(b.len() - 1).map(|(x, m)| x - beta * m).collect();
            a = a.iter().zip(&mirrored).take(a.len() - 1).map(|(x, m)| x - alpha * m).collect();
        }
        sum.sqrt()
    }

    /// Returns |C| of a row of order p.
    pub(super) fn per_step(&self, order: usize) -> f64 {
        let next = i32::try_from(order).unwrap_or(i32::MAX - 1) + 1;
        let factorial: f64 = (1..=next).map(f64::from).product();
        let states: f64 = self.alpha.iter().enumerate().map(|(j, a)| a * (1.0 - j as f64).powi(next)).sum();
        let slopes: f64 =
            self.beta.iter().enumerate().map(|(j, b)| b * (1.0 - j as f64).powi(next - 1)).sum();
        ((states - f64::from(next) * slopes) / factorial).abs()
    }
}

/// Where the parabola through three evenly spaced points has its vertex; NaN where they are on a line.
fn vertex([a, b, c]: [(f64, f64); 3]) -> f64 {
    b.0 + (c.0 - b.0) * (a.1 - c.1) / (2.0 * (a.1 - 2.0 * b.1 + c.1))
}

fn positive(h: f64) -> f64 {
    if h > 0.0 { h } else { f64::INFINITY }
}

/// The value of a polynomial, highest power first, at a complex point.
fn value_at(descending: &[f64], z: (f64, f64)) -> (f64, f64) {
    descending.iter().fold((0.0, 0.0), |v, c| (v.0 * z.0 - v.1 * z.1 + c, v.0 * z.1 + v.1 * z.0))
}

/// Whether all roots are within a radius: Schur and Cohn's reduction in doubles, highest power first.
fn is_schur_within(descending: &[f64], radius: f64) -> bool {
    let mut scaled = [0.0; MAX_STEPS + 1];
    let mut power = 1.0;
    for (entry, c) in scaled.iter_mut().zip(descending) {
        *entry = c * power;
        power /= radius;
    }
    for n in (1..descending.len()).rev() {
        let ratio = scaled[n] / scaled[0];
        if !(ratio.abs() < 1.0) {
            return false;
        }
        for i in 0..=n / 2 {
            let (low, high) = (scaled[i], scaled[n - i]);
            scaled[i] = low - ratio * high;
            scaled[n - i] = high - ratio * low;
        }
    }
    true
}

/// The spectral radius of a polynomial with all roots within `high`.
fn radius_below(descending: &[f64], mut high: f64, halvings: usize) -> f64 {
    let mut low = 0.0;
    for _ in 0..halvings {
        // Nearer to the known side: most improvements are small.
        let middle = 0.3 * low + 0.7 * high;
        if is_schur_within(descending, middle) {
            high = middle;
        } else {
            low = middle;
        }
        if high < LEAST_RADIUS {
            break;
        }
    }
    high
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formula::FormulaTable;

    /// The figures in doubles beside the exact ones, for every explicit row with a range and an end.
    #[test]
    fn quick_figures_agree_with_exact_ones() {
        let mut compared = 0;
        for formula in FormulaTable::builtin() {
            let analysis = formula.analysis();
            let exact = Figures::exact(analysis).filter(|exact| exact.h_max.is_finite());
            let Some(exact) = exact.filter(|_| formula.is_explicit() && formula.is_strictly_zero_stable())
            else {
                continue;
            };
            let doubles = |row: &[crate::math::Rational]| row.iter().map(rational_to_f64).collect::<Vec<_>>();
            let sum = rational_to_f64(&formula.gamma_sum());
            let row = FloatRow {
                alpha: doubles(formula.alpha()),
                beta: doubles(formula.beta()),
                feedback: doubles(formula.gamma()).iter().map(|g| g / sum).collect(),
            };
            let id = formula.id();
            assert!(row.parasitic_radius() < 1.0, "{id}");
            let end = row.range_end();
            assert!((end - exact.h_max).abs() < 2e-6 * end, "{id}: {end} {}", exact.h_max);
            let (h, r) = row.optimum(end);
            // The nearer all roots come to zero together, the narrower the valley.
            let tolerance = if exact.r_opt < 0.2 { 0.02 } else { 1e-3 };
            assert!(
                (r - exact.r_opt).abs() < tolerance,
                "{id}: r {r} {} at {h} {}",
                exact.r_opt,
                exact.h_opt
            );
            assert!((row.per_step(formula.order()) - exact.per_step).abs() < 1e-9 * exact.per_step, "{id}");
            if exact.noise.is_finite() {
                assert!((row.noise(exact.h_opt) - exact.noise).abs() < 1e-6 * exact.noise, "{id}");
            }
            compared += 1;
        }
        assert!(compared > 50);
    }
}
