//! Tells cargo to look again when a file is added to `robots/`: its files are embedded in the library.

#![allow(clippy::print_stdout, reason = "this is how a build script talks to cargo")]

fn main() {
    println!("cargo::rerun-if-changed=robots");
}
