//! The most that is read of a URDF, so that no file takes the memory of a machine.

/// Longest URDF text that is read \[bytes\]: 64 MiB.
pub const MAX_BYTES: usize = 64 << 20;
/// Most joints of a robot that are read; of links one more, as a tree has.
pub const MAX_JOINTS: usize = 20_000;
/// Deepest nesting of XML elements that is read.
pub const MAX_DEPTH: usize = 256;
