//! A start by one Runge-Kutta step for each step of the row.

use super::tableau::Tableau;
use crate::integrate::field::{Field, Parts};
use crate::math::Scalar;

/// A tableau with the memory its stages need.
#[derive(Clone, Debug)]
pub(in crate::integrate) struct RungeKutta<T> {
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
    use crate::integrate::field::Ode;

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
