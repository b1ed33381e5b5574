//! Arms that start off their paths: brought in by the feedback, or led there.
#![allow(clippy::unwrap_used)]

use kinstep::formula::FormulaTable;
use kinstep::nalgebra::{IsometryMatrix3, Vector3};
use kinstep::planner::{Arm, Planner, PlannerBuilder, PlannerError};
use kinstep::robot::embedded;
use kinstep::task::{Circle, Motion, Planar, Sin2, TaskKind};

const SIGMA: f64 = 0.01;

/// A planar arm whose circle begins so far from its tip \[m\].
fn arm(off: f64) -> Arm {
    let chain = embedded::get("planar4").unwrap().chain("base", "tip").unwrap();
    let q0 = vec![0.3, 0.4, 0.5, 0.6];
    let start = chain.forward(&q0, &mut chain.scratch()).pose();
    let center = start.translation.vector - Vector3::new(0.2 - off, 0.0, 0.0);
    let circle = Planar::whole(Circle { radius: 0.2 });
    let motion = Motion::centered(circle, Sin2, 2.0, center, IsometryMatrix3::identity().rotation);
    Arm::new("arm", chain, q0, TaskKind::PositionXy, motion)
}

fn planner(arm: Arm) -> PlannerBuilder {
    let formula = FormulaTable::builtin().get("la6-wang-guo").unwrap();
    Planner::builder().formula(formula).sigma(SIGMA).h(0.4).duration(2.0).arm(arm)
}

#[test]
fn the_feedback_brings_an_arm_in_as_fast_as_its_loop_says() {
    let off = 0.05;
    let plan = planner(arm(off).converging_to(1e-6)).build().unwrap().run();
    let found = plan.arms[0].convergence.clone().unwrap();
    assert!((found.initial_error - off).abs() < 1e-12 && plan.has_converged(), "{found:?}");
    let formula = FormulaTable::builtin().get("la6-wang-guo").unwrap();
    assert_eq!(found.factor, formula.spectral_radius(0.4));
    // The law of the loop holds up to a constant, and from where the start has ended.
    let (reached, predicted) = (found.reached.unwrap(), found.predicted);
    assert!(reached > 0.5 * predicted && reached < 2.0 * predicted + 10.0 * SIGMA, "{reached} {predicted}");
    assert!(
        plan.arms[0].max_error <= 1e-6 && plan.arms[0].errors[0].norm() > 0.04,
        "the transient counts apart"
    );
    // Without leave it is refused, and so is what no feedback brings in.
    assert!(matches!(planner(arm(off)).build(), Err(PlannerError::PathStart { .. })));
    assert!(matches!(planner(arm(0.9).converging_to(1e-6)).build(), Err(PlannerError::TooFar { .. })));
    // A tolerance that no row keeps is not said to be kept.
    let plan = planner(arm(off).converging_to(1e-300)).build().unwrap().run();
    assert!(
        !plan.has_converged() && plan.warnings.iter().any(|warning| warning.contains("did not stay within"))
    );
}

#[test]
fn an_arm_is_led_from_rest_to_rest_before_its_path_begins() {
    let there = arm(0.0);
    let from = vec![0.5, 0.1, 0.9, 0.2];
    let plan = planner(arm(0.0).with_lead(from.clone(), 0.5)).build().unwrap().run();
    let plain = planner(there).build().unwrap().run();
    assert_eq!((plan.lead, plan.samples(), plan.steps), (50, plain.samples() + 50, plain.steps + 50));
    let (own, other) = (&plan.arms[0], &plain.arms[0]);
    assert_eq!(own.position(0), from);
    assert!(own.velocity(0).iter().all(|v| *v == 0.0));
    // The path is the same, bit by bit, half a second later.
    assert_eq!(own.position(50), other.position(0));
    assert_eq!(own.positions[50 * 4..], other.positions[..]);
    assert_eq!(own.max_error, other.max_error);
    // Velocities are those of the positions, and no sample jumps.
    for n in 1..=50 {
        for joint in 0..4 {
            let mean = (own.position(n)[joint] - own.position(n - 1)[joint]) / SIGMA;
            let declared = f64::midpoint(own.velocity(n)[joint], own.velocity(n - 1)[joint]);
            assert!((mean - declared).abs() < 0.01, "{n} {joint}: {mean} {declared}");
        }
    }
    let again = arm(0.0).with_lead(from, 0.5);
    let times: Vec<f64> = (0..plan.samples()).map(|n| plan.time(n)).collect();
    assert_eq!(again.on_path_from(&times, &own.errors), 50);
    let mut scratch = again.chain().scratch();
    let error = again.task_error(plan.time(120), own.position(120), &mut scratch);
    assert!((error - own.errors[120]).norm() < 1e-12, "the path waits for the arm");
}
