//! The values of the sound joints, read by urdf-rs.
//!
//! It is given one document with the checked joints and nothing else: no geometry, no vendor elements, no names
//! (a joint is known by its place), so that whatever the file holds beside them can not disturb it.

use std::fmt::Write;

use super::raw_joint::RawJoint;
use crate::robot::report::Report;

/// Fills in `read` of every joint that is sound so far.
pub(super) fn read_values(joints: &mut [RawJoint], report: &mut Report<'_>) {
    let sound: Vec<usize> = (0..joints.len()).filter(|&index| joints[index].defect.is_none()).collect();
    let document = document(sound.iter().map(|&index| &joints[index]));
    match urdf_rs::read_from_string(&document) {
        Ok(robot) if robot.joints.len() == sound.len() => {
            for (&index, read) in sound.iter().zip(robot.joints) {
                joints[index].read = Some(read);
            }
        }
        _ => sound.iter().for_each(|&index| read_alone(&mut joints[index], report)),
    }
}

/// Reads one joint by itself, so that one that urdf-rs does not take spoils no other.
fn read_alone(joint: &mut RawJoint, report: &mut Report<'_>) {
    match urdf_rs::read_from_string(&document(std::iter::once(&*joint))) {
        Ok(mut robot) => joint.read = robot.joints.pop(),
        Err(error) => joint.fail(joint.offset, format!("can not be read: {error}"), report),
    }
}

fn document<'a>(joints: impl Iterator<Item = &'a RawJoint>) -> String {
    let mut document = String::from("<robot name=\"sound\">");
    for joint in joints {
        let kind = joint.kind.map_or("", crate::robot::JointKind::as_str);
        let _ = write!(
            document,
            "<joint name=\"j\" type=\"{kind}\"><parent link=\"p\"/><child link=\"c\"/>{}</joint>",
            joint.values
        );
    }
    document.push_str("</robot>");
    document
}
