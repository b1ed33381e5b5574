//! Capsules fitted to the `<collision>` shapes of a URDF.

use std::path::Path;

use super::model::{LinkCapsule, Missing};
use super::{CollisionModel, Fit};
use crate::collision::fit::{Fitted, fitted};
use crate::robot::{Robot, Shape, Visual, Visuals};

impl CollisionModel {
    /// Returns capsules around the `<collision>` shapes of the URDF text that the robot was read from: each contains the shape that
    /// it stands for. Meshes are looked for from `folder`, that of the URDF. What was fitted, and how well, is in
    /// [`fits`](CollisionModel::fits); shapes that can not be read, and meshes that are not there, in
    /// [`missing`](CollisionModel::missing).
    ///
    /// ```
    /// use kinstep::collision::CollisionModel;
    /// use kinstep::robot::Robot;
    /// let urdf = r#"<robot name="post"> <link name="post"> <collision>
    ///     <origin xyz="0 0 0.5"/> <geometry> <cylinder radius="0.1" length="1"/> </geometry>
    ///   </collision> </link> </robot>"#;
    /// let model = CollisionModel::from_urdf(&Robot::from_urdf(urdf)?, urdf, None);
    /// let fit = &model.fits()[0];
    /// assert_eq!((fit.link.as_str(), fit.shape), ("post", "cylinder"));
    /// assert!(fit.volume_ratio.is_some_and(|ratio| ratio < 1.15));
    /// # Ok::<(), kinstep::robot::UrdfError>(())
    /// ```
    pub fn from_urdf(robot: &Robot, text: &str, folder: Option<&Path>) -> CollisionModel {
        let mut model = CollisionModel::new(robot);
        let shapes = Visuals::collision_from_urdf(text);
        let note = |reason: String| Missing { link: String::new(), reason };
        model.missing.extend(shapes.notes.into_iter().map(note));
        for visual in shapes.visuals.iter().filter(|visual| robot.link(&visual.link).is_some()) {
            model.fit(visual, folder);
        }
        model
    }

    fn fit(&mut self, visual: &Visual, folder: Option<&Path>) {
        let link = visual.link.clone();
        match fitted(&visual.shape, &visual.origin, folder) {
            Ok(Fitted { capsule, volume_ratio }) => {
                let shape = word(&visual.shape);
                let length = (capsule.to() - capsule.from()).norm();
                let radius = capsule.radius();
                self.capsules.push(LinkCapsule { link: link.clone(), capsule });
                self.fits.push(Fit { link, shape, radius, length, volume_ratio });
            }
            Err(reason) => self.missing.push(Missing { link, reason }),
        }
    }
}

fn word(shape: &Shape) -> &'static str {
    match shape {
        Shape::Box { .. } => "box",
        Shape::Cylinder { .. } => "cylinder",
        Shape::Capsule { .. } => "capsule",
        Shape::Sphere { .. } => "sphere",
        Shape::Mesh { .. } => "mesh",
    }
}
