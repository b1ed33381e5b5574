//! Problems solved from start to end.

use kinstep::formula::FormulaTable;
use kinstep::integrate::{
    Direction, Event, Family, Field, IntegrateError, Method, Mode, Ode, Solution, SolveStatus, Solver,
    VariableOrder,
};
use kinstep::math::DoubleDouble;
use proptest::prelude::*;
use std::f64::consts::PI;

fn swing(rate: f64) -> Ode<impl FnMut(f64, &[f64], &mut [f64])> {
    Ode::new(2, move |_t, x: &[f64], f: &mut [f64]| {
        f[0] = rate * x[1];
        f[1] = -rate * x[0];
    })
}

/// Decays to the cosine, at a rate that makes it stiff or not.
fn decay(rate: f64) -> Ode<impl FnMut(f64, &[f64], &mut [f64])> {
    Ode::new(1, move |t: f64, x: &[f64], f: &mut [f64]| f[0] = -rate * (x[0] - t.cos()) - t.sin())
}

fn solvers() -> [Solver<'static, f64>; 3] {
    [Solver::automatic(), Solver::family(Family::ADAMS), Solver::family(Family::BDF)]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    /// Forwards and backwards, by every family, at every tolerance, between steps and at their ends.
    #[test]
    fn solutions_keep_to_their_tolerances(
        power in 3..11_i32, rate in 0.5..4.0_f64, start in -3.0..3.0_f64, length in 2.0..8.0_f64,
        backwards: bool, between in 0.0..1.0_f64,
    ) {
        let tolerance = 10_f64.powi(-power);
        let end = if backwards { start - length } else { start + length };
        let exact = |t: f64| [(rate * t).sin(), (rate * t).cos()];
        for solver in solvers() {
            let within = start + between * (end - start);
            let solver = solver.tolerance(tolerance, tolerance).sample_at([within, start, end]).dense();
            let solution = solver.solve(&mut swing(rate), start, &exact(start), end).unwrap();
            prop_assert_eq!((solution.status, solution.t), (SolveStatus::Completed, end));
            prop_assert_eq!(&solution.samples[2].x, &solution.x);
            prop_assert_eq!(solution.at(within), Some(solution.samples[1].x.clone()));
            for sample in &solution.samples {
                let apart = (0..2).map(|i| (sample.x[i] - exact(sample.t)[i]).abs()).fold(0.0, f64::max);
                prop_assert!(apart <= 100.0 * tolerance * rate * length, "{} {apart:e} at {}", solution.method, sample.t);
            }
        }
    }

    /// Every zero of a sine is met, in its direction, and no other.
    #[test]
    fn events_are_met_where_they_are(rate in 0.5..4.0_f64, shift in 0.05..0.95_f64, backwards: bool) {
        let end = if backwards { -10.0 } else { 10.0 };
        let value = |t: f64| (rate * t + shift * PI).sin();
        let mut zeros: Vec<f64> = (-40..40).map(|k| (f64::from(k) - shift) * PI / rate).filter(|t| t * (t - end) < 0.0).collect();
        zeros.sort_by(|a, b| a.abs().total_cmp(&b.abs()));
        let rises = |t: f64| ((rate * t + shift * PI).cos() > 0.0) != backwards;
        for solver in solvers() {
            let event = |name: &str, direction| Event::new(name, |_t, x: &[f64]| x[0]).direction(direction);
            let solver = solver
                .tolerance(1e-9, 1e-9)
                .event(event("any", Direction::Any))
                .event(event("up", Direction::Rising))
                .event(event("down", Direction::Falling));
            let solution = solver.solve(&mut swing(rate), 0.0, &[value(0.0), (shift * PI).cos()], end).unwrap();
            let met = |name: &str| -> Vec<f64> {
                solution.events.iter().filter(|event| event.name == name).map(|event| event.t).collect()
            };
            let near = |found: Vec<f64>, wanted: Vec<f64>| {
                found.len() == wanted.len() && found.iter().zip(&wanted).all(|(a, b)| (a - b).abs() < 1e-6)
            };
            prop_assert!(near(met("any"), zeros.clone()), "{:?} {:?}", met("any"), zeros);
            prop_assert!(near(met("up"), zeros.iter().copied().filter(|&t| rises(t)).collect()));
            prop_assert!(near(met("down"), zeros.iter().copied().filter(|&t| !rises(t)).collect()));
            prop_assert!(solution.events.iter().all(|event| event.x[0].abs() < 1e-12));
        }
    }
}

#[test]
fn a_terminal_event_ends_a_solution_and_what_comes_behind_is_not_told() {
    let mut ball = Ode::new(2, |_t, x: &[f64], f: &mut [f64]| f.copy_from_slice(&[x[1], -9.81]));
    for solver in solvers() {
        let ground = Event::new("ground", |_t, x: &[f64]| x[0]).direction(Direction::Falling).terminal();
        let late = Event::new("late", |t, _x: &[f64]| t - 2.5);
        let solver =
            solver.tolerance(1e-9, 1e-9).event(ground).event(late).sample_at([1.0, 3.0]).keep_steps();
        let solution = solver.solve(&mut ball, 0.0, &[0.0, 9.81], 5.0).unwrap();
        assert_eq!(solution.status, SolveStatus::Event);
        assert!((solution.t - 2.0).abs() < 1e-8 && solution.x[0].abs() < 1e-12);
        assert_eq!((solution.samples.len(), solution.events.len()), (1, 1));
        assert_eq!(solution.steps.last().unwrap().t, solution.t);
    }
}

#[test]
fn events_that_are_zero_all_the_time_or_never_do_not_happen() {
    let solver = Solver::automatic()
        .event(Event::new("always", |_t, _x: &[f64]| 0.0))
        .event(Event::new("never", |_t, _x: &[f64]| 1.0));
    let solver = solver.event(Event::new("nowhere", |_t, _x: &[f64]| f64::NAN));
    let solution = solver.solve(&mut swing(1.0), 0.0, &[0.0, 1.0], 10.0).unwrap();
    assert_eq!((solution.status, solution.events.len()), (SolveStatus::Completed, 0));
}

fn evaluations_and_error(solution: &Solution<f64>, exact: &[f64]) -> (usize, f64) {
    let apart = solution.x.iter().zip(exact).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    (solution.statistics.evaluations, apart)
}

#[test]
fn a_stiff_problem_is_recognised_and_handed_over() {
    let solve = |solver: Solver<'_, f64>| {
        let solution = solver.tolerance(1e-6, 1e-6).solve(&mut decay(1e5), 0.0, &[0.0], 10.0).unwrap();
        assert_eq!(solution.status, SolveStatus::Completed);
        solution
    };
    let automatic = solve(Solver::automatic());
    let (evaluations, error) = evaluations_and_error(&automatic, &[10_f64.cos()]);
    assert_eq!(automatic.method, "adams+bdf");
    assert!(evaluations < 2000 && error < 1e-4, "{evaluations} {error:e}");
    let explicit = solve(Solver::family(Family::ADAMS));
    assert!(explicit.warnings[0].starts_with("stiff from about t = "), "{:?}", explicit.warnings);
    assert!(explicit.statistics.evaluations > 100 * evaluations);
    // What is not stiff stays where it is.
    let plain =
        Solver::automatic().tolerance(1e-9, 1e-9).solve(&mut swing(1.0), 0.0, &[0.0, 1.0], 50.0).unwrap();
    assert_eq!((plain.method.as_str(), plain.warnings.len()), ("adams", 0));
}

#[test]
fn what_can_not_go_on_says_why_and_keeps_what_it_has() {
    let mut explosion = Ode::new(1, |_t, x: &[f64], f: &mut [f64]| f[0] = x[0] * x[0]);
    let mut wall = Ode::new(1, |t, _x: &[f64], f: &mut [f64]| f[0] = if t < 1.0 { 1.0 } else { f64::NAN });
    for family in Family::ALL {
        let solution =
            Solver::family(family).sample_at([0.5, 1.5]).solve(&mut explosion, 0.0, &[1.0], 2.0).unwrap();
        assert!(!solution.status.is_success(), "{family} {:?}", solution.status);
        assert!((solution.t - 1.0).abs() < 1e-3 && solution.reason.is_some());
        assert!((solution.samples[0].x[0] - 2.0).abs() < 1e-4);
        let solution = Solver::family(family).solve(&mut wall, 0.0, &[0.0], 2.0).unwrap();
        assert!((solution.t - 1.0).abs() < 1e-9 && (solution.x[0] - 1.0).abs() < 1e-6);
        assert!(!solution.status.is_success(), "{family} {:?}", solution.status);
    }
    let solution = Solver::automatic().most_steps(7).solve(&mut swing(1.0), 0.0, &[0.0, 1.0], 100.0).unwrap();
    assert_eq!((solution.status, solution.statistics.steps), (SolveStatus::TooManySteps, 7));
}

#[test]
fn a_step_in_the_right_hand_side_is_passed() {
    let mut switch = Ode::new(1, |t, _x: &[f64], f: &mut [f64]| f[0] = if t < 1.0 { 1.0 } else { -2.0 });
    for family in Family::ALL {
        let solution =
            Solver::family(family).tolerance(1e-8, 1e-8).solve(&mut switch, 0.0, &[0.0], 3.0).unwrap();
        assert_eq!(solution.status, SolveStatus::Completed);
        assert!((solution.x[0] + 3.0).abs() < 1e-5, "{family} {:e}", solution.x[0] + 3.0);
    }
}

/// A method in equal steps is that of the stepper, with the same polynomials, samples and events.
#[test]
fn any_method_of_the_table_solves_in_equal_steps() {
    let table = FormulaTable::builtin();
    let row = |id: &str| table.get(id).unwrap();
    let methods = [
        Method::of(row("ab4")),
        Method::of(row("la6-wang-guo")),
        Method::of(row("bdf4")),
        Method::pair(row("ab4"), row("am3"), Mode::Pece),
    ];
    for method in methods {
        let order = method.row().order() as f64;
        let error = |steps: f64| {
            let zero = Event::new("zero", |_t, x: &[f64]| x[0]);
            let solver = Solver::method(method.clone(), 5.0 / steps).event(zero).sample_at([2.345]);
            let solution = solver.solve(&mut swing(1.0), 0.0, &[0.0, 1.0], 5.0).unwrap();
            assert_eq!((solution.statistics.steps as f64, solution.status), (steps, SolveStatus::Completed));
            let errors = [
                solution.x[0] - 5_f64.sin(),
                solution.samples[0].x[0] - 2.345_f64.sin(),
                solution.events[0].t - PI,
            ];
            errors.map(f64::abs).into_iter().fold(0.0, f64::max)
        };
        let (coarse, fine) = (error(100.0), error(200.0));
        assert!(fine < 1e-4 && fine < coarse / 2_f64.powf(order - 0.9), "{order} {coarse:e} {fine:e}");
    }
}

#[test]
fn extended_numbers_are_solved_to_their_own_tolerances() {
    let number = DoubleDouble::from;
    let mut decay = Ode::new(1, |_t: DoubleDouble, x: &[DoubleDouble], f: &mut [DoubleDouble]| f[0] = -x[0]);
    let solver = Solver::automatic().tolerance(1e-22, 1e-22);
    let solution = solver.solve(&mut decay, number(0.0), &[number(1.0)], number(1.0)).unwrap();
    let euler = kinstep::integrate::Elementary::exp(number(-1.0));
    assert!((solution.x[0] - euler).to_f64().abs() < 1e-20, "{:?}", solution.x);
}

/// A Jacobian that the field has is used instead of differences.
#[test]
fn a_jacobian_of_the_fields_own_saves_evaluations() {
    struct Robertson {
        has_jacobian: bool,
    }
    impl Field<f64> for Robertson {
        fn dimension(&self) -> usize {
            3
        }
        fn evaluate(&mut self, _t: f64, x: &[f64], f: &mut [f64], _g: &mut [f64]) {
            f[0] = -0.04 * x[0] + 1e4 * x[1] * x[2];
            f[2] = 3e7 * x[1] * x[1];
            f[1] = -f[0] - f[2];
        }
        fn jacobian(&mut self, _t: f64, x: &[f64], jacobian: &mut [f64]) -> bool {
            let (first, third) = ([-0.04, 1e4 * x[2], 1e4 * x[1]], [0.0, 6e7 * x[1], 0.0]);
            for j in 0..3 {
                jacobian[j] = first[j];
                jacobian[3 + j] = -first[j] - third[j];
                jacobian[6 + j] = third[j];
            }
            self.has_jacobian
        }
    }
    let solve = |has_jacobian: bool| {
        let solver = Solver::family(Family::BDF).tolerances(1e-8, &[1e-14, 1e-20, 1e-14]);
        solver.solve(&mut Robertson { has_jacobian }, 0.0, &[1.0, 0.0, 0.0], 1e11).unwrap()
    };
    // Mazzia and Magherini, Test Set for Initial Value Problem Solvers, release 2.4, problem ROBER.
    let exact = [0.208_334_014_970_125_5e-7, 0.833_336_077_033_471_3e-13, 0.999_999_979_166_505];
    let (own, differences) = (solve(true), solve(false));
    for solution in [&own, &differences] {
        let relative = solution.x.iter().zip(exact).map(|(a, b)| (a / b - 1.0).abs()).fold(0.0, f64::max);
        assert!(relative < 1e-4, "{relative:e}");
    }
    assert!(own.statistics.evaluations < differences.statistics.evaluations && own.statistics.jacobians > 0);
}

#[test]
fn a_stepper_makes_one_step_at_a_time() {
    let mut field = swing(1.0);
    let mut stepper =
        VariableOrder::new(Family::ADAMS, &mut field, 0.0, &[0.0, 1.0], 10.0, 1e-10, &[1e-10]).unwrap();
    let mut last = 0.0;
    while stepper.time() < 10.0 {
        assert_eq!(stepper.advance(&mut field), None);
        assert!((stepper.time() - last - stepper.last_step()).abs() < 1e-14 && stepper.last_order() <= 12);
        last = stepper.time();
    }
    assert_eq!(stepper.time(), 10.0);
    assert_eq!(stepper.statistics().orders.iter().sum::<usize>(), stepper.statistics().steps);
}

#[test]
fn what_can_not_be_solved_is_refused_with_the_reason() {
    let refused = |solver: Solver<'_, f64>, x0: &[f64], end: f64| -> IntegrateError {
        solver.solve(&mut swing(1.0), 0.0, x0, end).unwrap_err()
    };
    let (start, solver) = ([0.0, 1.0], Solver::automatic);
    let said = |error: IntegrateError| error.to_string();
    assert!(said(refused(solver(), &[0.0], 1.0)).contains("1 entries"));
    assert!(said(refused(solver(), &[0.0, f64::NAN], 1.0)).contains("entry 1 of the initial state is NaN"));
    assert!(said(refused(solver(), &start, 0.0)).contains("range of time"));
    assert!(said(refused(solver(), &start, f64::INFINITY)).contains("range of time"));
    assert!(
        said(refused(solver().tolerance(-1e-3, 1.0), &start, 1.0)).contains("relative tolerance is -0.001")
    );
    assert!(
        said(refused(solver().tolerance(1e-3, f64::NAN), &start, 1.0)).contains("absolute tolerance is NaN")
    );
    assert!(said(refused(solver().tolerance(0.0, 0.0), &start, 1.0)).contains("both zero"));
    assert!(
        said(refused(solver().tolerances(1e-3, &[1.0, 1.0, 1.0]), &start, 1.0))
            .contains("absolute tolerances")
    );
    assert!(said(refused(solver().sample_at([2.0]), &start, 1.0)).contains("beyond the range"));
    assert!(said(refused(solver().largest_step(0.0), &start, 1.0)).contains("sampling gap"));
    let row = FormulaTable::builtin().get("ab4").unwrap();
    assert!(said(refused(Solver::method(Method::of(row), f64::NAN), &start, 1.0)).contains("sampling gap"));
}
