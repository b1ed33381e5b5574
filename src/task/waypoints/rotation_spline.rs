use super::quintic_spline::{Ends, interval};
use crate::math::rotation_vector;
use nalgebra::{Quaternion, Rotation3, UnitQuaternion, Vector3};
use std::f64::consts::TAU;

/// How many orientations to either side say how the tip turns at a knot.
const REACH: usize = 2;
/// Terms of the series of an angle by the cosine of its half: the last is below the rounding of the first.
const TERMS: usize = 64;

/// Interpolates orientations by the logarithms of the turns between them, with three continuous derivatives.
///
/// Between two knots `R(s) = R_i exp(f(s))` with a rotation vector `f` that is a polynomial of degree seven. At each knot the
/// first three derivatives of both neighbours are those of the polynomial through the logarithms `log(R_i^T R_k)` of the
/// knot itself and of two orientations to either side. Orientations that turn evenly about one axis are met exactly. The
/// axes of the world and of the tip do not matter.
#[derive(Clone, Debug)]
pub struct RotationSpline {
    knots: Vec<f64>,
    rotations: Vec<Rotation3<f64>>,
    /// For each interval the coefficients of the powers of `x` in [0, 1], from the first on.
    pieces: Vec<[Vector3<f64>; 7]>,
}

/// The first, second and third derivative of a rotation vector, where it vanishes itself.
type Jet = [Vector3<f64>; 3];

impl RotationSpline {
    /// Returns the curve through `rotations` at the parameters `knots`. Clamped, it rests at both ends: all three derivatives
    /// vanish.
    ///
    /// # Panics
    /// Unless there are as many knots as rotations, at least two, and the knots increase.
    pub fn new(knots: &[f64], rotations: &[Rotation3<f64>], ends: Ends) -> Self {
        assert!(
            knots.len() == rotations.len() && knots.len() >= 2,
            "a turn needs two orientations and as many knots"
        );
        assert!(knots.windows(2).all(|pair| pair[0] < pair[1]), "the knots of a spline increase");
        let last = knots.len() - 1;
        let jets: Vec<Jet> = (0..=last).map(|i| jet_at(knots, rotations, ends, i)).collect();
        let piece = |i: usize| {
            let h = knots[i + 1] - knots[i];
            let turn = rotation_vector(&(rotations[i].inverse() * rotations[i + 1]));
            let begin = scaled(jets[i], h);
            septic(begin, turn, jet_of_logarithm(&turn, scaled(jets[i + 1], h)))
        };
        Self { knots: knots.to_vec(), rotations: rotations.to_vec(), pieces: (0..last).map(piece).collect() }
    }

    /// The rotation at the parameter `s`, and its rate by it as a rotation rate in world axes.
    pub fn at(&self, s: f64) -> (Rotation3<f64>, Vector3<f64>) {
        let i = interval(&self.knots, s);
        let h = self.knots[i + 1] - self.knots[i];
        let x = (s - self.knots[i]) / h;
        let (mut turn, mut rate) = (Vector3::zeros(), Vector3::zeros());
        for coefficient in self.pieces[i].iter().rev() {
            // Horner for f / x, whose derivative gives that of f.
            rate = rate * x + turn;
            turn = turn * x + coefficient;
        }
        let rate = (rate * x + turn) / h;
        let turn = turn * x;
        let (begin, spin) = (&self.rotations[i], left_jacobian_times(&turn, &rate));
        (begin * Rotation3::new(turn), begin * spin)
    }
}

/// `J_l(f) r`, the rate in fixed axes of a rotation whose vector `f` changes by `r`:
/// `r + (1 - cos a) / a^2 f x r + (a - sin a) / a^3 f x (f x r)` with the angle `a = |f|`.
pub(in crate::task) fn left_jacobian_times(vector: &Vector3<f64>, rate: &Vector3<f64>) -> Vector3<f64> {
    let square = vector.norm_squared();
    let angle = square.sqrt();
    let (once, twice) = if square < 1e-4 {
        (0.5 - square / 24.0 * (1.0 - square / 30.0), (1.0 - square / 20.0 * (1.0 - square / 42.0)) / 6.0)
    } else {
        ((1.0 - angle.cos()) / square, (angle - angle.sin()) / (square * angle))
    };
    let across = vector.cross(rate);
    rate + across * once + vector.cross(&across) * twice
}

/// The derivatives by `x` of a function of `s = h x`.
fn scaled(jet: Jet, h: f64) -> Jet {
    [jet[0] * h, jet[1] * (h * h), jet[2] * (h * h * h)]
}

/// How the curve turns at knot `i`, seen from there.
fn jet_at(knots: &[f64], rotations: &[Rotation3<f64>], ends: Ends, i: usize) -> Jet {
    let last = rotations.len() - 1;
    if ends == Ends::Clamped && (i == 0 || i == last) {
        return [Vector3::zeros(); 3];
    }
    let (i, seen, own) = if ends == Ends::Periodic {
        let i = i % last;
        (i, around(knots, i), REACH)
    } else {
        // At the ends of an open path the neighbours lie to one side.
        let low = i.saturating_sub(REACH).min(last.saturating_sub(2 * REACH));
        let high = (low + 2 * REACH).min(last);
        (i, (low..=high).map(|k| (k, knots[k] - knots[i])).collect(), i - low)
    };
    let logarithm = |n: usize| rotation_vector(&(rotations[i].inverse() * rotations[seen[n].0]));
    let mut logarithms = vec![Vector3::zeros(); seen.len()];
    for n in own + 1..seen.len() {
        logarithms[n] = nearest(logarithm(n), &logarithms[n - 1]);
    }
    for n in (0..own).rev() {
        logarithms[n] = nearest(logarithm(n), &logarithms[n + 1]);
    }
    let steps: Vec<f64> = seen.iter().map(|(_, step)| *step).collect();
    polynomial_jet(&steps, &logarithms)
}

/// The waypoints around `i` on a closed path, and how far away they are by their parameters.
fn around(knots: &[f64], i: usize) -> Vec<(usize, f64)> {
    let last = knots.len() - 1;
    let period = knots[last] - knots[0];
    let neighbour = |offset: usize| {
        // So many periods ahead that nothing is negative.
        let place = i + REACH * last + offset - REACH;
        let turns = (place / last) as f64 - REACH as f64;
        (place % last, knots[place % last] + turns * period - knots[i])
    };
    (0..=2 * REACH).map(neighbour).collect()
}

/// Of all vectors of the same rotation the one that is nearest to another: turns go on beyond pi.
fn nearest(vector: Vector3<f64>, to: &Vector3<f64>) -> Vector3<f64> {
    let angle = vector.norm();
    if angle < 1e-9 {
        let turns = (to.norm() / TAU).round();
        return if turns == 0.0 { vector } else { to.normalize() * (turns * TAU) };
    }
    let axis = vector / angle;
    let turns = ((axis.dot(to) - angle) / TAU).round();
    axis * (angle + turns * TAU)
}

/// The first three derivatives at 0 of the polynomial through vectors at `steps`, one of which is 0 with the vector 0.
fn polynomial_jet(steps: &[f64], vectors: &[Vector3<f64>]) -> Jet {
    // Newton's divided differences, multiplied out to powers.
    let mut differences = vectors.to_vec();
    for order in 1..steps.len() {
        for k in (order..steps.len()).rev() {
            differences[k] = (differences[k] - differences[k - 1]) / (steps[k] - steps[k - order]);
        }
    }
    let mut powers = vec![Vector3::zeros(); steps.len()];
    for k in (0..steps.len()).rev() {
        for power in (1..steps.len()).rev() {
            powers[power] = powers[power - 1] - powers[power] * steps[k];
        }
        powers[0] = differences[k] - powers[0] * steps[k];
    }
    let of =
        |power: usize, factor: f64| powers.get(power).map_or(Vector3::zeros(), |c: &Vector3<f64>| c * factor);
    [of(1, 1.0), of(2, 2.0), of(3, 6.0)]
}

/// The first three derivatives of `log(exp(turn) exp(w))` where `w` vanishes with those derivatives.
fn jet_of_logarithm(turn: &Vector3<f64>, [v, a, j]: Jet) -> Jet {
    let begin = *UnitQuaternion::new(*turn).quaternion();
    // exp(w) as a quaternion: cos(|w| / 2), and w / 2 (1 - |w|^2 / 24).
    let square = v.norm_squared();
    let real = [1.0, 0.0, -square / 8.0, -v.dot(&a) / 8.0];
    let imaginary = [Vector3::zeros(), v * 0.5, a * 0.25, (j / 6.0 - v * (square / 24.0)) * 0.5];
    let terms: Vec<Quaternion<f64>> = real
        .iter()
        .zip(imaginary)
        .map(|(&real, imaginary)| begin * Quaternion::from_imag(imaginary) + begin * real)
        .collect();
    // The vector is the imaginary part times f(real part), f(s) = 2 acos(s) / sqrt(1 - s^2).
    let factor = angle_over_sine(terms[0].w);
    let [s1, s2, s3] = [terms[1].w, terms[2].w, terms[3].w];
    let series = [
        factor[0],
        factor[1] * s1,
        factor[1] * s2 + factor[2] * s1 * s1 / 2.0,
        factor[1] * s3 + factor[2] * s1 * s2 + factor[3] * s1 * s1 * s1 / 6.0,
    ];
    let coefficient = |n: usize| (0..=n).map(|k| terms[n - k].imag() * series[k]).sum::<Vector3<f64>>();
    [coefficient(1), coefficient(2) * 2.0, coefficient(3) * 6.0]
}

/// `f(s) = 2 acos(s) / sqrt(1 - s^2)` and its first three derivatives, for s from 0 to 1: the series in `1 - s`, whose
/// coefficients have the ratios `(k + 1) / (2 k + 3)`.
fn angle_over_sine(s: f64) -> [f64; 4] {
    let y = 1.0 - s;
    let mut sums = [0.0; 4];
    let mut coefficients = [2.0; TERMS];
    for k in 1..TERMS {
        coefficients[k] = coefficients[k - 1] * k as f64 / (2 * k + 1) as f64;
    }
    for (order, sum) in sums.iter_mut().enumerate() {
        let falling = |k: usize| (k + 1 - order..=k).map(|factor| factor as f64).product::<f64>();
        *sum = (order..TERMS).rev().fold(0.0, |sum, k| sum * y + coefficients[k] * falling(k));
        // Of s, not of 1 - s.
        if order % 2 == 1 {
            *sum = -*sum;
        }
    }
    sums
}

/// The polynomial of degree seven on [0, 1] from 0 to `end` with those three derivatives at its ends: its coefficients from the
/// first power on.
fn septic([v, a, j]: Jet, end: Vector3<f64>, at_end: Jet) -> [Vector3<f64>; 7] {
    let (c1, c2, c3) = (v, a * 0.5, j / 6.0);
    let value = end - c1 - c2 - c3;
    let rate = at_end[0] - c1 - c2 * 2.0 - c3 * 3.0;
    let bend = at_end[1] - c2 * 2.0 - c3 * 6.0;
    let jerk = at_end[2] - c3 * 6.0;
    [
        c1,
        c2,
        c3,
        value * 35.0 - rate * 15.0 + bend * 2.5 - jerk / 6.0,
        value * -84.0 + rate * 39.0 - bend * 7.0 + jerk * 0.5,
        value * 70.0 - rate * 34.0 + bend * 6.5 - jerk * 0.5,
        value * -20.0 + rate * 10.0 - bend * 2.0 + jerk / 6.0,
    ]
}
