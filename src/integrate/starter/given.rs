//! A start with states that are given.

use crate::integrate::error::{IntegrateError, check_length};
use crate::integrate::history::Origin;
use crate::math::Scalar;

/// The states `x_1, x_2, ...`.
#[derive(Clone, Debug)]
pub(in crate::integrate) struct GivenStates<T>(Vec<Vec<T>>);

impl<T: Scalar> GivenStates<T> {
    /// The start of a method of so many steps, called `id`.
    pub(super) fn new(
        states: &[Vec<T>],
        id: &str,
        steps: usize,
        dimension: usize,
    ) -> Result<Self, IntegrateError> {
        let expected = steps - 1;
        if states.len() != expected {
            return Err(IntegrateError::StartingStates { id: id.to_owned(), got: states.len(), expected });
        }
        for (k, state) in states.iter().enumerate() {
            check_length(&format!("starting state {}", k + 1), state, dimension)?;
        }
        Ok(Self(states.to_vec()))
    }

    /// The state that follows the one of index `index`.
    pub(super) fn after(&self, index: usize) -> &[T] {
        &self.0[index]
    }

    /// How many there are.
    pub(super) fn len(&self) -> usize {
        self.0.len()
    }

    /// The states of components that come from several starts.
    pub(super) fn gathered(starts: &[&Self], origins: &[Option<Origin>]) -> Self {
        let count = starts.first().map_or(0, |start| start.len());
        let state = |k: usize| {
            let entry =
                |origin: &Option<Origin>| origin.map_or(T::zero(), |(which, i)| starts[which].0[k][i]);
            origins.iter().map(entry).collect()
        };
        Self((0..count).map(state).collect())
    }
}
