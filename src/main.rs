//! The `kinstep` command.

fn main() {}
