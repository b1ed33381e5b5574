use super::differences::Differences;
use super::family::Past;
use super::piece::Piece;
use crate::math::Scalar;

/// The last states of a run, for the polynomial through them.
#[derive(Clone, Debug)]
pub(in crate::integrate) struct StateWindow<T> {
    past: Differences<T>,
    degree: usize,
    ones: Vec<T>,
    extrapolated: Vec<T>,
    state: Vec<T>,
}

impl<T: Scalar> StateWindow<T> {
    /// Begins with a state; polynomials are of that degree once there are enough states.
    pub(in crate::integrate) fn new(degree: usize, state: &[T]) -> Self {
        let mut past = Differences::new(degree + 2, state.len());
        past.begin(state, None);
        let ones = vec![T::one(); degree + 2];
        Self { past, degree, ones, extrapolated: state.to_vec(), state: state.to_vec() }
    }

    /// Adds the state after a step.
    pub(in crate::integrate) fn push(&mut self, step: T, state: &[T]) {
        let count = self.degree.min(self.past.known());
        self.past.prepare(step);
        self.past.combine(count, &self.ones, &mut self.extrapolated);
        for (top, &state) in self.extrapolated.iter_mut().zip(state) {
            *top = state - *top;
        }
        self.past.commit(count, &mut self.extrapolated);
        self.state.copy_from_slice(state);
    }

    /// The polynomial over the last step, which ends at `now`.
    pub(in crate::integrate) fn piece(&self, now: T) -> Piece<T> {
        let start = now - self.past.psi(0);
        Piece::new([start, now], Past::States, self.past.newest(self.count()), &self.state)
    }

    /// Writes the state at a time within the last step, which ends at `now`.
    pub(in crate::integrate) fn state_at(&self, now: T, t: T, out: &mut [T]) {
        self.past.newest(self.count()).value(t - now, out);
    }

    fn count(&self) -> usize {
        (self.degree + 1).min(self.past.known())
    }
}
