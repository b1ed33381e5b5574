//! How often joint positions are found for poses that an arm can take, of the robots that come with the library.
//!
//!     cargo run --example inverse_kinematics          a quick look
//!     cargo run --example inverse_kinematics -- 1000  the table of docs/inverse.md

#![allow(clippy::print_stdout, reason = "an example shows what it found")]

use kinstep::inverse::{Search, Target};
use kinstep::robot::{Chain, embedded};
use std::f64::consts::PI;
use std::time::Instant;

const ARMS: [[&str; 3]; 7] = [
    ["panda", "panda_link0", "panda_link8"],
    ["iiwa14", "iiwa_link_0", "iiwa_link_ee"],
    ["ur5e", "base_link", "tool0"],
    ["ur10e", "base_link", "tool0"],
    ["baxter", "torso", "left_gripper"],
    ["baxter", "torso", "right_gripper"],
    ["torso14", "floor", "left_tool"],
];

/// A generator of Knuth's; any would do.
struct Random(u64);

impl Random {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn joints(&mut self, chain: &Chain) -> Vec<f64> {
        let limits = chain.position_limits();
        limits.map(|(lower, upper)| lower.max(-PI) + (upper.min(PI) - lower.max(-PI)) * self.next()).collect()
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let count: usize = std::env::args().nth(1).map_or(Ok(20), |text| text.parse())?;
    println!(
        "| robot | joints | tip | poses | found | from the first start | most starts | worst error | mean time |"
    );
    println!("|---|---|---|---|---|---|---|---|---|");
    for [name, base, tip] in ARMS {
        let chain = embedded::get(name)?.chain(base, tip)?;
        let mut random = Random(1);
        let (mut found, mut first, mut most, mut worst) = (0, 0, 0, 0.0_f64);
        let begin = Instant::now();
        for _ in 0..count {
            let pose = chain.forward(&random.joints(&chain), &mut chain.scratch()).pose();
            let solution = Search::new().solutions(1).solve(&chain, &Target::pose(&pose))?;
            if solution.is_found() && chain.within_limits(&solution.q) {
                found += 1;
                first += usize::from(solution.starts == 1);
                most = most.max(solution.starts);
                worst = worst.max(solution.distance());
            }
        }
        let mean = begin.elapsed().as_secs_f64() * 1e3 / count as f64;
        println!(
            "| {name} | {} | {tip} | {count} | {found} | {first} | {most} | {worst:.1e} | {mean:.2} ms |",
            chain.dof()
        );
    }
    Ok(())
}
