//! The curves of a row's card: how roots move, where test equations are stable, how noise is passed on.
//!
//! These are figures to be drawn, in doubles; what is decided about a row is decided elsewhere, exactly.

use std::f64::consts::{PI, TAU};

use nalgebra::Complex;

use crate::math::{Rational, complex_roots, polish, rational_to_f64, starting_points};

use super::analysis::Analysis;

/// Amplification of noise of one angular frequency per step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrequencyResponse {
    /// Angular frequency in [0, pi] [rad per step].
    pub omega: f64,
    /// Amplification from noise in the measured residual to the residual.
    pub residual: f64,
    /// Amplification from noise in the feedforward velocity to the residual, per unit of sigma.
    pub feedforward_per_sigma: f64,
    /// Amplification from noise in the joint states of the history to the residual.
    pub state: f64,
}

/// Where x' = lambda x is integrated stably by (alpha, beta), sampled over a window of mu = sigma lambda.
#[derive(Debug, Clone)]
pub struct StabilityRegion {
    /// Least and largest real part of mu in the window.
    pub real: (f64, f64),
    /// Least and largest imaginary part of mu in the window.
    pub imaginary: (f64, f64),
    /// Rows from the least imaginary part up: whether the middle of each cell is strictly stable.
    pub stable: Vec<Vec<bool>>,
    /// mu = rho(z)/beta(z) for z once round the unit circle: every boundary lies on it. Interrupted where it is infinite.
    pub boundary: Vec<Complex<f64>>,
}

/// The roots of the closed loop pi_h as h grows.
#[derive(Debug, Clone, Default)]
pub struct RootLocus {
    /// The feedback steps at which the roots are given.
    pub h: Vec<f64>,
    /// One list per root, with an entry per feedback step.
    pub branches: Vec<Vec<Complex<f64>>>,
}

impl Analysis {
    /// Returns the roots of rho, largest modulus first.
    pub fn roots(&self) -> Vec<Complex<f64>> {
        complex_roots(self.rho())
    }

    /// Returns the h up to which pictures of the loop go: a little beyond the feedback range, so that its end is seen.
    pub fn pictured_h(&self) -> f64 {
        match self.feedback_range() {
            Some(range) if range.is_unbounded() => 4.0,
            Some(range) if !range.is_empty() => 1.2 * range.value(),
            _ => 1.0,
        }
    }

    /// Returns `count` + 1 points (h, r(h)) from 0 to `end`.
    pub fn radius_curve(&self, end: f64, count: usize) -> Vec<(f64, f64)> {
        let loop_roots = |h: f64| self.loop_roots(h).iter().map(|z| z.norm()).fold(0.0, f64::max);
        grid(end, count).map(|h| (h, loop_roots(h))).collect()
    }

    /// Returns the roots of pi_h at `count` + 1 feedback steps from 0 to `end`, each followed as it moves.
    pub fn root_locus(&self, end: f64, count: usize) -> RootLocus {
        let mut locus = RootLocus::default();
        for h in grid(end, count) {
            let mut roots = self.loop_roots(h);
            if locus.branches.is_empty() {
                locus.branches = roots.iter().map(|z| vec![*z]).collect();
                locus.h.push(h);
            } else if roots.len() == locus.branches.len() {
                locus.h.push(h);
                for branch in &mut locus.branches {
                    let last = branch[branch.len() - 1];
                    let distance = |z: &Complex<f64>| (z - last).norm();
                    let nearest =
                        (0..roots.len()).min_by(|&i, &j| distance(&roots[i]).total_cmp(&distance(&roots[j])));
                    branch.extend(nearest.map(|i| roots.swap_remove(i)));
                }
            }
        }
        locus
    }

    /// The roots of pi_h in doubles; none where the row has no closed loop.
    fn loop_roots(&self, h: f64) -> Vec<Complex<f64>> {
        let Some(closed_loop) = self.closed_loop() else { return Vec::new() };
        let coefficient = |k: usize| {
            let part =
                |p: &crate::math::Polynomial| rational_to_f64(&Rational::from_integer(p.coefficient(k)));
            part(closed_loop.rho()) + h * part(closed_loop.gamma())
        };
        float_roots((0..=closed_loop.degree()).rev().map(coefficient).collect())
    }

    /// Returns the boundary locus of x' = lambda x and the region of stability in a window that shows it.
    ///
    /// `cells` is the number of cells along the longer side of the window.
    pub fn stability_region(&self, cells: usize) -> StabilityRegion {
        let (alpha, beta) = (floats(self.alpha()), floats(self.beta()));
        let boundary = boundary_locus(&alpha, &beta, 1440);
        let stable = |mu: Complex<f64>| {
            is_schur(alpha.iter().zip(&beta).map(|(a, b)| Complex::from(*a) - mu * b).collect())
        };
        let mut frame = window(&boundary);
        // A region that is small beside its locus is looked at from nearer.
        for _ in 0..3 {
            match sampled(frame, 100, &stable).and_then(|cells| nearer(frame, &cells)) {
                Some(near) => frame = near,
                None => break,
            }
        }
        let (real, imaginary) = frame;
        let stable = sampled(frame, cells, &stable).unwrap_or_default();
        StabilityRegion { real, imaginary, stable, boundary }
    }

    /// Returns what the closed loop at h makes of noise at `count` + 1 frequencies from 0 to pi.
    pub fn frequency_response(&self, h: f64, count: usize) -> Vec<FrequencyResponse> {
        let (alpha, beta, gamma) = (floats(self.alpha()), floats(self.beta()), floats(self.gamma()));
        let sum = rational_to_f64(&self.gamma_sum());
        let at = |omega: f64| {
            let z_back = Complex::from_polar(1.0, -omega);
            let value = |row: &[f64]| row.iter().rev().fold(Complex::from(0.0), |v, c| v * z_back + c);
            let feedback = value(&gamma) * (h / sum);
            let closed = value(&alpha) + feedback;
            let head = alpha[0] + h * gamma[0] / sum;
            FrequencyResponse {
                omega,
                residual: (feedback / closed).norm(),
                feedforward_per_sigma: (value(&beta) / closed).norm(),
                state: ((closed - head) / closed).norm(),
            }
        };
        grid(PI, count).map(at).collect()
    }
}

fn grid(end: f64, count: usize) -> impl Iterator<Item = f64> {
    (0..=count).map(move |i| end * i as f64 / count.max(1) as f64)
}

fn floats(row: &[Rational]) -> Vec<f64> {
    row.iter().map(rational_to_f64).collect()
}

/// The roots of a real polynomial, highest power first, in doubles.
fn float_roots(mut descending: Vec<f64>) -> Vec<Complex<f64>> {
    let mut roots = Vec::new();
    while descending.last() == Some(&0.0) {
        descending.pop();
        roots.push(Complex::from(0.0));
    }
    let Some(lead) = descending.first().copied().filter(|lead| *lead != 0.0) else { return Vec::new() };
    for c in &mut descending {
        *c /= lead;
    }
    let mut moving = starting_points(&descending);
    polish(&descending, &mut moving, 80);
    roots.extend(moving.iter().map(|z| Complex::new(z.re, z.im)));
    roots
}

/// Whether all roots of a complex polynomial, highest power first, are inside the circle (Schur and Cohn's reduction).
fn is_schur(mut a: Vec<Complex<f64>>) -> bool {
    while a.len() > 1 {
        let (head, last) = (a[0], a[a.len() - 1]);
        if !(last.norm_sqr() < head.norm_sqr()) {
            return false;
        }
        let mirrored: Vec<Complex<f64>> = a.iter().rev().map(Complex::conj).collect();
        let reduced = a.iter().zip(&mirrored).map(|(x, m)| head.conj() * x - last * m);
        a = reduced.take(a.len() - 1).map(|c| c / head.norm_sqr()).collect();
    }
    !a.is_empty()
}

/// mu = rho(z)/beta(z) at `count` + 1 points of the unit circle; not a number where beta(z) is zero.
fn boundary_locus(alpha: &[f64], beta: &[f64], count: usize) -> Vec<Complex<f64>> {
    let point = |theta: f64| {
        let z_back = Complex::from_polar(1.0, -theta);
        let value = |row: &[f64]| row.iter().rev().fold(Complex::from(0.0), |v, c| v * z_back + c);
        value(alpha) / value(beta)
    };
    grid(TAU, count).map(point).collect()
}

/// Real and imaginary part of what is looked at, from where to where.
type Frame = ((f64, f64), (f64, f64));

/// Whether the middles of the cells of a frame are stable, rows from the least imaginary part up; `None` for a frame
/// without area.
fn sampled(
    (real, imaginary): Frame,
    cells: usize,
    stable: &dyn Fn(Complex<f64>) -> bool,
) -> Option<Vec<Vec<bool>>> {
    let cell = f64::max(real.1 - real.0, imaginary.1 - imaginary.0) / cells.max(1) as f64;
    let middles = |(low, high): (f64, f64)| {
        let count = ((high - low) / cell).round().max(1.0) as usize;
        (0..count).map(move |k| low + (k as f64 + 0.5) * (high - low) / count as f64)
    };
    let row = |y: f64| middles(real).map(|x| stable(Complex::new(x, y))).collect();
    (cell > 0.0).then(|| middles(imaginary).map(row).collect())
}

/// A frame around the stable cells where they fill less than half of either side and touch no edge, else `None`.
fn nearer((real, imaginary): Frame, cells: &[Vec<bool>]) -> Option<Frame> {
    let columns = cells.first()?.len();
    let rows_hit: Vec<usize> = (0..cells.len()).filter(|&i| cells[i].contains(&true)).collect();
    let columns_hit: Vec<usize> = (0..columns).filter(|&j| cells.iter().any(|row| row[j])).collect();
    let span = |hit: &[usize], count: usize, (low, high): (f64, f64)| {
        let (first, last) = (*hit.first()?, *hit.last()?);
        let at = |k: usize| low + (high - low) * k as f64 / count as f64;
        let fills = 2 * (last + 1 - first) >= count;
        (first > 0 && last + 1 < count).then(|| (at(first), at(last + 1), fills))
    };
    let (x, y) = (span(&columns_hit, columns, real)?, span(&rows_hit, cells.len(), imaginary)?);
    let half = 0.75 * f64::max(x.1 - x.0, y.1 - y.0);
    let around =
        |(low, high, _): (f64, f64, bool)| (f64::midpoint(low, high) - half, f64::midpoint(low, high) + half);
    (!x.2 && !y.2).then(|| (around(x), around(y)))
}

/// A window that holds the locus, or the part of it near the origin where it goes to infinity, with a margin.
fn window(boundary: &[Complex<f64>]) -> Frame {
    let mut moduli: Vec<f64> = boundary.iter().map(|mu| mu.norm()).filter(|m| m.is_finite()).collect();
    moduli.sort_by(f64::total_cmp);
    let median = moduli.get(moduli.len() / 2).copied().unwrap_or(1.0);
    let reach = moduli.last().copied().unwrap_or(1.0).min(8.0 * median.max(1e-6));
    let shown = || boundary.iter().filter(|mu| mu.norm() <= reach);
    let span = |part: fn(&Complex<f64>) -> f64| {
        let (low, high) = shown().map(part).fold((0.0_f64, 0.0_f64), |(l, h), x| (l.min(x), h.max(x)));
        (low, high)
    };
    let (real, imaginary) = (span(|mu| mu.re), span(|mu| mu.im));
    // The negative half-plane is what asks to be seen, and nothing is drawn thinner than half of its length.
    let least = 0.5 * f64::max(real.1 - real.0, imaginary.1 - imaginary.0).max(0.1);
    let widened = |(low, high): (f64, f64)| {
        let (middle, half) = (f64::midpoint(low, high), f64::max(high - low, least) / 2.0 * 1.12);
        (middle - half, middle + half)
    };
    (widened((real.0.min(-0.3 * least), real.1)), widened(imaginary))
}

#[cfg(test)]
mod tests {
    use crate::formula::FormulaTable;
    use nalgebra::Complex;

    fn analysis(id: &str) -> &'static crate::formula::Analysis {
        FormulaTable::builtin().get(id).expect("a built-in row").analysis()
    }

    #[test]
    fn the_curve_of_the_radius_is_the_spectral_radius() {
        for id in ["la6-wang-guo", "ab4", "split-ab6", "bdf3"] {
            for (h, radius) in analysis(id).radius_curve(1.0, 16) {
                assert!((radius - analysis(id).spectral_radius(h)).abs() < 1e-6, "{id} at {h}: {radius}");
            }
        }
    }

    #[test]
    fn the_locus_begins_at_the_roots_and_keeps_their_number() {
        let locus = analysis("la6-wang-guo").root_locus(0.8, 100);
        assert_eq!((locus.branches.len(), locus.h.len()), (5, 101));
        let largest = locus.branches.iter().map(|branch| branch[0].norm()).fold(0.0, f64::max);
        assert!((largest - 1.0).abs() < 1e-12);
        assert!(locus.branches.iter().all(|branch| branch.len() == 101));
    }

    #[test]
    fn eulers_region_is_a_disk_about_minus_one() {
        let region = analysis("la2-euler").stability_region(80);
        let (rows, columns) = (region.stable.len(), region.stable[0].len());
        for (i, row) in region.stable.iter().enumerate() {
            for (j, &stable) in row.iter().enumerate() {
                let part = |(low, high): (f64, f64), k: usize, n: usize| {
                    low + (k as f64 + 0.5) * (high - low) / n as f64
                };
                let mu = Complex::new(part(region.real, j, columns), part(region.imaginary, i, rows));
                assert_eq!(stable, (mu + 1.0).norm() < 1.0, "{mu}");
            }
        }
    }

    #[test]
    fn the_mean_square_of_the_response_is_the_noise_gain() {
        // Parseval: the l2 norm of the impulse response is the mean of |H|^2 over the circle.
        for (id, h) in [("la6-wang-guo", 0.4), ("split-ab6", 1.0), ("ab3", 0.2)] {
            let gain = analysis(id).noise_gain(h).expect("a stable loop");
            let response = analysis(id).frequency_response(h, 4096);
            let mean = |of: fn(&crate::formula::FrequencyResponse) -> f64| {
                let ends = f64::midpoint(of(&response[0]).powi(2), of(&response[4096]).powi(2));
                let inner: f64 = response[1..4096].iter().map(|r| of(r).powi(2)).sum();
                ((ends + inner) / 4096.0).sqrt()
            };
            assert!((mean(|r| r.residual) - gain.residual).abs() < 1e-9 * gain.residual);
            assert!(
                (mean(|r| r.feedforward_per_sigma) - gain.feedforward_per_sigma).abs()
                    < 1e-9 * gain.feedforward_per_sigma
            );
            assert!((mean(|r| r.state) - gain.state).abs() < 1e-9 * gain.state.max(1e-3), "{id}");
        }
    }
}
