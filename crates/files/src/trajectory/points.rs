//! The points of a joint trajectory.

use super::error::Problem;
use super::node::Node;
use super::quantity::Quantity;
use super::times::Times;
use super::{ArmTrajectory, Trajectory};

/// The key that has them.
pub(super) const POINTS: &str = "points";

/// Points while they are read, as plain numbers.
#[derive(Clone, Debug)]
pub(super) struct Points {
    /// Where the first one begins.
    first: usize,
    /// Whether a first point has decided what all have.
    is_begun: bool,
    width: usize,
    times: Times,
    values: [Vec<f64>; 3],
    known: [bool; 3],
}

impl Points {
    /// No points yet, of a list that begins at a byte.
    pub(super) fn new(at: usize) -> Self {
        let values = [Vec::new(), Vec::new(), Vec::new()];
        Self {
            first: at,
            is_begun: false,
            width: 0,
            times: Times::new(None),
            values,
            known: [true, false, false],
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.times.len() == 0
    }

    /// No points yet, of those that go on behind these.
    pub(super) fn following(&self) -> Self {
        let values = [Vec::new(), Vec::new(), Vec::new()];
        Self { times: self.times.following(), values, ..*self }
    }

    /// Adds points that go on behind these, and returns whether they come after them.
    pub(super) fn append(&mut self, other: &Self) -> bool {
        for (values, others) in self.values.iter_mut().zip(&other.values) {
            values.extend_from_slice(others);
        }
        self.times.append(&other.times)
    }

    /// Makes room for so many points.
    pub(super) fn reserve(&mut self, points: usize) {
        self.times.reserve(points);
        for (values, _) in self.values.iter_mut().zip(self.known).filter(|(_, known)| *known) {
            values.reserve_exact(points * self.width);
        }
    }

    /// Adds a point.
    pub(super) fn push(&mut self, point: &Node<'_>) -> Result<(), Problem> {
        if !self.is_begun {
            self.begin(point)?;
        }
        let span = point.need("time_from_start")?;
        let pushed = match span.nanoseconds()? {
            Some(nanoseconds) => self.times.push_nanoseconds(nanoseconds),
            None if span.text().is_err() => {
                return Err(Problem::at(
                    span.at(),
                    "expected seconds, or `sec` and `nanosec`, or `secs` and `nsecs`",
                ));
            }
            None => self.times.push(span.text()?),
        };
        pushed.map_err(|message| Problem::at(span.at(), message))?;
        for (quantity, values) in Quantity::ALL.into_iter().zip(&mut self.values) {
            if self.known[quantity as usize] {
                point.need(quantity.plural())?.numbers(self.width, values)?;
            }
        }
        Ok(())
    }

    /// What the first point has, all have.
    fn begin(&mut self, point: &Node<'_>) -> Result<(), Problem> {
        let positions = point.need(Quantity::Position.plural())?;
        self.first = positions.at();
        self.is_begun = true;
        self.width = positions.list("a list of numbers")?.len();
        for quantity in [Quantity::Velocity, Quantity::Acceleration] {
            self.known[quantity as usize] =
                point.get(quantity.plural()).is_some_and(|list| list.items().is_some() && !list.is_empty());
        }
        Ok(())
    }

    /// Returns the trajectory of joints of those names.
    pub(super) fn finish(
        self,
        name: &str,
        joints: Vec<String>,
        notes: &mut Vec<String>,
    ) -> Result<Trajectory, Problem> {
        if self.width != joints.len() {
            let (count, got) = (joints.len(), self.width);
            return Err(Problem::at(
                self.first,
                format!("expected {count} numbers, one per joint, got {got}"),
            ));
        }
        let [positions, velocities, accelerations] = self.values;
        let arm =
            ArmTrajectory { joints, positions, velocities, accelerations, ..ArmTrajectory::empty(name) };
        Ok(Trajectory { about: None, times: self.times.finish(notes), arms: vec![arm] })
    }
}
