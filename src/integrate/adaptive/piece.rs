use super::differences::Newest;
use super::family::Past;
use crate::math::Scalar;

/// The solution over one step, as a polynomial of the order of the formula that made it.
#[derive(Clone, Debug)]
pub(in crate::integrate) struct Piece<T> {
    /// From when to when.
    pub(in crate::integrate) times: [T; 2],
    past: Past,
    phi: Vec<T>,
    psi: Vec<T>,
    state: Vec<T>,
}

impl<T: Scalar> Piece<T> {
    pub(super) fn new(times: [T; 2], past: Past, newest: Newest<'_, T>, state: &[T]) -> Self {
        let (phi, psi) = (newest.phi.to_vec(), newest.psi.to_vec());
        Self { times, past, phi, psi, state: state.to_vec() }
    }

    /// Writes the state at a time within the step.
    pub(in crate::integrate) fn state_at(&self, t: T, out: &mut [T]) {
        let newest = Newest { phi: &self.phi, psi: &self.psi, dimension: self.state.len() };
        Self::write(self.past, newest, &self.state, t - self.times[1], out);
    }

    /// Writes the state at `offset` from the end of the step, where it is `state`.
    pub(super) fn write(past: Past, newest: Newest<'_, T>, state: &[T], offset: T, out: &mut [T]) {
        match past {
            Past::States => newest.value(offset, out),
            Past::Derivatives => {
                newest.integral(offset, out);
                for (entry, &state) in out.iter_mut().zip(state) {
                    *entry += state;
                }
            }
        }
    }
}
