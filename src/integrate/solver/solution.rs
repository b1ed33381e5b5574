use crate::integrate::adaptive::{Piece, SolveStatus, Statistics};
use crate::math::Scalar;

/// A state at its time.
#[derive(Clone, Debug, PartialEq)]
pub struct Sample<T> {
    /// The time.
    pub t: T,
    /// The state.
    pub x: Vec<T>,
}

/// An event that happened.
#[derive(Clone, Debug, PartialEq)]
pub struct Happening<T> {
    /// The event's place among those that were given.
    pub event: usize,
    /// Its name.
    pub name: String,
    /// When.
    pub t: T,
    /// The state then.
    pub x: Vec<T>,
}

/// A step that was made.
#[derive(Clone, Debug, PartialEq)]
pub struct StepRecord<T> {
    /// The time at its end.
    pub t: T,
    /// The state then.
    pub x: Vec<T>,
    /// The order of the formula that made it.
    pub order: usize,
}

/// What a [`Solver`](super::Solver) found; where it could not go on, up to there.
#[derive(Clone, Debug)]
pub struct Solution<T> {
    /// How it ended.
    pub status: SolveStatus,
    /// Why it did not go on, where it did not.
    pub reason: Option<String>,
    /// What made it: the id of a family or a formula, or several where one took over from another.
    pub method: String,
    /// The time at which it ended.
    pub t: T,
    /// The state then.
    pub x: Vec<T>,
    /// The states at the times that were asked for, as far as it came.
    pub samples: Vec<Sample<T>>,
    /// The events that happened, in their order.
    pub events: Vec<Happening<T>>,
    /// The start and every step, where they were asked for.
    pub steps: Vec<StepRecord<T>>,
    /// What it took.
    pub statistics: Statistics,
    /// What is questionable about it.
    pub warnings: Vec<String>,
    pub(super) pieces: Vec<Piece<T>>,
}

impl<T: Scalar> Solution<T> {
    /// Returns the state at a time, where the solution was kept [dense](super::Solver::dense) and covers it: by the polynomial of the step
    /// around it, of the order of the formula that made it.
    pub fn at(&self, t: T) -> Option<Vec<T>> {
        let place = |times: [T; 2]| (t - times[0]).to_f64() * (t - times[1]).to_f64() <= 0.0;
        let forwards = self.pieces.first().is_some_and(|piece| piece.times[1] > piece.times[0]);
        let ends_before = |piece: &Piece<T>| if forwards { piece.times[1] < t } else { piece.times[1] > t };
        let piece = self.pieces.get(self.pieces.partition_point(ends_before))?;
        let mut state = self.x.clone();
        place(piece.times).then(|| piece.state_at(t, &mut state))?;
        Some(state)
    }
}
