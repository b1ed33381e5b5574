//! Plans the paper's experiment A.1 with three formulas and draws it: the arms at intervals, and their task errors.
//!
//! `cargo run --example draw_plan -- docs/pictures/dual_arm.svg` (without an argument the drawing goes to standard output).

#![allow(clippy::print_stdout)]

use kinstep::nalgebra::{IsometryMatrix3, Vector3};
use kinstep::planner::{Arm, Plan};
use kinstep::robot::{Robot, embedded};
use kinstep::scheme;
use kinstep::task::{Motion, Planar, Plane, Sin2, TaskKind, Tricuspid};
use std::error::Error;
use std::f64::consts::{PI, TAU};
use std::fmt::Write as _;

const SIGMA: f64 = 0.01;
const DURATION: f64 = 10.0;
/// The arms' names, where they stand [m], how they start in units of pi/10 [rad], and their colours.
const ARMS: [(&str, f64, [f64; 4], &str); 2] =
    [("left", -0.35, [9.0, -1.0, -1.0, -1.0], "#0072b2"), ("right", 0.35, [1.0, 1.0, 1.0, 1.0], "#d55e00")];

fn main() -> Result<(), Box<dyn Error>> {
    let robot = embedded::get("planar4")?;
    let euler = scheme::euler(arms(&robot)?, SIGMA, 0.4).duration(DURATION).build()?.run();
    let dtsmp = scheme::dtsmp(arms(&robot)?, SIGMA, 0.4).duration(DURATION).build()?.run();
    let split = scheme::split(6, arms(&robot)?, SIGMA, 1.0).ok_or("split schemes have orders 1 to 8")?;
    let split = split.duration(DURATION).build()?.run();

    let mut svg = String::from(
        r##"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 1000 430" font-family="Helvetica, Arial, sans-serif" font-size="14" fill="#222"><rect width="1000" height="430" fill="#fff"/>"##,
    );
    draw_arms(&mut svg, &robot, &dtsmp)?;
    let curves = [
        ("Euler, h = 0.4", &euler, "#8a8a8a"),
        ("DTSMP, h = 0.4", &dtsmp, "#0072b2"),
        ("split-ab6, h = 1", &split, "#009e73"),
    ];
    draw_errors(&mut svg, &curves)?;
    svg.push_str("</svg>\n");
    match std::env::args().nth(1) {
        Some(file) => std::fs::write(file, svg)?,
        None => println!("{svg}"),
    }
    Ok(())
}

fn mount(x: f64) -> IsometryMatrix3<f64> {
    IsometryMatrix3::new(Vector3::new(x, 0.0, 0.0), Vector3::zeros())
}

/// The two four-link arms of the paper, each on a tricuspid that begins at the tip.
fn arms(robot: &Robot) -> Result<Vec<Arm>, Box<dyn Error>> {
    let mut arms = Vec::new();
    for (name, x, q0, _) in ARMS {
        let chain = robot.chain("base", "tip")?.mounted(&mount(x));
        let q0 = q0.map(|tenths| tenths * PI / 10.0);
        let start = chain.forward(&q0, &mut chain.scratch()).pose();
        let path = Planar::new(Tricuspid { radius: 0.4 }, Plane::Xy, PI / 2.0, 0.0, TAU);
        let motion = Motion::from_pose(path, Sin2, DURATION, &start);
        arms.push(Arm::new(name, chain, q0.to_vec(), TaskKind::PositionXy, motion));
    }
    Ok(arms)
}

/// Where the links of an arm begin and end, as seen in the drawing.
fn outline(robot: &Robot, x: f64, q: &[f64]) -> Result<Vec<(f64, f64)>, Box<dyn Error>> {
    let mut points = vec![screen(x, 0.0)];
    for link in ["link2", "link3", "link4", "tip"] {
        let chain = robot.chain("base", link)?.mounted(&mount(x));
        let position = chain.forward(&q[..chain.dof()], &mut chain.scratch()).position();
        points.push(screen(position.x, position.y));
    }
    Ok(points)
}

fn screen(x: f64, y: f64) -> (f64, f64) {
    (250.0 + 60.0 * x, 305.0 - 60.0 * y)
}

fn polyline(svg: &mut String, points: &[(f64, f64)], style: &str) -> std::fmt::Result {
    let points: Vec<String> = points.iter().map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
    writeln!(svg, r#"<polyline points="{}" fill="none" {style}/>"#, points.join(" "))
}

fn draw_arms(svg: &mut String, robot: &Robot, plan: &Plan) -> Result<(), Box<dyn Error>> {
    svg.push_str(
        r#"<text x="250" y="28" text-anchor="middle">two arms on one clock, drawn every 0.5 s</text>"#,
    );
    for (arm, (_, x, _, colour)) in plan.arms.iter().zip(ARMS) {
        for n in (0..plan.samples()).step_by(50) {
            let style = format!(r#"stroke="{colour}" stroke-width="2" stroke-opacity="0.25""#);
            polyline(svg, &outline(robot, x, arm.position(n))?, &style)?;
        }
        let last = outline(robot, x, arm.position(plan.samples() - 1))?;
        polyline(svg, &last, &format!(r#"stroke="{colour}" stroke-width="5" stroke-linejoin="round""#))?;
        for (x, y) in &last {
            writeln!(
                svg,
                r##"<circle cx="{x:.1}" cy="{y:.1}" r="4.5" fill="#fff" stroke="{colour}" stroke-width="2"/>"##
            )?;
        }
        let mut trace = Vec::new();
        for n in (0..plan.samples()).step_by(5) {
            trace.extend(outline(robot, x, arm.position(n))?.last());
        }
        polyline(svg, &trace, r##"stroke="#222" stroke-width="2""##)?;
    }
    Ok(())
}

fn draw_errors(svg: &mut String, curves: &[(&str, &Plan, &str)]) -> Result<(), Box<dyn Error>> {
    let place = |t: f64, error: f64| (570.0 + 28.0 * t, 60.0 + 24.0 * (-3.0 - error.max(1e-17).log10()));
    svg.push_str(
        r#"<text x="710" y="28" text-anchor="middle">task error of the left arm [m], sigma = 0.01 s</text>"#,
    );
    for exponent in [-3, -5, -7, -9, -11, -13, -15] {
        let (x, y) = place(0.0, 10_f64.powi(exponent));
        writeln!(
            svg,
            r##"<path d="M{x} {y}H850" stroke="#ddd"/><text x="{}" y="{}" text-anchor="end" fill="#666">1e{exponent}</text>"##,
            x - 8.0,
            y + 5.0
        )?;
    }
    for t in [0.0, 5.0, 10.0] {
        let (x, y) = place(t, 1e-16);
        writeln!(svg, r##"<text x="{x}" y="{}" text-anchor="middle" fill="#666">{t} s</text>"##, y + 24.0)?;
    }
    for (name, plan, colour) in curves {
        // The largest error of every few samples: narrower features than the drawing shows are peaks of these.
        let bins = plan.arms[0].errors.chunks(4).enumerate();
        let points: Vec<_> = bins
            .map(|(i, bin)| {
                place(plan.time(4 * i), bin.iter().map(kinstep::nalgebra::Vector6::norm).fold(0.0, f64::max))
            })
            .filter(|&(_, y)| y < 380.0)
            .collect();
        polyline(svg, &points, &format!(r#"stroke="{colour}" stroke-width="2""#))?;
        let peak = points.iter().fold(f64::MAX, |least, point| least.min(point.1));
        writeln!(svg, r#"<text x="862" y="{:.0}" fill="{colour}">{name}</text>"#, peak + 14.0)?;
    }
    Ok(())
}
