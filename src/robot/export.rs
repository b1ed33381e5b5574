//! A robot written down as URDF.

use std::fmt::Write;

use nalgebra::Rotation3;
use thiserror::Error;

use super::{Defect, Joint, JointKind, Robot, names};

/// What stands for a limit that is not known: readers of URDF take it as a number, this one as unlimited.
const UNKNOWN: f64 = 1e308;

/// Why a robot can not be written down.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[non_exhaustive]
pub enum ExportError {
    /// A joint or a link that is defective: what is written from it would look sound.
    #[error("{what} {} is defective (line {}): {}; mend it first", names::quote(.name), .defect.line, .defect.reason)]
    Defective {
        /// `joint` or `link`.
        what: &'static str,
        /// Name of the joint or link.
        name: String,
        /// What is wrong with the joint or link.
        defect: Defect,
    },
}

impl Robot {
    /// Returns the robot as URDF that reads back to the same kinematics: tree, names, origins, axes, limits and mimic
    /// ratios, every number with all its digits.
    ///
    /// Shapes, inertias, efforts and dynamics are not part of a [`Robot`] and are not written; a comment in the text says
    /// so. Limits that are not known are written as 1e308, or left out where the standard allows it (acceleration and jerk, of
    /// URDF 1.2). Angles stand as they were read; where an origin was computed
    /// (from a table, a calibration, a lock, a quaternion) they are worked out from the rotation, which costs at most a
    /// few units in the last place.
    ///
    /// # Errors
    /// [`ExportError`] where a joint or a link is defective.
    ///
    /// ```
    /// use kinstep::robot::{Robot, embedded};
    /// let panda = embedded::get("panda")?;
    /// let again = Robot::from_urdf(&panda.to_urdf()?)?;
    /// assert_eq!(again.joints(), panda.joints());
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    pub fn to_urdf(&self) -> Result<String, ExportError> {
        self.check_sound()?;
        let mut text = format!(
            "<?xml version=\"1.0\"?>\n<!--\n  Written by kinstep: kinematics and limits. Shapes, inertias, efforts and \
             dynamics are not kept.\n  {UNKNOWN:e} stands for a limit that is not known.\n-->\n<robot name=\"{}\">\n",
            escaped(&self.name)
        );
        for link in &self.links {
            if let Some(joint) = link.parent_joint {
                self.write_joint(&mut text, &self.joints[joint]);
            }
            let _ = writeln!(text, "  <link name=\"{}\"/>", escaped(&link.name));
        }
        text.push_str("</robot>\n");
        Ok(text)
    }

    fn check_sound(&self) -> Result<(), ExportError> {
        let joints = self.joints.iter().map(|joint| (&joint.name, joint.defect.as_ref()));
        let strays = self.strays.iter().map(|stray| (&stray.name, Some(&stray.defect)));
        let links = self.links.iter().map(|link| ("link", &link.name, link.defect.as_ref()));
        let joints = joints.chain(strays).map(|(name, defect)| ("joint", name, defect));
        let mut defects = joints.chain(links).filter_map(|(what, name, defect)| Some((what, name, defect?)));
        defects.next().map_or(Ok(()), |(what, name, defect)| {
            Err(ExportError::Defective { what, name: name.clone(), defect: defect.clone() })
        })
    }

    fn write_joint(&self, text: &mut String, joint: &Joint) {
        let link = |index: usize| escaped(&self.links[index].name);
        let (name, parent, child) = (escaped(&joint.name), link(joint.parent), link(joint.child));
        let _ = writeln!(text, "\n  <joint name=\"{name}\" type=\"{}\">", joint.kind);
        let xyz = numbers(joint.origin.translation.vector.as_slice());
        let rpy = numbers(&joint.angles.unwrap_or_else(|| angles(&joint.origin.rotation)));
        let _ = writeln!(text, "    <origin xyz=\"{xyz}\" rpy=\"{rpy}\"/>");
        let _ = writeln!(text, "    <parent link=\"{parent}\"/>\n    <child link=\"{child}\"/>");
        if joint.kind.is_movable() || joint.kind == JointKind::Planar {
            let _ = writeln!(text, "    <axis xyz=\"{}\"/>", numbers(joint.axis.as_slice()));
        }
        write_limits(text, joint);
        if let Some(mimic) = joint.follows {
            let driver = escaped(&self.joints[mimic.driver].name);
            let (multiplier, offset) = (number(mimic.multiplier), number(mimic.offset));
            let _ = writeln!(
                text,
                "    <mimic joint=\"{driver}\" multiplier=\"{multiplier}\" offset=\"{offset}\"/>"
            );
        }
        text.push_str("  </joint>\n");
    }
}

fn write_limits(text: &mut String, joint: &Joint) {
    let limits = joint.limits;
    let bound = |value: f64| number(if value.is_finite() { value } else { UNKNOWN.copysign(value) });
    let mut rest = format!("effort=\"{}\" velocity=\"{}\"", number(UNKNOWN), bound(limits.velocity));
    for (name, value) in [("acceleration", limits.acceleration), ("jerk", limits.jerk)] {
        if value.is_finite() {
            let _ = write!(rest, " {name}=\"{}\"", number(value));
        }
    }
    let is_held = [limits.velocity, limits.acceleration, limits.jerk].iter().any(|limit| limit.is_finite());
    let _ = match joint.kind {
        JointKind::Revolute | JointKind::Prismatic => writeln!(
            text,
            "    <limit lower=\"{}\" upper=\"{}\" {rest}/>",
            bound(limits.lower),
            bound(limits.upper)
        ),
        JointKind::Continuous if is_held => writeln!(text, "    <limit {rest}/>"),
        _ => Ok(()),
    };
}

/// Returns roll, pitch and yaw of a rotation `Rz(yaw) Ry(pitch) Rx(roll)`, near a pitch of 90 degrees too: whatever yaw
/// comes out there, the roll goes with it.
fn angles(rotation: &Rotation3<f64>) -> [f64; 3] {
    let r = |row: usize, column: usize| rotation[(row, column)];
    let yaw = r(1, 0).atan2(r(0, 0));
    let (sin, cos) = yaw.sin_cos();
    let pitch = (-r(2, 0)).atan2(cos * r(0, 0) + sin * r(1, 0));
    let roll = (sin * r(0, 2) - cos * r(1, 2)).atan2(cos * r(1, 1) - sin * r(0, 1));
    [roll, pitch, yaw]
}

fn numbers(values: &[f64]) -> String {
    values.iter().map(|&value| number(value)).collect::<Vec<_>>().join(" ")
}

/// The shortest decimal that reads back as the same double.
fn number(value: f64) -> String {
    if value == 0.0 || (1e-5..1e9).contains(&value.abs()) { format!("{value}") } else { format!("{value:e}") }
}

/// A name as the value of an attribute; characters that a reader would take for something else are written by their numbers.
fn escaped(name: &str) -> String {
    let mut text = String::with_capacity(name.len());
    for c in name.chars() {
        match c {
            '&' => text.push_str("&amp;"),
            '<' => text.push_str("&lt;"),
            '>' => text.push_str("&gt;"),
            '"' => text.push_str("&quot;"),
            // A `${` would be taken for xacro.
            '\t' | '\n' | '\r' | '$' => {
                let _ = write!(text, "&#{};", u32::from(c));
            }
            // No reader accepts the other control characters; a name with them can only have been made by a program.
            c if !names::is_of_xml(c) => text.push(char::REPLACEMENT_CHARACTER),
            c => text.push(c),
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn angles_lead_back_to_the_rotation_at_a_pitch_of_90_degrees_too() {
        for roll in [-3.0, -0.7, 0.0, 2.5] {
            for off in [0.0, 1e-16, -1e-12, 1e-8, 1e-3, 1.0, -2.0] {
                for yaw in [-2.0, 0.0, 1.1] {
                    let rotation = Rotation3::from_euler_angles(roll, std::f64::consts::FRAC_PI_2 + off, yaw);
                    let [roll, pitch, yaw] = angles(&rotation);
                    let again = Rotation3::from_euler_angles(roll, pitch, yaw);
                    let off = (again.matrix() - rotation.matrix()).amax();
                    assert!(off < 4.0 * f64::EPSILON, "{roll} {pitch} {yaw}: {off:e}");
                }
            }
        }
    }

    #[test]
    fn numbers_keep_their_digits_and_names_their_characters() {
        for value in [0.0, 0.1, -1.0 / 3.0, 1e-300, 1.797e308, 123_456_789.123_456_78] {
            assert_eq!(number(value).parse::<f64>().unwrap(), value);
        }
        assert_eq!(escaped("a<b>&\"c\"\n${d}"), "a&lt;b&gt;&amp;&quot;c&quot;&#10;&#36;{d}");
    }
}
