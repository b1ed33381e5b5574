//! A plan as comma-separated values.

use std::io::{self, Write};

use super::PlanFormat;
use crate::planner::Plan;

/// A row per sample: `t`, then of each arm `ARM.JOINT` [rad or m] joint by joint, `ARM.JOINT.velocity` [rad/s or m/s],
/// and `ARM.error`, the norm of its task error. 17 significant digits, so that every value reads back as it was.
#[derive(Clone, Copy, Debug, Default)]
pub struct PlanCsv;

impl PlanFormat for PlanCsv {
    fn write(&self, plan: &Plan, out: &mut dyn Write) -> io::Result<()> {
        write!(out, "t")?;
        for arm in &plan.arms {
            for suffix in ["", ".velocity"] {
                for joint in &arm.joints {
                    write!(out, ",{}", field(&format!("{}.{joint}{suffix}", arm.name)))?;
                }
            }
            write!(out, ",{}", field(&format!("{}.error", arm.name)))?;
        }
        writeln!(out)?;
        for sample in 0..plan.samples() {
            write!(out, "{:.16e}", plan.time(sample))?;
            for arm in &plan.arms {
                for value in arm.position(sample).iter().chain(arm.velocity(sample)) {
                    write!(out, ",{value:.16e}")?;
                }
                write!(out, ",{:.16e}", arm.errors[sample].norm())?;
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
