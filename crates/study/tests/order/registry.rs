//! The table is walked: every row has the tests of its kind, on every code path and with every start, and none of them was written
//! for that row. A row without a kind, or a kind without a test, can not exist.
#![allow(clippy::unwrap_used, reason = "a test that can not go on stops")]

use kinstep::formula::{Formula, FormulaTable, RootCondition};
use kinstep::integrate::{Elementary, Field, Multistep, Parts, Starter};
use kinstep::math::DoubleDouble;
use kinstep::planner::{Arm, Planner};
use kinstep::robot::{Chain, embedded};
use kinstep::task::{Circle, Motion, Planar, Plane, Sin2, TaskKind};
use kinstep_study::{Convergence, Criteria, Ladder, Mark, OrderStudy, Orders, Rung};
use rayon::prelude::*;
use std::f64::consts::TAU;

const DURATION: f64 = 4.0;

/// What a row can be asked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    /// It runs, with feedback too.
    StrictlyStable,
    /// It runs without feedback.
    WeaklyStable,
    /// Its refusal is its test.
    Unstable,
    /// It runs on equations, not on arms: its order is that of its defect too.
    Implicit,
}

fn kind(formula: &Formula) -> Kind {
    match (formula.root_condition(), formula.is_explicit()) {
        (RootCondition::Unstable, _) => Kind::Unstable,
        (_, false) => Kind::Implicit,
        (RootCondition::StrictlyStable, true) => Kind::StrictlyStable,
        (RootCondition::WeaklyStable, true) => Kind::WeaklyStable,
    }
}

fn rows(wanted: Kind) -> Vec<&'static Formula> {
    FormulaTable::builtin().iter().filter(|formula| kind(formula) == wanted).collect()
}

fn step(formula: &Formula) -> f64 {
    formula.optimum().map_or(0.5 * formula.feedback_range().value().min(1.0), |optimum| optimum.h)
}

/// Ladders to be tried one after the other: a loop that forgets slowly shows its order late.
fn ladders(order: usize) -> [Ladder; 2] {
    let (coarse, fine) = match order {
        0..=3 => (Ladder::halvings(DURATION, 128, 5), Ladder::halvings(DURATION, 1024, 5)),
        4 => (Ladder::half_octaves(DURATION, 128, 9), Ladder::half_octaves(DURATION, 512, 9)),
        5 => (Ladder::half_octaves(DURATION, 128, 9), Ladder::half_octaves(DURATION, 384, 9)),
        _ => (Ladder::half_octaves(DURATION, 48, 11), Ladder::half_octaves(DURATION, 64, 17)),
    };
    [coarse.unwrap(), fine.unwrap()]
}

/// Runs a study on one ladder after the other until it decides, and returns what stands in the way of the order.
///
/// Where a row of high order has a slow loop, doubles end before the loop has come into its own: the errors pass from the
/// row's order towards one more and meet the floor on the way.
fn shortfall(name: &str, order: usize, study: impl Fn(&Ladder) -> Convergence) -> Option<String> {
    let mut said = String::new();
    for ladder in ladders(order) {
        let seen = study(&ladder);
        let on_the_way = order >= 6
            && seen.marks.last() == Some(&Mark::NearFloor)
            && seen.finest_slope().is_some_and(|slope| slope > order as f64 - 1.2);
        if seen.verdict.is_confirmed() || on_the_way {
            return None;
        }
        said = format!("{name}, order {order}: {}\n  {:?}\n  {:?}", seen.verdict, seen.errors, seen.slopes);
    }
    Some(said)
}

fn assert_none(shortfalls: Vec<Option<String>>) {
    let shortfalls: Vec<String> = shortfalls.into_iter().flatten().collect();
    assert!(shortfalls.is_empty(), "{}\n{} in all", shortfalls.join("\n"), shortfalls.len());
}

#[test]
fn every_row_is_of_one_kind_and_every_kind_has_rows() {
    let kinds = [Kind::StrictlyStable, Kind::WeaklyStable, Kind::Unstable, Kind::Implicit];
    let counts = kinds.map(|kind| rows(kind).len());
    assert_eq!(counts.iter().sum::<usize>(), FormulaTable::builtin().len());
    assert!(counts.iter().all(|&count| count > 0), "{counts:?}");
    assert!(rows(Kind::StrictlyStable).iter().all(|row| row.runnable_with_feedback().is_ok()));
}

struct Place {
    name: &'static str,
    chain: Chain,
    q0: Vec<f64>,
    task: TaskKind,
    plane: Plane,
    radius: f64,
}

fn places() -> [Place; 2] {
    let robot = |name: &str, base: &str, tip: &str| embedded::get(name).unwrap().chain(base, tip).unwrap();
    [
        Place {
            name: "planar",
            chain: robot("planar4", "base", "tip"),
            q0: vec![0.3, 0.5, 0.6, 0.7],
            task: TaskKind::PositionXy,
            plane: Plane::Xy,
            radius: 0.2,
        },
        Place {
            name: "spatial",
            chain: robot("panda", "panda_link0", "panda_hand_tcp"),
            q0: vec![0.1, -0.8, 0.0, -2.3, 0.1, 1.6, 0.8],
            task: TaskKind::Pose,
            plane: Plane::Yz,
            radius: 0.05,
        },
    ]
}

/// A circle that accelerates at once, so that a start of low order shows.
fn on_a_circle(
    place: &Place,
    formula: &Formula,
    h: f64,
    start: &Starter<f64>,
    claimed: usize,
    ladder: &Ladder,
) -> Convergence {
    let claims = Orders { task: Some(claimed), ..Orders::default() };
    let report = OrderStudy::new(ladder.clone()).claiming(claims).of_planner(|sigma| {
        let pose = place.chain.forward(&place.q0, &mut place.chain.scratch()).pose();
        let path = Planar::new(Circle { radius: place.radius }, place.plane, 0.3, 0.0, TAU);
        let motion = Motion::from_pose(path, Sin2, DURATION, &pose);
        let arm = Arm::new("arm", place.chain.clone(), place.q0.clone(), place.task, motion);
        let builder = Planner::builder().formula(formula).sigma(sigma).duration(DURATION).h(h);
        builder.start(start.clone()).arm(arm).build()
    });
    report.unwrap().task_transient.unwrap()
}

fn walk_on_arms(starts: &[Starter<f64>], claimed: impl Fn(&Formula) -> usize + Sync) {
    let places = places();
    let (places, claimed) = (&places, &claimed);
    let walks = rows(Kind::StrictlyStable).into_par_iter().flat_map_iter(|formula| {
        places.iter().flat_map(move |place| starts.iter().map(move |start| (formula, place, start)))
    });
    let walk = |(formula, place, start): (&Formula, &Place, &Starter<f64>)| {
        let name = format!("{} on the {} arm from {start:?}", formula.id(), place.name);
        let order = claimed(formula);
        shortfall(&name, order, |ladder| on_a_circle(place, formula, step(formula), start, order, ladder))
    };
    assert_none(walks.map(walk).collect());
}

#[test]
fn strictly_stable_rows_show_one_order_more_on_both_arms_from_both_good_starts() {
    walk_on_arms(&[Starter::Sufficient, Starter::Rk8], |formula| formula.order() + 1);
}

#[test]
fn strictly_stable_rows_show_what_an_euler_start_leaves() {
    let multistep = |formula: &Formula| if formula.steps() > 1 { 2 } else { formula.order() + 1 };
    walk_on_arms(&[Starter::Paper, Starter::Ramp], multistep);
}

/// A number that is led along exp(sin t): x' = phi' - k (x - phi), the feedback in the second part.
struct Led<T> {
    gain: T,
}

impl<T: Elementary> Field<T> for Led<T> {
    fn dimension(&self) -> usize {
        1
    }

    fn parts(&self) -> Parts {
        Parts::Feedback
    }

    fn evaluate(&mut self, t: T, x: &[T], f: &mut [T], g: &mut [T]) {
        let (sine, cosine) = t.sin_cos();
        let phi = sine.exp();
        f[0] = phi * cosine;
        g[0] = -self.gain * (x[0] - phi);
    }
}

/// The largest error of a led number.
fn led<T: Elementary>(formula: &Formula, rung: Rung) -> f64 {
    let sigma = T::from_extended(DoubleDouble::from(DURATION)) / T::from_index(rung.steps);
    let gain = T::from_extended(DoubleDouble::from(step(formula)))
        / (sigma * T::from_rational(&formula.gamma_sum()));
    let mut field = Led { gain };
    let starter = Starter::sufficient_for(formula.order());
    let mut stepper = Multistep::new(formula, &starter, &field, T::zero(), sigma, &[T::one()]).unwrap();
    let mut most = 0.0_f64;
    for _ in 0..rung.steps {
        stepper.step(&mut field);
        let phi = stepper.time().sin_cos().0.exp();
        most = most.max((stepper.state()[0] - phi).to_extended().to_f64().abs());
    }
    most
}

#[test]
fn strictly_stable_rows_lead_a_number_with_one_order_more() {
    let walk = |formula: &&Formula| {
        let order = formula.order() + 1;
        let seen = |ladder: &Ladder| {
            // High orders show with 32 digits, where the floor is out of the way.
            let (run, floor) = if order > 4 {
                (led::<DoubleDouble> as fn(&Formula, Rung) -> f64, 1e-29)
            } else {
                (led::<f64> as fn(&Formula, Rung) -> f64, 1e-14)
            };
            let errors: Vec<f64> = ladder.rungs().map(|rung| run(formula, rung)).collect();
            Convergence::judge(&ladder.sigmas(), &errors, floor, Some(order), &Criteria::default())
        };
        let ladders = if order > 4 {
            [Ladder::halvings(DURATION, 512, 3), Ladder::half_octaves(DURATION, 4096, 4)]
        } else {
            [Ladder::halvings(DURATION, 512, 5), Ladder::halvings(DURATION, 2048, 5)]
        };
        let [coarse, fine] = ladders.map(Result::unwrap);
        let seen =
            Some(seen(&coarse)).filter(|seen| seen.verdict.is_confirmed()).unwrap_or_else(|| seen(&fine));
        (!seen.verdict.is_confirmed())
            .then(|| format!("{}: {} {:?} {:?}", formula.id(), seen.verdict, seen.errors, seen.slopes))
    };
    assert_none(rows(Kind::StrictlyStable).par_iter().map(walk).collect());
}

#[test]
fn weakly_stable_rows_run_on_arms_without_feedback_and_are_refused_with_it() {
    let place = &places()[0];
    for formula in rows(Kind::WeaklyStable) {
        let order = formula.order();
        let missing = shortfall(formula.id(), order, |ladder| {
            on_a_circle(place, formula, 0.0, &Starter::Sufficient, order, ladder)
        });
        assert_none(vec![missing]);
        assert!(formula.runnable_with_feedback().is_err() || !formula.feedback_range().is_empty());
    }
}

#[test]
fn unstable_and_implicit_rows_are_refused_by_name_by_arms() {
    for formula in rows(Kind::Unstable).into_iter().chain(rows(Kind::Implicit)) {
        let field = Led { gain: 1.0_f64 };
        let refused = Multistep::new(formula, &Starter::Rk8, &field, 0.0, 0.1, &[1.0]).unwrap_err();
        assert!(refused.to_string().contains(formula.id()), "{refused}");
        let place = &places()[0];
        let pose = place.chain.forward(&place.q0, &mut place.chain.scratch()).pose();
        let motion = Motion::from_pose(Planar::whole(Circle { radius: 0.1 }), Sin2, DURATION, &pose);
        let arm = Arm::new("arm", place.chain.clone(), place.q0.clone(), place.task, motion);
        let builder = Planner::builder().formula(formula).sigma(0.01).duration(DURATION).h(0.1).arm(arm);
        assert!(builder.build().is_err(), "{}", formula.id());
    }
}

/// The largest defect of a row on exp(sin t): what is left of its recursion when exact values are put in.
fn defect(formula: &Formula, sigma: f64) -> f64 {
    let sigma = DoubleDouble::from(sigma);
    let weights = |row: &[kinstep::math::Rational]| -> Vec<DoubleDouble> {
        row.iter().map(DoubleDouble::from_rational).collect()
    };
    let (alpha, beta) = (weights(formula.alpha()), weights(formula.beta()));
    let at = |n: u8| {
        let mut sum = DoubleDouble::from(0.0);
        for (j, (&alpha, &beta)) in alpha.iter().zip(&beta).enumerate() {
            let t = DoubleDouble::from(f64::from(n)) + sigma * DoubleDouble::from(1.0 - j as f64);
            let (sine, cosine) = t.sin_cos();
            let phi = sine.exp();
            sum += alpha * phi - sigma * beta * phi * cosine;
        }
        sum.to_f64().abs()
    };
    (0..6).map(at).fold(0.0, f64::max)
}

#[test]
fn every_row_whatever_its_kind_has_the_defect_of_its_order() {
    let sigmas: Vec<f64> = (0..9).map(|k| 0.04 / f64::from(1 << k)).collect();
    for formula in FormulaTable::builtin() {
        let errors: Vec<f64> = sigmas.iter().map(|&sigma| defect(formula, sigma)).collect();
        let order = formula.order() + 1;
        let judge = |order| Convergence::judge(&sigmas, &errors, 1e-31, Some(order), &Criteria::default());
        let seen = judge(order);
        assert!(seen.verdict.is_confirmed(), "{}: {} {:?}", formula.id(), seen.verdict, seen.slopes);
        assert!(judge(order + 1).verdict.is_not_reached(), "{}", formula.id());
    }
}
