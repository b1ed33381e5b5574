use super::problem::dot;
use super::*;
use clarabel::algebra::CscMatrix;
use clarabel::solver::{DefaultSettings, DefaultSolver, IPSolver, NonnegativeConeT, SolverStatus, ZeroConeT};
use proptest::prelude::*;

/// A problem that owns its numbers.
#[derive(Clone, Debug)]
struct Case {
    target: Vec<f64>,
    equalities: Vec<f64>,
    values: Vec<f64>,
    lower: Vec<f64>,
    upper: Vec<f64>,
    inequalities: Vec<f64>,
    bounds: Vec<f64>,
}

impl Case {
    fn problem(&self) -> LeastDistance<'_> {
        LeastDistance {
            target: &self.target,
            equalities: &self.equalities,
            values: &self.values,
            lower: &self.lower,
            upper: &self.upper,
            inequalities: &self.inequalities,
            bounds: &self.bounds,
        }
    }

    /// All that is not an equality as rows `n x <= value`.
    fn rows(&self) -> Vec<(Vec<f64>, f64)> {
        let n = self.target.len();
        let unit = |j: usize, sign: f64| (0..n).map(|i| if i == j { sign } else { 0.0 }).collect::<Vec<_>>();
        let upper = (0..n).map(|j| (unit(j, 1.0), self.upper[j]));
        let lower = (0..n).map(|j| (unit(j, -1.0), -self.lower[j]));
        let others = self.inequalities.chunks(n).map(<[f64]>::to_vec).zip(self.bounds.iter().copied());
        upper.chain(lower).chain(others).filter(|(_, value)| value.is_finite()).collect()
    }

    /// What another solver finds, if it is certain; `Err` where it is certain that there is nothing.
    fn by_clarabel(&self) -> Option<Result<Vec<f64>, ()>> {
        let n = self.target.len();
        let mut rows: Vec<(Vec<f64>, f64)> =
            self.equalities.chunks(n).map(<[f64]>::to_vec).zip(self.values.iter().copied()).collect();
        let equalities = rows.len();
        rows.extend(self.rows());
        let dense: Vec<Vec<f64>> = rows.iter().map(|(row, _)| row.clone()).collect();
        let a = CscMatrix::from(&dense);
        let b: Vec<f64> = rows.iter().map(|(_, value)| *value).collect();
        let q: Vec<f64> = self.target.iter().map(|c| -c).collect();
        let cones = [ZeroConeT(equalities), NonnegativeConeT(rows.len() - equalities)];
        let settings = DefaultSettings {
            verbose: false,
            tol_gap_abs: 1e-14,
            tol_gap_rel: 1e-14,
            tol_feas: 1e-14,
            ..DefaultSettings::default()
        };
        let mut solver = DefaultSolver::new(&CscMatrix::identity(n), &q, &a, &b, &cones, settings).ok()?;
        solver.solve();
        match solver.solution.status {
            SolverStatus::Solved => Some(Ok(solver.solution.x.clone())),
            SolverStatus::PrimalInfeasible => Some(Err(())),
            _ => None,
        }
    }
}

/// Problems with many bounds that are active, some of them pinned or open, and inequalities.
fn cases() -> impl Strategy<Value = Case> {
    (2..9_usize, 0..4_usize, 0..5_usize).prop_flat_map(|(n, m, p)| {
        let list = |count: usize| proptest::collection::vec(-1.0..1.0_f64, count);
        let range = proptest::collection::vec((0..8_u8, -0.6..0.2_f64, 0.0..0.8_f64), n);
        let m = m.min(n - 1);
        (list(n), list(n * m), list(m), range, list(n * p), list(p)).prop_map(
            |(target, equalities, values, range, inequalities, bounds)| Case {
                target: target.iter().map(|c| 2.0 * c).collect(),
                equalities,
                values,
                lower: range
                    .iter()
                    .map(|(kind, low, _)| if *kind == 0 { f64::NEG_INFINITY } else { *low })
                    .collect(),
                upper: range
                    .iter()
                    .map(|(kind, low, width)| match kind {
                        1 => f64::INFINITY,
                        2 => *low,
                        _ => low + width,
                    })
                    .collect(),
                inequalities,
                bounds: bounds.iter().map(|bound| bound + 0.3).collect(),
            },
        )
    })
}

/// The conditions of Karush, Kuhn and Tucker.
fn assert_optimal(case: &Case, solver: &LeastDistanceSolver, x: &[f64]) {
    let n = x.len();
    for (row, value) in case.rows() {
        assert!(dot(&row, x) <= value + 1e-11, "a bound is missed by {}", dot(&row, x) - value);
    }
    for (row, value) in case.equalities.chunks(n).zip(&case.values) {
        assert!((dot(row, x) - value).abs() < 1e-10);
    }
    let (mut sum, mut normal) = (case.target.clone(), vec![0.0; n]);
    for (constraint, multiplier) in solver.active() {
        assert!(matches!(constraint, Constraint::Equality(_)) || multiplier > -1e-10);
        let value = case.problem().normal(constraint, &mut normal);
        assert!((dot(&normal, x) - value).abs() < 1e-10);
        sum.iter_mut().zip(&normal).for_each(|(sum, entry)| *sum += multiplier * entry);
    }
    let scale = 1.0 + solver.active().map(|(_, multiplier)| multiplier.abs()).fold(0.0, f64::max);
    assert!(sum.iter().zip(x).all(|(sum, x)| (sum - x).abs() < 1e-10 * scale));
}

/// That the rows of a conflict alone have no solution: another solver says so.
fn assert_conflict(case: &Case, conflict: &[Constraint]) {
    let n = case.target.len();
    let open = |constraint: Constraint| !conflict.contains(&constraint);
    let mut alone = case.clone();
    let kept: Vec<usize> = (0..case.values.len()).filter(|&i| !open(Constraint::Equality(i))).collect();
    alone.equalities = kept.iter().flat_map(|&i| case.equalities[i * n..(i + 1) * n].to_vec()).collect();
    alone.values = kept.iter().map(|&i| case.values[i]).collect();
    for j in 0..n {
        if open(Constraint::Lower(j)) {
            alone.lower[j] = f64::NEG_INFINITY;
        }
        if open(Constraint::Upper(j)) {
            alone.upper[j] = f64::INFINITY;
        }
    }
    for i in 0..case.bounds.len() {
        if open(Constraint::Inequality(i)) {
            alone.bounds[i] = f64::INFINITY;
        }
    }
    assert!(!matches!(alone.by_clarabel(), Some(Ok(_))), "the rows of {conflict:?} can be met");
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(600))]
    #[test]
    fn it_agrees_with_another_solver_and_proves_what_it_says(case in cases()) {
        let (n, mut x) = (case.target.len(), vec![0.0; case.target.len()]);
        let mut solver = LeastDistanceSolver::with_capacity(n);
        match solver.solve(&case.problem(), &mut x) {
            Ok(_) => {
                assert_optimal(&case, &solver, &x);
                if let Some(found) = case.by_clarabel() {
                    let found = found.expect("there is a solution");
                    // The least value is known to 1e-9 and better; where it is flat, an interior point knows less of where it is.
                    let value = |x: &[f64]| {
                        x.iter().zip(&case.target).map(|(x, c)| (x - c) * (x - c) / 2.0).sum::<f64>()
                    };
                    prop_assert!((value(&found) - value(&x)).abs() < 1e-9, "{found:?} {x:?}");
                    prop_assert!(found.iter().zip(&x).all(|(a, b)| (a - b).abs() < 1e-7), "{found:?} {x:?}");
                }
            }
            Err(NoSolution::Infeasible) => {
                prop_assert!(!matches!(case.by_clarabel(), Some(Ok(_))));
                assert_conflict(&case, solver.conflict());
            }
            Err(other) => prop_assert!(false, "{other:?}"),
        }
    }

    #[test]
    fn a_warm_start_leads_to_the_same_point_in_fewer_steps(case in cases(), moves in proptest::collection::vec(-0.01..0.01_f64, 8)) {
        let n = case.target.len();
        let (mut warm, mut steps) = (LeastDistanceSolver::with_capacity(n), [0, 0]);
        let mut case = case;
        for _ in 0..20 {
            let (mut x, mut y) = (vec![0.0; n], vec![0.0; n]);
            let mut cold = LeastDistanceSolver::with_capacity(n);
            let (one, other) = (warm.solve(&case.problem(), &mut x), cold.solve(&case.problem(), &mut y));
            prop_assert_eq!(one.is_ok(), other.is_ok());
            let (Ok(one), Ok(other)) = (one, other) else { return Ok(()) };
            steps[0] += one.steps;
            steps[1] += other.steps;
            assert_optimal(&case, &warm, &x);
            prop_assert!(x.iter().zip(&y).all(|(x, y)| (x - y).abs() < 1e-9), "{x:?} {y:?}");
            case.target.iter_mut().zip(&moves).for_each(|(c, by)| *c += by);
        }
        prop_assert!(steps[0] <= steps[1], "{steps:?}");
    }
}

#[test]
fn without_an_active_bound_it_is_the_least_norm_solution() {
    let a = [1.0, 2.0, 3.0, 4.0, 0.0, 1.0, -1.0, 2.0];
    let wide = [1e3; 4];
    let problem = LeastDistance {
        target: &[0.1, 0.2, 0.3, 0.4],
        equalities: &a,
        values: &[1.0, -1.0],
        lower: &wide.map(|w| -w),
        upper: &wide,
        inequalities: &[],
        bounds: &[],
    };
    let mut x = [0.0; 4];
    let mut solver = LeastDistanceSolver::with_capacity(4);
    assert_eq!(solver.solve(&problem, &mut x), Ok(Solved { steps: 0, dependent_equalities: 0 }));
    let a = nalgebra::DMatrix::from_row_slice(2, 4, &a);
    let c = nalgebra::DVector::from_row_slice(problem.target);
    let missing = nalgebra::DVector::from_row_slice(problem.values) - &a * &c;
    let least = &c + a.transpose() * (&a * a.transpose()).try_inverse().unwrap() * missing;
    assert!(least.iter().zip(&x).all(|(a, b)| (a - b).abs() < 1e-14));
}

#[test]
fn rows_that_follow_from_others_are_counted_and_contradictions_named() {
    let open = ([f64::NEG_INFINITY; 2], [f64::INFINITY; 2]);
    let problem = |values: &'static [f64], upper: &'static [f64]| LeastDistance {
        target: &[0.0, 0.0],
        equalities: &[1.0, 1.0, 2.0, 2.0],
        values,
        lower: &open.0,
        upper,
        inequalities: &[],
        bounds: &[],
    };
    let (mut x, mut solver) = ([0.0; 2], LeastDistanceSolver::with_capacity(2));
    let solved = solver.solve(&problem(&[1.0, 2.0], &[f64::INFINITY; 2]), &mut x);
    assert_eq!(solved, Ok(Solved { steps: 0, dependent_equalities: 1 }));
    assert_eq!(solver.solve(&problem(&[1.0, 3.0], &[f64::INFINITY; 2]), &mut x), Err(NoSolution::Infeasible));
    assert_eq!(solver.conflict(), [Constraint::Equality(1), Constraint::Equality(0)]);
    assert_eq!(solver.solve(&problem(&[1.0, 2.0], &[0.2, 0.3]), &mut x), Err(NoSolution::Infeasible));
    let mut conflict = solver.conflict().to_vec();
    conflict.sort_by_key(|constraint| format!("{constraint:?}"));
    assert_eq!(conflict, [Constraint::Equality(0), Constraint::Upper(0), Constraint::Upper(1)]);
    let broken = LeastDistance { target: &[f64::NAN, 0.0], ..problem(&[1.0, 2.0], &[1.0; 2]) };
    assert_eq!(solver.solve(&broken, &mut x), Err(NoSolution::NotFinite));
    assert_eq!(solver.solve(&problem(&[1.0, 2.0], &[f64::NAN, 1.0]), &mut x), Err(NoSolution::NotFinite));
}
