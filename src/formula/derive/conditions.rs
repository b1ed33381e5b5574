//! Linear equations over the rationals, taken in one at a time.

use num_traits::{One, Zero};

use crate::math::Rational;

/// What an equation adds to those before it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Addition {
    /// One unknown fewer is free.
    Independent,
    /// Nothing: it follows from the others.
    Implied,
    /// It contradicts the others.
    Contradictory,
}

/// Equations in reduced echelon form, each with its right-hand side as the last entry.
#[derive(Debug, Clone)]
pub(super) struct Echelon {
    unknowns: usize,
    rows: Vec<Vec<Rational>>,
    pivots: Vec<usize>,
    /// Which unknowns are solved for first.
    preference: Vec<usize>,
}

/// All solutions: a particular one plus any multiples of the directions.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct AffineSpace {
    /// The solution with every free unknown zero.
    pub(crate) particular: Vec<Rational>,
    /// The unknowns that are free.
    pub(crate) free: Vec<usize>,
    /// One for each free unknown: the change when that one rises by 1 and the other free ones stay.
    pub(crate) directions: Vec<Vec<Rational>>,
}

impl Echelon {
    /// Returns no equations for `preference.len()` unknowns, to be solved for in that order.
    pub(super) fn new(preference: Vec<usize>) -> Self {
        Self { unknowns: preference.len(), rows: Vec::new(), pivots: Vec::new(), preference }
    }

    /// Takes an equation in: coefficients and, last, the right-hand side. A contradictory one is not kept.
    pub(super) fn add(&mut self, mut equation: Vec<Rational>) -> Addition {
        for (row, &pivot) in self.rows.iter().zip(&self.pivots) {
            subtract_multiple(&mut equation, row, pivot);
        }
        let Some(pivot) = self.preference.iter().copied().find(|&k| !equation[k].is_zero()) else {
            let contradicts = !equation[self.unknowns].is_zero();
            return if contradicts { Addition::Contradictory } else { Addition::Implied };
        };
        let scale = equation[pivot].clone();
        for c in &mut equation {
            *c /= &scale;
        }
        for row in &mut self.rows {
            subtract_multiple(row, &equation, pivot);
        }
        self.rows.push(equation);
        self.pivots.push(pivot);
        Addition::Independent
    }

    /// Returns all solutions.
    pub(super) fn solutions(&self) -> AffineSpace {
        let mut particular = vec![Rational::zero(); self.unknowns];
        for (row, &pivot) in self.rows.iter().zip(&self.pivots) {
            particular[pivot] = row[self.unknowns].clone();
        }
        let free: Vec<usize> = (0..self.unknowns).filter(|k| !self.pivots.contains(k)).collect();
        let direction = |&k: &usize| {
            let mut direction = vec![Rational::zero(); self.unknowns];
            direction[k] = Rational::one();
            for (row, &pivot) in self.rows.iter().zip(&self.pivots) {
                direction[pivot] = -&row[k];
            }
            direction
        };
        let directions = free.iter().map(direction).collect();
        AffineSpace { particular, free, directions }
    }
}

/// Takes the multiple of `row` (1 at `pivot`) off the equation that clears its entry there.
fn subtract_multiple(equation: &mut [Rational], row: &[Rational], pivot: usize) {
    let factor = equation[pivot].clone();
    if factor.is_zero() {
        return;
    }
    for (c, r) in equation.iter_mut().zip(row).filter(|(_, r)| !r.is_zero()) {
        *c -= &factor * r;
    }
}

impl AffineSpace {
    /// Returns the solution with these values of the free unknowns.
    pub(crate) fn at(&self, values: &[Rational]) -> Vec<Rational> {
        let mut solution = self.particular.clone();
        for (value, direction) in values.iter().zip(&self.directions) {
            for (entry, slope) in solution.iter_mut().zip(direction) {
                *entry += value * slope;
            }
        }
        solution
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn numbers(list: &[i64]) -> Vec<Rational> {
        list.iter().map(|&c| Rational::from_integer(c.into())).collect()
    }

    #[test]
    fn solves_says_what_follows_and_refuses_contradictions() {
        let mut echelon = Echelon::new(vec![0, 1, 2]);
        assert_eq!(echelon.add(numbers(&[1, 1, 1, 6])), Addition::Independent);
        assert_eq!(echelon.add(numbers(&[1, -1, 0, 1])), Addition::Independent);
        assert_eq!(echelon.add(numbers(&[2, 0, 1, 7])), Addition::Implied);
        assert_eq!(echelon.add(numbers(&[2, 0, 1, 8])), Addition::Contradictory);
        let all = echelon.solutions();
        assert_eq!(all.free, [2]);
        let found = all.at(&numbers(&[3]));
        assert_eq!(found, numbers(&[2, 1, 3]));
    }

    #[test]
    fn the_preferred_unknowns_are_solved_for() {
        let mut echelon = Echelon::new(vec![1, 0]);
        echelon.add(numbers(&[3, 2, 5]));
        assert_eq!(echelon.solutions().free, [0]);
    }
}
