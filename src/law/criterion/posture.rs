use super::super::{Instant, SystemShape};
use super::{Criterion, CriterionKind, MakeCriterion};
use crate::kind::{Form, Kind, Parameter, Parameters};

/// Pulls the joints towards a posture: `c = -rate (q - q_ref)`.
///
/// Where the task leaves the joints free, they come to rest where the pull has no component that is free, the nearest to
/// the posture that the task allows.
///
/// ```
/// use kinstep::law::{Posture, Pseudoinverse};
///
/// let law = Pseudoinverse::new().with_criterion(Posture::new(2.0, vec![0.0, 0.5, 0.5, 0.0]));
/// # let _ = law;
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct Posture {
    rate: f64,
    reference: Vec<f64>,
}

impl Posture {
    /// The pull at `rate` [1/s] towards the joint positions `reference` [rad or m], one per joint of the system.
    pub fn new(rate: f64, reference: Vec<f64>) -> Self {
        Self { rate, reference }
    }
}

impl Criterion for Posture {
    fn objection(&self, shape: &SystemShape) -> Option<String> {
        let (given, joints) = (self.reference.len(), shape.joints.len());
        (given != joints).then(|| format!("has a posture of {given} positions for {joints} joints"))
    }

    fn velocity(&mut self, instant: &Instant<'_>, c: &mut [f64]) {
        for ((c, q), reference) in c.iter_mut().zip(instant.q).zip(&self.reference) {
            *c = -self.rate * (q - reference);
        }
    }

    fn rate(&self) -> Option<f64> {
        Some(self.rate)
    }
}

pub(super) const KIND: CriterionKind = Kind::new(
    "posture",
    "Pulls the joints towards a posture: c = -rate (q - q_ref).",
    &[
        Parameter::required("rate", Form::Positive { noun: "rate" }, "1/s", "Rate of the pull."),
        Parameter::optional(
            "q",
            Form::Numbers,
            "rad or m",
            "Positions q_ref, one per joint that is resolved together. Default: where the joints start.",
        ),
    ],
    make as MakeCriterion,
)
.with_draw(|_, whole| Parameters::new().with("rate", f64::from(whole(1, 4))));

fn make(given: &Parameters, start: &[f64]) -> Box<dyn Criterion> {
    let reference = given.numbers("q").unwrap_or_else(|| start.to_vec());
    Box::new(Posture::new(given.number("rate").unwrap_or(0.0), reference))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_has_a_position_for_every_joint() {
        let shape = SystemShape::of_one_task(2, 4, 1.0);
        let objection = Posture::new(1.0, vec![0.0; 3]).objection(&shape).unwrap();
        assert_eq!(objection, "has a posture of 3 positions for 4 joints");
        assert_eq!(Posture::new(1.0, vec![0.0; 4]).objection(&shape), None);
    }

    #[test]
    fn it_is_where_the_joints_start_unless_given() {
        let given = Parameters::new().with("rate", 2.0);
        let objection = |given: &Parameters, joints: usize| {
            (KIND.make)(given, &[0.1, 0.2, 0.3]).objection(&SystemShape::of_one_task(2, joints, 1.0))
        };
        assert_eq!(objection(&given, 3), None);
        assert_eq!(objection(&given.with("q", vec![0.0; 2]), 2), None);
    }
}
