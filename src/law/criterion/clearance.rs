use super::super::{Avoidance, Instant};
use super::{Criterion, CriterionKind, MakeCriterion};
use crate::collision::Proximity;
use crate::kind::{Form, Kind, Parameter, Parameters};

/// Moves the arms away from what is near: the steepest descent of the potential `U = 1/2 sum (influence - d)^2` over all pairs of
/// bodies nearer than `influence`, `c = rate sum (influence - d) dd/dq` (after Khatib 1986, without the pole at contact).
///
/// Lengths are measured in metres, so that a joint with a lever of a metre goes at `rate`. It keeps no distance for certain: what
/// the tasks leave free is moved away, and no more; the law `qp` keeps the margin. Without anything around the arms it is zero.
///
/// ```
/// use kinstep::law::{Clearance, QuadraticProgram};
///
/// let law = QuadraticProgram::new().with_criterion(Clearance::new(2.0));
/// # let _ = law;
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clearance {
    rate: f64,
}

impl Clearance {
    /// The descent at `rate` [1/s] for a lever of a metre.
    pub fn new(rate: f64) -> Self {
        Self { rate }
    }
}

/// The nearest points of every pair, without the ends behind them.
fn nearest<'a>(avoidance: &Avoidance<'a>) -> impl Iterator<Item = (&'a Proximity, &'a [f64])> {
    let mut last = None;
    avoidance
        .contacts
        .iter()
        .filter(move |(proximity, _)| last.replace(proximity.pair) != Some(proximity.pair))
}

impl Criterion for Clearance {
    fn velocity(&mut self, instant: &Instant<'_>, c: &mut [f64]) {
        c.fill(0.0);
        let Some(avoidance) = instant.avoidance else { return };
        for (proximity, row) in nearest(&avoidance) {
            let push = self.rate * (avoidance.influence - proximity.separation.distance);
            for (c, slope) in c.iter_mut().zip(row) {
                *c += push * slope;
            }
        }
    }

    fn rate(&self) -> Option<f64> {
        None
    }

    /// `rate sum |dd/dq|^2`, a bound of the eigenvalues but for the curvature of the distances.
    fn rate_at(&self, instant: &Instant<'_>) -> f64 {
        let Some(avoidance) = instant.avoidance else { return 0.0 };
        let squares = |(_, row): (_, &[f64])| row.iter().map(|slope| slope * slope).sum::<f64>();
        self.rate * nearest(&avoidance).map(squares).sum::<f64>()
    }

    fn keeps_distances(&self) -> bool {
        true
    }
}

pub(super) const KIND: CriterionKind = Kind::new(
    "clearance",
    "Moves the arms away from obstacles and from each other: the steepest descent of 1/2 sum (influence - distance)^2.",
    &[Parameter::required(
        "rate",
        Form::Positive { noun: "rate" },
        "1/s",
        "Rate of the push on a joint with a lever of a metre.",
    )],
    make as MakeCriterion,
)
.with_draw(|_, whole| Parameters::new().with("rate", f64::from(whole(1, 4))));

fn make(given: &Parameters, _start: &[f64]) -> Box<dyn Criterion> {
    Box::new(Clearance::new(given.number("rate").unwrap_or(0.0)))
}
