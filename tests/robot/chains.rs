//! Robots that are one long chain.

use std::fmt::Write;

/// A URDF of so many joints, each on the one before.
pub(crate) fn chain_of(joints: usize) -> String {
    let mut text = String::from("<robot name=\"long\"><link name=\"l0\"/>");
    for joint in 1..=joints {
        let _ = write!(
            text,
            "<link name=\"l{joint}\"/><joint name=\"j{joint}\" type=\"continuous\"><parent link=\"l{}\"/>\
             <child link=\"l{joint}\"/></joint>",
            joint - 1
        );
    }
    text + "</robot>"
}
