//! Steps two Pandas on full-pose paths as a 1 kHz control loop would: one `step` per period, no allocation inside.
//!
//! `cargo run --example control_loop`

#![allow(clippy::print_stdout)]

use kinstep::nalgebra::{IsometryMatrix3, Vector3};
use kinstep::planner::Arm;
use kinstep::robot::embedded;
use kinstep::scheme;
use kinstep::task::{Motion, PathPoint, Planar, Plane, Quintic, Rose, TaskKind, Turning};
use std::error::Error;
use std::f64::consts::TAU;
use std::time::Instant;

const PERIOD: f64 = 1e-3;
const DURATION: f64 = 4.0;
const HOME: [f64; 7] = [0.0, -0.5, 0.0, -2.2, 0.0, 1.8, 0.8];

/// A Panda beside the origin, and the pose of its flange at home.
fn panda(side: f64) -> Result<(kinstep::robot::Chain, IsometryMatrix3<f64>), Box<dyn Error>> {
    let mount = IsometryMatrix3::new(Vector3::new(0.0, side, 0.0), Vector3::zeros());
    let chain = embedded::get("panda")?.chain("panda_link0", "panda_link8")?.mounted(&mount);
    let start = chain.forward(&HOME, &mut chain.scratch()).pose();
    Ok((chain, start))
}

fn main() -> Result<(), Box<dyn Error>> {
    // The left arm draws a rose in the horizontal plane while its hand turns about the vertical.
    let (chain, start) = panda(0.5)?;
    let rose = Planar::new(Rose { radius: 0.06, petals: 3.0 }, Plane::Xy, 0.0, 0.0, TAU / 2.0);
    let motion = Motion::from_pose(Turning::new(rose, Vector3::z_axis(), 0.5), Quintic, DURATION, &start);
    let left = Arm::new("left", chain, HOME.to_vec(), TaskKind::Pose, motion);

    // The right arm follows a path of our own: any closure with its derivative will do.
    let (chain, start) = panda(-0.5)?;
    let wave = |u: f64| PathPoint {
        position: Vector3::new(0.1 * u, 0.04 * (TAU * u).sin(), 0.0),
        tangent: Vector3::new(0.1, 0.04 * TAU * (TAU * u).cos(), 0.0),
    };
    let motion = Motion::from_pose(wave, Quintic, DURATION, &start);
    let right = Arm::new("right", chain, HOME.to_vec(), TaskKind::Pose, motion);

    let scheme = scheme::split(6, [left, right], PERIOD, 1.0).ok_or("split schemes have orders 1 to 8")?;
    let mut planner = scheme.duration(DURATION).build()?;
    let (mut worst, begin) = (0.0_f64, Instant::now());
    while !planner.is_finished() {
        // Here the positions would go to the robots, and the loop would wait for its clock.
        worst = worst.max(planner.arm(0).error.norm()).max(planner.arm(1).error.norm());
        planner.step();
    }
    let each = begin.elapsed().as_secs_f64() / planner.index() as f64;
    if let Some(stop) = planner.stop() {
        return Err(stop.reason.clone().into());
    }
    println!("{} periods of {PERIOD} s, {:.2} us of work each", planner.index(), each * 1e6);
    println!("largest task error of the two arms: {worst:.1e} (m, rad)");
    Ok(())
}
