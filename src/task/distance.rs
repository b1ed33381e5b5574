use super::{AddedTaskKind, MadeTask, MakeTask, Quintic, Task, TaskInstant, TaskRows, TaskStart, TimeLaw};
use crate::kind::{Form, Kind, Parameter, Parameters};
use nalgebra::Vector6;

/// Two tips keep a distance, or follow one: the row `|p_2 - p_1| - d(t)`.
///
/// ```
/// use kinstep::planner::JointSystem;
/// use kinstep::task::Distance;
///
/// let pair = JointSystem::of(["left", "right"]).with_task(Distance::kept(0.4));
/// # let _ = pair;
/// ```
///
/// Where the tips meet, their distance has no direction, and the row is lost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Distance {
    from: f64,
    to: f64,
    duration: f64,
}

impl Distance {
    /// The distance `d` \[m\] at all times.
    pub fn kept(d: f64) -> Self {
        Self { from: d, to: d, duration: 1.0 }
    }

    /// The distance that goes from `from` to `to` \[m\] in `duration` \[s\], by the time law [`Quintic`].
    pub fn followed(from: f64, to: f64, duration: f64) -> Self {
        Self { from, to, duration }
    }

    /// The distance \[m\] at time `t` \[s\] and its derivative [m/s].
    pub fn at(&self, t: f64) -> (f64, f64) {
        let tau = (t / self.duration).clamp(0.0, 1.0);
        let (u, rate) = Quintic.progress(tau);
        let way = self.to - self.from;
        (self.from + way * u, way * rate / self.duration)
    }
}

impl Task for Distance {
    fn name(&self) -> &str {
        KIND.name
    }

    fn rows(&self) -> usize {
        1
    }

    fn least_tips(&self) -> usize {
        2
    }

    fn evaluate(&self, at: &TaskInstant<'_>, out: &mut TaskRows) {
        let (one, other) = (at.tip(0), at.tip(1));
        let apart = other.pose.translation.vector - one.pose.translation.vector;
        let along = apart.try_normalize(0.0).unwrap_or_default();
        let direction = Vector6::new(along.x, along.y, along.z, 0.0, 0.0, 0.0);
        let (distance, rate) = self.at(at.t);
        out.error[0] = apart.norm() - distance;
        out.feedforward[0] = rate;
        out.add_to_row(0, other, &direction);
        out.add_to_row(0, one, &-direction);
    }
}

pub(super) const KIND: AddedTaskKind = Kind::new(
    "distance",
    "Two tips keep a distance, or follow one.",
    &[
        Parameter::optional(
            "distance",
            Form::Positive { noun: "distance" },
            "m",
            "Distance of the tips at the start. Default: the one that they have there.",
        ),
        Parameter::optional(
            "to",
            Form::Positive { noun: "distance" },
            "m",
            "Distance at the end, which is reached smoothly. Default: the one at the start.",
        ),
    ],
    MakeTask::of(2, from_start),
)
.with_draw(|size, _| Parameters::new().with("to", size));

fn from_start(given: &Parameters, start: &TaskStart<'_>) -> MadeTask {
    let [one, other] = start.tips else { return Err("a distance is between two tips".to_owned()) };
    let apart = (other.translation.vector - one.translation.vector).norm();
    if apart == 0.0 {
        return Err("the tips start at one point, where their distance has no direction".to_owned());
    }
    let from = given.number("distance").unwrap_or(apart);
    Ok(Box::new(Distance::followed(from, given.number("to").unwrap_or(from), start.duration)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{IsometryMatrix3, Vector3};

    fn poses(x: f64) -> [IsometryMatrix3<f64>; 2] {
        [0.0, x].map(|x| IsometryMatrix3::new(Vector3::new(x, 0.0, 0.0), Vector3::zeros()))
    }

    #[test]
    fn it_goes_from_one_distance_to_another_and_rests_there() {
        let distance = Distance::followed(0.4, 0.6, 2.0);
        assert_eq!((distance.at(0.0), distance.at(3.0)), ((0.4, 0.0), (0.6, 0.0)));
        let (step, (_, rate)) = (1e-6, distance.at(0.7));
        let difference = (distance.at(0.7 + step).0 - distance.at(0.7 - step).0) / (2.0 * step);
        assert!((difference - rate).abs() < 1e-9);
        assert_eq!(Distance::kept(0.3).at(0.5), (0.3, 0.0));
    }

    #[test]
    fn tips_that_start_at_one_point_have_no_distance() {
        let tips = poses(0.0);
        let start = TaskStart::new(&tips, 1.0);
        let refusal = from_start(&Parameters::new(), &start).err().unwrap();
        assert!(refusal.contains("start at one point"), "{refusal}");
    }
}
