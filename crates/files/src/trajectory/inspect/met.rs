//! Values, and when they were met.

/// A value, and when it was met \[s\].
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Met {
    /// The value.
    pub value: f64,
    /// The time \[s\].
    pub t: f64,
}

impl Met {
    /// Takes another value where that is larger, whatever the signs.
    pub(super) fn larger(&mut self, value: f64, t: f64) {
        if value.abs() > self.value.abs() {
            *self = Self { value, t };
        }
    }
}

/// Returns the largest of values, whatever their signs, each with its time.
pub(super) fn largest(values: impl Iterator<Item = Met>, start: f64) -> Met {
    let mut met = Met { value: 0.0, t: start };
    values.for_each(|other| met.larger(other.value, other.t));
    met
}
