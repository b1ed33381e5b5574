//! Robots from files of any kind, and their kinematics.

mod bad_input;
mod chain;
mod chains;
mod changes;
mod dh;
mod kinematics;
mod never_panics;
mod reference;
mod sizes;
mod trees;
