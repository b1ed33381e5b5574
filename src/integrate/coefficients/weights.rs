use super::ratio::RatioRow;
use crate::formula::Formula;
use crate::math::Rational;
use crate::math::Scalar;

/// A row as the stepper uses it: what multiplies the known states and evaluations, newest first, and the new evaluation.
///
/// `x_{n+1} = sum_j state_j x_{n-j} + sum_j first_j f_{n-j} + sum_j second_j g_{n-j} + new_0 f_{n+1} + new_1 g_{n+1}` with
/// `sum_j state_j = 1`.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::integrate) struct Weights<T> {
    /// Without the newest state, whose weight is what the others leave of one.
    pub(in crate::integrate) older: Terms<T>,
    pub(in crate::integrate) first: Terms<T>,
    pub(in crate::integrate) second: Terms<T>,
    /// The weights `sigma beta_0` and `sigma gamma_0` of both parts at the new state, zero in an explicit row.
    pub(in crate::integrate) new: [T; 2],
}

/// The weights that are not zero, with the ages of what they multiply.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::integrate) struct Terms<T>(pub(in crate::integrate) Vec<(usize, T)>);

impl<T: Scalar> Terms<T> {
    fn new(weights: impl Iterator<Item = T>) -> Self {
        Self(weights.enumerate().filter(|(_, weight)| *weight != T::zero()).collect())
    }

    /// No terms yet, with room for so many.
    fn with_capacity(capacity: usize) -> Self {
        Self(Vec::with_capacity(capacity))
    }

    /// Puts other weights, of the ages from `youngest` on, in the place of these, without allocating where there is room.
    fn write(&mut self, youngest: usize, weights: impl Iterator<Item = T>) {
        self.0.clear();
        let aged = (youngest..).zip(weights);
        self.0.extend(aged.filter(|(_, weight)| *weight != T::zero()));
    }

    /// How many samples have to be kept.
    pub(in crate::integrate) fn depth(&self) -> usize {
        self.0.last().map_or(0, |(age, _)| age + 1)
    }
}

impl<T: Scalar> Weights<T> {
    /// The weights of a row at gap `sigma`.
    pub(in crate::integrate) fn of(formula: &Formula, sigma: T) -> Self {
        Self::scaled(formula.alpha(), formula.beta(), formula.gamma(), sigma, T::one())
    }

    /// The same for a row that starts another one: its `gamma` is scaled to the other's `gamma_sum`, so that both
    /// run with the same feedback step `h`.
    pub(in crate::integrate) fn for_start(formula: &Formula, sigma: T, gamma_sum: &Rational) -> Self {
        let scale = T::from_rational(&(gamma_sum / formula.gamma_sum()));
        Self::scaled(formula.alpha(), formula.beta(), formula.gamma(), sigma, scale)
    }

    /// Euler's step with the feedback step of a row whose `gamma` sums to `gamma_sum`.
    pub(in crate::integrate) fn euler(sigma: T, gamma_sum: &Rational) -> Self {
        let only = |weight| Terms(vec![(0, weight)]);
        Self {
            older: Terms(Vec::new()),
            first: only(sigma),
            second: only(sigma * T::from_rational(gamma_sum)),
            new: [T::zero(); 2],
        }
    }

    /// No weights yet, with room for those of a row of so many steps.
    pub(super) fn with_room_for(steps: usize) -> Self {
        let terms = || Terms::with_capacity(steps);
        Self { older: terms(), first: terms(), second: terms(), new: [T::zero(); 2] }
    }

    /// Puts the weights of a row at the step `sigma` in the place of these, without allocating where there is room.
    pub(super) fn write(&mut self, row: &RatioRow<'_, T>, sigma: T) {
        let scale = T::one() / row.alpha[0];
        let step = sigma * scale;
        self.older.write(1, row.alpha[2..].iter().map(|&weight| -weight * scale));
        self.first.write(0, row.beta[1..].iter().map(|&weight| weight * step));
        self.second.write(0, row.gamma[1..].iter().map(|&weight| weight * step));
        self.new = [row.beta[0] * step, row.gamma[0] * step];
    }

    /// Whether the new state is needed to compute it.
    pub(in crate::integrate) fn is_implicit(&self) -> bool {
        self.new.iter().any(|weight| *weight != T::zero())
    }

    fn scaled(alpha: &[Rational], beta: &[Rational], gamma: &[Rational], sigma: T, feedback: T) -> Self {
        let terms = |row: &[Rational], scale: T| {
            Terms::new(row[1..].iter().map(|weight| T::from_rational(weight) * scale))
        };
        let mut older = terms(alpha, -T::one());
        older.0.retain(|&(age, _)| age > 0);
        let new = [(beta, sigma), (gamma, sigma * feedback)];
        Self {
            older,
            first: terms(beta, sigma),
            second: terms(gamma, sigma * feedback),
            new: new.map(|(row, scale)| T::from_rational(&row[0]) * scale),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::formula::FormulaTable;

    #[test]
    fn the_weights_of_the_new_state_are_kept() {
        let weights = |id| Weights::of(FormulaTable::builtin().get(id).unwrap(), 0.5);
        let bdf2 = weights("bdf2");
        assert_eq!((bdf2.new, bdf2.is_implicit()), ([1.0 / 3.0, 1.0 / 3.0], true));
        assert_eq!((bdf2.first.depth(), bdf2.older.0.as_slice()), (0, &[(1_usize, -1.0 / 3.0)][..]));
        let ab2 = weights("ab2");
        assert_eq!((ab2.new, ab2.is_implicit(), ab2.first.depth()), ([0.0, 0.0], false, 2));
    }

    #[test]
    fn rewritten_weights_are_those_of_the_row() {
        // Twice the Adams-Moulton formula of two steps.
        let (mut alpha, mut beta) = ([2.0, -2.0, 0.0], [5.0 / 6.0, 4.0 / 3.0, -1.0 / 6.0]);
        let mut gamma = beta;
        let row = RatioRow { alpha: &mut alpha, beta: &mut beta, gamma: &mut gamma };
        let mut weights = Weights::with_room_for(2);
        weights.write(&row, 0.5);
        let fixed = Weights::of(FormulaTable::builtin().get("am2").unwrap(), 0.5);
        let near = |a: &Terms<f64>, b: &Terms<f64>| {
            a.0.iter().zip(&b.0).all(|(a, b)| a.0 == b.0 && (a.1 - b.1).abs() < 1e-15)
        };
        assert!(near(&weights.first, &fixed.first) && near(&weights.second, &fixed.second));
        assert_eq!((weights.older.depth(), weights.new), (0, fixed.new));
    }
}
