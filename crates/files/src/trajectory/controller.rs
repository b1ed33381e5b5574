//! What controllers ask of a trajectory, and an end at rest where there is none.

use super::clock::Stamp;
use super::group::{Group, ros_name};
use super::{ArmTrajectory, Recording, Stage, Trajectory};

/// The fastest velocity [rad/s or m/s] that `ros2_control`'s joint trajectory controller takes for rest.
const REST: f64 = 1e-6;
/// The longest deceleration to rest that is made up \[s\].
const LONGEST_STOP: f64 = 1.0;

/// Why a trajectory is not written in a format.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct Refusal(pub(super) String);

/// Refuses what no message can hold: values that are not finite, times of more than 31 bits of seconds, times that are
/// equal once they are rounded to nanoseconds, names that are the same in the Robot Operating System.
pub(super) fn check_messages(recording: Recording<'_>) -> Result<(), Refusal> {
    check_finite(recording.trajectory)?;
    check_times(recording.trajectory)?;
    let mut names: Vec<String> = Group::all(recording).iter().map(|group| ros_name(group.name)).collect();
    names.sort();
    match names.windows(2).find(|pair| pair[0] == pair[1]) {
        None => Ok(()),
        Some(pair) => Err(Refusal(format!("two machines are called `{}` in ROS; rename an arm", pair[0]))),
    }
}

/// As [`check_messages`], and refuses what the joint trajectory controller refuses: an end that is not at rest.
pub(super) fn check_command(recording: Recording<'_>) -> Result<(), Refusal> {
    check_messages(recording)?;
    match fastest_end(recording.trajectory) {
        Some((name, velocity)) if velocity.abs() > REST => {
            let remedy = match recording.trajectory.samples() {
                1 => "there is no second sample, and so no motion that could be brought to rest",
                _ => "--append-stop adds a deceleration, or choose a time law that ends at rest",
            };
            Err(Refusal(format!(
                "joint `{name}` ends with a velocity of {velocity:.3e}, and controllers refuse an end that is not at rest (above \
                 {REST:e}); {remedy}"
            )))
        }
        _ => Ok(()),
    }
}

fn check_finite(trajectory: &Trajectory) -> Result<(), Refusal> {
    for sample in 0..trajectory.samples() {
        let names = || trajectory.columns();
        if let Some(column) = trajectory.values(sample).position(|value| !value.is_finite()) {
            let name = names().swap_remove(column + 1);
            return Err(Refusal(format!("`{name}` is not a finite number in sample {sample}")));
        }
    }
    Ok(())
}

fn check_times(trajectory: &Trajectory) -> Result<(), Refusal> {
    let mut before: Option<Stamp> = None;
    for &time in &trajectory.times {
        let since = time - trajectory.times[0];
        let Some(stamp) = Stamp::of(since) else {
            return Err(Refusal(format!("{since} s after the start: messages hold times below 2^31 s")));
        };
        if before.is_some_and(|before| stamp <= before) {
            return Err(Refusal(format!(
                "times have to increase, in whole nanoseconds: the sample at {time} s does not come after the one before it"
            )));
        }
        before = Some(stamp);
    }
    Ok(())
}

/// The joint that is fastest in the last sample, as `ARM.JOINT`, and its velocity.
fn fastest_end(trajectory: &Trajectory) -> Option<(String, f64)> {
    let last = trajectory.samples().checked_sub(1)?;
    let of_arm = |arm: &ArmTrajectory| {
        let velocities = arm.velocity(last).unwrap_or_default().to_vec();
        let name = |joint: &String| format!("{}.{joint}", arm.name);
        arm.joints.iter().map(name).zip(velocities).collect::<Vec<_>>()
    };
    trajectory.arms.iter().flat_map(of_arm).max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))
}

impl Trajectory {
    /// Returns the trajectory with one more sample, at rest: every joint decelerates evenly to it, by
    /// `v T / 2` in the time `T` that all joints share. A controller's cubic between the two samples is that motion.
    ///
    /// `T` is as long as the joints need when none decelerates harder than the fastest it accelerated before, a sampling gap at
    /// least and a second at most. Task errors are left out, since the stop follows no path,
    /// and accelerations, with which the controller's spline would be another. An end at rest stays as it is,
    /// and so does a trajectory without velocities.
    ///
    /// # Errors
    /// [`Refusal`] where the stop would leave a joint's limits.
    pub fn with_stop(&self, stage: &Stage) -> Result<Self, Refusal> {
        let last = self.samples().saturating_sub(1);
        if last == 0 || fastest_end(self).is_none_or(|(_, velocity)| velocity.abs() <= REST) {
            return Ok(self.clone());
        }
        let duration = self.stop_duration(last);
        let mut stopped = self.clone();
        stopped.times.push(self.times[last] + duration);
        for (arm, before) in stopped.arms.iter_mut().zip(&self.arms) {
            arm.errors.clear();
            // With accelerations a controller's spline would be a quintic, and another motion than this cubic.
            arm.accelerations.clear();
            let still = vec![0.0; arm.joints.len()];
            let velocity = before.velocity(last).unwrap_or(&still);
            let end = before.position(last).iter().zip(velocity).map(|(q, v)| q + v * duration / 2.0);
            let end: Vec<f64> = end.collect();
            check_stop(stage, before, &end)?;
            arm.positions.extend(end);
            if !arm.velocities.is_empty() {
                arm.velocities.extend(still);
            }
        }
        Ok(stopped)
    }

    fn stop_duration(&self, last: usize) -> f64 {
        let gap = |n: usize| self.times[n] - self.times[n - 1];
        let mut duration = gap(last);
        for arm in &self.arms {
            for joint in 0..arm.joints.len() {
                let at = |n: usize| arm.velocity(n).map_or(0.0, |velocity| velocity[joint]);
                let hardest = (1..=last).map(|n| ((at(n) - at(n - 1)) / gap(n)).abs()).fold(0.0, f64::max);
                // Without any acceleration the quotient is infinite or NaN, and the bound holds.
                duration = f64::max(duration, (at(last) / hardest).abs().min(LONGEST_STOP));
            }
        }
        duration
    }
}

fn check_stop(stage: &Stage, arm: &ArmTrajectory, end: &[f64]) -> Result<(), Refusal> {
    let Some(staged) = stage.arm(&arm.name).filter(|staged| staged.moves(&arm.joints)) else { return Ok(()) };
    match staged.chain.check_within_limits(end) {
        Ok(()) => Ok(()),
        Err(e) => {
            Err(Refusal(format!("arm `{}` can not decelerate to rest after its last sample: {e}", arm.name)))
        }
    }
}
