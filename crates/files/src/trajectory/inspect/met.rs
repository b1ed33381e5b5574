//! Values, and when they were met.

use super::segment::Segment;

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

    /// Takes the largest value over a step, whose values have these bounds, where that is larger, whatever the signs.
    pub(super) fn take(&mut self, segment: &Segment, [least, most]: [f64; 2]) {
        if least.abs().max(most.abs()) > self.value.abs() {
            for s in segment.turning_points().into_iter().chain([0.0, 1.0]) {
                self.larger(segment.value(s), segment.time(s));
            }
        }
    }
}

/// Returns the largest of values, whatever their signs, each with its time.
pub(super) fn largest(values: impl Iterator<Item = Met>, start: f64) -> Met {
    let mut met = Met { value: 0.0, t: start };
    values.for_each(|other| met.larger(other.value, other.t));
    met
}
