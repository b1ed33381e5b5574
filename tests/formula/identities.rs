//! Identities that every row obeys, and the figures of the paper's row.

use kinstep::formula::{
    Coefficients, Formula, FormulaTable, NotRunnable, RootCondition, Row, Strictness, read_rows,
};
use kinstep::math::{Polynomial, Rational, is_schur_within, parse_rational, rational_from_f64};
use num_traits::Zero;
use proptest::prelude::*;

fn builtin() -> impl Iterator<Item = &'static Formula> {
    FormulaTable::builtin().iter()
}

fn formula(id: &str) -> &'static Formula {
    FormulaTable::builtin().get(id).expect("a row of the table")
}

fn number(text: &str) -> Rational {
    parse_rational(text).expect("a number of this test")
}

fn difference(numerators: &str, denominator: &str) -> Formula {
    let row = Row::from_difference("typed", numerators, denominator).expect("a readable row");
    row.check().into_formula().expect("a row without contradictions")
}

#[test]
fn the_papers_row_has_the_papers_figures() {
    let row = formula("la6-wang-guo");
    assert_eq!((row.steps(), row.order()), (5, 3));
    assert_eq!(*row.error_constant(), number("5/16"));
    assert_eq!(*row.per_step_constant(), number("5/8"));
    assert_eq!(row.gamma_sum(), number("2"));
    assert_eq!(row.root_condition(), RootCondition::StrictlyStable);
    assert_eq!(row.feedback_range().exact(), Some(number("2/3")));
    assert!((row.spectral_radius(0.4) - 0.883_744).abs() < 1e-6);
    let best = row.optimum().expect("a bounded range has a best h");
    let root = 33_f64.sqrt();
    assert!((best.h - (15.0 * root - 71.0) / 48.0).abs() < 1e-14, "{}", best.h);
    assert!((best.radius - ((3.0 + root) / 12.0).sqrt()).abs() < 1e-14, "{}", best.radius);
}

#[test]
fn noise_gains_have_their_known_values() {
    let gain = formula("la6-wang-guo").noise_gain(0.4).expect("0.4 is inside the range");
    assert!(
        (gain.residual - 0.5225).abs() < 5e-5 && (gain.feedforward_per_sigma - 2.6123).abs() < 5e-5,
        "{gain:?}"
    );
    let gain = formula("split-ab6").noise_gain(1.0).expect("1 is inside the range");
    assert!(
        (gain.residual - 1.0).abs() < 1e-14 && (gain.feedforward_per_sigma - 10.8135).abs() < 5e-5,
        "{gain:?}"
    );
    // Encoder noise is corrected within the step that reads it when the correction is deadbeat.
    assert!(gain.state.abs() < 1e-14, "{gain:?}");
}

#[test]
fn split_rows_share_one_residual_gain() {
    for row in builtin().filter(|row| row.family() == "split") {
        for h in [0.1, 0.5, 1.0, 1.9] {
            let gain = row.noise_gain(h).expect("the range of split rows is (0, 2)");
            assert!((gain.residual - (h / (2.0 - h)).sqrt()).abs() < 1e-13, "{}: {gain:?}", row.id());
        }
    }
}

#[test]
fn noise_gains_end_where_the_range_ends() {
    let row = formula("la6-wang-guo");
    assert!(row.noise_gain(2.0 / 3.0 + 1e-15).is_none());
    assert!(
        row.noise_gain(0.0).is_none() && row.noise_gain(-0.1).is_none() && row.noise_gain(f64::NAN).is_none()
    );
    assert!(row.noise_gain(0.666).is_some());
}

#[test]
fn the_range_knows_its_exact_edge() {
    let range = formula("la6-wang-guo").feedback_range();
    // The double nearest to 2/3 lies below it, and stands for it: it is outside, and the one before it is inside.
    let end = 2.0_f64 / 3.0;
    assert!(range.contains(end.next_down()) && !range.contains(end) && !range.contains(end.next_up()));
    assert!(!range.contains(0.0) && range.contains(f64::MIN_POSITIVE));
    assert!(!range.contains(f64::NAN) && !range.contains(f64::INFINITY) && !range.contains(-0.1));
    assert!(range.contains_exact(&number("0.66666666666666666666666666666666")));
    assert!(!range.contains_exact(&number("2/3")));
}

#[test]
fn an_irrational_edge_is_decided_too() {
    let range = formula("la5-18").feedback_range();
    assert_eq!(range.polynomial().as_deref(), Some("32 h^2 + 108 h - 81"));
    let edge = range.value();
    assert!((edge - (-108.0 + (108.0_f64 * 108.0 + 4.0 * 32.0 * 81.0).sqrt()) / 64.0).abs() < 1e-15);
    assert!(range.contains(edge.next_down()) && !range.contains(edge.next_up()));
    let (low, high) = range.certified_interval().expect("an irrational edge has an interval");
    assert!(high - low < number("1e-18") && low < high);
}

#[test]
fn the_first_touch_ends_the_range() {
    let specimen = difference("32,-24,10,-17,-6,5", "54");
    assert_eq!(specimen.feedback_range().exact(), Some(number("45/32")));
    assert!((specimen.spectral_radius(45.0 / 32.0) - 1.0).abs() < 1e-12);
    assert!(specimen.spectral_radius(1.6) < 1.0, "stable again above the touch");
    assert!(!specimen.feedback_range().contains(1.6));
}

#[test]
fn inside_the_range_the_radius_is_below_one_and_at_its_end_it_is_one() {
    for row in builtin().filter(|row| !row.feedback_range().is_empty()) {
        let range = row.feedback_range();
        let end = range.value().min(50.0);
        for part in [1e-6, 0.01, 0.3, 0.5, 0.77, 0.999] {
            let radius = row.spectral_radius(end * part);
            assert!(radius < 1.0, "{}: r({}) = {radius}", row.id(), end * part);
        }
        if !range.is_unbounded() {
            let radius = row.spectral_radius(range.value());
            // Where two roots meet on the circle, the last digit of h costs half the digits of r.
            assert!((radius - 1.0).abs() < 1e-7, "{}: r(h_max) = {radius}", row.id());
        }
    }
}

#[test]
fn spectral_radii_are_certified_by_exact_tests_beside_them() {
    let exact = |x: f64| rational_from_f64(x).expect("finite");
    for row in builtin().step_by(3) {
        let end = row.feedback_range().value();
        for h in [0.1, 0.37, 0.5 * end, 0.999 * end].into_iter().filter(|h| *h > 0.0 && h.is_finite()) {
            let radius = row.spectral_radius(h);
            let over_sum = exact(h) / row.gamma_sum();
            let closed: Vec<Rational> =
                row.alpha().iter().zip(row.gamma()).map(|(a, g)| a + g * &over_sum).collect();
            let closed = Polynomial::from_rationals_descending(&closed);
            assert!(is_schur_within(&closed, &exact(radius + 2e-13)), "{}: r({h}) > {radius}", row.id());
            assert!(!is_schur_within(&closed, &exact(radius - 2e-13)), "{}: r({h}) < {radius}", row.id());
        }
    }
}

#[test]
fn the_optimum_is_the_least_radius_of_the_range() {
    for row in builtin() {
        let Some(best) = row.optimum() else { continue };
        assert!(row.feedback_range().contains(best.h), "{}", row.id());
        assert!((row.spectral_radius(best.h) - best.radius).abs() < 1e-6, "{}", row.id());
        let end = row.feedback_range().value().min(50.0);
        for part in 1..200 {
            let h = end * f64::from(part) / 200.0;
            assert!(
                row.spectral_radius(h) >= best.radius - 1e-12,
                "{}: r({h}) is less than {best:?}",
                row.id()
            );
        }
    }
}

#[test]
fn a_plateau_begins_at_its_smallest_h() {
    // z^2 + (h - 4/3) z + 1/3: a complex pair of modulus 1/sqrt 3 for every h from 4/3 - 2/sqrt 3 on.
    let best = formula("la3-order1").optimum().expect("a bounded range has a best h");
    assert!((best.h - (4.0 / 3.0 - 2.0 / 3_f64.sqrt())).abs() < 1e-12, "{best:?}");
    assert!((best.radius - 1.0 / 3_f64.sqrt()).abs() < 1e-12, "{best:?}");
}

#[test]
fn only_strictly_stable_rows_have_a_feedback_range() {
    for row in builtin() {
        if !row.is_strictly_zero_stable() {
            assert!(row.feedback_range().is_empty() && row.optimum().is_none(), "{}", row.id());
        }
    }
    assert!(formula("ab3").feedback_range().exact() == Some(number("6/11")));
    assert!(formula("ab6").feedback_range().exact() == Some(number("5/57")));
    assert!(formula("ab8").feedback_range().exact() == Some(number("945/38716")));
}

#[test]
fn every_row_cites_the_bibliography() {
    let bibliography = include_str!("../../docs/references.bib");
    for row in builtin() {
        let key = row.source().split_whitespace().next().expect("a source is not empty");
        assert!(bibliography.contains(&format!("{{{key},")), "{} cites {key}", row.id());
    }
}

#[test]
fn scaling_a_row_changes_nothing() {
    for row in builtin().take(60) {
        let times = |list: &[Rational]| list.iter().map(|c| c * number("-7/3")).collect::<Vec<_>>();
        let scaled = Row::new(
            "scaled",
            Coefficients::General {
                alpha: times(row.alpha()),
                beta: times(row.beta()),
                gamma: Some(times(row.gamma())),
            },
        );
        let scaled = scaled.expect("readable").check().into_formula().expect("a formula");
        assert_eq!((scaled.alpha(), scaled.beta(), scaled.gamma()), (row.alpha(), row.beta(), row.gamma()));
        assert_eq!(scaled.feedback_range().to_string(), row.feedback_range().to_string());
    }
}

#[test]
fn an_idle_oldest_sample_changes_nothing_but_the_steps() {
    for row in builtin() {
        let padded = |list: &[Rational]| list.iter().cloned().chain([Rational::zero()]).collect::<Vec<_>>();
        let longer = Row::new(
            "longer",
            Coefficients::General {
                alpha: padded(row.alpha()),
                beta: padded(row.beta()),
                gamma: Some(padded(row.gamma())),
            },
        );
        let longer = longer.expect("readable").check().into_formula().expect("a formula");
        assert_eq!(longer.steps(), row.steps() + 1);
        assert_eq!(
            (longer.order(), longer.error_constant()),
            (row.order(), row.error_constant()),
            "{}",
            row.id()
        );
        assert_eq!(longer.root_condition(), row.root_condition(), "{}", row.id());
        assert_eq!(longer.feedback_range().to_string(), row.feedback_range().to_string(), "{}", row.id());
        assert_eq!(longer.optimum(), row.optimum(), "{}", row.id());
    }
}

#[test]
fn a_common_factor_inside_the_circle_leaves_the_range_alone() {
    // Both polynomials of the paper's row times (z + 1/2): the same method in disguise. gamma(1), and with it the h of
    // one and the same gain, grows by 3/2.
    let row = formula("la6-wang-guo");
    let half = number("1/2");
    let times = |list: &[Rational]| -> Vec<Rational> {
        (0..=list.len())
            .map(|j| {
                let own = list.get(j).cloned().unwrap_or_default();
                let shifted = j.checked_sub(1).and_then(|j| list.get(j)).cloned().unwrap_or_default();
                own + shifted * &half
            })
            .collect()
    };
    let coefficients =
        Coefficients::General { alpha: times(row.alpha()), beta: times(row.beta()), gamma: None };
    let disguised =
        Row::new("disguised", coefficients).expect("readable").check().into_formula().expect("a formula");
    assert_eq!((disguised.order(), disguised.error_constant()), (row.order(), row.error_constant()));
    assert_eq!(disguised.feedback_range().exact(), row.feedback_range().exact().map(|h| h * number("3/2")));
    let (best, own) = (disguised.optimum().expect("one"), row.optimum().expect("one"));
    assert!((best.h - 1.5 * own.h).abs() < 1e-14 && (best.radius - own.radius).abs() < 1e-14);
}

#[test]
fn order_conditions_hold_up_to_the_order_and_fail_after_it() {
    for row in builtin() {
        for q in 0..=row.order() {
            assert!(row.analysis().order_defect(q).is_zero(), "{}: E_{q}", row.id());
        }
        assert!(!row.analysis().order_defect(row.order() + 1).is_zero(), "{}", row.id());
    }
}

#[test]
fn a_changed_coefficient_is_noticed() {
    // A typo that still sums to zero keeps neither the order nor the error constant.
    let text = r#"
        [[formula]]
        id = "typo"
        difference = [24, -5, -12, -5, -5, 3]
        denominator = 48
        order = 3
        error_constant = "5/16"
        zero_stable = true
        source = "nowhere"
    "#;
    let error = FormulaTable::from_toml(text).expect_err("a lying row");
    assert!(!error.is_unreadable(), "{error}");
    assert!(error.to_string().contains("inconsistent"), "{error}");
}

#[test]
fn drafts_are_finished_and_then_pass_the_strict_door() {
    for row in builtin().step_by(7) {
        let gamma = row.is_split().then(|| row.gamma().to_vec());
        let coefficients =
            Coefficients::General { alpha: row.alpha().to_vec(), beta: row.beta().to_vec(), gamma };
        let finished = Row::new(row.id(), coefficients).expect("readable").check().to_toml();
        let table = FormulaTable::from_toml(&finished).expect("a finished row");
        let again = table.get(row.id()).expect("the row");
        assert_eq!((again.order(), again.error_constant()), (row.order(), row.error_constant()));
        assert_eq!((again.alpha(), again.beta(), again.gamma()), (row.alpha(), row.beta(), row.gamma()));
    }
    let draft = "[[formula]]\nid = \"mine\"\ndifference = [1, \"-1.0\"]\ndenominator = 1\nnote = \"a \\\"quoted\\\" word\"\n";
    assert!(read_rows(draft, Strictness::Finished).is_err());
    let rows = read_rows(draft, Strictness::Draft).expect("a draft");
    let finished = rows.into_iter().next().expect("one row").check().to_toml();
    assert_eq!(
        FormulaTable::from_toml(&finished).expect("finished").iter().next().map(Formula::order),
        Some(1)
    );
}

#[test]
fn the_runner_is_told_why_not() {
    assert!(formula("la6-wang-guo").runnable_with_feedback().is_ok());
    assert!(formula("ab4").runnable().is_ok());
    assert!(matches!(formula("bad-double-root").runnable(), Err(NotRunnable::Unstable { .. })));
    assert!(matches!(formula("bdf2").runnable(), Err(NotRunnable::Implicit { .. })));
    assert!(formula("la3-leapfrog").runnable().is_ok(), "without feedback the leapfrog may run");
    assert!(matches!(
        formula("la3-leapfrog").runnable_with_feedback(),
        Err(NotRunnable::WeaklyStable { .. })
    ));
}

#[test]
fn a_ramp_climbs_within_the_family() {
    let table = FormulaTable::builtin();
    let rung = |id: &str, known| table.ramp(formula(id), known).map(Formula::id);
    for k in 1..=6 {
        assert_eq!(rung("split-ab6", k), Some(format!("split-ab{k}")).as_deref());
    }
    assert_eq!(rung("ab4", 2), Some("ab2"));
    assert_eq!(rung("la6-wang-guo", 1), Some("la2-euler"));
    assert_eq!(rung("la6-wang-guo", 0), None);
    assert_eq!(rung("bdf3", 1), None, "every row of that family is implicit");
    let third = table.ramp(formula("la6-wang-guo"), 3).expect("look-ahead rows of three steps");
    assert_eq!((third.order(), third.steps() <= 3), (2, true));
}

#[test]
fn tables_extend_without_collisions() {
    let row = |id: &str| {
        format!(
            "[[formula]]\nid = \"{id}\"\ndifference = [1, -1]\ndenominator = 1\norder = 1\nerror_constant = \"1/2\"\n\
             zero_stable = true\nsource = \"here\"\n"
        )
    };
    let own = FormulaTable::from_toml(&row("mine")).expect("a good row");
    let all = FormulaTable::builtin().extended_with(own).expect("a new id");
    assert_eq!(all.len(), FormulaTable::builtin().len() + 1);
    assert!(all.get("mine").is_ok() && all.get("ab1").is_ok());
    let taken = FormulaTable::from_toml(&row("ab1")).expect("a good row");
    let error = FormulaTable::builtin().extended_with(taken).expect_err("the id is taken");
    assert!(error.to_string().contains("\"ab1\" is taken"), "{error}");
}

#[test]
fn an_unknown_id_offers_the_nearest() {
    let error = FormulaTable::builtin().get("la6-wangguo").expect_err("misspelt");
    assert_eq!(error.nearest.first().map(String::as_str), Some("la6-wang-guo"));
    assert!(error.to_string().contains("la6-wang-guo"), "{error}");
}

#[test]
fn forty_steps_and_four_hundred_digits_are_analysed() {
    // Adams-Bashforth-like: x_(n+1) = x_n plus velocities of 40 samples that keep only consistency, and a 40-step difference.
    let spread =
        |value: &str, rest: usize| std::iter::repeat_n(value.to_owned(), rest).collect::<Vec<_>>().join(",");
    let alpha = format!("1,-1,{}", spread("0", 39));
    let beta = format!("0,{}", spread("1/40", 40));
    let row = Row::from_weights("forty", &alpha, &beta, None).expect("readable").check();
    let formula = row.into_formula().expect("consistent");
    assert_eq!((formula.steps(), formula.order()), (40, 1));
    assert_eq!(formula.root_condition(), RootCondition::StrictlyStable);
    assert!(formula.feedback_range().value() > 0.0 && formula.optimum().is_some());
    let digits = "7".repeat(399);
    let alpha = format!("1{digits},-1{digits}");
    let beta = format!("0,1{digits}");
    let formula = Row::from_weights("long", &alpha, &beta, None).expect("readable").check().into_formula();
    assert_eq!(formula.expect("Euler in disguise").feedback_range().exact(), Some(number("2")));
}

/// A consistent row of random small fractions: (z - 1) times factors with roots inside the circle, feedback weights at random.
fn random_row() -> impl Strategy<Value = Formula> {
    let inside = proptest::collection::vec((-6_i64..=6, 7_i64..=9), 1..5);
    let weights = proptest::collection::vec(-3_i64..=6, 6);
    (inside, weights).prop_filter_map("weights that cancel", |(roots, weights)| {
        let mut alpha = vec![number("1"), number("-1")];
        for (n, d) in roots {
            let root = Rational::new(n.into(), d.into());
            alpha.push(Rational::zero());
            for j in (1..alpha.len()).rev() {
                let shifted = &alpha[j - 1] * &root;
                alpha[j] -= shifted;
            }
        }
        // rho'(1) = sum of (s - j) alpha_j is what beta has to sum to.
        let slope: Rational =
            (0_i64..).zip(&alpha).map(|(j, a)| a * Rational::from_integer((1 - j).into())).sum();
        let weights: Vec<Rational> = (0..alpha.len())
            .map(|j| Rational::from_integer((if j == 0 { 0 } else { weights[j % 6] }).into()))
            .collect();
        let sum: Rational = weights.iter().sum();
        if sum.is_zero() || slope.is_zero() {
            return None;
        }
        let beta = weights.iter().map(|w| w * &slope / &sum).collect();
        Row::new("random", Coefficients::General { alpha, beta, gamma: None })
            .ok()?
            .check()
            .into_formula()
            .ok()
    })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn a_random_range_ends_where_the_radius_reaches_one(row in random_row()) {
        prop_assert_eq!(row.root_condition(), RootCondition::StrictlyStable);
        let range = row.feedback_range();
        prop_assert!(!range.is_empty(), "small h moves the root 1 inwards: {:?}", row.alpha());
        let end = range.value().min(1e3);
        for part in [1e-3, 0.2, 0.5, 0.8, 0.98] {
            prop_assert!(row.spectral_radius(end * part) < 1.0, "r({}) with {range}", end * part);
        }
        if !range.is_unbounded() {
            prop_assert!((row.spectral_radius(range.value()) - 1.0).abs() < 1e-6, "{}", range);
        }
        if let Some(best) = row.optimum() {
            prop_assert!(range.contains(best.h));
            for part in 1..60 {
                let h = end * f64::from(part) / 60.0;
                prop_assert!(row.spectral_radius(h) > best.radius - 1e-9, "r({h}) is below {best:?}");
            }
        }
    }

    #[test]
    fn random_noise_gains_are_those_of_the_simulated_loop(row in random_row(), part in 0.1_f64..0.9) {
        let h = row.feedback_range().value().min(10.0) * part;
        prop_assume!(row.spectral_radius(h) < 0.97);
        let gain = row.noise_gain(h).expect("inside the range");
        let as_f64 = |list: &[Rational]| list.iter().map(kinstep::math::rational_to_f64).collect::<Vec<_>>();
        let (alpha, beta, gamma) = (as_f64(row.alpha()), as_f64(row.beta()), as_f64(row.gamma()));
        let sum: f64 = gamma.iter().sum();
        let closed: Vec<f64> = alpha.iter().zip(&gamma).map(|(a, g)| a + h * g / sum).collect();
        let norm = |input: &dyn Fn(usize) -> f64| {
            let mut response: Vec<f64> = Vec::new();
            for n in 0..3000 {
                let past: f64 = (1..closed.len().min(n + 1)).map(|j| closed[j] * response[n - j]).sum();
                response.push((if n < closed.len() { input(n) } else { 0.0 }) - past);
            }
            response.iter().map(|e| e * e).sum::<f64>().sqrt()
        };
        let close = |a: f64, b: f64| (a - b).abs() <= 1e-9 * b.max(1e-3);
        prop_assert!(close(gain.residual, norm(&|j| -h * gamma[j] / sum)));
        prop_assert!(close(gain.feedforward_per_sigma, norm(&|j| beta[j])));
        let state = norm(&|j| if j == 0 { 0.0 } else { -closed[j] });
        prop_assert!(close(gain.state, state));
    }
}
