//! Complex roots as figures: all at once by the Ehrlich-Aberth iteration, in doubles or longer numbers.
//!
//! Nothing is decided with these; they are for showing moduli, spectral radii and their minimum.

use num_bigint::BigInt;
use num_traits::Zero;

use super::polynomial::Polynomial;
use super::rational::Rational;
use super::real::Real;
use super::wide::Wide;

/// A complex number re + i im.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Complex<T> {
    pub(crate) re: T,
    pub(crate) im: T,
}

impl<T: Real> Complex<T> {
    pub(crate) fn new(re: T, im: T) -> Self {
        Self { re, im }
    }

    fn zero() -> Self {
        Self::new(T::from_f64(0.0), T::from_f64(0.0))
    }

    /// |z|^2, without a square root and so exact enough to compare by.
    pub(crate) fn modulus_squared(&self) -> T {
        self.re.clone() * self.re.clone() + self.im.clone() * self.im.clone()
    }

    pub(crate) fn modulus(&self) -> f64 {
        self.re.to_f64().hypot(self.im.to_f64())
    }

    fn add(&self, other: &Self) -> Self {
        Self::new(self.re.clone() + other.re.clone(), self.im.clone() + other.im.clone())
    }

    fn sub(&self, other: &Self) -> Self {
        Self::new(self.re.clone() - other.re.clone(), self.im.clone() - other.im.clone())
    }

    fn mul(&self, other: &Self) -> Self {
        let re = self.re.clone() * other.re.clone() - self.im.clone() * other.im.clone();
        let im = self.re.clone() * other.im.clone() + self.im.clone() * other.re.clone();
        Self::new(re, im)
    }

    /// The quotient, `None` when the divisor is zero to working precision.
    fn checked_div(&self, divisor: &Self) -> Option<Self> {
        let norm = divisor.modulus_squared();
        if norm.is_zero() {
            return None;
        }
        let conjugate = Self::new(divisor.re.clone(), -divisor.im.clone());
        let product = self.mul(&conjugate);
        Some(Self::new(product.re / norm.clone(), product.im / norm))
    }
}

/// A real polynomial at a complex point.
struct Evaluated<T> {
    value: Complex<T>,
    slope: Complex<T>,
    /// Whether the value is no larger than what rounding makes of it.
    is_noise: bool,
}

/// The value of a polynomial and of its derivative, coefficients highest power first.
fn evaluate<T: Real>(descending: &[T], z: &Complex<T>) -> Evaluated<T> {
    let (mut value, mut slope) = (Complex::zero(), Complex::zero());
    // sum |c_k| |z|^k: the rounding error of the value is at most about this times the resolution.
    let modulus = T::from_f64(z.modulus());
    let mut size = T::from_f64(0.0);
    for coefficient in descending {
        slope = slope.mul(z).add(&value);
        value = value.mul(z);
        value.re = value.re + coefficient.clone();
        size = size * modulus.clone() + coefficient.magnitude();
    }
    let is_noise = value.re.magnitude() + value.im.magnitude() <= size * T::from_f64(T::resolution());
    Evaluated { value, slope, is_noise }
}

/// Improves approximations of all roots together until no correction is worth making.
///
/// A root is left alone once the polynomial there is zero to within rounding: nothing better can be had in this arithmetic. The
/// cluster of a repeated root gets there too, with as many digits fewer as its multiplicity divides away.
pub(crate) fn polish<T: Real>(descending: &[T], roots: &mut [Complex<T>], most_rounds: usize) {
    let mut settled = vec![false; roots.len()];
    for _ in 0..most_rounds {
        for i in 0..roots.len() {
            if settled[i] {
                continue;
            }
            match aberth_step(descending, roots, i) {
                Some(step) => {
                    settled[i] = step.modulus() <= T::resolution() * roots[i].modulus();
                    roots[i] = roots[i].sub(&step);
                }
                None => settled[i] = true,
            }
        }
        if settled.iter().all(|done| *done) {
            return;
        }
    }
}

/// p / (p' - p sum_j 1/(z_i - z_j)): Newton's step, with the other approximations divided out; `None` at a root.
fn aberth_step<T: Real>(descending: &[T], roots: &[Complex<T>], i: usize) -> Option<Complex<T>> {
    let Evaluated { value, slope, is_noise } = evaluate(descending, &roots[i]);
    if is_noise {
        return None;
    }
    let one = Complex::new(T::from_f64(1.0), T::from_f64(0.0));
    let mut repulsion = Complex::zero();
    for (_, other) in roots.iter().enumerate().filter(|(j, _)| *j != i) {
        if let Some(term) = one.checked_div(&roots[i].sub(other)) {
            repulsion = repulsion.add(&term);
        }
    }
    // At a stationary point any small move will do; this one is the same on every run.
    value.checked_div(&slope.sub(&value.mul(&repulsion))).or_else(|| {
        let nudge = 1e-3 * (1.0 + roots[i].modulus().min(1e100));
        Some(Complex::new(T::from_f64(nudge), T::from_f64(nudge / 3.0)))
    })
}

/// Starting points on circles whose radii are read off the convex hull of log |c_k| (Bini's choice), lowest power first.
///
/// Each is given by the binary logarithm of its radius and its angle. Neither end of the list may be zero.
fn circles(ascending_logs: &[Option<f64>]) -> Vec<(f64, f64)> {
    let mut hull: Vec<(usize, f64)> = Vec::new();
    for (k, log) in ascending_logs.iter().enumerate().filter_map(|(k, log)| log.map(|log| (k, log))) {
        while let [.., (k0, log0), (k1, log1)] = hull[..] {
            let turns_up = (log1 - log0) * (k - k0) as f64 <= (log - log0) * (k1 - k0) as f64;
            if !turns_up {
                break;
            }
            hull.pop();
        }
        hull.push((k, log));
    }
    let mut points = Vec::new();
    for edge in hull.windows(2) {
        let ((k0, log0), (k1, log1)) = (edge[0], edge[1]);
        let count = k1 - k0;
        let log_radius = (log0 - log1) / count as f64;
        for j in 0..count {
            let turn = (j as f64 + 0.35) / count as f64 + 0.07 * k0 as f64;
            points.push((log_radius, std::f64::consts::TAU * turn));
        }
    }
    points
}

/// Starting points for doubles; the first and the last coefficient (highest power first) must not be zero.
pub(crate) fn starting_points(descending: &[f64]) -> Vec<Complex<f64>> {
    let logs: Vec<Option<f64>> =
        descending.iter().rev().map(|c| (*c != 0.0).then(|| c.abs().log2())).collect();
    let on_circle =
        |(log, angle): (f64, f64)| Complex::new(log.exp2() * angle.cos(), log.exp2() * angle.sin());
    circles(&logs).into_iter().map(on_circle).collect()
}

/// Returns the complex roots of an exact polynomial, each as often as its multiplicity, largest modulus first.
///
/// The square-free decomposition is exact and comes first, so a repeated root is as accurate as a simple one:
/// every root is good to the last digits of a double. The zero polynomial gives none.
pub fn complex_roots(polynomial: &Polynomial) -> Vec<nalgebra::Complex<f64>> {
    let (rest, zeros) =
        if polynomial.is_zero() { (Polynomial::default(), 0) } else { polynomial.without_zero_roots() };
    let mut roots = vec![nalgebra::Complex::new(0.0, 0.0); zeros];
    for (factor, multiplicity) in rest.square_free_decomposition() {
        for root in simple_roots(&factor) {
            let (re, im) = (root.re.to_f64(), root.im.to_f64());
            // What is left beside a real or imaginary root is the rounding of 192 bits.
            let part = |x: f64, other: f64| if x.abs() < 1e-50 * other.abs() { 0.0 } else { x };
            let root = nalgebra::Complex::new(part(re, im), part(im, re));
            roots.extend(std::iter::repeat_n(root, multiplicity));
        }
    }
    roots.sort_by(|a, b| {
        b.norm().total_cmp(&a.norm()).then(b.re.total_cmp(&a.re)).then(b.im.total_cmp(&a.im))
    });
    roots
}

/// Returns the moduli of the complex roots of an exact polynomial, each as often as its multiplicity, largest first.
pub fn root_moduli(polynomial: &Polynomial) -> Vec<f64> {
    complex_roots(polynomial).iter().map(|root| root.re.hypot(root.im)).collect()
}

/// The roots of a square-free polynomial with a nonzero constant term, in 192 significant bits.
fn simple_roots(square_free: &Polynomial) -> Vec<Complex<Wide>> {
    const MOST_ROUNDS: usize = 400;
    let log = |c: &BigInt| {
        // The top 53 bits and their place: a logarithm for integers of any size.
        let drop = c.bits().saturating_sub(53);
        let top = Rational::from_integer(c.clone() >> drop);
        (!c.is_zero()).then(|| super::rational_to_f64(&top).abs().log2() + drop as f64)
    };
    let logs: Vec<Option<f64>> = square_free.ascending().iter().map(log).collect();
    let mut roots: Vec<Complex<Wide>> = circles(&logs).into_iter().map(fixed_point).collect();
    let leading = square_free.leading();
    let descending: Vec<Wide> = square_free
        .ascending()
        .iter()
        .rev()
        .map(|c| Wide::from_rational(&Rational::new(c.clone(), leading.clone())))
        .collect();
    polish(&descending, &mut roots, MOST_ROUNDS);
    roots
}

fn fixed_point((log, angle): (f64, f64)) -> Complex<Wide> {
    let (whole, part) = (log.floor(), log - log.floor());
    let scale = Wide::power_of_two(whole as i64) * Wide::from_f64(part.exp2());
    Complex::new(scale.clone() * Wide::from_f64(angle.cos()), scale * Wide::from_f64(angle.sin()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn repeated_roots_have_clean_moduli() {
        // (z - 1)^3 (2 z + 1)^2 z
        let (one, half) = (Polynomial::from_descending(&[1, -1]), Polynomial::from_descending(&[2, 1]));
        let p = &(&(&one * &one) * &one) * &(&(&half * &half) * &Polynomial::power(1));
        assert_eq!(root_moduli(&p), [1.0, 1.0, 1.0, 0.5, 0.5, 0.0]);
    }

    #[test]
    fn close_roots_keep_their_digits() {
        // z^2 - 2 + 2e-24: roots within 1e-24 of each other's mirror image; and 1/3, 1/3 + 1e-12.
        let third = Polynomial::from_descending(&[3, -1]);
        let near = Polynomial::from_ascending([
            BigInt::from(-1_000_000_000_003_i64),
            BigInt::from(3_000_000_000_000_i64),
        ]);
        let moduli = root_moduli(&(&third * &near));
        assert!((moduli[1] - 1.0 / 3.0).abs() < 1e-16);
        assert!((moduli[0] - moduli[1] - 1e-12).abs() < 1e-16);
    }

    #[test]
    fn survives_coefficients_of_any_size() {
        let huge = BigInt::from(10).pow(399);
        let p = Polynomial::from_ascending([
            BigInt::from(-1),
            BigInt::from(3),
            huge.clone(),
            -huge,
            BigInt::from(7),
        ]);
        let moduli = root_moduli(&p);
        assert_eq!(moduli.len(), 4);
        assert!(moduli[0].is_infinite() || moduli[0] > 1e300, "{moduli:?}");
        assert!((moduli[1] - 1.0).abs() < 1e-15);
    }

    #[test]
    fn cyclotomic_roots_are_on_the_circle() {
        let mut coefficients = vec![0; 41];
        (coefficients[0], coefficients[40]) = (1, -1);
        for modulus in root_moduli(&Polynomial::from_descending(&coefficients)) {
            assert!((modulus - 1.0).abs() < 1e-15);
        }
    }
}
