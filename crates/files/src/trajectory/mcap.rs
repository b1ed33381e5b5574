//! A trajectory as a recording of the Robot Operating System.

use std::collections::BTreeMap;
use std::io::{self, Write};

use mcap::records::{MessageHeader, Metadata};
use mcap::write::NoSeek;
use mcap::{McapError, WriteOptions, Writer};
use nalgebra::{IsometryMatrix3, UnitQuaternion};

use super::cdr::{Cdr, CdrReader};
use super::clock::Stamp;
use super::controller::{Refusal, check_messages};
use super::error::Problem;
use super::group::{Group, ros_name};
use super::mcap_records::{Channel, Contents, MAGIC};
use super::quantity::Quantity;
use super::read::{Source, TrajectoryReader};
use super::ros2_schema::schema;
use super::ros2_yaml::start_of;
use super::states::{State, StateTime, States};
use super::{About, ArmTrajectory, Machine, ReadOptions, Reading, Recording, Trajectory, TrajectoryFormat};

/// The frame in which all machines stand.
const WORLD: &str = "world";
/// The name of the record that says what made the trajectory.
const ABOUT: &str = "kinstep";
/// The entry of a channel's metadata that has the machine's name as it is.
const MACHINE: &str = "kinstep.machine";
/// The least time between transforms [ns]: screens show sixty pictures a second, and viewers interpolate.
const FRAME_GAP: u64 = 10_000_000;
/// The most poses of a path that is drawn.
const LONGEST_PATH: usize = 10_000;
/// The quality of service of topics that late listeners get too: reliable, with the last message kept.
const LATCHED: &str = "- history: 1\n  depth: 1\n  reliability: 1\n  durability: 1\n  deadline:\n    sec: 9223372036\n    \
     nsec: 854775807\n  lifespan:\n    sec: 9223372036\n    nsec: 854775807\n  liveliness: 1\n  \
     liveliness_lease_duration:\n    sec: 9223372036\n    nsec: 854775807\n  avoid_ros_namespace_conventions: false\n";

/// An MCAP file with the profile `ros2`, as Foxglove, RViz (`ros2 bag play`) and `rosbag2` open it. Time begins at zero and
/// counts from the first sample.
///
/// At the start, kept for late listeners: `robot_description` (`std_msgs/String`, the robot's URDF), `/tf_static` (links
/// that do not move in their parents, and where the robots stand in `world`), `joint_trajectory`
/// (`trajectory_msgs/JointTrajectory`), `display_planned_path` (`moveit_msgs/DisplayTrajectory`), and of every arm
/// `ARM/path` (`nav_msgs/Path`, at most 10,000 poses). At every sample: `joint_states` (`sensor_msgs/JointState`, all joints
/// of the robot). `/tf` (`tf2_msgs/TFMessage`) at most 100 times per second of motion, with the first and the last sample.
///
/// With one machine, topics and frames have plain names. With several, the topics of each are in a namespace, `/MACHINE/...`,
/// and its frames are `MACHINE/LINK`: the prefix that RViz calls "TF Prefix" and Foxglove "frame prefix". Joints keep the
/// names that they have in the URDF. Nothing is compressed, and the same trajectory gives the same bytes.
///
/// Read are joint trajectories, one of each topic, and where there are none joint states, one arm of each topic.
#[derive(Clone, Copy, Debug, Default)]
pub struct Mcap;

impl TrajectoryFormat for Mcap {
    fn check(&self, recording: Recording<'_>) -> Result<(), Refusal> {
        check_messages(recording)
    }

    fn write(&self, recording: Recording<'_>, out: &mut dyn Write) -> io::Result<()> {
        let options = WriteOptions::new()
            .compression(None)
            .disable_seeking(true)
            .profile("ros2")
            .library(concat!("kinstep ", env!("CARGO_PKG_VERSION")));
        let writer = options.create(NoSeek::new(out)).map_err(plain)?;
        let mut bag = Bag { writer, cdr: Cdr::new(), sequences: BTreeMap::new() };
        bag.record(recording).map_err(plain)
    }
}

fn plain(error: McapError) -> io::Error {
    match error {
        McapError::Io(error) => error,
        other => io::Error::other(other),
    }
}

struct Bag<W: Write> {
    writer: Writer<NoSeek<W>>,
    cdr: Cdr,
    sequences: BTreeMap<u16, u32>,
}

/// What one machine's topics and frames are called.
struct Names {
    topics: String,
    frames: String,
}

impl Names {
    fn of(group: &Group<'_>, is_alone: bool) -> Self {
        if is_alone {
            return Self { topics: "/".to_owned(), frames: String::new() };
        }
        let name = ros_name(group.name);
        Self { topics: format!("/{name}/"), frames: format!("{name}/") }
    }
}

/// A machine while it moves: its joints' positions, and the links that move in their parents.
struct Moving<'a> {
    group: &'a Group<'a>,
    names: Names,
    states: u16,
    /// The joints of the machine that are not among those of the group, and where they rest.
    resting: Vec<(&'a str, f64)>,
    transforms: Option<Frames<'a>>,
}

/// The links of a machine: which follow the samples, which stand still in their parents.
struct Frames<'a> {
    machine: &'a Machine,
    /// The place in [`Robot::joints`](kinstep::robot::Robot::joints) of every column.
    joints: Vec<Option<usize>>,
    positions: Vec<f64>,
    moves: Vec<bool>,
}

impl<W: Write> Bag<W> {
    fn record(&mut self, recording: Recording<'_>) -> Result<(), McapError> {
        let trajectory = recording.trajectory;
        if let Some(about) = &trajectory.about {
            let metadata = about.entries().into_iter().collect();
            self.writer.write_metadata(&Metadata { name: ABOUT.to_owned(), metadata })?;
        }
        let groups = Group::all(recording);
        let mut moving = Vec::new();
        for group in &groups {
            let names = Names::of(group, groups.len() == 1);
            let topic = format!("{}joint_states", names.topics);
            let states = self.channel_of(Some(group.name), &topic, "sensor_msgs/JointState", false)?;
            let resting = start_of(group).split_off(group.columns.len());
            let transforms = group.machine.map(|machine| Frames::of(machine, group));
            moving.push(Moving { group, names, states, resting, transforms });
        }
        self.describe(&mut moving)?;
        for Moving { group, names, .. } in &moving {
            self.command(trajectory, group, names)?;
        }
        self.paths(recording)?;
        let transforms = self.channel("/tf", "tf2_msgs/TFMessage", false)?;
        let has_frames = moving.iter().any(|machine| machine.transforms.is_some());
        let (mut next, last) = (0, trajectory.samples().saturating_sub(1));
        for sample in 0..trajectory.samples() {
            let stamp = stamp(trajectory, sample);
            for machine in &mut moving {
                self.states(machine, sample, stamp)?;
            }
            if has_frames && (stamp.nanoseconds() >= next || sample == last) {
                next = stamp.nanoseconds() + FRAME_GAP;
                self.transforms(&mut moving, sample, stamp, true);
                self.send(transforms, stamp)?;
            }
        }
        self.writer.finish().map(|_| ())
    }

    fn channel(&mut self, topic: &str, message: &str, is_latched: bool) -> Result<u16, McapError> {
        self.channel_of(None, topic, message, is_latched)
    }

    fn channel_of(
        &mut self,
        machine: Option<&str>,
        topic: &str,
        message: &str,
        is_latched: bool,
    ) -> Result<u16, McapError> {
        let name = message.replacen('/', "/msg/", 1);
        let schema = self.writer.add_schema(&name, "ros2msg", schema(message).as_bytes())?;
        let quality = is_latched.then(|| ("offered_qos_profiles".to_owned(), LATCHED.to_owned()));
        let machine = machine.map(|machine| (MACHINE.to_owned(), machine.to_owned()));
        self.writer.add_channel(schema, topic, "cdr", &quality.into_iter().chain(machine).collect())
    }

    /// Writes the message that was put together.
    fn send(&mut self, channel_id: u16, stamp: Stamp) -> Result<(), McapError> {
        let sequence = self.sequences.entry(channel_id).or_default();
        let time = stamp.nanoseconds();
        let header = MessageHeader { channel_id, sequence: *sequence, log_time: time, publish_time: time };
        *sequence += 1;
        let sent = self.writer.write_to_known_channel(&header, self.cdr.bytes());
        self.cdr.restart();
        sent
    }

    /// Where the robots stand, what they look like, and the links that do not move.
    fn describe(&mut self, moving: &mut [Moving<'_>]) -> Result<(), McapError> {
        for machine in moving.iter() {
            let Some(frames) = &machine.transforms else { continue };
            let urdf = frames.machine.urdf.clone().or_else(|| frames.machine.robot.to_urdf().ok());
            if let Some(urdf) = urdf {
                let topic = format!("{}robot_description", machine.names.topics);
                let channel = self.channel(&topic, "std_msgs/String", true)?;
                self.cdr.text(&urdf);
                self.send(channel, Stamp::ZERO)?;
            }
        }
        if moving.iter().all(|machine| machine.transforms.is_none()) {
            return Ok(());
        }
        let channel = self.channel("/tf_static", "tf2_msgs/TFMessage", true)?;
        self.transforms(moving, 0, Stamp::ZERO, false);
        self.send(channel, Stamp::ZERO)
    }

    /// Puts together the transforms of the links that move, or of those that do not, with the machines' roots.
    fn transforms(&mut self, moving: &mut [Moving<'_>], sample: usize, stamp: Stamp, moves: bool) {
        let all = moving.iter_mut().filter_map(|machine| {
            let frames = machine.transforms.as_mut()?;
            Some((frames.transforms(machine.group, sample, moves), &machine.names))
        });
        let all: Vec<(Vec<Transform<'_>>, &Names)> = all.collect();
        self.cdr.count(all.iter().map(|(transforms, _)| transforms.len()).sum());
        for (transforms, names) in all {
            for Transform { parent, child, pose } in transforms {
                let parent =
                    parent.map_or_else(|| WORLD.to_owned(), |parent| format!("{}{parent}", names.frames));
                self.cdr.header(stamp, &parent);
                self.cdr.text(&format!("{}{child}", names.frames));
                self.pose(&pose);
            }
        }
    }

    fn pose(&mut self, pose: &IsometryMatrix3<f64>) {
        self.cdr.reals(pose.translation.vector.iter().copied());
        let turn = UnitQuaternion::from_rotation_matrix(&pose.rotation);
        self.cdr.reals([turn.i, turn.j, turn.k, turn.w]);
    }

    fn states(&mut self, machine: &Moving<'_>, sample: usize, stamp: Stamp) -> Result<(), McapError> {
        let Moving { group, states, resting, .. } = machine;
        let count = group.columns.len() + resting.len();
        self.cdr.header(stamp, "");
        self.cdr.count(count);
        let names =
            group.columns.iter().map(|column| column.joint).chain(resting.iter().map(|(name, _)| *name));
        names.for_each(|name| self.cdr.text(name));
        self.cdr.count(count);
        self.cdr.reals(group.positions(sample).chain(resting.iter().map(|&(_, position)| position)));
        if group.has(Quantity::Velocity) {
            self.cdr.count(count);
            self.cdr.reals(group.values(Quantity::Velocity, sample).chain(resting.iter().map(|_| 0.0)));
        } else {
            self.cdr.count(0);
        }
        self.cdr.count(0);
        self.send(*states, stamp)
    }

    fn command(
        &mut self,
        trajectory: &Trajectory,
        group: &Group<'_>,
        names: &Names,
    ) -> Result<(), McapError> {
        let topic = format!("{}joint_trajectory", names.topics);
        let channel = self.channel_of(Some(group.name), &topic, "trajectory_msgs/JointTrajectory", true)?;
        self.joint_trajectory(trajectory, group);
        self.send(channel, Stamp::ZERO)?;
        let topic = format!("{}display_planned_path", names.topics);
        let channel = self.channel(&topic, "moveit_msgs/DisplayTrajectory", true)?;
        self.display_trajectory(trajectory, group);
        self.send(channel, Stamp::ZERO)
    }

    fn joint_trajectory(&mut self, trajectory: &Trajectory, group: &Group<'_>) {
        self.cdr.header(Stamp::ZERO, "");
        self.cdr.texts(group.columns.iter().map(|column| column.joint));
        self.cdr.count(trajectory.samples());
        let count = |quantity| if group.has(quantity) { group.columns.len() } else { 0 };
        let [velocities, accelerations] = [Quantity::Velocity, Quantity::Acceleration].map(count);
        for sample in 0..trajectory.samples() {
            self.cdr.count(group.columns.len());
            self.cdr.reals(group.positions(sample));
            self.cdr.count(velocities);
            self.cdr.reals(group.values(Quantity::Velocity, sample));
            self.cdr.count(accelerations);
            self.cdr.reals(group.values(Quantity::Acceleration, sample));
            self.cdr.count(0);
            self.cdr.stamp(stamp(trajectory, sample));
        }
    }

    fn display_trajectory(&mut self, trajectory: &Trajectory, group: &Group<'_>) {
        self.cdr.text(group.machine.map_or(group.name, |machine| machine.robot.name()));
        self.cdr.count(1);
        self.joint_trajectory(trajectory, group);
        // No joints with several freedoms: a header, and two empty lists.
        self.cdr.header(Stamp::ZERO, "");
        self.cdr.count(0);
        self.cdr.count(0);
        let start = start_of(group);
        self.cdr.header(Stamp::ZERO, "");
        self.cdr.texts(start.iter().map(|(name, _)| *name));
        self.cdr.list(start.iter().map(|&(_, position)| position));
        self.cdr.count(0);
        self.cdr.count(0);
        // The same of the start, with three lists; and nothing attached.
        self.cdr.header(Stamp::ZERO, "");
        (0..5).for_each(|_| self.cdr.count(0));
        self.cdr.flag(group.machine.is_none());
    }

    /// Where the tips go, in the world.
    fn paths(&mut self, recording: Recording<'_>) -> Result<(), McapError> {
        let Recording { trajectory, stage } = recording;
        let stride = trajectory.samples().div_ceil(LONGEST_PATH).max(1);
        let samples: Vec<usize> = (0..trajectory.samples()).step_by(stride).collect();
        for arm in &trajectory.arms {
            let Some(staged) = stage.arm(&arm.name).filter(|staged| staged.chain.dof() == arm.joints.len())
            else {
                continue;
            };
            let channel = self.channel(&format!("/{}/path", ros_name(&arm.name)), "nav_msgs/Path", true)?;
            let mut scratch = staged.chain.scratch();
            self.cdr.header(Stamp::ZERO, WORLD);
            self.cdr.count(samples.len());
            for &sample in &samples {
                self.cdr.header(stamp(trajectory, sample), WORLD);
                let pose = staged.chain.forward(arm.position(sample), &mut scratch).pose();
                self.pose(&pose);
            }
            self.send(channel, Stamp::ZERO)?;
        }
        Ok(())
    }
}

/// The time of a sample since the first one; the times have been checked.
fn stamp(trajectory: &Trajectory, sample: usize) -> Stamp {
    Stamp::of(trajectory.times[sample] - trajectory.times[0]).unwrap_or(Stamp::ZERO)
}

/// Where a link stands in the one above it, or in the world.
struct Transform<'a> {
    parent: Option<&'a str>,
    child: &'a str,
    pose: IsometryMatrix3<f64>,
}

impl<'a> Frames<'a> {
    fn of(machine: &'a Machine, group: &Group<'_>) -> Self {
        let all = machine.robot.joints();
        let place = |name: &str| all.iter().position(|joint| joint.name == name);
        let joints: Vec<Option<usize>> = group.columns.iter().map(|column| place(column.joint)).collect();
        let is_moved = |index: usize| joints.contains(&Some(index));
        let moves = all.iter().enumerate();
        let moves = moves.map(|(index, joint)| is_moved(joint.mimic.map_or(index, |mimic| mimic.driver)));
        Self { machine, moves: moves.collect(), joints, positions: machine.rest.clone() }
    }

    fn transforms(&mut self, group: &Group<'_>, sample: usize, moves: bool) -> Vec<Transform<'a>> {
        for (joint, position) in self.joints.iter().zip(group.positions(sample)) {
            if let Some(joint) = *joint {
                self.positions[joint] = position;
            }
        }
        let robot = &self.machine.robot;
        let poses = robot.link_poses(&self.positions);
        let links = robot.links();
        let joints = robot.joints().iter().zip(&self.moves).filter(|(_, own)| **own == moves);
        let below = joints.map(|(joint, _)| Transform {
            parent: Some(&links[joint.parent].name),
            child: &links[joint.child].name,
            pose: poses[joint.parent].inv_mul(&poses[joint.child]),
        });
        let roots = robot.roots().filter(|_| !moves);
        let world_from_root = self.machine.world_from_root;
        let roots = roots.map(|root| Transform { parent: None, child: &root.name, pose: world_from_root });
        roots.chain(below).collect()
    }
}

impl TrajectoryReader for Mcap {
    fn knows(&self, source: Source<'_>) -> bool {
        source.bytes.starts_with(MAGIC) || source.has_extension(&["mcap"])
    }

    fn read(&self, source: Source<'_>, options: &ReadOptions) -> Result<Reading, Problem> {
        let (mut commands, mut states): (Vec<Series>, Vec<Joints>) = (Vec::new(), Vec::new());
        let contents =
            Contents::read(source.bytes, &mut |channel, time, message| match channel.message.as_str() {
                "trajectory_msgs/msg/JointTrajectory"
                    if !commands.iter().any(|known| known.topic == channel.topic) =>
                {
                    commands.push(Series::command(channel, message)?);
                    Ok(())
                }
                "sensor_msgs/msg/JointState" => {
                    let known = states.iter().position(|known| known.topic == channel.topic);
                    let place = known.unwrap_or(states.len());
                    if known.is_none() {
                        states.push(Joints {
                            topic: channel.topic.clone(),
                            name: name_of(channel),
                            states: States::default(),
                        });
                    }
                    let topic = &channel.topic;
                    let pushed = states[place].states.push(&state_of(time, message)?, options);
                    pushed.map_err(|problem| Problem::new(format!("{topic}: {}", problem.message)))
                }
                _ => Ok(()),
            })?;
        let about = contents.metadata.get(ABOUT);
        let about =
            about.and_then(|about| About::from_entries(about.iter().map(|(k, v)| (k.as_str(), v.as_str()))));
        let mut notes = Vec::new();
        if commands.is_empty() {
            let finished = states.into_iter().map(|one| one.series(options, &mut notes));
            commands = finished.collect::<Result<_, _>>()?;
        }
        let nothing = "it has neither trajectory_msgs/msg/JointTrajectory nor sensor_msgs/msg/JointState";
        let first = commands.first().ok_or_else(|| Problem::new(nothing))?;
        if let Some(other) = commands.iter().find(|other| other.times != first.times) {
            let (one, other) = (&first.topic, &other.topic);
            let message = format!("{other} and {one} have samples at different times; keep one of them");
            return Err(Problem::new(message));
        }
        let times = first.times.clone();
        let arms = commands.into_iter().map(|series| series.arm).collect();
        Ok(Reading { trajectory: Trajectory { about, times, arms }, notes })
    }
}

/// The joint states of one topic.
struct Joints {
    topic: String,
    name: String,
    states: States,
}

impl Joints {
    fn series(self, options: &ReadOptions, notes: &mut Vec<String>) -> Result<Series, Problem> {
        let (topic, mut own) = (self.topic, Vec::new());
        let trajectory = self.states.finish(&self.name, options, &mut own);
        let Trajectory { times, mut arms, .. } =
            trajectory.map_err(|problem| Problem::new(format!("{topic}: {}", problem.message)))?;
        notes.extend(own.into_iter().map(|note| format!("{topic}: {note}")));
        Ok(Series { arm: arms.swap_remove(0), topic, times })
    }
}

/// A joint state, with the time at which it was recorded where it has no stamp.
fn state_of(log_time: u64, message: &[u8]) -> Result<State, Problem> {
    let mut cdr = CdrReader::new(message)?;
    let stamp = cdr.header()?;
    let names = cdr.texts()?;
    let has_stamp = stamp != Stamp::ZERO || log_time == 0;
    let nanoseconds = if has_stamp { stamp.nanoseconds() } else { log_time };
    let (positions, velocities) = (cdr.list()?, cdr.list()?);
    Ok(State { at: None, time: StateTime::Nanoseconds(nanoseconds.into()), names, positions, velocities })
}

/// The samples of one topic.
struct Series {
    topic: String,
    times: Vec<f64>,
    arm: ArmTrajectory,
}

/// The arm that a topic is about: what stands before its last word.
fn arm_of(topic: &str) -> &str {
    let space = topic.rsplit_once('/').map_or("", |(space, _)| space).trim_start_matches('/');
    if space.is_empty() { "arm" } else { space }
}

/// The name of the arm, or machine, that a channel is about.
fn name_of(channel: &Channel) -> String {
    channel.metadata.get(MACHINE).map_or(arm_of(&channel.topic), String::as_str).to_owned()
}

impl Series {
    fn of(channel: &Channel) -> Self {
        let (topic, name) = (channel.topic.clone(), name_of(channel));
        Self { arm: ArmTrajectory::empty(&name), times: Vec::new(), topic }
    }

    fn command(channel: &Channel, message: &[u8]) -> Result<Self, Problem> {
        let mut series = Self::of(channel);
        let mut cdr = CdrReader::new(message)?;
        cdr.header()?;
        series.arm.joints = cdr.texts()?;
        for _ in 0..cdr.count()? {
            let (positions, rates) = (cdr.list()?, [cdr.list()?, cdr.list()?]);
            let _efforts = cdr.list()?;
            series.times.push(cdr.stamp()?.seconds());
            series.push(positions, rates)?;
        }
        Ok(series)
    }

    /// Adds a sample, of which all have velocities or none, and accelerations likewise.
    fn push(&mut self, positions: Vec<f64>, rates: [Vec<f64>; 2]) -> Result<(), Problem> {
        let (samples, topic, joints) = (self.times.len(), &self.topic, self.arm.joints.len());
        if positions.len() != joints {
            let got = positions.len();
            return Err(Problem::new(format!(
                "sample {samples} of {topic} has {got} positions for {joints} joints"
            )));
        }
        for (quantity, rates) in [Quantity::Velocity, Quantity::Acceleration].into_iter().zip(rates) {
            let known = self.arm.of_mut(quantity);
            if rates.len() == joints && (samples == 1 || !known.is_empty()) {
                known.extend(rates);
            } else if !known.is_empty() {
                let missing = quantity.plural();
                return Err(Problem::new(format!(
                    "sample {samples} of {topic} has no {missing} although others have"
                )));
            }
        }
        self.arm.positions.extend(positions);
        Ok(())
    }
}
