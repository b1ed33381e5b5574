#![allow(clippy::print_stdout)]
//! What the solver takes for how close an answer: evaluations and time against error, as comma-separated values that
//! `scripts/work_precision.py` sets beside other solvers.
//!
//! `cargo run --release --example work_precision`

use kinstep::integrate::{Family, Ode, Solver};
use std::f64::consts::TAU;
use std::time::Instant;

type RightHandSide = fn(f64, &[f64], &mut [f64]);

/// A problem with its end, which is known.
struct Problem {
    name: &'static str,
    family: Family,
    right_hand_side: RightHandSide,
    initial: &'static [f64],
    end: f64,
    known: &'static [f64],
    /// The absolute tolerance over the relative one.
    scale: f64,
}

/// `sqrt(1.3 / 0.7)`, the velocity nearest to the sun.
const NEAREST: f64 = 1.362_770_287_738_494_3;

const PROBLEMS: [Problem; 6] = [
    Problem {
        name: "kepler",
        family: Family::ADAMS,
        right_hand_side: |_t, x, f| {
            let cube = (x[0] * x[0] + x[1] * x[1]).powf(1.5);
            f.copy_from_slice(&[x[2], x[3], -x[0] / cube, -x[1] / cube]);
        },
        initial: &[0.7, 0.0, 0.0, NEAREST],
        end: TAU,
        known: &[0.7, 0.0, 0.0, NEAREST],
        scale: 1.0,
    },
    Problem {
        name: "lotka_volterra",
        family: Family::ADAMS,
        right_hand_side: |_t, x, f| f.copy_from_slice(&[2.0 * (x[0] - x[0] * x[1]), -(x[1] - x[0] * x[1])]),
        initial: &[1.0, 3.0],
        end: 20.0,
        known: &[0.676_187_600_857_666_7, 0.186_081_609_964_003_6],
        scale: 1.0,
    },
    Problem {
        name: "robertson",
        family: Family::BDF,
        right_hand_side: |_t, x, f| {
            f[0] = -0.04 * x[0] + 1e4 * x[1] * x[2];
            f[2] = 3e7 * x[1] * x[1];
            f[1] = -f[0] - f[2];
        },
        initial: &[1.0, 0.0, 0.0],
        end: 40.0,
        known: &[0.715_827_068_719_394, 9.185_534_764_557_618e-6, 0.284_163_745_745_841_3],
        scale: 1e-4,
    },
    Problem {
        name: "van_der_pol_stiff",
        family: Family::BDF,
        right_hand_side: |_t, x, f| f.copy_from_slice(&[x[1], 1000.0 * (1.0 - x[0] * x[0]) * x[1] - x[0]]),
        initial: &[2.0, 0.0],
        end: 2000.0,
        known: &[1.706_167_732_170_483, -0.892_809_701_024_797_5e-3],
        scale: 1.0,
    },
    Problem {
        name: "hires",
        family: Family::BDF,
        right_hand_side: |_t, y, f| {
            let reaction = 280.0 * y[5] * y[7];
            f[0] = -1.71 * y[0] + 0.43 * y[1] + 8.32 * y[2] + 0.0007;
            f[1] = 1.71 * y[0] - 8.75 * y[1];
            f[2] = -10.03 * y[2] + 0.43 * y[3] + 0.035 * y[4];
            f[3] = 8.32 * y[1] + 1.71 * y[2] - 1.12 * y[3];
            f[4] = -1.745 * y[4] + 0.43 * y[5] + 0.43 * y[6];
            f[5] = -reaction + 0.69 * y[3] + 1.71 * y[4] - 0.43 * y[5] + 0.69 * y[6];
            f[6] = reaction - 1.81 * y[6];
            f[7] = -f[6];
        },
        initial: &[1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0057],
        end: 321.8122,
        known: &[
            0.737_131_257_332_566_8e-3,
            0.144_248_572_631_618_5e-3,
            0.588_872_974_096_757_5e-4,
            0.117_565_134_328_314_9e-2,
            0.238_635_619_883_133_1e-2,
            0.623_896_825_274_279_6e-2,
            0.284_999_839_518_576_9e-2,
            0.285_000_160_481_423_1e-2,
        ],
        scale: 1.0,
    },
    Problem {
        name: "oregonator",
        family: Family::BDF,
        right_hand_side: |_t, x, f| {
            f[0] = 77.27 * (x[1] + x[0] * (1.0 - 8.375e-6 * x[0] - x[1]));
            f[1] = (x[2] - (1.0 + x[0]) * x[1]) / 77.27;
            f[2] = 0.161 * (x[0] - x[2]);
        },
        initial: &[1.0, 2.0, 3.0],
        end: 360.0,
        known: &[1.000_814_870_318_523, 1_228.178_521_549_917, 132.055_494_284_670_6],
        scale: 1.0,
    },
];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let repetitions = std::env::args().nth(1).map_or(Ok(3), |count| count.parse::<usize>())?;
    println!("problem,solver,tolerance,evaluations,error,error_over_tolerance,microseconds");
    for problem in &PROBLEMS {
        for power in 4..=12 {
            let tolerance = 10_f64.powi(-power);
            for automatic in [false, true] {
                measure(problem, tolerance, automatic, repetitions)?;
            }
        }
    }
    Ok(())
}

fn measure(
    problem: &Problem,
    tolerance: f64,
    is_automatic: bool,
    repetitions: usize,
) -> Result<(), Box<dyn std::error::Error>> {
    let absolute = tolerance * problem.scale;
    let solve = || {
        let solver = if is_automatic { Solver::automatic() } else { Solver::family(problem.family) };
        let mut field = Ode::new(problem.initial.len(), problem.right_hand_side);
        solver.tolerance(tolerance, absolute).solve(&mut field, 0.0, problem.initial, problem.end)
    };
    let solution = solve()?;
    let mut fastest = f64::INFINITY;
    for _ in 0..repetitions {
        let begin = Instant::now();
        std::hint::black_box(solve()?);
        fastest = fastest.min(begin.elapsed().as_secs_f64() * 1e6);
    }
    let pairs = || solution.x.iter().zip(problem.known).map(|(x, known)| ((x - known).abs(), known.abs()));
    let error = pairs().map(|(error, _)| error).fold(0.0, f64::max);
    let times = pairs().map(|(error, known)| error / (tolerance * known + absolute)).fold(0.0, f64::max);
    let solver = if is_automatic { "kinstep automatic" } else { "kinstep" };
    let evaluations = solution.statistics.evaluations;
    println!("{},{solver},{tolerance:e},{evaluations},{error:e},{times:.3},{fastest:.1}", problem.name);
    Ok(())
}
