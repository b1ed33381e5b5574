//! What a control loop repeats, a given number of times: `counted NAME COUNT`, to be run under an instruction counter.
//!
//! `scripts/performance.py` runs it twice with different counts; the difference is free of everything else.

#![allow(clippy::print_stdout)]

mod works;

use std::hint::black_box;

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).filter(|argument| argument != "--bench").collect();
    let [name, count] = arguments.as_slice() else {
        // `cargo bench` runs every benchmark without arguments: nothing to count then.
        println!("works: {}", works::NAMES.join("; "));
        return;
    };
    let count: usize = count.parse().expect("the second argument is a number of repetitions");
    let mut work = works::by_name(name).expect("the first argument names one of the works");
    for _ in 0..count {
        black_box(work());
    }
}
