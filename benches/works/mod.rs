//! The works that are timed and counted, by name.

use kinstep::formula::FormulaTable;
use kinstep::integrate::Starter;
use kinstep::math::GramCholesky;
use kinstep::nalgebra::{IsometryMatrix3, Vector3, Vector6};
use kinstep::planner::{Arm, Batch, Plan, Planner, run_together};
use kinstep::robot::{Chain, DhTable, Robot, embedded};
use kinstep::task::{Circle, Motion, Planar, Reference, Sin2, TaskKind};
use std::f64::consts::FRAC_PI_2;
use std::hint::black_box;
use std::sync::Arc;

/// One repetition; the result only keeps the compiler from leaving it out.
pub(crate) type Work = Box<dyn FnMut() -> f64>;

const ARMS: [(&str, &str, &str, &[f64]); 4] = [
    ("ur5e", "base_link", "tool0", &[0.2, -1.3, 1.7, -1.4, -1.2, 0.4]),
    ("panda", "panda_link0", "panda_link8", &[0.1, -0.4, 0.2, -2.1, 0.3, 1.8, 0.6]),
    ("iiwa14", "iiwa_link_0", "iiwa_link_ee", &[0.1, 0.6, 0.2, -1.4, 0.3, 1.1, 0.4]),
    (
        "baxter",
        "left_hand",
        "right_hand",
        &[0.1, 0.6, 0.2, 1.4, 0.3, 1.1, 0.4, 0.1, 0.6, 0.2, 1.4, 0.3, 1.1, 0.4],
    ),
];

/// Steps of a plan before it begins anew.
const STEPS: usize = 20_000;
const SIGMA: f64 = 1e-3;

/// Every work, in the order in which they are listed.
pub(crate) const NAMES: [&str; 14] = [
    "kinematics ur5e",
    "kinematics panda",
    "kinematics iiwa14",
    "kinematics baxter",
    "solve",
    "step 1 panda",
    "step 2 pandas",
    "step 4 pandas",
    "step 8 pandas",
    "step 2 pandas, path computed",
    "step 2 pandas, split-ab6",
    "step 4 plans",
    "4 plans, one by one",
    "4 plans, together",
];

/// Returns the work of that name; besides those that are listed, `arms N` and `joints N` show what a step costs by size.
pub(crate) fn by_name(name: &str) -> Option<Work> {
    Some(match name {
        "solve" => solve(),
        "step 1 panda" => steps(1, "la6-wang-guo", 0.4, true),
        "step 2 pandas" => steps(2, "la6-wang-guo", 0.4, true),
        "step 4 pandas" => steps(4, "la6-wang-guo", 0.4, true),
        "step 8 pandas" => steps(8, "la6-wang-guo", 0.4, true),
        "step 2 pandas, path computed" => steps(2, "la6-wang-guo", 0.4, false),
        "step 2 pandas, split-ab6" => steps(2, "split-ab6", 1.0, true),
        "step 4 plans" => batch(4),
        "4 plans, one by one" => plans(|planners| planners.into_iter().map(Planner::run).collect()),
        "4 plans, together" => plans(run_together),
        _ => by_size(name).or_else(|| name.strip_prefix("kinematics ").map(kinematics))?,
    })
}

/// A step of a number of Pandas, or of two arms with a number of joints.
fn by_size(name: &str) -> Option<Work> {
    let (what, number) = name.split_once(' ')?;
    let number: usize = number.parse().ok()?;
    match what {
        "arms" => Some(steps(number, "la6-wang-guo", 0.4, true)),
        "joints" => {
            let (chain, q) = snake(number);
            Some(stepped(plans_of(
                vec![(chain.clone(), q.clone()), (chain, q)],
                "la6-wang-guo",
                0.4,
                STEPS,
                true,
            )))
        }
        _ => None,
    }
}

/// An arm of that many joints, the first two of them with parallel axes, the others with axes at right angles.
fn snake(joints: usize) -> (Chain, Vec<f64>) {
    let mut table = DhTable::planar("snake", &vec![0.2; joints]);
    for (i, row) in table.rows.iter_mut().enumerate().take(joints).skip(2) {
        row.alpha = if i % 2 == 0 { -FRAC_PI_2 } else { FRAC_PI_2 };
    }
    let robot = Robot::from_dh(&table).expect("a table without fault");
    (robot.chain("base", "tip").expect("the links of the table"), vec![0.5; joints])
}

fn arm(robot: &str) -> (Chain, &'static [f64]) {
    let (_, base, tip, q) = ARMS.iter().find(|arm| arm.0 == robot).expect("an arm of the list");
    let chain =
        embedded::get(robot).expect("an embedded robot").chain(base, tip).expect("a chain of that robot");
    (chain, q)
}

/// Forward kinematics and geometric Jacobian of one arm.
fn kinematics(robot: &str) -> Work {
    let (chain, q) = arm(robot);
    let mut scratch = chain.scratch();
    let mut columns = vec![Vector6::zeros(); chain.dof()];
    Box::new(move || {
        let posed = chain.forward(black_box(q), &mut scratch);
        posed.geometric_jacobian(&mut columns);
        black_box(&columns);
        posed.pose().translation.x
    })
}

/// Gram matrix, factorisation, solution and bound of the smallest singular value of one 6 x 7 Jacobian.
fn solve() -> Work {
    let (chain, q) = arm("panda");
    let mut columns = vec![Vector6::zeros(); chain.dof()];
    chain.forward(q, &mut chain.scratch()).geometric_jacobian(&mut columns);
    Box::new(move || {
        let gram = GramCholesky::<6>::new(black_box(&columns)).expect("a regular configuration");
        gram.solve(black_box(&[1.0, 2.0, 3.0, 4.0, 5.0, 6.0]))[0] + gram.smallest_singular_value_bound()
    })
}

fn panda(side: f64) -> (Chain, &'static [f64]) {
    let (chain, q) = arm("panda");
    (chain.mounted(&IsometryMatrix3::new(Vector3::new(0.0, side, 0.0), Vector3::zeros())), q)
}

/// A circle from where the arm stands.
fn circle(chain: &Chain, q: &[f64], steps: usize) -> Motion {
    let start = chain.forward(q, &mut chain.scratch()).pose();
    Motion::from_pose(Planar::whole(Circle { radius: 0.05 }), Sin2, steps as f64 * SIGMA, &start)
}

/// Makes planners of Pandas side by side on full-pose circles.
fn pandas(
    arms: usize,
    formula: &'static str,
    h: f64,
    steps: usize,
    is_sampled: bool,
) -> impl Fn() -> Planner {
    let pandas = (0..arms).map(|i| panda(0.5 * i as f64)).map(|(chain, q)| (chain, q.to_vec()));
    plans_of(pandas.collect(), formula, h, steps, is_sampled)
}

/// Makes planners of arms on full-pose circles.
fn plans_of(
    arms: Vec<(Chain, Vec<f64>)>,
    formula: &'static str,
    h: f64,
    steps: usize,
    is_sampled: bool,
) -> impl Fn() -> Planner {
    let formula = FormulaTable::builtin().get(formula).expect("a row of the built-in table");
    let sample = |motion: &Motion| (0..=steps).map(|n| motion.at(n as f64 * SIGMA)).collect();
    let samples: Vec<Arc<[Reference]>> =
        arms.iter().map(|(chain, q)| sample(&circle(chain, q, steps))).collect();
    move || {
        let arms = arms.iter().zip(&samples).enumerate().map(|(i, ((chain, q), samples))| {
            let sampled = || Motion::sampled(Arc::clone(samples), SIGMA);
            let motion = if is_sampled { sampled() } else { circle(chain, q, steps) };
            Arm::new(format!("arm {i}"), chain.clone(), q.clone(), TaskKind::Pose, motion)
        });
        let builder = Planner::builder().formula(formula).sigma(SIGMA).duration(steps as f64 * SIGMA).h(h);
        builder.start(Starter::Paper).arms(arms).build().expect("a plan within range")
    }
}

/// One step: kinematics, Jacobians, errors, solves, checks and history.
fn steps(arms: usize, formula: &'static str, h: f64, is_sampled: bool) -> Work {
    stepped(pandas(arms, formula, h, STEPS, is_sampled))
}

fn stepped(begin: impl Fn() -> Planner + 'static) -> Work {
    let mut running = begin();
    Box::new(move || {
        if running.is_finished() {
            if let Some(stop) = running.stop() {
                panic!("what is measured is no step: {}", stop.reason);
            }
            running = begin();
        }
        running.step();
        running.arm(0).positions[0]
    })
}

/// One step of so many plans of two Pandas at once.
fn batch(plans: usize) -> Work {
    let begin = pandas(2, "la6-wang-guo", 0.4, STEPS, true);
    let all = move || Batch::new((0..plans).map(|_| begin()));
    let mut running = all();
    Box::new(move || {
        if running.is_finished() {
            running = all();
        }
        running.step();
        running.arm(0, 0).positions[0]
    })
}

/// Four plans of two arms and 2,000 steps, made, run and recorded: 8,000 steps.
fn plans(run: fn(Vec<Planner>) -> Vec<Plan>) -> Work {
    let begin = pandas(2, "la6-wang-guo", 0.4, 2000, true);
    Box::new(move || run((0..4).map(|_| begin()).collect())[3].arms[1].max_error)
}
