use super::multistep::Multistep;
use crate::integrate::coefficients::{Terms, Weights};
use crate::integrate::history::Ring;
use crate::math::Scalar;

impl<T: Scalar> Multistep<T> {
    /// Writes what the history contributes to the state after `x_n`, and returns what the two parts of the derivative at `x_n`
    /// are multiplied by in it: `x_{n+1} = known + first f(t_n, x_n) + second g(t_n, x_n)`.
    ///
    /// To be asked before [`evaluate`](Self::evaluate): a right-hand side that chooses its values by the state that they lead
    /// to (limits of joint positions, say) needs it there. While a start is under way that is no row, and for rows that are
    /// corrected afterwards, it is the state after one Euler step.
    pub fn write_next_state(&self, known: &mut [T]) -> [T; 2] {
        known.copy_from_slice(self.state());
        let Some(weights) = self.explicit_row() else { return [self.step_size(); 2] };
        let newest = self.state();
        for &(age, weight) in &weights.older.0 {
            let sample = self.history().x.get(age);
            for (i, known) in known.iter_mut().enumerate() {
                *known += weight * (sample[i] - newest[i]);
            }
        }
        let second = self.history().g.as_ref().map(|g| add_past(&weights.second, g, known));
        [add_past(&weights.first, &self.history().f, known), second.unwrap_or(T::zero())]
    }

    /// The explicit row that makes the next state, where one does.
    fn explicit_row(&self) -> Option<&Weights<T>> {
        self.next_row().filter(|weights| !weights.is_implicit())
    }
}

/// Adds the terms of the evaluations before the one at the newest state, which is still to come; returns its weight.
fn add_past<T: Scalar>(terms: &Terms<T>, ring: &Ring<T>, known: &mut [T]) -> T {
    let mut newest = T::zero();
    for &(age, weight) in &terms.0 {
        if age == 0 {
            newest = weight;
            continue;
        }
        // One evaluation is missing yet, so everything is one place younger than it will be.
        let sample = ring.get(age - 1);
        for (known, entry) in known.iter_mut().zip(sample) {
            *known += weight * *entry;
        }
    }
    newest
}
