//! How fast the closed loop forgets: its spectral radius r(h), and the h for which it is least.
//!
//! r(h) has corners and vertical tangents, where doubles keep half their digits; the figures here are worked out in
//! 192 binary places where that matters.

use num_traits::{One, Signed};

use crate::math::{
    Complex, Fixed, Polynomial, Rational, Real, polish, rational_from_f64, rational_to_f64, root_moduli,
    simple_roots, starting_points,
};

use super::feedback_range::{ClosedLoop, FeedbackRange};

/// The feedback step at which the closed loop forgets fastest, and how fast that is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Optimum {
    /// h_opt, inside the feedback range.
    pub h: f64,
    /// The spectral radius there: errors decay like radius^n over n steps.
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
/// moves bound the radius from below; h is then the one that is best for the others.
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
fn deadbeat(closed_loop: &ClosedLoop) -> Option<Rational> {
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

/// Samples the range, narrows every valley in doubles, and settles the lowest in 192 binary places.
fn search(closed_loop: &ClosedLoop, range: &FeedbackRange) -> Option<Optimum> {
    const SAMPLES: usize = 600;
    let walk = Walk { end: (!range.is_unbounded()).then(|| range.value()) };
    let mut tracker = Tracker::new(closed_loop);
    let grid: Vec<(f64, f64)> =
        (1..SAMPLES).map(|i| i as f64 / SAMPLES as f64).map(|t| (t, tracker.radius(walk.h(t)))).collect();
    let lowest = grid.iter().map(|(_, r)| *r).fold(f64::INFINITY, f64::min);
    if range.is_unbounded() && tracker.radius(1e9) <= lowest {
        return None;
    }
    let mut valleys: Vec<(f64, f64)> = (1..grid.len() - 1)
        .filter(|&i| grid[i].1 <= grid[i - 1].1 && grid[i].1 <= grid[i + 1].1)
        .map(|i| narrow(&mut tracker, &walk, (grid[i - 1].0, grid[i + 1].0)))
        .collect();
    valleys.sort_by(|a, b| a.1.total_cmp(&b.1));
    let best = valleys.first()?.1;
    valleys
        .iter()
        .take_while(|(_, radius)| *radius <= best + 1e-6)
        .map(|(t, _)| settle(closed_loop, walk.h(*t)))
        .min_by(|a, b| a.radius.total_cmp(&b.radius))
}

/// Narrows a valley by ever finer grids; returns its bottom (t, r), good to the half of the digits that doubles give.
fn narrow(tracker: &mut Tracker, walk: &Walk, (mut low, mut high): (f64, f64)) -> (f64, f64) {
    const POINTS: usize = 8;
    let mut best = (low, f64::INFINITY);
    for _ in 0..14 {
        let step = (high - low) / POINTS as f64;
        let start = low;
        for k in 0..=POINTS {
            let t = start + step * k as f64;
            let radius = tracker.radius(walk.h(t));
            if radius < best.1 {
                best = (t, radius);
            }
        }
        (low, high) = ((best.0 - step).max(low), (best.0 + step).min(high));
    }
    best
}

/// Roots followed from one h to the next in doubles.
struct Tracker {
    /// Coefficients of rho and of gamma/gamma(1), highest power first.
    rho: Vec<f64>,
    gamma: Vec<f64>,
}

impl Tracker {
    fn new(closed_loop: &ClosedLoop) -> Self {
        let scale = closed_loop.rho().leading();
        let list = |p: &Polynomial| {
            (0..=closed_loop.degree())
                .rev()
                .map(|k| rational_to_f64(&Rational::new(p.coefficient(k), scale.clone())))
                .collect()
        };
        Self { rho: list(closed_loop.rho()), gamma: list(closed_loop.gamma()) }
    }

    fn radius(&mut self, h: f64) -> f64 {
        let mut descending: Vec<f64> = self.rho.iter().zip(&self.gamma).map(|(r, g)| r + h * g).collect();
        while descending.last() == Some(&0.0) {
            descending.pop();
        }
        if descending.first().is_none_or(|c| *c == 0.0) {
            return f64::INFINITY;
        }
        let mut roots = starting_points(&descending);
        polish(&descending, &mut roots, 40);
        roots.iter().map(Complex::modulus).fold(0.0, f64::max)
    }
}

/// Finds the bottom of a valley near a double by golden sections in 192 binary places.
fn settle(closed_loop: &ClosedLoop, near: f64) -> Optimum {
    const SECTIONS: usize = 56;
    let exact = rational_from_f64(near).unwrap_or_else(Rational::one);
    let mut valley = Valley::new(closed_loop, &exact);
    let margin = &exact * rational_from_f64(2e-6).unwrap_or_else(Rational::one);
    let (mut low, mut high) =
        (Fixed::from_rational(&(&exact - &margin)), Fixed::from_rational(&(exact + margin)));
    let golden = Fixed::from_f64((5_f64.sqrt() - 1.0) / 2.0);
    let inner = |from: &Fixed, to: &Fixed| from.clone() + (to.clone() - from.clone()) * golden.clone();
    let (mut left, mut right) = (inner(&high, &low), inner(&low, &high));
    let (mut at_left, mut at_right) = (valley.squared_radius(&left), valley.squared_radius(&right));
    for _ in 0..SECTIONS {
        if at_left <= at_right {
            high = right;
            (right, at_right) = (left, at_left);
            left = inner(&high, &low);
            at_left = valley.squared_radius(&left);
        } else {
            low = left;
            (left, at_left) = (right, at_right);
            right = inner(&low, &high);
            at_right = valley.squared_radius(&right);
        }
    }
    let (h, squared) = if at_left <= at_right { (left, at_left) } else { (right, at_right) };
    Optimum { h: h.to_f64(), radius: squared.to_f64().sqrt() }
}

/// Roots followed from one h to the next in 192 binary places.
struct Valley {
    rho: Vec<Fixed>,
    gamma: Vec<Fixed>,
    roots: Vec<Complex<Fixed>>,
}

impl Valley {
    fn new(closed_loop: &ClosedLoop, start: &Rational) -> Self {
        let scale = closed_loop.rho().leading();
        let list = |p: &Polynomial| {
            (0..=closed_loop.degree())
                .rev()
                .map(|k| Fixed::from_rational(&Rational::new(p.coefficient(k), scale.clone())))
                .collect()
        };
        let (moving, zeros) = closed_loop.at(start).without_zero_roots();
        let mut roots = simple_roots(&moving);
        let nothing = Fixed::from_f64(0.0);
        roots.extend(std::iter::repeat_n(Complex::new(nothing.clone(), nothing), zeros));
        Self { rho: list(closed_loop.rho()), gamma: list(closed_loop.gamma()), roots }
    }

    fn squared_radius(&mut self, h: &Fixed) -> Fixed {
        let descending: Vec<Fixed> =
            self.rho.iter().zip(&self.gamma).map(|(r, g)| r.clone() + h.clone() * g.clone()).collect();
        polish(&descending, &mut self.roots, 200);
        let nothing = Fixed::from_f64(0.0);
        self.roots.iter().map(Complex::modulus_squared).fold(nothing, |a, b| if b > a { b } else { a })
    }
}
