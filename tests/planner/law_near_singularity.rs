//! What the least-norm law promises near singularities, on random arms and chains that are nearly stretched out.
#![allow(clippy::unwrap_used, reason = "a test that can not go on stops")]

use kinstep::law::{Instant, JointVelocity, Law, Pseudoinverse, Resolution, SystemShape};
use kinstep::nalgebra::{DMatrix, Vector6};
use kinstep::task::TaskRows;
use kinstep_strategies::{ConfigurationCase, away_from_singularity, towards_singularity};
use proptest::prelude::*;

const THRESHOLD: f64 = 1e-4;

/// The columns of the Jacobian, the joint velocities for a unit task velocity, and what the law says of them.
fn resolve(
    case: &ConfigurationCase,
    direction: [f64; 6],
) -> (Vec<Vector6<f64>>, Vec<f64>, Vector6<f64>, Resolution) {
    let chain = case.chain().unwrap();
    let mut columns = vec![Vector6::zeros(); chain.dof()];
    chain.forward(&case.q, &mut chain.scratch()).geometric_jacobian(&mut columns);
    let rows = case.task.rows();
    let wanted = Vector6::from_fn(|row, _| if row < rows { direction[row] } else { 0.0 });
    let wanted = wanted / wanted.norm().max(1e-3);
    let mut law = Pseudoinverse::new().with_threshold(THRESHOLD);
    law.prepare(&SystemShape::of_one_task(rows, chain.dof(), chain.reach()));
    let (mut f, mut g) = (vec![0.0; chain.dof()], vec![0.0; chain.dof()]);
    let rest = vec![0.0; chain.dof()];
    let task = TaskRows {
        feedforward: wanted.as_slice()[..rows].to_vec(),
        jacobian: DMatrix::from_fn(rows, chain.dof(), |row, column| columns[column][row]),
        ..TaskRows::zeros(rows, chain.dof())
    };
    let instant = Instant {
        t: 0.0,
        sigma: 0.01,
        is_sample: true,
        q: &case.q,
        previous_velocity: &rest,
        limits: &[],
        tasks: &[task],
        tips: &[],
        next: None,
        avoidance: None,
    };
    let mut answer = JointVelocity { feedforward: &mut f, feedback: &mut g };
    let resolution = law.resolve(&instant, &mut answer).unwrap();
    assert!(g.iter().all(|velocity| *velocity == 0.0));
    (columns, f, wanted, resolution)
}

/// By how much the task velocity is missed.
fn missed(case: &ConfigurationCase, columns: &[Vector6<f64>], f: &[f64], wanted: &Vector6<f64>) -> f64 {
    let reached: Vector6<f64> = columns.iter().zip(f).map(|(column, velocity)| column * *velocity).sum();
    (reached - wanted).rows(0, case.task.rows()).norm()
}

fn norm(velocities: &[f64]) -> f64 {
    velocities.iter().map(|velocity| velocity * velocity).sum::<f64>().sqrt()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn velocities_are_bounded_by_the_threshold_however_near_the_singularity_is(
        case in towards_singularity(), direction in prop::array::uniform6(-1.0..1.0),
    ) {
        let (columns, f, wanted, resolution) = resolve(&case, direction);
        let (smallest, largest) = case.singular_values();
        // What is said of the smallest singular value is never more than it is.
        prop_assert!(resolution.smallest_singular_value <= smallest * (1.0 + 1e-6) + 1e-14 * largest);
        prop_assert_eq!(resolution.damped, smallest < THRESHOLD, "{}", smallest);
        prop_assert!(norm(&f) <= 1.0 / THRESHOLD * (1.0 + 1e-9));
        if !resolution.damped {
            let condition = largest / smallest;
            prop_assert!(missed(&case, &columns, &f, &wanted) <= 1e-14 * condition * condition.max(10.0));
        }
    }

    #[test]
    fn away_from_singularity_the_task_is_met_and_nothing_is_damped(
        case in away_from_singularity(), direction in prop::array::uniform6(-1.0..1.0),
    ) {
        let (columns, f, wanted, resolution) = resolve(&case, direction);
        prop_assert!(!resolution.damped && missed(&case, &columns, &f, &wanted) < 1e-11);
        prop_assert!(norm(&f) <= 1.0 / case.singular_values().0 * (1.0 + 1e-9));
    }
}
