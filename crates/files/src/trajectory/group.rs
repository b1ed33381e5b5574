//! Joints that are commanded together: those of all arms of one machine, each once.

use super::quantity::Quantity;
use super::{ArmTrajectory, Machine, Recording};

/// The arms of one machine as one list of joints; an arm that no machine is known of stands alone.
#[derive(Clone, Debug)]
pub(super) struct Group<'a> {
    /// The machine's name, or the arm's.
    pub(super) name: &'a str,
    pub(super) machine: Option<&'a Machine>,
    pub(super) columns: Vec<Column<'a>>,
}

/// A joint of a group.
#[derive(Clone, Copy, Debug)]
pub(super) struct Column<'a> {
    pub(super) joint: &'a str,
    arm: &'a ArmTrajectory,
    place: usize,
}

impl Column<'_> {
    /// The position [rad or m] at a sample.
    pub(super) fn position(&self, sample: usize) -> f64 {
        self.arm.position(sample)[self.place]
    }

    /// A quantity at a sample, where it is known.
    fn value(&self, quantity: Quantity, sample: usize) -> Option<f64> {
        self.arm.of(quantity).get(sample * self.arm.joints.len() + self.place).copied()
    }
}

impl<'a> Group<'a> {
    /// Returns the groups of a recording: machines in their order, then arms that stand alone.
    pub(super) fn all(recording: Recording<'a>) -> Vec<Self> {
        let Recording { trajectory, stage } = recording;
        let machine_of = |arm: &ArmTrajectory| stage.arm(&arm.name).map(|staged| staged.machine);
        let of_machine = |(index, machine): (usize, &'a Machine)| {
            let arms = trajectory.arms.iter().filter(|arm| machine_of(arm) == Some(index));
            Self { name: &machine.name, machine: Some(machine), columns: columns(arms) }
        };
        let alone = trajectory.arms.iter().filter(|arm| machine_of(arm).is_none());
        let alone =
            alone.map(|arm| Self { name: &arm.name, machine: None, columns: columns(std::iter::once(arm)) });
        let groups = stage.machines.iter().enumerate().map(of_machine).chain(alone);
        groups.filter(|group| !group.columns.is_empty()).collect()
    }

    /// Whether the quantity is known of all joints.
    pub(super) fn has(&self, quantity: Quantity) -> bool {
        self.columns.iter().all(|column| !column.arm.of(quantity).is_empty())
    }

    /// The quantity of all joints at a sample; nothing where it is unknown of one.
    pub(super) fn values(&self, quantity: Quantity, sample: usize) -> impl Iterator<Item = f64> + '_ {
        let known = self.has(quantity);
        self.columns.iter().filter(move |_| known).filter_map(move |column| column.value(quantity, sample))
    }

    /// The positions [rad or m] of all joints at a sample.
    pub(super) fn positions(&self, sample: usize) -> impl Iterator<Item = f64> + '_ {
        self.columns.iter().map(move |column| column.position(sample))
    }
}

fn columns<'a>(arms: impl Iterator<Item = &'a ArmTrajectory>) -> Vec<Column<'a>> {
    let mut columns: Vec<Column<'a>> = Vec::new();
    for arm in arms {
        for (place, joint) in arm.joints.iter().enumerate() {
            if columns.iter().all(|column| column.joint != joint) {
                columns.push(Column { joint, arm, place });
            }
        }
    }
    columns
}

/// Returns a name as the Robot Operating System takes it in topics and frames: letters, digits and `_`, no digit first.
pub(super) fn ros_name(name: &str) -> String {
    let plain: String = name.chars().map(|c| if c.is_ascii_alphanumeric() { c } else { '_' }).collect();
    if plain.starts_with(|c: char| c.is_ascii_digit()) || plain.is_empty() {
        format!("_{plain}")
    } else {
        plain
    }
}
