use super::mask::{PoseRows, Row};
use super::{
    AddedTaskKind, Component, MadeTask, MakeTask, Mask, Motion, Task, TaskInstant, TaskRows, TaskStart, Tip,
};
use crate::kind::{Kind, Parameters};
use nalgebra::{IsometryMatrix3, Rotation3, Vector3, Vector6};

/// The pose of one tip in the frame of another follows a motion there, in the rows of a [`Mask`].
///
/// With the poses `T_1`, `T_2` of the tips the pose is `X = T_1^-1 T_2`, and its twist in the axes of the first tip
///
/// `v = R_1^T (v_2 - v_1 - omega_1 x (p_2 - p_1))`, `omega = R_1^T (omega_2 - omega_1)`:
///
/// the relative Jacobian of the two arms (C. Lewis, *Trajectory generation for two robots cooperating to perform a task*, 1996;
/// R. Jamisola and R. Roberts, *A more compact expression of relative Jacobian based on individual manipulator Jacobians*, 2015),
/// which here may have joints in common. Base axes are those of the first tip, tip axes those of the second.
///
/// The first tip leads where it has a task of its own: the second then keeps, or moves, in its frame.
///
/// ```
/// use kinstep::nalgebra::IsometryMatrix3;
/// use kinstep::planner::JointSystem;
/// use kinstep::task::{Mask, Motion, Relative};
///
/// let second_in_first = IsometryMatrix3::translation(0.3, 0.0, 0.0);
/// let task = Relative::new(Mask::pose(), Motion::held(&second_in_first))?;
/// let pair = JointSystem::of(["left", "right"]).with_task(task);
/// # let _ = pair;
/// # Ok::<(), String>(())
/// ```
#[derive(Debug)]
pub struct Relative {
    rows: PoseRows,
}

impl Relative {
    /// The second tip follows `motion` in the frame of the first.
    ///
    /// # Errors
    /// The end of a sentence that begins with the path, where path axes are asked for and not defined all along it.
    pub fn new(mask: Mask, motion: Motion) -> Result<Self, String> {
        Ok(Self { rows: PoseRows::new(mask, motion, Rotation3::identity())? })
    }
}

impl Task for Relative {
    fn name(&self) -> &str {
        KIND.name
    }

    fn rows(&self) -> usize {
        self.rows.mask.rows()
    }

    fn least_tips(&self) -> usize {
        2
    }

    fn evaluate(&self, at: &TaskInstant<'_>, out: &mut TaskRows) {
        let pair = Pair::of(at.tip(0), at.tip(1));
        self.rows.write(at.t, &pair.relative(), |place, row| pair.add(out, place, &row));
    }

    fn component(&self, row: usize) -> Component {
        self.rows.mask.component(row)
    }
}

/// Two tips, the second seen from the first.
pub(super) struct Pair<'a> {
    first: &'a Tip,
    second: &'a Tip,
}

impl<'a> Pair<'a> {
    pub(super) fn of(first: &'a Tip, second: &'a Tip) -> Self {
        Self { first, second }
    }

    /// The pose of the second in the frame of the first.
    pub(super) fn relative(&self) -> IsometryMatrix3<f64> {
        relative_pose(&self.first.pose, &self.second.pose)
    }

    /// Puts a row about that pose down as one about both tips.
    pub(super) fn add(&self, out: &mut TaskRows, place: usize, row: &Row) {
        let axes = self.first.pose.rotation;
        let [linear, angular] = [0, 3].map(|first| axes * row.direction.fixed_rows::<3>(first).into_owned());
        let apart = self.second.pose.translation.vector - self.first.pose.translation.vector;
        out.error[place] = row.error;
        out.feedforward[place] = row.feedforward;
        out.add_to_row(place, self.second, &joined(&linear, &angular));
        out.add_to_row(place, self.first, &joined(&-linear, &(-angular - apart.cross(&linear))));
    }
}

/// The pose of `second` in the frame of `first`.
pub(super) fn relative_pose(
    first: &IsometryMatrix3<f64>,
    second: &IsometryMatrix3<f64>,
) -> IsometryMatrix3<f64> {
    let inverse = first.rotation.inverse();
    let apart = second.translation.vector - first.translation.vector;
    IsometryMatrix3::from_parts((inverse * apart).into(), inverse * second.rotation)
}

pub(super) fn joined(linear: &Vector3<f64>, angular: &Vector3<f64>) -> Vector6<f64> {
    Vector6::new(linear.x, linear.y, linear.z, angular.x, angular.y, angular.z)
}

pub(super) const KIND: AddedTaskKind = Kind::new(
    "relative",
    "The second tip keeps its pose in the frame of the first, or follows a path there.",
    &[],
    MakeTask::of(2, from_start).with_paths(&["path"]).with_rows(),
)
.with_draw(|_, _| Parameters::new());

fn from_start(_: &Parameters, start: &TaskStart<'_>) -> MadeTask {
    let [first, second] = start.tips else { return Err("a relative pose is that of two tips".to_owned()) };
    let motion = start.motion_or_held("path", &relative_pose(first, second));
    let mask = start.mask.cloned().unwrap_or_else(Mask::pose);
    Relative::new(mask, motion)
        .map(|task| Box::new(task) as _)
        .map_err(|problem| format!("its path {problem}"))
}
