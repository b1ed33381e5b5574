//! How fast the closed loop forgets: its spectral radius r(h), and the h for which it is least.
//!
//! r(h) has corners and vertical tangents, where doubles keep half their digits; the figures here are worked out in
//! twice as many where that matters.

use num_traits::Signed;

use crate::math::{
    Complex, DoubleDouble, Polynomial, Rational, Real, polish, rational_from_f64, rational_to_f64,
    root_moduli, starting_points,
};

use super::feedback_range::{ClosedLoop, FeedbackRange};

/// The feedback step at which the spectral radius of the closed loop is least, and that radius.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Optimum {
    /// h_opt, inside the feedback range.
    pub h: f64,
    /// The spectral radius at h_opt: errors decay like radius^n over n steps.
    pub radius: f64,
}

/// Returns the spectral radius of pi_h, to about 1e-13, for a finite h; NaN for any other.
pub(crate) fn spectral_radius(closed_loop: &ClosedLoop, h: f64) -> f64 {
    let Some(exact) = rational_from_f64(h) else { return f64::NAN };
    let polynomial = closed_loop.at(&exact);
    if polynomial.degree() < closed_loop.degree() {
        // The new state's own coefficient vanishes at this h: a root has gone to infinity.
        return f64::INFINITY;
    }
    quick_radius(&polynomial).unwrap_or_else(|| root_moduli(&polynomial).first().copied().unwrap_or(0.0))
}

/// The spectral radius by doubles, `None` where they can not vouch for 1e-13.
fn quick_radius(polynomial: &Polynomial) -> Option<f64> {
    let (rest, _) = polynomial.without_zero_roots();
    let leading = rest.leading();
    let descending: Vec<f64> = rest
        .ascending()
        .iter()
        .rev()
        .map(|c| rational_to_f64(&Rational::new(c.clone(), leading.clone())))
        .collect();
    let mut roots = starting_points(&descending);
    polish(&descending, &mut roots, 60);
    let radius = roots.iter().map(Complex::modulus).fold(0.0, f64::max);
    let surest = roots.iter().map(|root| root.modulus() + error_bound(&descending, root)).fold(0.0, f64::max);
    (radius.is_finite() && surest - radius <= 1e-13 * radius.max(1e-3)).then_some(radius)
}

/// A first-order bound on the error of a simple root: the rounding error of the value over the slope.
fn error_bound(descending: &[f64], root: &Complex<f64>) -> f64 {
    let (mut value, mut slope, mut size) = ((0.0, 0.0), (0.0, 0.0), 0.0);
    let modulus = root.modulus();
    for c in descending {
        slope = (
            slope.0 * root.re - slope.1 * root.im + value.0,
            slope.0 * root.im + slope.1 * root.re + value.1,
        );
        value = (value.0 * root.re - value.1 * root.im + c, value.0 * root.im + value.1 * root.re);
        size = size * modulus + c.abs();
    }
    descending.len() as f64 * f64::EPSILON * size / f64::hypot(slope.0, slope.1)
}

/// Returns the h inside the range with the least spectral radius, `None` where there is none.
///
/// There is none in an empty range, and none in an unbounded one along which the radius keeps falling. Roots that no h
/// moves bound the radius from below; h is then the one that is best for the others. Of equally good h the smallest is given.
pub(crate) fn optimum(closed_loop: &ClosedLoop, range: &FeedbackRange) -> Option<Optimum> {
    if range.is_empty() {
        return None;
    }
    let (moving, fixed) = closed_loop.split();
    let floor = root_moduli(&fixed).first().copied().unwrap_or(0.0);
    let best = match deadbeat(&moving).filter(|h| range.contains_exact(h)) {
        Some(h) => Optimum { h: rational_to_f64(&h), radius: 0.0 },
        None => search(&moving, range)?,
    };
    Some(Optimum { radius: best.radius.max(floor), ..best })
}

/// The h, if any, at which every root is zero: all coefficients but the leading one vanish together.
pub(super) fn deadbeat(closed_loop: &ClosedLoop) -> Option<Rational> {
    let n = closed_loop.degree();
    let (rho, gamma) = (closed_loop.rho(), closed_loop.gamma());
    let (constant, slope) =
        (0..n).map(|k| (rho.coefficient(k), gamma.coefficient(k))).find(|(_, g)| *g != 0.into())?;
    let h = -Rational::new(constant, slope);
    let image = closed_loop.at(&h);
    (h.is_positive() && image.degree() == n && (0..n).all(|k| image.coefficient(k) == 0.into())).then_some(h)
}

/// How the search walks the range: t in (0, 1) stands for h in (0, h_max), or for t/(1 - t) where there is no end.
struct Walk {
    end: Option<f64>,
}

impl Walk {
    fn h(&self, t: f64) -> f64 {
        match self.end {
            Some(end) => end * t,
            None => t / (1.0 - t),
        }
    }
}

/// Radii closer than this count as equal in doubles: the smallest h of a plateau is taken.
const TIE: f64 = 1e-10;

/// Samples the range, narrows every valley in doubles, and settles the lowest in twice the digits.
fn search(closed_loop: &ClosedLoop, range: &FeedbackRange) -> Option<Optimum> {
    const SAMPLES: usize = 600;
    let walk = Walk { end: (!range.is_unbounded()).then(|| range.value()) };
    let pencil = Pencil::new(closed_loop);
    let grid: Vec<(f64, f64)> =
        (1..SAMPLES).map(|i| i as f64 / SAMPLES as f64).map(|t| (t, pencil.radius(walk.h(t)))).collect();
    let lowest = grid.iter().map(|(_, r)| *r).fold(f64::INFINITY, f64::min);
    if range.is_unbounded() && pencil.radius(1e9) <= lowest {
        return None;
    }
    let valleys: Vec<Valley> = (1..grid.len() - 1)
        .filter(|&i| grid[i].1 < grid[i - 1].1 - TIE && grid[i].1 <= grid[i + 1].1 + TIE)
        .map(|i| narrow(&pencil, &walk, (grid[i - 1].0, grid[i + 1].0)))
        .collect();
    let best = valleys.iter().map(|valley| valley.radius).fold(f64::INFINITY, f64::min);
    valleys
        .iter()
        .filter(|valley| valley.radius <= best + 1e-3)
        .map(|valley| settle(closed_loop, walk.h(valley.low), walk.h(valley.high)))
        .min_by(|a, b| a.radius.total_cmp(&b.radius))
}

/// A stretch of the walk that holds one least radius, and about how low it is.
struct Valley {
    low: f64,
    high: f64,
    radius: f64,
}

/// Narrows a valley by finer grids, as far as doubles can be trusted beside a double root.
fn narrow(pencil: &Pencil<f64>, walk: &Walk, (mut low, mut high): (f64, f64)) -> Valley {
    const POINTS: usize = 8;
    const ROUNDS: usize = 3;
    let mut best = (low, f64::INFINITY);
    for _ in 0..ROUNDS {
        let step = (high - low) / POINTS as f64;
        let start = low;
        for k in 0..=POINTS {
            let t = start + step * k as f64;
            let radius = pencil.radius(walk.h(t));
            if radius < best.1 - TIE {
                best = (t, radius);
            }
        }
        (low, high) = ((best.0 - 2.0 * step).max(low), (best.0 + 2.0 * step).min(high));
    }
    Valley { low, high, radius: best.1 }
}

/// Finds the bottom of a valley by golden sections in twice the digits.
fn settle(closed_loop: &ClosedLoop, low: f64, high: f64) -> Optimum {
    const SECTIONS: usize = 68;
    let pencil = Pencil::new(closed_loop);
    let wide = DoubleDouble::from_f64;
    let golden = wide((5_f64.sqrt() - 1.0) / 2.0);
    let inner = |from: DoubleDouble, to: DoubleDouble| from + (to - from) * golden;
    let (mut low, mut high) = (wide(low), wide(high));
    let (mut left, mut right) = (inner(high, low), inner(low, high));
    let (mut at_left, mut at_right) = (pencil.squared_radius(&left), pencil.squared_radius(&right));
    // On a plateau the left part is kept; elsewhere so small a difference means nothing.
    let tie = wide(1.0) + wide(1e-28);
    for _ in 0..SECTIONS {
        if at_left <= at_right * tie {
            high = right;
            (right, at_right) = (left, at_left);
            left = inner(high, low);
            at_left = pencil.squared_radius(&left);
        } else {
            low = left;
            (left, at_left) = (right, at_right);
            right = inner(low, high);
            at_right = pencil.squared_radius(&right);
        }
    }
    let (h, squared) = if at_left <= at_right { (left, at_left) } else { (right, at_right) };
    Optimum { h: h.to_f64(), radius: squared.to_f64().sqrt() }
}

/// The coefficients of pi_h for any h in one of the two arithmetics.
struct Pencil<T> {
    /// Coefficients of rho and of gamma/gamma(1), highest power first, for a leading coefficient 1 of rho.
    rho: Vec<T>,
    gamma: Vec<T>,
}

impl<T: Traceable> Pencil<T> {
    fn new(closed_loop: &ClosedLoop) -> Self {
        let scale = closed_loop.rho().leading();
        let list = |p: &Polynomial| {
            let coefficient = |k| Rational::new(p.coefficient(k), scale.clone());
            (0..=closed_loop.degree()).rev().map(|k| T::from_rational(&coefficient(k))).collect()
        };
        Self { rho: list(closed_loop.rho()), gamma: list(closed_loop.gamma()) }
    }

    /// |z|^2 of the largest root.
    fn squared_radius(&self, h: &T) -> T {
        let nothing = T::from_f64(0.0);
        let mut descending: Vec<T> =
            self.rho.iter().zip(&self.gamma).map(|(r, g)| r.clone() + h.clone() * g.clone()).collect();
        while descending.last().is_some_and(Real::is_zero) {
            descending.pop();
        }
        if descending.first().is_none_or(Real::is_zero) {
            return T::from_f64(f64::INFINITY);
        }
        let doubles: Vec<f64> = descending.iter().map(Real::to_f64).collect();
        let mut start = starting_points(&doubles);
        polish(&doubles, &mut start, 60);
        let mut roots: Vec<Complex<T>> = start.iter().enumerate().map(|(k, z)| tilted(z, k)).collect();
        polish(&descending, &mut roots, 200);
        roots.iter().map(Complex::modulus_squared).fold(nothing, |a, b| if b > a { b } else { a })
    }
}

/// An approximation moved off the real axis by a trifle: real ones would stay real, though the roots be a complex pair.
fn tilted<T: Real>(z: &Complex<f64>, index: usize) -> Complex<T> {
    let trifle = 1e-9 * z.modulus() * (1.0 + index as f64);
    Complex::new(T::from_f64(z.re), T::from_f64(z.im + trifle))
}

impl Pencil<f64> {
    fn radius(&self, h: f64) -> f64 {
        self.squared_radius(&h).sqrt()
    }
}

/// The two arithmetics of the search.
trait Traceable: Real {
    fn from_rational(value: &Rational) -> Self;
}

impl Traceable for f64 {
    fn from_rational(value: &Rational) -> Self {
        rational_to_f64(value)
    }
}

impl Traceable for DoubleDouble {
    fn from_rational(value: &Rational) -> Self {
        Self::from_rational(value)
    }
}
