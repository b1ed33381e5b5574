use super::{CriterionKind, MakeCriterion, Posture};
use crate::kind::{Form, Kind, Parameter, Parameters};

pub(super) const KIND: CriterionKind = Kind::new(
    "repetitive",
    "Pulls the joints towards where they started, so that they come back on closed paths: c = -rate (q - q(0)).",
    &[Parameter::required("rate", Form::Positive { noun: "rate" }, "1/s", "Rate lambda of the pull.")],
    make as MakeCriterion,
)
.with_draw(|_, whole| Parameters::new().with("rate", f64::from(whole(1, 4))));

/// Repetitive motion (Zhang, Wang and Xia 2003) is a [`Posture`] at the start.
fn make(given: &Parameters, start: &[f64]) -> Box<dyn super::Criterion> {
    Box::new(Posture::new(given.number("rate").unwrap_or(0.0), start.to_vec()))
}
