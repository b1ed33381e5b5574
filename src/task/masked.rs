use super::mask::PoseRows;
use super::{Component, Mask, Motion, Task, TaskInstant, TaskRows};
use nalgebra::Rotation3;

/// The own task of an arm whose tip tracks a motion in the rows of a [`Mask`].
///
/// ```
/// use kinstep::planner::Arm;
/// use kinstep::robot::embedded;
/// use kinstep::task::{Axes, Circle, Component, Mask, Masked, Motion, Planar, Quintic};
///
/// let chain = embedded::get("panda")?.chain("panda_link0", "panda_hand_tcp")?;
/// let q0 = vec![0.0, -0.4, 0.0, -2.1, 0.0, 1.8, 0.6];
/// let start = chain.forward(&q0, &mut chain.scratch()).pose();
/// let motion = Motion::from_pose(Planar::whole(Circle { radius: 0.05 }), Quintic, 2.0, &start);
/// // The tool's position, and the direction of its z axis: how it turns about that is left open.
/// let linear = Component::ALL.into_iter().take(3);
/// let task = Masked::new(Mask::of(linear, Axes::Base).with_pointing(2), motion)?;
/// let arm = Arm::with_own_task("arm", chain, q0, Box::new(task));
/// # let _ = arm;
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Masked {
    name: String,
    rows: PoseRows,
}

impl Masked {
    /// The rows of the mask, of a tip that follows a motion in the world, with base axes along the world's.
    ///
    /// # Errors
    /// The end of a sentence that begins with the path, where path axes are asked for and not defined all along it.
    pub fn new(mask: Mask, motion: Motion) -> Result<Self, String> {
        Self::based(mask, motion, Rotation3::identity())
    }

    /// The same with base axes that are turned like that in the world.
    ///
    /// # Errors
    /// As [`Masked::new`].
    pub fn based(mask: Mask, motion: Motion, base: Rotation3<f64>) -> Result<Self, String> {
        Ok(Self { name: mask.name(), rows: PoseRows::new(mask, motion, base)? })
    }
}

impl Task for Masked {
    fn name(&self) -> &str {
        &self.name
    }

    fn rows(&self) -> usize {
        self.rows.mask.rows()
    }

    fn evaluate(&self, at: &TaskInstant<'_>, out: &mut TaskRows) {
        let tip = at.tip(0);
        self.rows.write(at.t, &tip.pose, |place, row| {
            out.error[place] = row.error;
            out.feedforward[place] = row.feedforward;
            out.add_to_row(place, tip, &row.direction);
        });
    }

    fn component(&self, row: usize) -> Component {
        self.rows.mask.component(row)
    }
}
