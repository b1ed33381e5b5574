//! A trajectory as NumPy arrays in one file.

use std::io::{self, Cursor, Read, Write};

use zip::write::SimpleFileOptions;
use zip::{CompressionMethod, ZipArchive, ZipWriter};

use super::csv_dialects::numbered;
use super::csv_layout::ONLY_ARM;
use super::error::Problem;
use super::npy::{Array, Content, write_numbers, write_texts};
use super::read::{Source, TrajectoryReader};
use super::times::Times;
use super::{About, ArmTrajectory, ReadOptions, Reading, Recording, Trajectory, TrajectoryFormat};

/// Arrays as `numpy.load` reads them: `t` \[s\]; `arms`, the arms' names; of every arm `ARM.joints`, `ARM.positions`
/// (samples x joints, rad or m), and where they are known `ARM.velocities`, `ARM.accelerations` and `ARM.errors`; `about`, pairs of keys and
/// values that say what made it. Nothing is compressed, and the same trajectory gives the same bytes.
///
/// Of others are read files with `t` (or `time`), `positions` (or `q`), `joints`, and perhaps `velocities` (or `qd`) and
/// `accelerations` (or `qdd`): one arm.
#[derive(Clone, Copy, Debug, Default)]
pub struct Npz;

impl TrajectoryFormat for Npz {
    fn write(&self, recording: Recording<'_>, out: &mut dyn Write) -> io::Result<()> {
        let trajectory = recording.trajectory;
        let mut archive = ZipWriter::new_stream(out);
        let samples = trajectory.samples();
        let mut numbers = |name: &str, values: &[f64], columns: Option<usize>| -> io::Result<()> {
            let shape: Vec<usize> = std::iter::once(samples).chain(columns).collect();
            let options = options().large_file(values.len() >= 1 << 28);
            archive.start_file(format!("{name}.npy"), options)?;
            write_numbers(&mut archive, &shape, values)
        };
        numbers("t", &trajectory.times, None)?;
        for arm in &trajectory.arms {
            let (name, joints) = (&arm.name, Some(arm.joints.len()));
            for (quantity, values) in arm.known() {
                numbers(&format!("{name}.{}", quantity.plural()), values, joints)?;
            }
            if !arm.errors.is_empty() {
                numbers(&format!("{name}.errors"), &arm.errors, None)?;
            }
        }
        let mut texts = |name: &str, shape: &[usize], values: &[&str]| -> io::Result<()> {
            archive.start_file(format!("{name}.npy"), options())?;
            write_texts(&mut archive, shape, values)
        };
        let names: Vec<&str> = trajectory.arms.iter().map(|arm| arm.name.as_str()).collect();
        texts("arms", &[names.len()], &names)?;
        for arm in &trajectory.arms {
            let joints: Vec<&str> = arm.joints.iter().map(String::as_str).collect();
            texts(&format!("{}.joints", arm.name), &[joints.len()], &joints)?;
        }
        if let Some(about) = &trajectory.about {
            let entries = about.entries();
            let flat: Vec<&str> = entries.iter().flat_map(|(key, value)| [key.as_str(), value]).collect();
            texts("about", &[entries.len(), 2], &flat)?;
        }
        archive.finish()?;
        Ok(())
    }
}

fn options() -> SimpleFileOptions {
    SimpleFileOptions::default().compression_method(CompressionMethod::Stored)
}

impl TrajectoryReader for Npz {
    fn knows(&self, source: Source<'_>) -> bool {
        source.bytes.starts_with(b"PK\x03\x04") || source.has_extension(&["npz"])
    }

    fn read(&self, source: Source<'_>, options: &ReadOptions) -> Result<Reading, Problem> {
        let archive = ZipArchive::new(Cursor::new(source.bytes))
            .map_err(|e| Problem::new(format!("it is no archive of arrays: {e}")))?;
        let mut arrays = Arrays { archive };
        let times = arrays.first(&["t", "time"])?;
        let samples = times.shape.first().copied().unwrap_or_default();
        let mut clock = Times::new(options.time_unit);
        let times = times.numbers("t", &[samples])?;
        times.into_iter().try_for_each(|time| clock.push_real(time)).map_err(Problem::new)?;
        let mut notes = Vec::new();
        let times = clock.finish(&mut notes);
        let arms = match arrays.get("arms")? {
            None => vec![arrays.plain_arm(samples, options, &mut notes)?],
            Some(names) => {
                let names = names.texts("arms")?;
                names.iter().map(|name| arrays.arm(name, samples)).collect::<Result<_, _>>()?
            }
        };
        let about = arrays.get("about")?.map(|array| array.texts("about")).transpose()?;
        let about = about.and_then(|flat| {
            let pairs = flat.chunks_exact(2).map(|pair| (pair[0].as_str(), pair[1].as_str()));
            About::from_entries(pairs)
        });
        Ok(Reading { trajectory: Trajectory { about, times, arms }, notes })
    }
}

/// The arrays of an archive, by name.
struct Arrays<'a> {
    archive: ZipArchive<Cursor<&'a [u8]>>,
}

impl Arrays<'_> {
    fn get(&mut self, name: &str) -> Result<Option<Array>, Problem> {
        let file = format!("{name}.npy");
        let bad =
            |e: &dyn std::fmt::Display| Problem::new(format!("the array `{name}` can not be read: {e}"));
        let Some(index) = self.archive.index_for_name(&file) else { return Ok(None) };
        let mut entry = self
            .archive
            .by_index(index)
            .map_err(|e| bad(&format!("{e}; save it by numpy.savez, which does not compress")))?;
        let mut bytes = Vec::new();
        entry.read_to_end(&mut bytes).map_err(|e| bad(&e))?;
        Array::read(&bytes).map(Some).map_err(|e| bad(&e))
    }

    fn first(&mut self, names: &[&str]) -> Result<Array, Problem> {
        for name in names {
            if let Some(array) = self.get(name)? {
                return Ok(array);
            }
        }
        let known = self.archive.file_names().flatten();
        let known: Vec<String> = known.map(|name| name.trim_end_matches(".npy").to_owned()).collect();
        let (wanted, known) = (names.join("` or `"), known.join(", "));
        Err(Problem::new(format!("there is no array `{wanted}`; there are {known}")))
    }

    fn arm(&mut self, name: &str, samples: usize) -> Result<ArmTrajectory, Problem> {
        let own = |part: &str| format!("{name}.{part}");
        let joints = self.first(&[&own("joints")])?.texts("joints")?;
        let names = ["positions", "velocities", "accelerations", "errors"].map(own);
        let names = names.each_ref().map(|name| [name.as_str()]);
        self.arm_of((name, joints), samples, names.each_ref().map(<[&str; 1]>::as_slice))
    }

    /// The only arm of a file of others; joints without names are the robot's, in its order.
    fn plain_arm(
        &mut self,
        samples: usize,
        options: &ReadOptions,
        notes: &mut Vec<String>,
    ) -> Result<ArmTrajectory, Problem> {
        let positions: &[&str] = &["positions", "q"];
        let mut joints = None;
        for key in ["joints", "joint_names"] {
            joints = joints.or(self.get(key)?);
        }
        let joints = match joints {
            Some(joints) => joints.texts("joints")?,
            None if options.joints.is_empty() => self.first(&["joints", "joint_names"])?.texts("joints")?,
            None => {
                let width = self.first(positions)?.shape.get(1).copied().unwrap_or_default();
                let numbers: Vec<usize> = (0..width).collect();
                numbered(&numbers, positions[0], options, notes).map_err(Problem::new)?
            }
        };
        let rest: [&[&str]; 3] = [&["velocities", "qd"], &["accelerations", "qdd"], &["errors"]];
        self.arm_of((ONLY_ARM, joints), samples, [positions, rest[0], rest[1], rest[2]])
    }

    fn arm_of(
        &mut self,
        (name, joints): (&str, Vec<String>),
        samples: usize,
        keys: [&[&str]; 4],
    ) -> Result<ArmTrajectory, Problem> {
        let [positions, velocities, accelerations, errors] = keys;
        let shape = [samples, joints.len()];
        let positions = self.first(positions)?.numbers(positions[0], &shape)?;
        let mut known = |keys: &[&str], shape: &[usize]| -> Result<Vec<f64>, Problem> {
            for key in keys {
                if let Some(array) = self.get(key)? {
                    return array.numbers(key, shape);
                }
            }
            Ok(Vec::new())
        };
        let velocities = known(velocities, &shape)?;
        let accelerations = known(accelerations, &shape)?;
        let errors = known(errors, &[samples])?;
        Ok(ArmTrajectory { name: name.to_owned(), joints, positions, velocities, accelerations, errors })
    }
}

impl Array {
    fn numbers(self, name: &str, shape: &[usize]) -> Result<Vec<f64>, Problem> {
        if self.shape != shape {
            let got = self.shape;
            return Err(Problem::new(format!(
                "the array `{name}` has the shape {got:?}, expected {shape:?}"
            )));
        }
        match self.content {
            Content::Numbers(values) => Ok(values),
            Content::Texts(_) => {
                Err(Problem::new(format!("the array `{name}` has text in place of numbers")))
            }
        }
    }

    fn texts(self, name: &str) -> Result<Vec<String>, Problem> {
        match self.content {
            Content::Texts(values) => Ok(values),
            Content::Numbers(_) => {
                Err(Problem::new(format!("the array `{name}` has numbers in place of text")))
            }
        }
    }
}
