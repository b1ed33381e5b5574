//! Noise in the loop makes of the task error what the formulas' noise gains say.
#![allow(clippy::unwrap_used, reason = "a test that can not go on stops")]

use kinstep::formula::{Formula, FormulaTable};
use kinstep::nalgebra::{Vector3, Vector6};
use kinstep::planner::{Arm, Noise, Plan, Planner, PlannerBuilder, PlannerError, run_together};
use kinstep::robot::{Chain, embedded};
use kinstep::task::{Circle, Motion, Planar, Quintic, TaskKind};
use kinstep_strategies::{ArmCase, arms, paths};
use proptest::prelude::*;

const SIGMA: f64 = 0.004;
const STEPS: usize = 4000;
/// Samples after which the start is forgotten by every loop here.
const FORGOTTEN: usize = 400;
/// The largest spectral radius of the loops here: those that remember longer have fewer independent samples.
const RADIUS: f64 = 0.9;

const START: [f64; 7] = [0.0, -0.6, 0.0, -2.2, 0.0, 1.6, 0.8];

fn panda() -> Chain {
    embedded::get("panda").unwrap().chain("panda_link0", "panda_link8").unwrap()
}

fn motion(chain: &Chain, duration: f64) -> Motion {
    let start = chain.forward(&START, &mut chain.scratch()).pose();
    Motion::from_pose(Planar::whole(Circle { radius: 0.02 }), Quintic, duration, &start)
}

/// A Panda that goes round a small circle slowly, with its orientation held.
fn builder(formula: &Formula) -> PlannerBuilder {
    let (chain, duration) = (panda(), SIGMA * STEPS as f64);
    let motion = motion(&chain, duration);
    let arm = Arm::new("arm", chain, START.to_vec(), TaskKind::Pose, motion);
    Planner::builder().formula(formula).sigma(SIGMA).duration(duration).arm(arm)
}

/// A row in eight of those that may run and whose loops forget quickly at their best steps.
fn rows() -> impl Iterator<Item = (&'static Formula, f64)> {
    let optimum = |row: &'static Formula| row.optimum().map(|optimum| (row, optimum.h, optimum.radius));
    let usable = FormulaTable::builtin().iter().filter(|row| row.runnable_with_feedback().is_ok());
    usable.filter_map(optimum).filter(|&(.., radius)| radius <= RADIUS).map(|(row, h, _)| (row, h)).step_by(8)
}

/// The mean squares of the position and of the orientation errors, summed over three components each.
fn mean_squares(plan: &Plan) -> [f64; 2] {
    assert!(plan.is_completed(), "{:?}", plan.reason);
    let errors = &plan.arms[0].errors[FORGOTTEN..];
    [0, 3].map(|first| {
        let square = |error: &Vector6<f64>| error.fixed_rows::<3>(first).norm_squared();
        errors.iter().map(square).sum::<f64>() / errors.len() as f64
    })
}

/// Five standard deviations of a root mean square of that many independent streams of samples, each of which depends on
/// its past as much as a loop of that radius lets it.
fn tolerance(row: &Formula, h: f64, streams: f64) -> f64 {
    let square = row.spectral_radius(h).powi(2);
    5.0 * ((1.0 + square) / (1.0 - square) / (2.0 * streams * (STEPS - FORGOTTEN) as f64)).sqrt()
}

fn assert_near(measured: f64, predicted: f64, tolerance: f64, of: &str) {
    let ratio = measured / predicted;
    assert!(
        (ratio - 1.0).abs() < tolerance,
        "{of}: {measured:.4e} measured, {predicted:.4e} predicted ({ratio:.4})"
    );
}

#[test]
fn noise_in_the_measured_residual_gives_the_error_that_the_gain_says() {
    let noise = Noise { seed: 1, position: 1e-6, orientation: 3e-6, ..Noise::default() };
    for (row, h) in rows() {
        let [position, orientation] = mean_squares(&builder(row).noise(noise).build().unwrap().run());
        let gain = row.noise_gain(h).unwrap().residual * 3.0_f64.sqrt();
        let tolerance = tolerance(row, h, 3.0);
        assert_near(position.sqrt(), gain * noise.position, tolerance, row.id());
        assert_near(orientation.sqrt(), gain * noise.orientation, tolerance, row.id());
    }
}

#[test]
fn noise_in_the_streamed_velocity_gives_the_error_that_the_gain_says() {
    let noise = Noise { seed: 2, linear_velocity: 1e-4, angular_velocity: 4e-4, ..Noise::default() };
    for (row, h) in rows() {
        let [position, orientation] = mean_squares(&builder(row).noise(noise).build().unwrap().run());
        let gain = SIGMA * row.noise_gain(h).unwrap().feedforward_per_sigma * 3.0_f64.sqrt();
        let tolerance = tolerance(row, h, 3.0);
        assert_near(position.sqrt(), gain * noise.linear_velocity, tolerance, row.id());
        assert_near(orientation.sqrt(), gain * noise.angular_velocity, tolerance, row.id());
    }
}

#[test]
fn noise_in_the_measured_joints_gives_the_error_that_the_gain_says() {
    let noise = Noise { seed: 3, joints: 1e-6, ..Noise::default() };
    for (row, h) in rows() {
        let gain = row.noise_gain(h).unwrap().state * noise.joints;
        // A deadbeat loop of one step lets none of it through: only its own error is left to be seen.
        if gain == 0.0 {
            continue;
        }
        let plan = builder(row).noise(noise).build().unwrap().run();
        // The components of the error depend on each other: counted as one stream.
        let tolerance = tolerance(row, h, 1.0);
        for (measured, columns) in mean_squares(&plan).into_iter().zip(mean_squares_of_columns(&plan)) {
            assert_near(measured.sqrt(), gain * columns.sqrt(), tolerance, row.id());
        }
    }
}

/// What a joint's noise does to the tip is its column of the Jacobian: the sum of the squares of their upper and of their
/// lower halves, on average over the way.
fn mean_squares_of_columns(plan: &Plan) -> [f64; 2] {
    let chain = panda();
    let (mut columns, mut scratch) = (vec![Vector6::zeros(); chain.dof()], chain.scratch());
    let samples: Vec<usize> = (0..plan.samples()).step_by(100).collect();
    let mut sums = [0.0; 2];
    for &n in &samples {
        chain.forward(plan.arms[0].position(n), &mut scratch).geometric_jacobian(&mut columns);
        for (sum, first) in sums.iter_mut().zip([0, 3]) {
            *sum += columns.iter().map(|column| column.fixed_rows::<3>(first).norm_squared()).sum::<f64>();
        }
    }
    sums.map(|sum| sum / samples.len() as f64)
}

fn any_noise() -> Noise {
    Noise {
        seed: 5,
        position: 1e-5,
        orientation: 1e-5,
        linear_velocity: 1e-4,
        angular_velocity: 1e-4,
        joints: 1e-5,
    }
}

fn short(noise: Noise) -> Planner {
    builder(FormulaTable::builtin().get("la6-wang-guo").unwrap()).duration(2.0).noise(noise).build().unwrap()
}

#[test]
fn no_noise_is_no_change_and_a_seed_is_a_promise() {
    let of = |plan: &Plan| (plan.arms[0].positions.clone(), plan.arms[0].velocities.clone());
    let quiet = short(Noise::default()).run();
    assert_eq!(quiet.noise, None);
    assert_eq!(of(&quiet), of(&short(Noise { seed: 9, ..Noise::default() }).run()));
    let loud = short(any_noise()).run();
    assert_eq!(loud.noise, Some(any_noise()));
    assert_ne!(of(&quiet), of(&loud));
    assert_ne!(of(&loud), of(&short(Noise { seed: 6, ..any_noise() }).run()));
    // Quiet and noisy plans in any company.
    let company = [any_noise(), Noise::default(), any_noise(), Noise::default(), any_noise()].map(short);
    let together = run_together(company.into());
    for (plan, alone) in together.iter().zip([&loud, &quiet, &loud, &quiet, &loud]) {
        assert_eq!((of(plan), plan.arms[0].rms_error_steady), (of(alone), alone.arms[0].rms_error_steady));
    }
}

#[test]
fn the_errors_stated_are_those_of_the_positions_sent() {
    let plan = short(any_noise()).run();
    let (chain, arm) = (panda(), &plan.arms[0]);
    let motion = motion(&chain, SIGMA * STEPS as f64);
    for n in 0..plan.samples() {
        let tip = chain.forward(arm.position(n), &mut chain.scratch()).pose();
        let error = TaskKind::Pose.error(&tip, &motion.at(plan.time(n)));
        assert!((error - arm.errors[n]).norm() < 1e-14, "sample {n}");
    }
    let half = &arm.errors[plan.samples() / 2..];
    let rms = (half.iter().map(Vector6::norm_squared).sum::<f64>() / half.len() as f64).sqrt();
    assert!((arm.rms_error_steady / rms - 1.0).abs() < 1e-12);
}

/// Two arms on a common torso, sent about with noise.
#[test]
fn arms_that_share_joints_suffer_noise_and_state_their_true_errors() {
    let robot = embedded::get("torso14").unwrap();
    let q0 = |side: f64| vec![0.2, 0.1, -0.58 * side, -0.82, -0.7, -1.36 * side, 0.68, 0.08 * side];
    let part = |tip: &str, side: f64| {
        let chain = robot.chain("floor", tip).unwrap();
        let start = chain.forward(&q0(side), &mut chain.scratch()).pose();
        let motion = Motion::from_pose(Planar::whole(Circle { radius: 0.05 }), Quintic, 2.0, &start);
        (chain, motion)
    };
    let parts = || [("left_tool", 1.0), ("right_tool", -1.0)].map(|(tip, side)| (tip, side, part(tip, side)));
    let arms = parts().map(|(tip, side, (chain, motion))| {
        Arm::new(tip, chain, q0(side), TaskKind::Pose, motion).on_machine("torso")
    });
    let formula = FormulaTable::builtin().get("la6-wang-guo").unwrap();
    let builder = Planner::builder().formula(formula).sigma(SIGMA).duration(2.0).arms(arms);
    let plan = builder.noise(any_noise()).build().unwrap().run();
    assert!(plan.is_completed() && plan.shared.len() == 1);
    let last = plan.samples() - 1;
    assert_eq!(plan.arms[0].position(last)[..2], plan.arms[1].position(last)[..2], "one torso");
    for (arm, (_, _, (chain, motion))) in plan.arms.iter().zip(parts()) {
        assert!(arm.rms_error_steady > 1e-6, "{}", arm.rms_error_steady);
        let tip = chain.forward(arm.position(last), &mut chain.scratch()).pose();
        let error = TaskKind::Pose.error(&tip, &motion.at(plan.time(last)));
        assert!((error - arm.errors[last]).norm() < 1e-14);
    }
}

#[test]
fn what_is_no_standard_deviation_is_refused() {
    let formula = FormulaTable::builtin().get("la6-wang-guo").unwrap();
    for value in [-1e-3, f64::NAN, f64::INFINITY] {
        let error = builder(formula).noise(Noise { joints: value, ..Noise::default() }).build().unwrap_err();
        assert!(matches!(error, PlannerError::Noise { what: "joints", .. }), "{error}");
        assert!(error.to_string().contains("zero or positive"), "{error}");
    }
}

/// The errors of a random arm under noise in its residual, in units of that noise, by the component of the task.
fn of_random_arm(arm: &ArmCase, motion: Motion, duration: f64) -> Option<f64> {
    let row = FormulaTable::builtin().get("split-ab4").unwrap();
    let noise = Noise { seed: 4, position: 1e-6, ..Noise::default() };
    let arm = Arm::new("arm", arm.chain()?, arm.q0(), arm.task, motion);
    let builder = Planner::builder().formula(row).sigma(duration / STEPS as f64).duration(duration).arm(arm);
    let plan = builder.noise(noise).h(0.5).build().ok()?.run();
    plan.is_completed().then(|| mean_squares(&plan)[0].sqrt() / noise.position)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(6))]

    #[test]
    fn random_arms_let_through_what_the_gain_says(arm in arms(), path in paths()) {
        let chain = arm.chain().unwrap();
        let start = chain.forward(&arm.q0(), &mut chain.scratch()).pose();
        let (smallest, _) = arm.singular_values(&chain, &arm.q0());
        // Slowly enough that nothing but the noise is seen.
        let motion = Motion::from_pose(path.path(0.2 * smallest), Quintic, 40.0, &start);
        let Some(measured) = of_random_arm(&arm, motion, 40.0) else { return Ok(()) };
        let row = FormulaTable::builtin().get("split-ab4").unwrap();
        let components = arm.task.rows().min(3) as f64;
        let predicted = row.noise_gain(0.5).unwrap().residual * components.sqrt();
        prop_assert!((measured / predicted - 1.0).abs() < tolerance(row, 0.5, components), "{} {}", measured, predicted);
    }
}

#[test]
fn the_axis_of_a_disturbance_does_not_matter_at_rest() {
    // A line of no length: the arm stands still, and all that moves it is noise.
    let chain = panda();
    let start = chain.forward(&START, &mut chain.scratch()).pose();
    let rest =
        Motion::from_pose(kinstep::task::Line { displacement: Vector3::zeros() }, Quintic, 32.0, &start);
    let arm = Arm::new("arm", chain, START.to_vec(), TaskKind::Position, rest);
    let row = FormulaTable::builtin().get("split-ab6").unwrap();
    let noise = Noise { seed: 8, position: 1e-6, ..Noise::default() };
    let builder = Planner::builder().formula(row).sigma(SIGMA).duration(32.0).h(1.0).arm(arm).noise(noise);
    let plan = builder.build().unwrap().run();
    // With the deadbeat step the error is the noise of the sample before, and no more.
    for axis in 0..3 {
        let errors = plan.arms[0].errors.iter().skip(FORGOTTEN).map(|error| error[axis].powi(2));
        let rms = (errors.sum::<f64>() / (plan.samples() - FORGOTTEN) as f64).sqrt();
        assert_near(rms, noise.position, 5.0 / (2.0 * STEPS as f64).sqrt(), "split-ab6");
    }
}
