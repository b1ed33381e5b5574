use super::mask::PoseRows;
use super::relative::{Pair, relative_pose};
use super::{
    AddedTaskKind, Component, MadeTask, MakeTask, Mask, Motion, Reference, Task, TaskInstant, TaskRows,
    TaskStart,
};
use crate::kind::{Kind, Parameters};
use nalgebra::{IsometryMatrix3, Rotation3, Vector3};

/// Any number of hands carry one object along a motion: each keeps its grasp `G_i`, its pose in the frame of the object.
///
/// With the object at `O(t)` hand `i` follows `O(t) G_i`, which moves with `v = v_o + omega_o x (R_o g_i)` and turns with `omega_o`:
/// six rows per hand, or those of a mask.
///
/// ```
/// use kinstep::nalgebra::IsometryMatrix3;
/// use kinstep::task::{Carried, Mask, Motion, Task};
///
/// let object = IsometryMatrix3::translation(0.5, 0.0, 0.8);
/// let grasps = [0.2, -0.2].map(|y| IsometryMatrix3::translation(0.0, y, 0.0));
/// let task = Carried::new(Mask::pose(), Motion::held(&object), &grasps)?;
/// assert_eq!((task.rows(), task.least_tips()), (12, 2));
/// # Ok::<(), String>(())
/// ```
#[derive(Debug)]
pub struct Carried {
    object: PoseRows,
    grasps: Vec<IsometryMatrix3<f64>>,
}

impl Carried {
    /// An object that follows `motion` in the world, and the poses of the hands in its frame.
    ///
    /// # Errors
    /// The end of a sentence that begins with the path, where path axes are asked for and not defined all along it.
    pub fn new(mask: Mask, motion: Motion, grasps: &[IsometryMatrix3<f64>]) -> Result<Self, String> {
        Ok(Self { object: PoseRows::new(mask, motion, Rotation3::identity())?, grasps: grasps.to_vec() })
    }
}

impl Task for Carried {
    fn name(&self) -> &str {
        KIND.name
    }

    fn rows(&self) -> usize {
        self.grasps.len() * self.object.mask.rows()
    }

    fn least_tips(&self) -> usize {
        self.grasps.len()
    }

    fn evaluate(&self, at: &TaskInstant<'_>, out: &mut TaskRows) {
        let (object, axes) = self.object.at(at.t);
        let mask = &self.object.mask;
        for (hand, grasp) in self.grasps.iter().enumerate() {
            let tip = at.tip(hand);
            mask.write(&tip.pose, &of_grasp(&object, grasp), &axes, |place, row| {
                let place = hand * mask.rows() + place;
                out.error[place] = row.error;
                out.feedforward[place] = row.feedforward;
                out.add_to_row(place, tip, &row.direction);
            });
        }
    }

    fn component(&self, row: usize) -> Component {
        let mask = &self.object.mask;
        mask.component(row % mask.rows())
    }
}

/// Where a hand shall be that has that grasp of an object.
fn of_grasp(object: &Reference, grasp: &IsometryMatrix3<f64>) -> Reference {
    let arm = object.rotation * grasp.translation.vector;
    let angular = object.twist.fixed_rows::<3>(3).into_owned();
    let mut twist = object.twist;
    let mut linear = twist.fixed_rows_mut::<3>(0);
    linear += angular.cross(&arm);
    Reference { position: object.position + arm, rotation: object.rotation * grasp.rotation, twist }
}

/// Any number of hands hold one object together, wherever it moves: every hand but the first keeps its pose in the frame of the
/// first.
///
/// Six rows for each of the others, or those of a mask: whatever moves the object is the task of one hand.
#[derive(Debug)]
pub struct Held {
    others: Vec<PoseRows>,
}

impl Held {
    /// The poses of all hands but the first in the frame of the first.
    ///
    /// # Errors
    /// A mask that a pose at rest can not have, such as one in axes of the path, as the end of a sentence.
    pub fn new(mask: &Mask, others: &[IsometryMatrix3<f64>]) -> Result<Self, String> {
        let rows = |pose| PoseRows::new(mask.clone(), Motion::held(pose), Rotation3::identity());
        Ok(Self { others: others.iter().map(rows).collect::<Result<_, _>>()? })
    }
}

impl Task for Held {
    fn name(&self) -> &str {
        KIND.name
    }

    fn rows(&self) -> usize {
        self.others.iter().map(|rows| rows.mask.rows()).sum()
    }

    fn least_tips(&self) -> usize {
        self.others.len() + 1
    }

    fn evaluate(&self, at: &TaskInstant<'_>, out: &mut TaskRows) {
        let mut first = 0;
        for (other, rows) in self.others.iter().enumerate() {
            let pair = Pair::of(at.tip(0), at.tip(other + 1));
            rows.write(at.t, &pair.relative(), |place, row| pair.add(out, first + place, &row));
            first += rows.mask.rows();
        }
    }

    fn component(&self, row: usize) -> Component {
        let mask = &self.others[0].mask;
        mask.component(row % mask.rows())
    }
}

pub(super) const KIND: AddedTaskKind = Kind::new(
    "object",
    "Hands carry one object along a path, or hold it together wherever the task of one of them moves it.",
    &[],
    MakeTask::of(2, from_start).or_more().with_paths(&["path"]).with_rows().with_pose(),
)
.with_draw(|_, _| Parameters::new());

fn from_start(_: &Parameters, start: &TaskStart<'_>) -> MadeTask {
    let Some((first, others)) = start.tips.split_first() else { return Err("no hand holds it".to_owned()) };
    let mask = start.mask.cloned().unwrap_or_else(Mask::pose);
    let wrong_path = |problem| format!("its path {problem}");
    let object = start.pose.unwrap_or_else(|| between(start.tips));
    if let Some(motion) = start.motion("path", &object) {
        let grasps: Vec<_> = start.tips.iter().map(|tip| relative_pose(&object, tip)).collect();
        return Carried::new(mask, motion, &grasps).map(|task| Box::new(task) as _).map_err(wrong_path);
    }
    let others: Vec<_> = others.iter().map(|other| relative_pose(first, other)).collect();
    Held::new(&mask, &others).map(|task| Box::new(task) as _).map_err(wrong_path)
}

/// The mean of the positions of the hands, with the axes of the world.
fn between(tips: &[IsometryMatrix3<f64>]) -> IsometryMatrix3<f64> {
    let sum: Vector3<f64> = tips.iter().map(|tip| tip.translation.vector).sum();
    IsometryMatrix3::from_parts((sum / tips.len() as f64).into(), Rotation3::identity())
}
