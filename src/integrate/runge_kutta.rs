use super::{Field, Parts, Scalar};
use crate::math::Rational;

/// An explicit Runge-Kutta tableau, used to start multistep rows.
///
/// `k_i = f(t + c_i sigma, x + sigma sum_{j<i} a_ij k_j)`, `x_next = x + sigma sum_i b_i k_i`.
#[derive(Clone, Debug, PartialEq)]
pub struct Tableau<T> {
    /// Row `i` holds `a_ij` for `j < i`; the first row is empty.
    pub a: Vec<Vec<T>>,
    /// The weights of the stages.
    pub b: Vec<T>,
    /// The abscissas `c_i`, each the sum of its row.
    pub c: Vec<T>,
}

impl<T: Scalar> Tableau<T> {
    fn new(a: Vec<Vec<T>>, b: Vec<T>) -> Self {
        let c = a.iter().map(|row| row.iter().fold(T::zero(), |sum, &entry| sum + entry)).collect();
        Self { a, b, c }
    }

    /// Number of stages.
    pub fn stages(&self) -> usize {
        self.b.len()
    }

    /// The classical method of order 4 (Kutta 1901).
    pub fn rk4() -> Self {
        let q = |n: i64, d: i64| T::from_rational(&Rational::new(n.into(), d.into()));
        let o = T::zero;
        Self::new(
            vec![vec![], vec![q(1, 2)], vec![o(), q(1, 2)], vec![o(), o(), T::one()]],
            vec![q(1, 6), q(1, 3), q(1, 3), q(1, 6)],
        )
    }

    /// The eleven-stage method of order 8 of Cooper and Verner (SIAM J. Numer. Anal. 9, 1972), whose coefficients
    /// lie in Q(sqrt 21) and are therefore as exact as the scalar.
    pub fn rk8() -> Self {
        let root = T::from_index(21).sqrt();
        // (n + m sqrt 21) / d
        let q = |n: i64, m: i64, d: i64| {
            T::from_rational(&Rational::new(n.into(), d.into()))
                + root * T::from_rational(&Rational::new(m.into(), d.into()))
        };
        let o = T::zero;
        let a = vec![
            vec![],
            vec![q(1, 0, 2)],
            vec![q(1, 0, 4), q(1, 0, 4)],
            vec![q(1, 0, 7), q(-7, -3, 98), q(21, 5, 49)],
            vec![q(11, 1, 84), o(), q(18, 4, 63), q(21, -1, 252)],
            vec![q(5, 1, 48), o(), q(9, 1, 36), q(-231, 14, 360), q(63, -7, 80)],
            vec![q(10, -1, 42), o(), q(-432, 92, 315), q(633, -145, 90), q(-504, 115, 70), q(63, -13, 35)],
            vec![q(1, 0, 14), o(), o(), o(), q(14, -3, 126), q(13, -3, 63), q(1, 0, 9)],
            vec![
                q(1, 0, 32),
                o(),
                o(),
                o(),
                q(91, -21, 576),
                q(11, 0, 72),
                q(-385, -75, 1152),
                q(63, 13, 128),
            ],
            vec![
                q(1, 0, 14),
                o(),
                o(),
                o(),
                q(1, 0, 9),
                q(-733, -147, 2205),
                q(515, 111, 504),
                q(-51, -11, 56),
                q(132, 28, 245),
            ],
            vec![
                o(),
                o(),
                o(),
                o(),
                q(-42, 7, 18),
                q(-18, 28, 45),
                q(-273, -53, 72),
                q(301, 53, 72),
                q(28, -28, 45),
                q(49, -7, 18),
            ],
        ];
        let mut b = vec![q(1, 0, 20), o(), o(), o(), o(), o(), o()];
        b.extend([q(49, 0, 180), q(16, 0, 45), q(49, 0, 180), q(1, 0, 20)]);
        Self::new(a, b)
    }
}

/// A tableau with the memory its stages need.
#[derive(Clone, Debug)]
pub(super) struct RungeKutta<T> {
    tableau: Tableau<T>,
    stages: Vec<Vec<T>>,
    argument: Vec<T>,
    second: Vec<T>,
}

impl<T: Scalar> RungeKutta<T> {
    pub(super) fn new(tableau: Tableau<T>, dimension: usize, parts: Parts) -> Self {
        let second = if parts == Parts::One { 0 } else { dimension };
        Self {
            stages: vec![vec![T::zero(); dimension]; tableau.stages()],
            argument: vec![T::zero(); dimension],
            second: vec![T::zero(); second],
            tableau,
        }
    }

    /// Whether the other one is the same method.
    pub(super) fn is_like(&self, other: &Self) -> bool {
        self.tableau == other.tableau && self.second.is_empty() == other.second.is_empty()
    }

    /// The same method for states of another length.
    pub(super) fn for_dimension(&self, dimension: usize) -> Self {
        let parts = if self.second.is_empty() { Parts::One } else { Parts::Additive };
        Self::new(self.tableau.clone(), dimension, parts)
    }

    /// Writes the state one `sigma` after `x` at time `t`; `f` and `g` are the parts already known at `(t, x)`.
    pub(super) fn step(
        &mut self,
        field: &mut impl Field<T>,
        t: T,
        sigma: T,
        (x, f, g): (&[T], &[T], Option<&[T]>),
        next: &mut [T],
    ) {
        self.stages[0].copy_from_slice(f);
        if let (Parts::Additive, Some(g)) = (field.parts(), g) {
            add_to(&mut self.stages[0], g);
        }
        for i in 1..self.tableau.stages() {
            combine(&mut self.argument, x, sigma, &self.tableau.a[i], &self.stages);
            let time = t + self.tableau.c[i] * sigma;
            field.evaluate(time, &self.argument, &mut self.stages[i], &mut self.second);
            if field.parts() == Parts::Additive {
                add_to(&mut self.stages[i], &self.second);
            }
        }
        combine(next, x, sigma, &self.tableau.b, &self.stages);
    }
}

fn add_to<T: Scalar>(sum: &mut [T], other: &[T]) {
    for (a, &b) in sum.iter_mut().zip(other) {
        *a += b;
    }
}

/// Writes `x + sigma * sum_j weights_j stages_j`.
fn combine<T: Scalar>(out: &mut [T], x: &[T], sigma: T, weights: &[T], stages: &[Vec<T>]) {
    for (i, entry) in out.iter_mut().enumerate() {
        let mut sum = T::zero();
        for (&weight, stage) in weights.iter().zip(stages) {
            sum += weight * stage[i];
        }
        *entry = x[i] + sigma * sum;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::integrate::Ode;

    /// Largest error at t = 1 of x' = x cos t, y' = x - t y^2 / 4 against a run with many more steps.
    fn error(tableau: &Tableau<f64>, steps: usize) -> f64 {
        let run = |steps: usize| {
            let mut field = Ode::new(2, |t: f64, x: &[f64], d: &mut [f64]| {
                d[0] = x[0] * t.cos();
                d[1] = x[0] - t * x[1] * x[1] / 4.0;
            });
            let mut method = RungeKutta::new(tableau.clone(), 2, Parts::One);
            let (mut x, mut next, mut f) = ([1.0, 0.5], [0.0; 2], [0.0; 2]);
            let sigma = 1.0 / steps as f64;
            for n in 0..steps {
                let t = n as f64 * sigma;
                field.evaluate(t, &x, &mut f, &mut []);
                method.step(&mut field, t, sigma, (&x, &f, None), &mut next);
                x = next;
            }
            x
        };
        let (coarse, fine) = (run(steps), run(64));
        (coarse[0] - fine[0]).abs().max((coarse[1] - fine[1]).abs())
    }

    #[test]
    fn tableaus_have_the_order_they_claim() {
        for (tableau, order) in [(Tableau::rk4(), 4.0), (Tableau::rk8(), 8.0)] {
            let (coarse, fine) = if order < 5.0 { (8, 16) } else { (2, 4) };
            let slope = (error(&tableau, coarse) / error(&tableau, fine)).log2();
            assert!(slope > order - 0.25, "order {order}: slope {slope}");
        }
    }

    #[test]
    fn a_wrong_entry_costs_the_order() {
        let mut tableau = Tableau::<f64>::rk8();
        tableau.a[8][4] += 1e-3;
        let slope = (error(&tableau, 2) / error(&tableau, 4)).log2();
        assert!(slope < 7.0, "slope {slope}");
    }
}
