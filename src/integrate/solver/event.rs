use crate::math::Scalar;
use std::fmt;

/// In which direction the function of an [`Event`] has to cross zero, as time goes on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Direction {
    /// In either.
    #[default]
    Any,
    /// From below.
    Rising,
    /// From above.
    Falling,
}

/// A function of time and state.
type Function<'e, T> = dyn FnMut(T, &[T]) -> T + 'e;

/// Something that happens where a function of time and state crosses zero.
///
/// ```
/// use kinstep::integrate::{Direction, Event};
/// let ground = Event::new("ground", |_t, x: &[f64]| x[0]).direction(Direction::Falling).terminal();
/// assert_eq!(ground.name(), "ground");
/// ```
pub struct Event<'e, T> {
    name: String,
    function: Box<Function<'e, T>>,
    direction: Direction,
    is_terminal: bool,
}

impl<'e, T: Scalar> Event<'e, T> {
    /// The event of that name where `function(t, x)` crosses zero.
    pub fn new(name: impl Into<String>, function: impl FnMut(T, &[T]) -> T + 'e) -> Self {
        let function = Box::new(function);
        Self { name: name.into(), function, direction: Direction::Any, is_terminal: false }
    }

    /// Only where it crosses zero in this direction.
    #[must_use]
    pub fn direction(self, direction: Direction) -> Self {
        Self { direction, ..self }
    }

    /// The solution ends there.
    #[must_use]
    pub fn terminal(self) -> Self {
        Self { is_terminal: true, ..self }
    }

    /// Its name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Whether the solution ends there.
    pub fn is_terminal(&self) -> bool {
        self.is_terminal
    }

    pub(super) fn value(&mut self, t: T, x: &[T]) -> f64 {
        (self.function)(t, x).to_f64()
    }

    /// Whether it happens where the function goes from one value to another.
    pub(super) fn is_crossed(&self, before: f64, after: f64) -> bool {
        match self.direction {
            Direction::Any => true,
            Direction::Rising => before < after,
            Direction::Falling => before > after,
        }
    }
}

impl<T> fmt::Debug for Event<'_, T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { name, direction, is_terminal, .. } = self;
        f.debug_struct("Event")
            .field("name", name)
            .field("direction", direction)
            .field("is_terminal", is_terminal)
            .finish_non_exhaustive()
    }
}
