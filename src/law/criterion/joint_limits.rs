use super::super::Instant;
use super::{Criterion, CriterionKind, MakeCriterion};
use crate::kind::{Form, Kind, Parameter, Parameters};
use crate::robot::Limits;

/// Keeps joints away from their position limits: the steepest descent of `H(q) = 1/2 sum ((q_i - m_i) / r_i)^2`, with `m_i` the
/// middle of a joint's range and `r_i` half its width (Liegeois 1977), `c = -rate r^2 grad H` with `r` the least of the `r_i`.
///
/// Joints with a limit on one side only, or on none, are left alone. A joint of the narrowest range comes to its middle at
/// `rate`, those of wider ones more slowly.
///
/// ```
/// use kinstep::law::{JointLimits, Pseudoinverse};
///
/// let law = Pseudoinverse::new().with_criterion(JointLimits::new(2.0));
/// # let _ = law;
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointLimits {
    rate: f64,
}

impl JointLimits {
    /// The pull to the middle at `rate` [1/s].
    pub fn new(rate: f64) -> Self {
        Self { rate }
    }
}

/// Half the width of a range of positions; infinite where it is open, or a point.
fn half_width(limits: &Limits) -> f64 {
    let half = (limits.upper - limits.lower) / 2.0;
    if half > 0.0 { half } else { f64::INFINITY }
}

impl Criterion for JointLimits {
    fn velocity(&mut self, instant: &Instant<'_>, c: &mut [f64]) {
        c.fill(0.0);
        let least = instant.limits.iter().map(half_width).fold(f64::INFINITY, f64::min);
        for ((c, q), limits) in c.iter_mut().zip(instant.q).zip(instant.limits) {
            let half = half_width(limits);
            if half.is_finite() {
                *c = -self.rate * (least / half).powi(2) * (q - limits.lower - half);
            }
        }
    }

    fn rate(&self) -> Option<f64> {
        Some(self.rate)
    }
}

pub(super) const KIND: CriterionKind = Kind::new(
    "joint-limits",
    "Keeps the joints away from their position limits: the steepest descent of 1/2 sum ((q - middle) / half range)^2.",
    &[Parameter::required(
        "rate",
        Form::Positive { noun: "rate" },
        "1/s",
        "Rate of the pull on the joint of the narrowest range; it is less on wider ones.",
    )],
    make as MakeCriterion,
)
.with_draw(|_, whole| Parameters::new().with("rate", f64::from(whole(1, 4))));

fn make(given: &Parameters, _start: &[f64]) -> Box<dyn Criterion> {
    Box::new(JointLimits::new(given.number("rate").unwrap_or(0.0)))
}
