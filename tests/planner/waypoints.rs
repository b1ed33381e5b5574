//! Paths through waypoints: against SciPy, against differences, and how smooth they are.
#![allow(clippy::unwrap_used, reason = "a test that can not go on stops")]

use kinstep::formula::FormulaTable;
use kinstep::integrate::StarterKind;
use kinstep::kind::Parameters;
use kinstep::math::rotation_vector;
use kinstep::nalgebra::{DMatrix, DVector, Quaternion, Rotation3, UnitQuaternion, Vector3};
use kinstep::planner::{Arm, Plan, Planner};
use kinstep::robot::embedded;
use kinstep::task::{
    Ends, Motion, Path, Polyline, QuinticSpline, RotationSpline, SCurve, Sin2Sin2, Spline, TIME_LAWS,
    TaskKind, TimeLaw, Trapezoid, Waypoints,
};
use proptest::prelude::*;
use serde_json::Value;

fn figures() -> Value {
    serde_json::from_str(include_str!("../data/scipy_splines.json")).unwrap()
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|number| number.as_f64().unwrap()).collect()
}

fn vectors(value: &Value) -> Vec<Vector3<f64>> {
    value.as_array().unwrap().iter().map(|row| Vector3::from_vec(numbers(row))).collect()
}

fn rotations(value: &Value) -> Vec<Rotation3<f64>> {
    let rotation = |row: &Value| {
        let q = numbers(row);
        UnitQuaternion::from_quaternion(Quaternion::new(q[3], q[0], q[1], q[2])).to_rotation_matrix()
    };
    value.as_array().unwrap().iter().map(rotation).collect()
}

fn distance(one: &Rotation3<f64>, other: &Rotation3<f64>) -> f64 {
    rotation_vector(&(one * other.inverse())).norm()
}

#[test]
fn quintic_splines_and_all_their_derivatives_are_those_of_scipy() {
    for case in figures()["quintic"].as_array().unwrap() {
        let ends = Ends::ALL.into_iter().find(|ends| ends.name() == case["ends"]).unwrap();
        let spline = QuinticSpline::new(&numbers(&case["knots"]), &vectors(&case["points"]), ends);
        for (order, theirs) in case["derivatives"].as_array().unwrap().iter().enumerate() {
            let theirs = vectors(theirs);
            let largest = theirs.iter().map(Vector3::norm).fold(0.0, f64::max);
            for (at, theirs) in numbers(&case["at"]).into_iter().zip(theirs) {
                let off = (spline.derivative(at, order) - theirs).norm() / largest;
                assert!(off < 1e-10, "{} {order} {at}: {off:e}", ends.name());
            }
        }
    }
}

#[test]
fn straight_ways_turn_as_slerp_does_and_a_spline_turns_as_another_one_through_many_orientations() {
    let case = &figures()["orientations"];
    let (knots, through) = (numbers(&case["knots"]), rotations(&case["quaternions"]));
    let points = knots.iter().map(|&s| Vector3::x() * s).collect();
    let waypoints = Waypoints::new(points, Some(through.clone()), Some(knots.clone())).unwrap();
    // Blends that end before the places that are looked at.
    let polyline = Polyline::through(&waypoints, 1e-5).unwrap();
    let spline = RotationSpline::new(&knots, &through, Ends::Natural);
    let theirs = ["slerp", "rotation_spline"].map(|name| rotations(&case[name]));
    let rates = vectors(&case["rotation_spline_rate"]);
    for (k, at) in numbers(&case["at"]).into_iter().enumerate() {
        let is_at_corner = knots.iter().any(|knot| (knot - at).abs() < 1e-3);
        if !is_at_corner {
            let turn = polyline.turn(at).0 * through[0];
            assert!(distance(&turn, &theirs[0][k]) < 1e-14, "{at}");
        }
        let (rotation, rate) = spline.at(at);
        // Near the ends theirs takes the rates to be even.
        if !(0.2..0.8).contains(&at) {
            continue;
        }
        let off = distance(&rotation, &theirs[1][k]);
        assert!(off < 3e-6, "{at}: {off:e}");
        let off = (rotation.inverse() * rate - rates[k]).norm();
        assert!(off < 3e-4, "{at}: {off:e}");
    }
}

/// Points, orientations and increasing parameters drawn at random, with turns of up to 2.5 rad between neighbours.
fn drawn() -> impl Strategy<Value = (Vec<Vector3<f64>>, Vec<Rotation3<f64>>, Vec<f64>)> {
    let vector = || prop::array::uniform3(-1.0..1.0_f64).prop_map(Vector3::from);
    let one = (vector(), vector(), 0.3..1.0_f64);
    prop::collection::vec(one, 3..9).prop_map(|all| {
        let (mut turned, mut s) = (Rotation3::identity(), 0.0);
        let mut drawn = (Vec::new(), Vec::new(), Vec::new());
        for (point, turn, step) in all {
            turned *= Rotation3::new(turn.cap_magnitude(1.0) * 2.5);
            s += step;
            drawn.0.push(point);
            drawn.1.push(turned);
            drawn.2.push(s);
        }
        drawn
    })
}

/// The same as a spline, and as polylines with blends and with stops.
fn paths(
    (points, rotations, knots): (Vec<Vector3<f64>>, Vec<Rotation3<f64>>, Vec<f64>),
) -> Vec<Box<dyn Path>> {
    let waypoints = Waypoints::new(points, Some(rotations), Some(knots)).unwrap();
    let shortest = waypoints.chords().iter().copied().fold(f64::MAX, f64::min);
    let speeds =
        waypoints.knots().windows(2).zip(waypoints.chords()).map(|(pair, chord)| chord / (pair[1] - pair[0]));
    let (slowest, fastest) = speeds.fold((f64::MAX, 0.0_f64), |(low, high), v| (low.min(v), high.max(v)));
    let blend = 0.4 * shortest * slowest / fastest;
    vec![
        Box::new(Spline::through(&waypoints, Ends::Natural).unwrap()),
        Box::new(Spline::through(&waypoints, Ends::Clamped).unwrap()),
        Box::new(Polyline::through(&waypoints, blend).unwrap()),
        Box::new(Polyline::through(&waypoints, 0.0).unwrap()),
    ]
}

/// The first four derivatives at `s`, of the polynomial through nine places to one side.
fn one_sided(f: &dyn Fn(f64) -> Vector3<f64>, s: f64, step: f64) -> [Vector3<f64>; 5] {
    let matrix = DMatrix::from_fn(9, 9, |row, column| (row as f64).powf(column as f64));
    let lu = matrix.lu();
    let mut derivatives = [Vector3::zeros(); 5];
    for axis in 0..3 {
        let values = DVector::from_fn(9, |row, _| f(s + step * (row as f64 + 1e-9))[axis]);
        let coefficients = lu.solve(&values).unwrap();
        let mut factorial = 1.0;
        for (order, derivative) in derivatives.iter_mut().enumerate() {
            factorial *= (order as f64).max(1.0);
            derivative[axis] = coefficients[order] * factorial / step.powf(order as f64);
        }
    }
    derivatives
}

/// How far the derivatives jump at `s`, by their sizes.
fn jumps(f: &dyn Fn(f64) -> Vector3<f64>, s: f64, step: f64) -> [f64; 5] {
    let (before, behind) = (one_sided(f, s, -step), one_sided(f, s, step));
    std::array::from_fn(|order| {
        (before[order] - behind[order]).norm() / (1.0 + before[order].norm().max(behind[order].norm()))
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn rates_are_the_derivatives_of_poses(all in drawn(), u in 0.01..0.99_f64) {
        let step = 1e-6;
        for path in paths(all) {
            let [before, behind] = [u - step, u + step].map(|u| (path.point(u).position, path.turn(u).0));
            let tangent = path.point(u).tangent;
            prop_assert!(((behind.0 - before.0) / (2.0 * step) - tangent).norm() < 1e-6 * (1.0 + tangent.norm()));
            let (turn, spin) = path.turn(u);
            let difference = rotation_vector(&(behind.1 * before.1.inverse())) / (2.0 * step);
            prop_assert!((difference - spin).norm() < 1e-6 * (1.0 + spin.norm()), "{difference} {spin}");
            prop_assert!((turn.matrix() * turn.matrix().transpose() - kinstep::nalgebra::Matrix3::identity()).norm() < 1e-13);
        }
    }

    #[test]
    fn waypoints_are_met(all in drawn()) {
        let (points, rotations, _) = all.clone();
        let waypoints = Waypoints::new(points.clone(), None, Some(all.2.clone())).unwrap();
        let knots = waypoints.knots().to_vec();
        for (k, path) in paths(all).iter().enumerate().filter(|(k, _)| *k != 2) {
            for (i, &u) in knots.iter().enumerate() {
                prop_assert!((path.point(u).position - points[i]).norm() < 1e-11, "{k} {i}");
                let turned = path.turn(u).0 * rotations[0];
                prop_assert!(distance(&turned, &rotations[i]) < 1e-11, "{k} {i}");
            }
            prop_assert!(distance(&path.initial_orientation().unwrap(), &rotations[0]) < 1e-15);
        }
    }

    #[test]
    fn positions_have_four_continuous_derivatives_and_no_fifth(all in drawn()) {
        for ends in [Ends::Natural, Ends::Clamped, Ends::Periodic] {
            let mut points = all.0.clone();
            if ends == Ends::Periodic {
                *points.last_mut().unwrap() = points[0];
            }
            let spline = QuinticSpline::new(&all.2, &points, ends);
            let mut fifth = 0.0_f64;
            let seam = (ends == Ends::Periodic).then(|| (all.2[all.2.len() - 1] - 1e-12, all.2[0]));
            for (before, behind) in all.2[1..all.2.len() - 1].iter().map(|&s| (s - 1e-12, s)).chain(seam) {
                for order in 0..=4 {
                    let [a, b] = [before, behind].map(|s| spline.derivative(s, order));
                    prop_assert!((a - b).norm() < 1e-7 * (1.0 + a.norm()), "{} {order}", ends.name());
                }
                fifth = fifth.max((spline.derivative(before, 5) - spline.derivative(behind, 5)).norm());
            }
            prop_assert!(fifth > 1e-3 || points.len() == 3);
        }
    }

    #[test]
    fn angular_velocities_have_two_continuous_derivatives(all in drawn()) {
        for ends in [Ends::Natural, Ends::Periodic] {
            let mut turned = all.1.clone();
            let last = turned.len() - 1;
            if ends == Ends::Periodic {
                turned[last] = turned[0];
                prop_assume!(distance(&turned[last - 1], &turned[0]) < 3.0);
            }
            let spline = RotationSpline::new(&all.2, &turned, ends);
            let rate = |s: f64| spline.at(s).1;
            for &s in &all.2[1..last] {
                let jumps = jumps(&rate, s, 0.004);
                prop_assert!(jumps[0] < 1e-6 && jumps[1] < 1e-4 && jumps[2] < 1e-2, "{jumps:?}");
            }
            if ends == Ends::Periodic {
                let (end, begin) = (one_sided(&rate, all.2[last], -0.004), one_sided(&rate, all.2[0], 0.004));
                for (order, most) in [1e-6, 1e-4, 1e-2].into_iter().enumerate() {
                    let size = 1.0 + begin[order].norm();
                    prop_assert!((end[order] - begin[order]).norm() < most * size, "{order}");
                }
            }
        }
    }

    #[test]
    fn turns_do_not_depend_on_the_axes_of_world_and_tip(
        all in drawn(), world in prop::array::uniform3(-2.0..2.0_f64), tip in prop::array::uniform3(-2.0..2.0_f64), u in 0.0..1.0_f64,
    ) {
        let [world, tip] = [world, tip].map(|vector| Rotation3::new(Vector3::from(vector)));
        let s = all.2[0] + u * (all.2[all.2.len() - 1] - all.2[0]);
        let (plain, spin) = RotationSpline::new(&all.2, &all.1, Ends::Natural).at(s);
        let moved: Vec<_> = all.1.iter().map(|rotation| world * rotation * tip).collect();
        let (turned, turned_spin) = RotationSpline::new(&all.2, &moved, Ends::Natural).at(s);
        prop_assert!(distance(&turned, &(world * plain * tip)) < 1e-9);
        prop_assert!((turned_spin - world * spin).norm() < 1e-8 * (1.0 + spin.norm()));
    }

    #[test]
    fn an_even_turn_stays_even_beyond_a_whole_one(
        axis in prop::array::uniform3(-1.0..1.0_f64), angle in 0.1..2.9_f64, u in 0.0..1.0_f64,
    ) {
        let axis = Vector3::from(axis);
        prop_assume!(axis.norm() > 0.1);
        let axis = axis.normalize();
        let knots = [0.0, 1.0, 2.0, 3.0, 4.0, 5.0];
        let turned = knots.map(|s| Rotation3::new(axis * (angle * s)));
        let (rotation, rate) = RotationSpline::new(&knots, &turned, Ends::Natural).at(5.0 * u);
        prop_assert!(distance(&rotation, &Rotation3::new(axis * (angle * 5.0 * u))) < 1e-11);
        prop_assert!((rate - axis * angle).norm() < 1e-10);
    }

    #[test]
    fn blends_have_four_continuous_derivatives_and_leave_corners_out_as_told(blend in 0.05..0.5_f64, turn in 0.2..2.8_f64) {
        let corner = Vector3::x();
        let points = vec![Vector3::zeros(), corner, corner + Vector3::new(turn.cos(), turn.sin(), 0.0)];
        let polyline = Polyline::through(&Waypoints::new(points, None, None).unwrap(), blend).unwrap();
        let point = |u: f64| polyline.point(u).position;
        for edge in [0.5 - 0.5 * blend, 0.5 + 0.5 * blend] {
            let jumps = jumps(&point, edge, 0.05 * blend);
            prop_assert!(jumps.iter().all(|&jump| jump < 1e-2), "{jumps:?}");
        }
        let passed = (point(0.5) - corner).norm();
        prop_assert!((passed - 35.0 / 128.0 * blend * (turn / 2.0).sin()).abs() < 1e-12);
        prop_assert!((point(0.2 * (1.0 - blend)) - Vector3::x() * (0.4 * (1.0 - blend))).norm() < 1e-14);
    }
}

#[test]
fn a_polyline_without_blends_stops_in_its_corners() {
    let points = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0]].map(Vector3::from).to_vec();
    let polyline = Polyline::through(&Waypoints::new(points, None, None).unwrap(), 0.0).unwrap();
    let corner = polyline.point(0.5);
    assert_eq!((corner.position, corner.tangent), (Vector3::x(), Vector3::zeros()));
    assert!(polyline.point(0.25).tangent.norm() > 4.0);
    let jumps = jumps(&|u: f64| polyline.point(u).position, 0.5, 0.02);
    assert!(jumps[3] < 1e-6 && jumps[4] > 0.5, "{jumps:?}");
}

#[test]
fn what_does_not_fit_is_refused_with_what_would() {
    let points =
        [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 0.3, 0.0], [2.0, 0.3, 0.0]].map(Vector3::from).to_vec();
    let waypoints = Waypoints::new(points.clone(), None, None).unwrap();
    let refused = Polyline::through(&waypoints, 0.2).unwrap_err();
    assert_eq!(refused, "blend = 0.2 m does not fit between points[1] and points[2]; at most 0.15 m does");
    assert!(Polyline::through(&waypoints, 0.15).is_ok());
    assert!(
        Spline::through(&waypoints, Ends::Periodic)
            .unwrap_err()
            .starts_with("points[3] is 2.022e0 m and 0.000e0 rad")
    );
    let two = Waypoints::new(points[..2].to_vec(), None, None).unwrap();
    assert!(Spline::through(&two, Ends::Natural).unwrap_err().starts_with("points[2] is missing"));
}

/// The smoothness that laws declare is that of their derivatives.
#[test]
fn time_laws_are_as_smooth_as_they_say() {
    let tau = 1.0 / 3.0;
    for kind in TIME_LAWS {
        let law: Box<dyn TimeLaw> = (kind.make)(&Parameters::new());
        let jumps = jumps(&|tau: f64| Vector3::x() * law.progress(tau).0, tau, 0.01);
        let smooth = law.smoothness().unwrap_or(4);
        assert!(jumps[..=smooth].iter().all(|&jump| jump < 1e-3), "{} {jumps:?}", kind.name);
        assert!(smooth == 4 || jumps[smooth + 1] > 0.1, "{} {jumps:?}", kind.name);
    }
}

/// A planar arm along a spline through four points.
fn run_along_a_spline(formula: &str, law: Box<dyn TimeLaw>, steps: usize) -> Plan {
    let chain = embedded::get("planar4").unwrap().chain("base", "tip").unwrap();
    let q0 = vec![0.3, 0.3, 0.3, 0.3];
    let start = chain.forward(&q0, &mut chain.scratch()).pose();
    let points = [[0.0, 0.0, 0.0], [0.1, 0.05, 0.0], [0.15, -0.1, 0.0], [0.05, -0.2, 0.0]].map(Vector3::from);
    let path = Spline::through(&Waypoints::new(points.to_vec(), None, None).unwrap(), Ends::Natural).unwrap();
    let motion = Motion::from_pose(path, law, 2.0, &start);
    let formula = FormulaTable::builtin().get(formula).unwrap();
    let planner = Planner::builder()
        .formula(formula)
        .sigma(2.0 / steps as f64)
        .duration(2.0)
        .start(StarterKind::Rk8.into())
        .arm(Arm::new("arm", chain, q0, TaskKind::PositionXy, motion));
    let planner = match formula.optimum() {
        Some(optimum) => planner.h(0.5 * optimum.h),
        None => planner,
    };
    planner.build().unwrap().run()
}

/// With `k` continuous derivatives errors fall like the power `k + 1`, or that of the formula at a fixed h if it is less.
#[test]
fn formulas_show_as_much_of_their_order_as_the_path_is_smooth() {
    type Made = fn() -> Box<dyn TimeLaw>;
    let laws: [(Made, f64); 3] = [
        (|| Box::new(Sin2Sin2), 5.0),
        (|| Box::new(SCurve { ramp: 0.25, rounding: 1.0 }), 3.0),
        (|| Box::new(Trapezoid { ramp: 0.25 }), 2.0),
    ];
    for formula in ["la6-wang-guo", "split-ab4", "split-ab5"] {
        let order = FormulaTable::builtin().get(formula).unwrap().order() as f64;
        for (law, most) in laws {
            let [coarse, fine] =
                [400, 3200].map(|steps| run_along_a_spline(formula, law(), steps).arms[0].max_error);
            let slope = (coarse / fine).log2() / 3.0;
            let expected = most.min(order + 1.0);
            assert!((slope - expected).abs() < 0.35, "{formula} {expected}: {slope}");
        }
    }
    let plan = run_along_a_spline("split-ab5", Box::new(Sin2Sin2), 100);
    assert_eq!(plan.smoothness, Some(4));
    assert!(
        plan.warnings.iter().any(|warning| warning.contains("O(sigma^5) at best")),
        "{:?}",
        plan.warnings
    );
    let plan = run_along_a_spline("split-ab4", Box::new(Sin2Sin2), 100);
    assert!(plan.warnings.is_empty(), "{:?}", plan.warnings);
}
