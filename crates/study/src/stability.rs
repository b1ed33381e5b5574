//! Whether a row is stable at a gap on a problem that is stiff.

use kinstep::formula::Formula;
use kinstep::integrate::{EquationField, Equations, Field};
use kinstep::math::rational_to_f64;
use nalgebra::{Complex, DMatrix, linalg::Schur};

/// Problems with more unknowns are not looked at: a Jacobian matrix for each of them takes too long.
const MOST_UNKNOWNS: usize = 64;
/// Rounds after which the eigenvalues of a matrix are given up.
const MOST_ROUNDS: usize = 10_000;
/// A decaying part of the solution that a row lets grow by this factor on the way spoils the run.
const SPOILS: f64 = 1e4;
/// Halvings of the interval in which the largest modulus of a root is sought.
const HALVINGS: usize = 40;

/// The eigenvalues of the Jacobian matrix of a right-hand side at times evenly spread over a run.
pub(super) struct Spectra {
    eigenvalues: Vec<Vec<Complex<f64>>>,
    duration: f64,
}

impl Spectra {
    /// The spectra along states of a solution; empty where they can not be had.
    pub(super) fn along(equations: &Equations, duration: f64, states: &[Vec<f64>]) -> Self {
        let dimension = equations.unknowns().len();
        let count = states.len();
        let mut field = equations.field::<f64>();
        let mut eigenvalues = Vec::new();
        if dimension <= MOST_UNKNOWNS {
            for (k, state) in states.iter().enumerate() {
                let t = duration * k as f64 / (count - 1).max(1) as f64;
                eigenvalues.extend(spectrum(&mut field, t, state));
            }
        }
        Self { eigenvalues, duration }
    }

    /// The largest modulus of an eigenvalue \[1/s\].
    pub(super) fn radius(&self) -> f64 {
        self.eigenvalues.iter().flatten().map(|eigenvalue| eigenvalue.norm()).fold(0.0, f64::max)
    }

    /// Whether the row lets a part of the solution grow that does not grow: the product over the steps of the largest
    /// root of sum (alpha_j - sigma lambda beta_j) z^(s-j), for eigenvalues lambda with a real part of zero or less.
    pub(super) fn spoil(&self, formula: &Formula, sigma: f64) -> bool {
        let steps = self.duration / sigma / self.eigenvalues.len().max(1) as f64;
        let growth = |eigenvalues: &Vec<Complex<f64>>| {
            let decaying = eigenvalues.iter().filter(|eigenvalue| eigenvalue.re <= 0.0);
            let largest = decaying.map(|eigenvalue| largest_root(formula, eigenvalue * sigma));
            steps * largest.fold(1.0, f64::max).ln()
        };
        self.eigenvalues.iter().map(growth).sum::<f64>() > SPOILS.ln()
    }
}

/// The eigenvalues of the Jacobian matrix by central differences.
fn spectrum(field: &mut EquationField<f64>, t: f64, state: &[f64]) -> Option<Vec<Complex<f64>>> {
    let n = state.len();
    let scale = state.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    let mut matrix = DMatrix::zeros(n, n);
    let (mut above, mut below) = (vec![0.0; n], vec![0.0; n]);
    for column in 0..n {
        let step = 1e-6 * state[column].abs().max(1e-3 * scale).max(1e-6);
        let mut moved = state.to_vec();
        moved[column] = state[column] + step;
        field.evaluate(t, &moved, &mut above, &mut []);
        moved[column] = state[column] - step;
        field.evaluate(t, &moved, &mut below, &mut []);
        for row in 0..n {
            matrix[(row, column)] = (above[row] - below[row]) / (2.0 * step);
        }
    }
    if !matrix.iter().all(|entry| entry.is_finite()) {
        return None;
    }
    let schur = Schur::try_new(matrix, f64::EPSILON, MOST_ROUNDS)?;
    Some(schur.complex_eigenvalues().iter().copied().collect())
}

/// The largest modulus of a root of sum (alpha_j - z beta_j) w^(s-j), from above; at least one.
fn largest_root(formula: &Formula, z: Complex<f64>) -> f64 {
    const FARTHEST: f64 = 1e12;
    let pairs = formula.alpha().iter().zip(formula.beta());
    let polynomial: Vec<Complex<f64>> =
        pairs.map(|(alpha, beta)| z * -rational_to_f64(beta) + rational_to_f64(alpha)).collect();
    // The root of one itself is on the circle for z = 0; a hair is no instability.
    let mut high = 1.0 + 1e-9;
    if is_within(&polynomial, high) {
        return 1.0;
    }
    while !is_within(&polynomial, high) && high < FARTHEST {
        high *= 4.0;
    }
    let mut low = 1.0;
    for _ in 0..HALVINGS {
        let middle = f64::midpoint(low, high);
        if is_within(&polynomial, middle) {
            high = middle;
        } else {
            low = middle;
        }
    }
    high
}

/// Whether all roots lie within a radius: Schur's reduction, highest power first.
fn is_within(polynomial: &[Complex<f64>], radius: f64) -> bool {
    let mut power = 1.0;
    let mut rest = Vec::with_capacity(polynomial.len());
    for coefficient in polynomial {
        rest.push(coefficient * power);
        power /= radius;
    }
    while rest.len() > 1 {
        let (first, last) = (rest[0], rest[rest.len() - 1]);
        let ratio = last / first.conj();
        if !(last.norm() < first.norm()) {
            return false;
        }
        let mirrored: Vec<Complex<f64>> = rest.iter().rev().map(Complex::conj).collect();
        rest = rest.iter().zip(&mirrored).take(rest.len() - 1).map(|(a, b)| a - ratio * b).collect();
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;
    use kinstep::formula::FormulaTable;

    /// The ends of real stability intervals as textbooks have them (E. Hairer and G. Wanner, Solving Ordinary Differential
    /// Equations II, V.1).
    #[test]
    fn the_real_intervals_of_adams_rows_end_where_they_are_known_to() {
        for (id, end) in [("la2-euler", -2.0), ("ab2", -1.0), ("ab3", -6.0 / 11.0), ("ab4", -0.3)] {
            let formula = FormulaTable::builtin().get(id).expect("a row");
            assert!(largest_root(formula, Complex::new(0.999 * end, 0.0)) <= 1.0, "{id}");
            assert!(largest_root(formula, Complex::new(1.001 * end, 0.0)) > 1.0, "{id}");
        }
        let euler = FormulaTable::builtin().get("la2-euler").expect("a row");
        let root = largest_root(euler, Complex::new(-2.0, 3.0));
        assert!((root - 10_f64.sqrt()).abs() < 1e-9, "{root}");
    }
}
