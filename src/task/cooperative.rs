use super::mask::PoseRows;
use super::relative::{Pair, joined, relative_pose};
use super::{AddedTaskKind, MadeTask, MakeTask, Mask, Motion, Task, TaskInstant, TaskRows, TaskStart, Tip};
use crate::kind::{Kind, Parameters};
use crate::math::rotation_vector;
use nalgebra::{IsometryMatrix3, Matrix3, Rotation3, Vector3};

/// The cooperative task space of two tips: twelve rows, six of their absolute pose and six of their [relative](super::Relative) one.
///
/// The absolute pose lies between them: `p_a = (p_1 + p_2) / 2`, `R_a = R_1 exp(phi / 2)` with `phi = log(R_1^T R_2)^vee`
/// (P. Chiacchio, S. Chiaverini, B. Siciliano, *Direct and inverse kinematics for coordinated motion tasks of a two-manipulator
/// system*, 1996). Its angular velocity is `omega_1 + K (omega_2 - omega_1)` with `K = R_1 (I + exp(phi / 2))^-1 R_1^T`: the mean of
/// both where the tips keep their relative orientation, which is what the paper takes everywhere.
#[derive(Debug)]
pub struct Cooperative {
    absolute: PoseRows,
    relative: PoseRows,
}

impl Cooperative {
    /// The absolute pose follows `absolute` in the world, the second tip follows `relative` in the frame of the first.
    pub fn new(absolute: Motion, relative: Motion) -> Self {
        // Base axes are defined on any path.
        let whole = |motion| PoseRows::in_base_axes(Mask::pose(), motion);
        Self { absolute: whole(absolute), relative: whole(relative) }
    }
}

impl Task for Cooperative {
    fn name(&self) -> &str {
        KIND.name
    }

    fn rows(&self) -> usize {
        12
    }

    fn least_tips(&self) -> usize {
        2
    }

    fn evaluate(&self, at: &TaskInstant<'_>, out: &mut TaskRows) {
        let (first, second) = (at.tip(0), at.tip(1));
        let middle = Middle::of(&first.pose, &second.pose);
        self.absolute.write(at.t, &middle.pose, |place, row| {
            out.error[place] = row.error;
            out.feedforward[place] = row.feedforward;
            let [linear, angular] = [0, 3].map(|first| row.direction.fixed_rows::<3>(first).into_owned());
            let of_second = middle.share.tr_mul(&angular);
            let mut add = |tip: &Tip, angular: Vector3<f64>| {
                out.add_to_row(place, tip, &joined(&(linear * 0.5), &angular));
            };
            add(first, angular - of_second);
            add(second, of_second);
        });
        let pair = Pair::of(first, second);
        self.relative.write(at.t, &pair.relative(), |place, row| pair.add(out, 6 + place, &row));
    }
}

/// What lies between two tips.
struct Middle {
    pose: IsometryMatrix3<f64>,
    /// The share `K` that the second has in the angular velocity.
    share: Matrix3<f64>,
}

impl Middle {
    fn of(first: &IsometryMatrix3<f64>, second: &IsometryMatrix3<f64>) -> Self {
        let half = rotation_vector(&(first.rotation.inverse() * second.rotation)) * 0.5;
        let position = (first.translation.vector + second.translation.vector) * 0.5;
        let pose = IsometryMatrix3::from_parts(position.into(), first.rotation * Rotation3::new(half));
        // (I + exp [x])^-1 = (I - tan(|x|/2) [x]/|x|) / 2; half of the turn is at most a quarter turn.
        let angle = half.norm();
        let tangent = if angle > 0.0 { (0.5 * angle).tan() / angle } else { 0.5 };
        let axes = first.rotation.matrix();
        let share = (Matrix3::identity() - axes * half.cross_matrix() * axes.transpose() * tangent) * 0.5;
        Self { pose, share }
    }
}

pub(super) const KIND: AddedTaskKind = Kind::new(
    "cooperative",
    "The pose between two tips follows a path, and the second keeps its pose in the frame of the first, or follows a path there.",
    &[],
    MakeTask::of(2, from_start).with_paths(&["path", "relative"]),
)
.with_draw(|_, _| Parameters::new());

fn from_start(_: &Parameters, start: &TaskStart<'_>) -> MadeTask {
    let [first, second] = start.tips else { return Err("two tips cooperate".to_owned()) };
    let absolute = start.motion_or_held("path", &Middle::of(first, second).pose);
    let relative = start.motion_or_held("relative", &relative_pose(first, second));
    Ok(Box::new(Cooperative::new(absolute, relative)))
}
