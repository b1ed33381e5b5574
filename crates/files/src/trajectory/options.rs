//! What is known of a file of others before it is read.

use super::Trajectory;
use super::column_map::ColumnMap;
use super::times::TimeUnit;
use kinstep::robot::{Joint, JointKind, Limits, Robot};

/// A joint that may move in a file, as its robot has it.
#[derive(Clone, Debug, PartialEq)]
pub struct KnownJoint {
    /// Its name.
    pub name: String,
    /// How it moves.
    pub kind: JointKind,
    /// Its range and speed.
    pub limits: Limits,
    /// Whether it follows another joint.
    pub follows: bool,
}

impl KnownJoint {
    /// Returns the joints of a robot that move, in its order, those that follow others among them.
    pub fn of(robot: &Robot) -> Vec<Self> {
        robot.joints().iter().filter(|joint| joint.kind.is_movable()).map(Self::from).collect()
    }
}

impl From<&Joint> for KnownJoint {
    fn from(joint: &Joint) -> Self {
        let (name, follows) = (joint.name.clone(), joint.mimic.is_some());
        Self { name, kind: joint.kind, limits: joint.limits, follows }
    }
}

/// How a file of others is read: what its columns, its joints and its times mean. The default takes it at its word.
///
///     use kinstep_files::trajectory::{ReadOptions, Trajectory};
///     let options = ReadOptions { map: vec!["angle *".parse().unwrap()], ..ReadOptions::default() };
///     let text = "t,angle elbow,torque elbow\n0,0.1,7\n1,0.2,8\n";
///     let reading = Trajectory::from_bytes_with("a.csv".as_ref(), text.as_bytes(), &options).unwrap();
///     assert_eq!(reading.trajectory.arms[0].joints, ["elbow"]);
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ReadOptions {
    /// The columns of a table that are taken, where they are not called after joints; all others are left out. Without any,
    /// the names of the columns say what they are.
    pub map: Vec<ColumnMap>,
    /// What the names of joints begin with that the robot's do not.
    pub prefix: Option<String>,
    /// The unit of the times; without it they are in seconds unless they can not be.
    pub time_unit: Option<TimeUnit>,
    /// Whether angles are in degrees, and their rates too.
    pub degrees: bool,
    /// Whether the turns of 2 pi are undone that continuous joints were wrapped by.
    pub unwrap: bool,
    /// The joints of the robots that may move here, in their order; empty where that is not known.
    pub joints: Vec<KnownJoint>,
}

impl ReadOptions {
    pub(super) fn joint(&self, name: &str) -> Option<&KnownJoint> {
        self.joints.iter().find(|joint| joint.name == name)
    }
}

/// A trajectory that was read, and what was recognised and assumed on the way.
#[derive(Clone, Debug, PartialEq)]
pub struct Reading {
    /// The trajectory.
    pub trajectory: Trajectory,
    /// Sentences, in the order in which the file was read.
    pub notes: Vec<String>,
}
