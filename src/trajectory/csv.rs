//! A trajectory as comma-separated values.

use std::io::{self, Write};

use super::{Recording, TrajectoryFormat};

/// A row per sample: `t`, then of each arm `ARM.JOINT` [rad or m] joint by joint, `ARM.JOINT.velocity` [rad/s or m/s],
/// and `ARM.error`, the norm of its task error; what is not known has no columns. 17 significant digits, so that every
/// value reads back as it was.
#[derive(Clone, Copy, Debug, Default)]
pub struct Csv;

impl TrajectoryFormat for Csv {
    fn write(&self, recording: Recording<'_>, out: &mut dyn Write) -> io::Result<()> {
        let trajectory = recording.trajectory;
        write!(out, "t")?;
        for arm in &trajectory.arms {
            for (suffix, known) in [("", true), (".velocity", !arm.velocities.is_empty())] {
                for joint in arm.joints.iter().filter(|_| known) {
                    write!(out, ",{}", field(&format!("{}.{joint}{suffix}", arm.name)))?;
                }
            }
            if !arm.errors.is_empty() {
                write!(out, ",{}", field(&format!("{}.error", arm.name)))?;
            }
        }
        writeln!(out)?;
        for (sample, time) in trajectory.times.iter().enumerate() {
            write!(out, "{time:.16e}")?;
            for arm in &trajectory.arms {
                let velocities = arm.velocity(sample).unwrap_or_default();
                for value in arm.position(sample).iter().chain(velocities).chain(arm.errors.get(sample)) {
                    write!(out, ",{value:.16e}")?;
                }
            }
            writeln!(out)?;
        }
        Ok(())
    }
}

/// A heading with a comma, a quote or a line break in it stands in quotes.
fn field(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}
