//! Messages of trajectories as YAML: what `ros2 topic pub --yaml-file` and `rclpy` load.

use std::fmt::Write as _;
use std::io::{self, Write};

use super::clock::Stamp;
use super::controller::{Refusal, check_command};
use super::error::Problem;
use super::group::Group;
use super::lines::write_lines;
use super::long_file::LongFile;
use super::messages::Messages;
use super::points::Points;
use super::quantity::Quantity;
use super::read::{Source, TrajectoryReader};
use super::{About, Machine, ReadOptions, Reading, Recording, Trajectory, TrajectoryFormat};
use super::{long_points, yaml};

/// The line of a comment that has the machine's name.
const MACHINE: &str = "# machine: ";

/// `trajectory_msgs/msg/JointTrajectory` of one machine: all joints of its arms, each once, by their names in the URDF.
/// Times are rounded to nanoseconds and count from the first sample; positions and velocities read back as they were.
///
/// What the joint trajectory controller of `ros2_control` refuses is refused before anything is written: times that do not
/// increase in nanoseconds or have more than 31 bits of seconds, an end that is not at rest, values that are not finite.
///
/// Read are joint trajectories of ROS 1 and ROS 2, alone or within goals, results, robot and display trajectories, and joint
/// states, as documents one after another or as a list.
#[derive(Clone, Debug)]
pub struct Ros2Yaml {
    /// The machine's name, or that of an arm that stands alone.
    pub machine: String,
}

/// `moveit_msgs/msg/DisplayTrajectory` of one machine, with the positions of all its joints at the start. Fields that are
/// left out have their defaults. Refused is what [`Ros2Yaml`] refuses.
#[derive(Clone, Debug)]
pub struct MoveItYaml {
    /// The machine's name, or that of an arm that stands alone.
    pub machine: String,
}

impl TrajectoryFormat for Ros2Yaml {
    fn check(&self, recording: Recording<'_>) -> Result<(), Refusal> {
        check(recording, &self.machine)
    }

    fn write(&self, recording: Recording<'_>, out: &mut dyn Write) -> io::Result<()> {
        let group = begin(recording, &self.machine, out)?;
        write_joint_trajectory(recording.trajectory, &group, "", out)
    }
}

impl TrajectoryFormat for MoveItYaml {
    fn check(&self, recording: Recording<'_>) -> Result<(), Refusal> {
        check(recording, &self.machine)
    }

    fn write(&self, recording: Recording<'_>, out: &mut dyn Write) -> io::Result<()> {
        let group = begin(recording, &self.machine, out)?;
        let model = group.machine.map_or(group.name, |machine| machine.robot.name());
        writeln!(out, "model_id: {}\ntrajectory:\n- joint_trajectory:", yaml::quoted(model))?;
        write_joint_trajectory(recording.trajectory, &group, "    ", out)?;
        let start = start_of(&group);
        let mut text = String::from("trajectory_start:\n  joint_state:\n    name: ");
        yaml::push_list(&mut text, start.iter().map(|(name, _)| yaml::quoted(name)));
        text.push_str("\n    position: ");
        yaml::push_numbers(&mut text, start.iter().map(|&(_, position)| position));
        let _ = write!(text, "\n  is_diff: {}", group.machine.is_none());
        writeln!(out, "{text}")
    }
}

/// What the messages of both formats are refused for.
fn check(recording: Recording<'_>, machine: &str) -> Result<(), Refusal> {
    check_command(recording)?;
    group(recording, machine).map(|_| ())
}

/// Begins the file of a machine's message with a comment, and returns the machine's joints. `rclpy` and `ros2` skip comments.
fn begin<'a>(recording: Recording<'a>, machine: &str, out: &mut dyn Write) -> io::Result<Group<'a>> {
    let group = group(recording, machine).map_err(io::Error::other)?;
    writeln!(out, "{MACHINE}{}", group.name.escape_debug())?;
    let entries = recording.trajectory.about.iter().flat_map(About::entries);
    for (key, value) in entries {
        writeln!(out, "# {key}: {}", value.escape_debug())?;
    }
    Ok(group)
}

fn group<'a>(recording: Recording<'a>, name: &str) -> Result<Group<'a>, Refusal> {
    let groups = Group::all(recording);
    let known: Vec<&str> = groups.iter().map(|group| group.name).collect();
    let message = format!("no machine `{name}` moves; there are {}", known.join(", "));
    groups.into_iter().find(|group| group.name == name).ok_or(Refusal(message))
}

/// The joints that move on their own, and where they are in the first sample: of the whole machine where it is known.
pub(super) fn start_of<'a>(group: &Group<'a>) -> Vec<(&'a str, f64)> {
    let moved = group.columns.iter().map(|column| (column.joint, column.position(0)));
    let rest = |machine: &'a Machine| {
        let joints = machine.robot.joints().iter().zip(&machine.rest);
        let own = joints.filter(|(joint, _)| joint.kind.is_movable() && joint.mimic.is_none());
        own.map(|(joint, &position)| (joint.name.as_str(), position))
    };
    let resting = group.machine.into_iter().flat_map(rest);
    let resting = resting.filter(|(name, _)| group.columns.iter().all(|column| column.joint != *name));
    moved.chain(resting).collect()
}

/// What points have beside positions.
fn rates() -> impl Iterator<Item = Quantity> {
    [Quantity::Velocity, Quantity::Acceleration].into_iter()
}

fn write_joint_trajectory(
    trajectory: &Trajectory,
    group: &Group<'_>,
    indent: &str,
    out: &mut dyn Write,
) -> io::Result<()> {
    let mut text =
        format!("{indent}header:\n{indent}  stamp: {{sec: 0, nanosec: 0}}\n{indent}  frame_id: \"\"\n");
    let _ = write!(text, "{indent}joint_names: ");
    yaml::push_list(&mut text, group.columns.iter().map(|column| yaml::quoted(column.joint)));
    let _ = write!(text, "\n{indent}points:");
    writeln!(out, "{text}")?;
    write_lines(trajectory.samples(), out, |text: &mut String, sample| {
        let _ = write!(text, "{indent}- positions: ");
        yaml::push_numbers(text, group.positions(sample));
        for quantity in rates() {
            if group.has(quantity) {
                let _ = write!(text, "\n{indent}  {}: ", quantity.plural());
                yaml::push_numbers(text, group.values(quantity, sample));
            }
        }
        let since = trajectory.times[sample] - trajectory.times[0];
        let Stamp { sec, nanosec } = Stamp::of(since).unwrap_or(Stamp::ZERO);
        let _ = writeln!(text, "\n{indent}  time_from_start: {{sec: {sec}, nanosec: {nanosec}}}");
    })
}

impl TrajectoryReader for Ros2Yaml {
    fn knows(&self, source: Source<'_>) -> bool {
        let is_named = source.has_extension(&["yaml", "yml"]) || source.bytes.starts_with(MACHINE.as_bytes());
        is_named || !source.has_extension(&["csv", "tsv"]) && begins_with_a_key(source)
    }

    fn read(&self, source: Source<'_>, options: &ReadOptions) -> Result<Reading, Problem> {
        read(source.text()?, options, None)
    }

    fn read_blocks(&self, file: &mut LongFile<'_>, options: &ReadOptions) -> Option<Reading> {
        let (text, points) = long_points::read(file)?;
        read(&text, options, Some(points)).ok()
    }
}

/// Reads documents; points that were read before stand in the first list of them that is empty.
fn read(text: &str, options: &ReadOptions, mut points: Option<Box<Points>>) -> Result<Reading, Problem> {
    let comments = || text.lines().take_while(|line| line.starts_with('#'));
    let mut messages = Messages::new(options);
    yaml::documents(text, &mut |mut node| {
        node.fill(&mut points);
        messages.take(node)
    })?;
    let mut reading = messages.finish(comments().find_map(|line| line.strip_prefix(MACHINE)))?;
    let entries = comments().filter_map(|line| line.strip_prefix("# ")?.split_once(": "));
    reading.trajectory.about = About::from_entries(entries);
    Ok(reading)
}

/// Whether a text begins as a message does that is printed: with a word and a colon, or with the line between messages.
fn begins_with_a_key(source: Source<'_>) -> bool {
    let start = &source.bytes[..source.bytes.len().min(1000)];
    let text = String::from_utf8_lossy(start);
    let mut lines = text.lines().filter(|line| !line.trim().is_empty() && !line.starts_with('#'));
    lines.next().is_some_and(|line| {
        let word = line.trim_start_matches("- ").split(':').next().unwrap_or_default();
        let is_word = word.chars().all(|c| c.is_ascii_alphanumeric() || c == '_');
        line.starts_with("---")
            || (is_word && !word.is_empty() && line.len() > word.len() && line.contains(':'))
    })
}
