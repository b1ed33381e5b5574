use super::{Infeasible, Instant, JointVelocity, SystemShape};

/// How the answer of a law depends on what it is asked for: by this the planner knows which coefficients of a row integrate it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LinearityKind {
    /// Linear in `phi'` and `-k e` apart: the feedforward part is integrated with `beta`, the feedback part with `gamma`,
    /// and the feedback step `h` lies in the range of the whole row.
    #[default]
    Split,
    /// Not linear, as soon as a limit is active for instance: everything is integrated with `beta`, and the feedback step
    /// lies in the range of `(alpha, beta)`.
    Total,
}

/// How well conditioned an instant was, and what else is watched.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resolution {
    /// The smallest singular value of the task Jacobian where it is near the threshold, else a lower bound of it.
    pub smallest_singular_value: f64,
    /// Whether the answer was damped because that value lay below the law's threshold.
    pub damped: bool,
    /// The rate [1/s] at which the null-space criteria pulled here; zero without any.
    pub criterion_rate: f64,
    /// How many rows of a stack of tasks could not be met beside those that come before them.
    pub missing_rows: usize,
}

impl Default for Resolution {
    /// Far from every singularity, without a criterion.
    fn default() -> Self {
        Self { smallest_singular_value: f64::INFINITY, damped: false, criterion_rate: 0.0, missing_rows: 0 }
    }
}

/// A redundancy resolution: joint velocities for the tasks of a system.
///
/// Two methods are required. A law owns what scratch memory it needs, so every system has its own; nothing is allocated
/// after [`prepare`](Law::prepare). Laws of your own use the same door as the built-in ones:
///
/// ```
/// use kinstep::law::{Infeasible, Instant, JointVelocity, Law, Resolution, SystemShape};
///
/// /// The transposed Jacobian: slow, but never singular.
/// struct Transposed {
///     rate: f64,
/// }
///
/// impl Law for Transposed {
///     fn prepare(&mut self, _shape: &SystemShape) {}
///
///     fn resolve(
///         &mut self,
///         instant: &Instant<'_>,
///         velocity: &mut JointVelocity<'_>,
///     ) -> Result<Resolution, Infeasible> {
///         velocity.feedforward.fill(0.0);
///         velocity.feedback.fill(0.0);
///         for task in instant.tasks {
///             for (joint, column) in task.jacobian.column_iter().enumerate() {
///                 for row in 0..task.rows() {
///                     velocity.feedforward[joint] += self.rate * column[row] * task.feedforward[row];
///                     velocity.feedback[joint] += self.rate * column[row] * task.feedback[row];
///                 }
///             }
///         }
///         Ok(Resolution::default())
///     }
/// }
/// ```
pub trait Law: Send {
    /// Allocates what systems of this shape need; called once, before the first [`resolve`](Law::resolve).
    fn prepare(&mut self, shape: &SystemShape);

    /// Writes the joint velocities for an instant.
    ///
    /// It may be called several times for one sample, and for instants that are none (the stages of Runge-Kutta starts):
    /// what a law remembers it takes note of in [`accept`](Law::accept).
    ///
    /// # Errors
    /// [`Infeasible`] when no joint velocity meets what is asked for within what is allowed; the run stops there.
    fn resolve(
        &mut self,
        instant: &Instant<'_>,
        velocity: &mut JointVelocity<'_>,
    ) -> Result<Resolution, Infeasible>;

    /// Takes note of a sample of the run, once for each: for warm starts and memory.
    fn accept(&mut self, _instant: &Instant<'_>) {}

    /// How the answer depends on what is asked for; [`LinearityKind::Split`] unless overridden.
    fn kind(&self) -> LinearityKind {
        LinearityKind::Split
    }

    /// Whether its answers keep the limits of all joints. Then a run may start with joints outside their position limits: they are
    /// brought back.
    fn keeps_limits(&self) -> bool {
        false
    }

    /// Whether [`Instant::next`] is to be there.
    fn needs_next_state(&self) -> bool {
        false
    }

    /// Whether [`Instant::avoidance`] is to be there: pairs of bodies that are near. All arms of a plan that has something around
    /// them are then one system, so that the law sees every pair.
    fn keeps_distances(&self) -> bool {
        false
    }

    /// The singular value below which this law calls a configuration singular: a run does not start there, and what it
    /// loses near there is put down to it. Zero unless overridden: no configuration is.
    fn threshold(&self) -> f64 {
        0.0
    }

    /// Why this law can not resolve systems of a shape, as the end of a sentence that begins with "this law"; `None` if it
    /// can. Asked before [`prepare`](Law::prepare).
    fn objection(&self, _shape: &SystemShape) -> Option<String> {
        None
    }

    /// The threshold of a law that is the least-norm law and nothing else. While the smallest singular value is certain to
    /// lie above it, the planner resolves several systems at once, with the same answer to the last bit.
    fn fast_path(&self) -> Option<f64> {
        None
    }

    /// The largest rate [1/s] at which null-space criteria of this law pull the joints, if it is known beforehand. It is
    /// integrated explicitly, so the planner refuses a `sigma` at which the row could not follow it; rates that depend on
    /// the configuration are watched instead ([`Resolution::criterion_rate`]).
    fn criterion_rate(&self) -> Option<f64> {
        None
    }
}

impl Law for Box<dyn Law> {
    fn prepare(&mut self, shape: &SystemShape) {
        (**self).prepare(shape);
    }

    fn resolve(
        &mut self,
        instant: &Instant<'_>,
        velocity: &mut JointVelocity<'_>,
    ) -> Result<Resolution, Infeasible> {
        (**self).resolve(instant, velocity)
    }

    fn accept(&mut self, instant: &Instant<'_>) {
        (**self).accept(instant);
    }

    fn kind(&self) -> LinearityKind {
        (**self).kind()
    }

    fn keeps_limits(&self) -> bool {
        (**self).keeps_limits()
    }

    fn needs_next_state(&self) -> bool {
        (**self).needs_next_state()
    }

    fn keeps_distances(&self) -> bool {
        (**self).keeps_distances()
    }

    fn threshold(&self) -> f64 {
        (**self).threshold()
    }

    fn objection(&self, shape: &SystemShape) -> Option<String> {
        (**self).objection(shape)
    }

    fn fast_path(&self) -> Option<f64> {
        (**self).fast_path()
    }

    fn criterion_rate(&self) -> Option<f64> {
        (**self).criterion_rate()
    }
}
