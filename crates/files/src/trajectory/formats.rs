//! The formats by their names, and the files that each of them makes.

#[cfg(feature = "parquet")]
use super::Parquet;
use super::group::Group;
use super::{Csv, CsvMetadata, Mcap, MoveItYaml, Npz, Recording, Ros2Yaml, TrajectoryFormat};

/// The name of the files, before the dot.
const STEM: &str = "trajectory";

/// A format that is chosen by its name. A new one is a line in [`Export::ALL`] and in each match below.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Export {
    /// Comma-separated values, with metadata.
    Csv,
    /// NumPy arrays.
    Npz,
    /// A table of Apache Parquet.
    #[cfg(feature = "parquet")]
    Parquet,
    /// Messages `trajectory_msgs/JointTrajectory` as YAML, one file for each machine.
    Ros2,
    /// A recording of the Robot Operating System.
    Mcap,
    /// Messages `moveit_msgs/DisplayTrajectory` as YAML, one file for each machine.
    MoveIt,
}

/// A file that a format makes: its name, and what writes it.
pub struct ExportFile {
    /// The name.
    pub name: String,
    /// What writes it.
    pub format: Box<dyn TrajectoryFormat>,
}

impl std::fmt::Debug for ExportFile {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("ExportFile").field("name", &self.name).finish_non_exhaustive()
    }
}

impl Export {
    /// Every format, for listings.
    pub const ALL: &'static [Self] = &[
        Self::Csv,
        Self::Npz,
        #[cfg(feature = "parquet")]
        Self::Parquet,
        Self::Ros2,
        Self::Mcap,
        Self::MoveIt,
    ];

    /// The name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Csv => "csv",
            Self::Npz => "npz",
            #[cfg(feature = "parquet")]
            Self::Parquet => "parquet",
            Self::Ros2 => "ros2",
            Self::Mcap => "mcap",
            Self::MoveIt => "moveit",
        }
    }

    /// Whether it is sent to controllers, which ask for an end at rest.
    pub fn is_for_controllers(self) -> bool {
        matches!(self, Self::Ros2 | Self::Mcap | Self::MoveIt)
    }

    /// Returns the files of a trajectory on which these machines move.
    pub fn files(self, machines: &[String]) -> Vec<ExportFile> {
        let file = |name: String, format: Box<dyn TrajectoryFormat>| ExportFile { name, format };
        let plain = |machine: &String| -> String {
            let is_plain = |c: char| c.is_ascii_alphanumeric() || c == '-' || c == '_';
            machine.chars().map(|c| if is_plain(c) { c } else { '_' }).collect()
        };
        let each = |ending: &str, format: &dyn Fn(String) -> Box<dyn TrajectoryFormat>| -> Vec<ExportFile> {
            let of = |machine: &String| {
                file(format!("{STEM}.{}.{ending}", plain(machine)), format(machine.clone()))
            };
            machines.iter().map(of).collect()
        };
        match self {
            Self::Csv => {
                let metadata = CsvMetadata { table: format!("{STEM}.csv") };
                let name = metadata.file_name();
                vec![file(format!("{STEM}.csv"), Box::new(Csv)), file(name, Box::new(metadata))]
            }
            Self::Npz => vec![file(format!("{STEM}.npz"), Box::new(Npz))],
            #[cfg(feature = "parquet")]
            Self::Parquet => vec![file(format!("{STEM}.parquet"), Box::new(Parquet))],
            Self::Mcap => vec![file(format!("{STEM}.mcap"), Box::new(Mcap))],
            Self::Ros2 => each("yaml", &|machine| Box::new(Ros2Yaml { machine })),
            Self::MoveIt => each("moveit.yaml", &|machine| Box::new(MoveItYaml { machine })),
        }
    }
}

impl Recording<'_> {
    /// Returns the names of the machines that move, as files and topics have them; an arm without a known machine stands
    /// for one.
    pub fn machines(&self) -> Vec<String> {
        Group::all(*self).iter().map(|group| group.name.to_owned()).collect()
    }
}
