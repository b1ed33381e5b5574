//! What is done to a trajectory once it is read: names, degrees and turns.

use std::f64::consts::{PI, TAU};

use super::csv_layout::listed;
use super::error::Problem;
use super::quantity::Quantity;
use super::{KnownJoint, ReadOptions, Reading, Trajectory};
use kinstep::robot::JointKind;

/// How far from whole turns a step may be that is taken for turns \[rad\].
const NEAR_TURN: f64 = PI / 4.0;

/// A step of about whole turns, which a joint does not make.
#[derive(Clone, Debug, PartialEq)]
pub struct Turn {
    /// The arm's name.
    pub arm: String,
    /// The joint's name.
    pub joint: String,
    /// The time of the sample after the step \[s\].
    pub t: f64,
    /// The step \[rad\].
    pub jump: f64,
}

impl Trajectory {
    /// Returns the first step of about whole turns (2 pi, within pi / 4) of each joint that is named: angles that were wrapped into a
    /// range of one turn. [`Trajectory::unwrapped`] undoes them.
    ///
    ///     use kinstep_files::trajectory::Trajectory;
    ///     let read = |text: &str| Trajectory::from_bytes("a.csv".as_ref(), text.as_bytes()).unwrap();
    ///     let wrapped = read("t,a,b\n0,3.1,0\n0.1,-3.1,0\n");
    ///     assert_eq!(wrapped.turns(&["a", "b"])[0].joint, "a");
    ///     assert!((wrapped.unwrapped(&["a"]).arms[0].positions[2] - 3.183).abs() < 1e-3);
    pub fn turns(&self, continuous: &[&str]) -> Vec<Turn> {
        let mut found = Vec::new();
        for arm in &self.arms {
            for (place, joint) in named(&arm.joints, continuous) {
                let column = arm.positions.iter().skip(place).step_by(arm.joints.len());
                let column: Vec<f64> = column.copied().collect();
                let is_turn = |pair: &[f64]| {
                    let jump = pair[1] - pair[0];
                    turns_of(jump) != 0.0 && (jump - turns_of(jump) * TAU).abs() < NEAR_TURN
                };
                if let Some(n) = column.windows(2).position(is_turn) {
                    let (arm, joint) = (arm.name.clone(), joint.to_owned());
                    found.push(Turn { arm, joint, t: self.times[n + 1], jump: column[n + 1] - column[n] });
                }
            }
        }
        found
    }

    /// Returns the same with whole turns added to the positions of the joints that are named, so that none of their steps is larger
    /// than half a turn.
    #[must_use]
    pub fn unwrapped(&self, continuous: &[&str]) -> Self {
        let mut unwrapped = self.clone();
        unwrapped.unwrap_turns(continuous);
        unwrapped
    }

    fn unwrap_turns(&mut self, continuous: &[&str]) {
        for arm in &mut self.arms {
            let width = arm.joints.len();
            let places: Vec<usize> = named(&arm.joints, continuous).map(|(place, _)| place).collect();
            for place in places {
                let mut before: Option<f64> = None;
                for q in arm.positions.iter_mut().skip(place).step_by(width) {
                    *q -= before.map_or(0.0, |before| turns_of(*q - before) * TAU);
                    before = Some(*q);
                }
            }
        }
    }
}

/// The joints that are named, with their places.
fn named<'j>(joints: &'j [String], names: &[&str]) -> impl Iterator<Item = (usize, &'j str)> {
    joints.iter().map(String::as_str).enumerate().filter(move |(_, joint)| names.contains(joint))
}

fn turns_of(jump: f64) -> f64 {
    (jump / TAU).round()
}

/// Does what the options ask for to what was read.
pub(super) fn adjusted(mut reading: Reading, options: &ReadOptions) -> Result<Reading, Problem> {
    let Reading { trajectory, notes } = &mut reading;
    if let Some(prefix) = &options.prefix {
        strip_prefix(trajectory, prefix)?;
    }
    if options.degrees {
        notes.push(from_degrees(trajectory, &options.joints));
    }
    if options.unwrap {
        let continuous = options.joints.iter().filter(|joint| joint.kind == JointKind::Continuous);
        let continuous: Vec<&str> = continuous.map(|joint| joint.name.as_str()).collect();
        let turns = trajectory.turns(&continuous);
        trajectory.unwrap_turns(&continuous);
        let turned: Vec<&str> = turns.iter().map(|turn| turn.joint.as_str()).collect();
        notes.push(match listed(&turned) {
            Some(list) => format!("turns of 2 pi are undone in {list}"),
            None if options.joints.is_empty() => {
                "--unwrap does nothing here: without a robot it is not known which joints are continuous"
                    .to_owned()
            }
            None => "--unwrap does nothing here: no continuous joint jumps by a turn".to_owned(),
        });
    }
    Ok(reading)
}

fn strip_prefix(trajectory: &mut Trajectory, prefix: &str) -> Result<(), Problem> {
    let all = trajectory.arms.iter().flat_map(|arm| &arm.joints);
    if !all.clone().any(|joint| joint.starts_with(prefix)) {
        let all: Vec<&str> = all.map(String::as_str).collect();
        let known = listed(&all).unwrap_or_default();
        return Err(Problem::new(format!("--prefix {prefix}: no joint's name begins so; there are {known}")));
    }
    for joint in trajectory.arms.iter_mut().flat_map(|arm| &mut arm.joints) {
        if let Some(own) = joint.strip_prefix(prefix) {
            *joint = own.to_owned();
        }
    }
    Ok(())
}

/// Converts all joints that are not known to slide, and says so.
fn from_degrees(trajectory: &mut Trajectory, joints: &[KnownJoint]) -> String {
    let slides =
        |name: &String| joints.iter().any(|joint| joint.name == *name && joint.kind == JointKind::Prismatic);
    let mut kept: Vec<String> = Vec::new();
    for arm in &mut trajectory.arms {
        let is_angle: Vec<bool> = arm.joints.iter().map(|joint| !slides(joint)).collect();
        kept.extend(arm.joints.iter().filter(|joint| slides(joint)).cloned());
        for quantity in Quantity::ALL {
            let values = arm.of_mut(quantity).iter_mut().zip(is_angle.iter().cycle());
            values.filter(|(_, is_angle)| **is_angle).for_each(|(value, _)| *value = value.to_radians());
        }
    }
    let kept: Vec<&str> = kept.iter().map(String::as_str).collect();
    let kept = listed(&kept).map_or_else(String::new, |list| format!("; {list} slide and stay as they are"));
    format!("angles are converted from degrees{kept}")
}
