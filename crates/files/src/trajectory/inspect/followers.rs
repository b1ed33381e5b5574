//! Joints that follow others, along a trajectory that may or may not hold them.

use super::interpolant::{Interpolation, Knots};
use super::met::Met;
use crate::trajectory::ArmTrajectory;
use kinstep::robot::{Joint, JointKind, Robot};

/// How far from where it follows to a recorded angle may stand \[rad\], and how far a recorded length \[m\].
const APART: [f64; 2] = [1e-2, 1e-3];

/// A joint that does not stand where the one that it follows takes it.
#[derive(Clone, Debug, PartialEq)]
pub struct Straying {
    /// The joint that follows.
    pub joint: String,
    /// The joint that it follows.
    pub driver: String,
    /// Its ratio to the driver's position.
    pub multiplier: f64,
    /// Its position [rad or m] where the driver stands at zero.
    pub offset: f64,
    /// The largest distance [rad or m] from `multiplier * driver + offset`, and when.
    pub apart: Met,
}

impl ArmTrajectory {
    /// Returns the same with the joints of the robot that follow one of its joints and are not in it, moved by
    /// `q = multiplier * driver + offset`, and those that are in it but stand elsewhere, at
    /// samples or between them: further than 0.01 rad or 1 mm.
    pub fn with_followers(
        &self,
        robot: &Robot,
        times: &[f64],
        interpolation: Interpolation,
    ) -> (Self, Vec<Straying>) {
        let place = |name: &str| self.joints.iter().position(|joint| joint == name);
        let (mut all, mut straying) = (self.clone(), Vec::new());
        for (follower, driver, multiplier, offset) in followers(robot) {
            let Some(driven_by) = place(&driver.name) else { continue };
            let Some(own) = place(&follower.name) else {
                all.append(&follower.name, driven_by, multiplier, offset);
                continue;
            };
            let between =
                Knots::of(self, own, times).less(&Knots::of(self, driven_by, times), multiplier, offset);
            let mut apart = Met { value: 0.0, t: times[0] };
            for n in 0..between.steps() {
                let [apart_over_step, ..] = between.segments(interpolation, n);
                apart.take(&apart_over_step, apart_over_step.bounds());
            }
            let allowed = APART[usize::from(follower.kind == JointKind::Prismatic)];
            if apart.value.abs() > allowed {
                let [joint, driver] = [follower, driver].map(|joint| joint.name.clone());
                straying.push(Straying { joint, driver, multiplier, offset, apart });
            }
        }
        (all, straying)
    }

    /// Appends a joint that stands at `multiplier * driver + offset`, with the driver's place.
    fn append(&mut self, joint: &str, driver: usize, multiplier: f64, offset: f64) {
        let joints = self.joints.len();
        let append = |values: &mut Vec<f64>, offset: f64| {
            let rows = values.chunks_exact(joints);
            *values =
                rows.flat_map(|row| row.iter().copied().chain([multiplier * row[driver] + offset])).collect();
        };
        append(&mut self.positions, offset);
        append(&mut self.velocities, 0.0);
        append(&mut self.accelerations, 0.0);
        self.joints.push(joint.to_owned());
    }
}

/// The joints of a robot that follow, each with its driver, its ratio and its offset.
fn followers(robot: &Robot) -> impl Iterator<Item = (&Joint, &Joint, f64, f64)> {
    let follows = |joint: &'_ &Joint| joint.kind.is_movable() && joint.mimic.is_some();
    robot.joints().iter().filter(follows).filter_map(|joint| {
        let mimic = joint.mimic?;
        Some((joint, &robot.joints()[mimic.driver], mimic.multiplier, mimic.offset))
    })
}
