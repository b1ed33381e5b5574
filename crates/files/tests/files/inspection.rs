//! Verdicts on trajectories: held against motions whose extremes are known otherwise.

use kinstep::planner::LimitKind;
use kinstep::robot::{Limits, Robot};
use kinstep_files::trajectory::{
    ArmTrajectory, Crossing, Interpolation, JointFigures, Rest, TimeFigures, Trajectory,
};
use kinstep_strategies::{TreeCase, trees};
use proptest::collection::vec;
use proptest::prelude::*;

/// How many random goals must be judged rightly, of each kind.
const GOALS: u32 = 10_000;

/// At how many places of a step its extremes are looked for.
const PLACES: u32 = 40;

/// The samples of one joint, and how a controller moves between them.
#[derive(Clone, Debug)]
struct Goal {
    times: Vec<f64>,
    positions: Vec<f64>,
    velocities: Vec<f64>,
    accelerations: Vec<f64>,
}

impl Goal {
    fn arm(&self) -> ArmTrajectory {
        ArmTrajectory {
            name: "arm".to_owned(),
            joints: vec!["j".to_owned()],
            positions: self.positions.clone(),
            velocities: self.velocities.clone(),
            accelerations: self.accelerations.clone(),
            errors: Vec::new(),
        }
    }

    fn interpolation(&self) -> Interpolation {
        Interpolation::of(&self.arm())
    }

    /// The control points of Bezier's form of a step: another way to the same polynomial.
    fn control_points(&self, n: usize) -> Vec<f64> {
        let h = self.times[n + 1] - self.times[n];
        let both = |values: &[f64]| [values[n], values[n + 1]];
        let [p, q] = both(&self.positions);
        match self.interpolation() {
            Interpolation::Linear => vec![p, q],
            Interpolation::Cubic => {
                let [v, w] = both(&self.velocities).map(|v| v * h / 3.0);
                vec![p, p + v, q - w, q]
            }
            Interpolation::Quintic => {
                let [v, w] = both(&self.velocities).map(|v| v * h / 5.0);
                let [a, b] = both(&self.accelerations).map(|a| a * h * h / 20.0);
                vec![p, p + v, p + 2.0 * v + a, q - 2.0 * w + b, q - w, q]
            }
        }
    }

    /// The largest values of position, velocity and acceleration, whatever their signs, each with the first time at which it
    /// is met, by looking at many places.
    fn extremes(&self) -> [[f64; 2]; 3] {
        let mut found = [[0.0, 0.0]; 3];
        for n in 0..self.times.len() - 1 {
            let h = self.times[n + 1] - self.times[n];
            let mut points = self.control_points(n);
            for extreme in &mut found {
                for place in 0..=PLACES {
                    let s = f64::from(place) / f64::from(PLACES);
                    let value = casteljau(&points, s).abs();
                    if value > extreme[0] {
                        *extreme = [value, self.times[n] + s * h];
                    }
                }
                let degree = points.len().saturating_sub(1) as f64;
                points = points.windows(2).map(|pair| degree * (pair[1] - pair[0]) / h).collect();
                if points.is_empty() {
                    break;
                }
            }
        }
        found
    }

    fn inspected(&self, limits: Limits) -> JointFigures {
        self.arm().inspect(&self.times, &[limits], self.interpolation()).remove(0)
    }
}

fn casteljau(points: &[f64], s: f64) -> f64 {
    let mut points = points.to_vec();
    while points.len() > 1 {
        for n in 1..points.len() {
            points[n - 1] += s * (points[n] - points[n - 1]);
        }
        points.pop();
    }
    points[0]
}

/// Limits at these sizes.
fn limits([position, velocity, acceleration]: [f64; 3]) -> Limits {
    Limits { lower: -position, upper: position, velocity, acceleration, ..Limits::UNLIMITED }
}

fn stamps(gaps: &[f64]) -> Vec<f64> {
    let mut time = 0.0;
    let later = gaps.iter().map(|gap| {
        time += gap;
        time
    });
    std::iter::once(0.0).chain(later).collect()
}

/// Points as they are sent to controllers: from rest to rest, through some points at which nothing is declared, or the
/// joint stops, or passes at some velocity and acceleration; with dwells; further apart than samples of a recording.
fn sparse_goals() -> impl Strategy<Value = Goal> {
    let point = (-2.5..2.5_f64, -1.0..1.0_f64, -2.0..2.0_f64, 0.06..3.0_f64, 0_u8..4);
    (vec(point, 1..8), 0_u8..4).prop_map(|(points, declares)| {
        let gaps: Vec<f64> = points.iter().map(|point| point.3).collect();
        let mut goal = Goal {
            times: stamps(&gaps),
            positions: vec![0.3],
            velocities: vec![0.0],
            accelerations: vec![0.0],
        };
        let last = points.len() - 1;
        for (n, (slope, v, a, gap, kind)) in points.into_iter().enumerate() {
            let is_rest = n == last || kind < 2;
            let before = goal.positions[n];
            goal.positions.push(if kind == 0 { before } else { before + slope * gap });
            goal.velocities.push(if is_rest { 0.0 } else { v });
            goal.accelerations.push(if is_rest { 0.0 } else { a });
        }
        match declares {
            0 => (goal.velocities, goal.accelerations) = (Vec::new(), Vec::new()),
            1 | 2 => goal.accelerations = Vec::new(),
            _ => {}
        }
        goal
    })
}

/// A smooth motion from rest to rest with a dwell in the middle, sampled at any rate, exactly.
fn profiles(gap: std::ops::Range<f64>, declares: std::ops::Range<u8>) -> impl Strategy<Value = Goal> {
    (0.5..4.0_f64, 0.1..3.0_f64, 0.1..1.0_f64, gap, declares).prop_map(
        |(duration, height, dwell, gap, declares)| {
            let whole = 2.0 * duration + dwell;
            let count = (whole / gap).ceil().max(2.0);
            let times: Vec<f64> = (0..=count as usize).map(|n| whole * n as f64 / count).collect();
            // sin^2 up to the height, the dwell, and down again.
            let at = |t: f64| {
                let tau = if t < duration { t } else { (t - dwell).max(duration) };
                let (rate, phase) =
                    (std::f64::consts::PI / duration, std::f64::consts::PI * tau / duration / 2.0);
                let is_still = t >= duration && t <= duration + dwell;
                let velocity = if is_still { 0.0 } else { height * rate / 2.0 * (2.0 * phase).sin() };
                let acceleration =
                    if is_still { 0.0 } else { height * rate * rate / 2.0 * (2.0 * phase).cos() };
                [height * phase.sin().powi(2), velocity, acceleration]
            };
            let values = |order: usize| -> Vec<f64> {
                let value = |t: &f64| if *t == 0.0 || *t == whole { at(0.0)[order] } else { at(*t)[order] };
                times.iter().map(value).collect()
            };
            let (mut goal_velocities, mut goal_accelerations) = (Vec::new(), Vec::new());
            if declares > 0 {
                goal_velocities = values(1);
                if let Some(last) = goal_velocities.last_mut() {
                    *last = 0.0;
                }
            }
            if declares > 1 {
                goal_accelerations = values(2);
            }
            Goal {
                positions: values(0),
                times,
                velocities: goal_velocities,
                accelerations: goal_accelerations,
            }
        },
    )
}

/// Nothing is said against a goal, in limits that it keeps.
fn assert_sound(goal: &Goal, extremes: &[[f64; 2]; 3]) -> Result<(), TestCaseError> {
    let mut sizes = extremes.map(|[size, _]| size * (1.0 + 1e-2) + 1e-9);
    if goal.interpolation() == Interpolation::Linear {
        sizes[2] = f64::INFINITY;
    }
    let found = goal.inspected(limits(sizes));
    prop_assert!(found.crossings.is_empty(), "{:?}", found.crossings);
    prop_assert!(found.jumps.is_empty(), "{:?}", found.jumps);
    prop_assert!(found.disagreements.iter().flatten().next().is_none(), "{:?}", found.disagreements);
    prop_assert!(!found.rests.iter().any(|rest| matches!(rest, Rest::InMotion(_))), "{:?}", found.rests);
    let trajectory = Trajectory { about: None, times: goal.times.clone(), arms: vec![goal.arm()] };
    prop_assert_eq!(TimeFigures::of(&trajectory).repeated, None);
    Ok(())
}

/// Every limit that is a little too small is found crossed, no later than where it was seen to be, and not earlier than
/// anything near it.
fn assert_found(goal: &Goal, extremes: &[[f64; 2]; 3]) -> Result<(), TestCaseError> {
    let kinds = [LimitKind::Position, LimitKind::Velocity, LimitKind::Acceleration];
    let is_linear = goal.interpolation() == Interpolation::Linear;
    for (order, kind) in kinds.into_iter().enumerate().take(if is_linear { 2 } else { 3 }) {
        let [size, t] = extremes[order];
        if size < 1e-3 {
            continue;
        }
        let mut sizes = [1e9; 3];
        sizes[order] = size * 0.99;
        let found = goal.inspected(limits(sizes));
        prop_assert!(found.crossings.iter().all(|crossing| crossing.kind == kind), "{:?}", found.crossings);
        // One for each side of the limits.
        let first = found.crossings.iter().map(|crossing| crossing.first).fold(f64::MAX, f64::min);
        prop_assert!(first <= t + 1e-9, "{} after {}", first, t);
        let reaches = |crossing: &&Crossing| crossing.worst.value.abs() >= size * (1.0 - 1e-9);
        let Some(crossing) = found.crossings.iter().find(reaches) else {
            return Err(TestCaseError::fail(format!("{kind:?} {size}: {:?}", found.crossings)));
        };
        let whole = goal.times[goal.times.len() - 1];
        prop_assert!(crossing.outside.is_some_and(|outside| outside >= 0.0 && outside <= whole + 1e-9));
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(GOALS))]

    #[test]
    fn sound_sparse_goals_raise_no_alarm_and_no_crossing_is_missed(goal in sparse_goals()) {
        let extremes = goal.extremes();
        assert_sound(&goal, &extremes)?;
        assert_found(&goal, &extremes)?;
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1_000))]

    #[test]
    fn sampled_profiles_raise_no_alarm_and_no_crossing_is_missed(goal in profiles(0.005..0.3, 0..3)) {
        let extremes = goal.extremes();
        assert_sound(&goal, &extremes)?;
        assert_found(&goal, &extremes)?;
    }

    /// Velocities that are not those of the positions are found where samples are close, and a jump of any size that matters.
    #[test]
    fn wrong_velocities_and_jumps_are_found_in_recordings(
        goal in profiles(0.005..0.02, 0..3), wrong in prop_oneof![-1.0..0.7_f64, 1.3..3.0_f64], jump in 0.2..2.0_f64,
    ) {
        let jump = jump + 12.0 * goal.extremes()[1][0] * goal.times[1];
        let mut spoilt = goal.clone();
        spoilt.positions.iter_mut().skip(goal.times.len() / 3).for_each(|q| *q += jump);
        let found = spoilt.inspected(Limits::UNLIMITED);
        prop_assert_eq!(found.jumps.len(), 1, "{:?}", found.jumps);
        prop_assert!((found.jumps[0].distance / jump - 1.0).abs() < 0.1);
        prop_assert_eq!(found.jumps[0].t, goal.times[goal.times.len() / 3]);
        if goal.velocities.is_empty() {
            return Ok(());
        }
        let mut spoilt = goal.clone();
        spoilt.velocities.iter_mut().for_each(|v| *v *= wrong);
        let found = spoilt.inspected(Limits::UNLIMITED).disagreements;
        prop_assert!(found.as_ref().is_some_and(|found| !found.is_empty()), "{:?}", found);
        let mut cut = goal.clone();
        let kept = goal.times.len() / 4;
        for values in [&mut cut.times, &mut cut.positions, &mut cut.velocities] {
            values.truncate(kept);
        }
        cut.accelerations.clear();
        prop_assert!(matches!(cut.inspected(Limits::UNLIMITED).rests, [Rest::AtRest, Rest::InMotion(_)]));
    }

    /// What follows a joint is checked as if it stood in the file, and by its own values where it does.
    #[test]
    fn followers_move_with_their_drivers_in_random_trees(case in trees(), samples in vec(-1.0..1.0_f64, 2..5)) {
        let robot = robot(&case);
        let drivers: Vec<String> = robot.movable_joints().map(|joint| joint.name.clone()).collect();
        prop_assume!(!drivers.is_empty());
        let rows = samples.iter().flat_map(|value| (0..drivers.len()).map(move |joint| value + joint as f64));
        let positions: Vec<f64> = rows.collect();
        let arm = ArmTrajectory {
            velocities: positions.clone(),
            joints: drivers.clone(),
            positions,
            name: "arm".to_owned(),
            accelerations: Vec::new(),
            errors: Vec::new(),
        };
        let times = stamps(&vec![1.0; samples.len() - 1]);
        let (all, straying) = arm.with_followers(&robot, &times, Interpolation::Cubic);
        prop_assert!(straying.is_empty());
        for (place, name) in all.joints.iter().enumerate() {
            let joint = robot.joint(name).unwrap();
            let (driver, multiplier, offset) = joint.mimic.map_or((name, 1.0, 0.0), |mimic| {
                (&robot.joints()[mimic.driver].name, mimic.multiplier, mimic.offset)
            });
            let driver = drivers.iter().position(|known| known == driver).unwrap();
            for n in 0..samples.len() {
                let wanted = multiplier * arm.position(n)[driver] + offset;
                prop_assert!((all.position(n)[place] - wanted).abs() < 1e-12);
                let rate = multiplier * arm.velocity(n).unwrap()[driver];
                prop_assert!((all.velocity(n).unwrap()[place] - rate).abs() < 1e-12);
            }
        }
        let following = robot.joints().iter().filter(|joint| joint.kind.is_movable() && joint.mimic.is_some());
        prop_assert_eq!(all.joints.len(), drivers.len() + following.count());
        // In the file they are held against their drivers.
        let (again, straying) = all.with_followers(&robot, &times, Interpolation::Cubic);
        prop_assert!(again == all && straying.is_empty(), "{:?}", straying);
        if all.joints.len() > drivers.len() {
            let mut other = all.clone();
            let last = other.positions.len() - 1;
            other.positions[last] += 0.1;
            let (_, straying) = other.with_followers(&robot, &times, Interpolation::Cubic);
            prop_assert_eq!(straying.len(), 1);
            prop_assert_eq!(straying[0].apart.t, times[times.len() - 1]);
        }
    }
}

fn robot(case: &TreeCase) -> Robot {
    case.robot().expect("the strategy makes sound robots")
}

/// The samples of a motion from 0 to 1 rad in 2 s with the least jerk, at this gap, with velocities.
fn gentle(gap: f64) -> Goal {
    let count = (2.0 / gap).round() as usize;
    let times: Vec<f64> = (0..=count).map(|n| n as f64 * gap).collect();
    let position = |t: &f64| (t / 2.0).powi(3) * (10.0 - 15.0 * t / 2.0 + 6.0 * (t / 2.0).powi(2));
    let velocity = |t: &f64| 15.0 * (t / 2.0).powi(2) * (1.0 - t / 2.0).powi(2);
    let (positions, velocities) =
        (times.iter().map(position).collect(), times.iter().map(velocity).collect());
    Goal { times, positions, velocities, accelerations: Vec::new() }
}

/// A number between -1 and 1 that goes with a place.
fn wobble(n: usize) -> f64 {
    (n * n * 7919 % 1013) as f64 / 506.0 - 1.0
}

/// Recordings are rounded and noisy; what is said of them does not follow from that.
#[test]
fn rounding_and_noise_raise_no_alarm() {
    for gap in [0.002, 0.008, 0.02] {
        for step in [1e-4, std::f64::consts::TAU / 4096.0, std::f64::consts::TAU / 131_072.0, 1e-9] {
            for [of_positions, of_velocities] in [[0.0, 0.0], [0.0, 1e-2], [1e-5, 1e-3]] {
                let mut goal = gentle(gap);
                let rounded = |(n, q): (usize, &f64)| ((q + of_positions * wobble(n)) / step).round() * step;
                goal.positions = goal.positions.iter().enumerate().map(rounded).collect();
                let noisy = |(n, v): (usize, &mut f64)| *v += of_velocities * wobble(3 * n + 1);
                goal.velocities.iter_mut().enumerate().for_each(noisy);
                let found = goal.inspected(Limits::UNLIMITED);
                let case = format!("{gap} {step} {of_positions} {of_velocities}");
                assert!(found.jumps.is_empty(), "{case}: {:?}", found.jumps);
                assert_eq!(found.disagreements, Some(Vec::new()), "{case}");
                assert!(found.rests.iter().all(|rest| *rest == Rest::AtRest), "{case}: {:?}", found.rests);
                let (times, arms) = (goal.times.clone(), vec![goal.arm()]);
                let clock = TimeFigures::of(&Trajectory { about: None, times, arms });
                assert_eq!(clock.repeated, None, "{case}");
            }
        }
    }
}

/// One sample that is lost, held or swapped in a recording is seen, and so is a stall of any length.
#[test]
fn single_samples_that_are_wrong_are_found() {
    for gap in [0.002, 0.01, 0.02_f64] {
        let middle = (1.0 / gap).round() as usize;
        let disagrees = |goal: Goal| !goal.inspected(Limits::UNLIMITED).disagreements.unwrap().is_empty();
        let mut lost = gentle(gap);
        lost.positions.remove(middle);
        lost.velocities.remove(middle);
        lost.times.pop();
        assert!(disagrees(lost), "{gap}");
        let mut held = gentle(gap);
        held.positions[middle] = held.positions[middle - 1];
        assert!(disagrees(held), "{gap}");
        let mut swapped = gentle(gap);
        swapped.positions.swap(middle, middle + 1);
        assert!(disagrees(swapped), "{gap}");
        for length in [1, 2, 5, 9] {
            let mut stalled = Goal { velocities: Vec::new(), ..gentle(gap) };
            (middle..middle + length).for_each(|n| stalled.positions[n] = stalled.positions[middle - 1]);
            let (times, arms) = (stalled.times.clone(), vec![stalled.arm()]);
            let clock = TimeFigures::of(&Trajectory { about: None, times, arms });
            assert_eq!(clock.repeated.map(|(count, _)| count), Some(length), "{gap}");
        }
    }
}

/// What steps at samples is decided only where it must be crossed.
#[test]
fn limits_that_an_interpolation_does_not_decide_are_named() {
    let goal = |velocities: Vec<f64>, accelerations: Vec<f64>| Goal {
        times: vec![0.0, 1.0, 2.0],
        positions: vec![0.0, 1.0, 0.0],
        velocities,
        accelerations,
    };
    let allowed = |acceleration: f64, jerk: f64| Limits { acceleration, jerk, ..Limits::UNLIMITED };
    let straight = goal(Vec::new(), Vec::new());
    let found = straight.inspected(allowed(5.0, 100.0));
    assert_eq!(
        (found.crossings.len(), &found.undecided[..]),
        (0, &[LimitKind::Acceleration, LimitKind::Jerk][..])
    );
    // Any smooth motion from 0 to 1 and back in two seconds decelerates by 2 somewhere.
    let found = straight.inspected(allowed(1.9, 100.0));
    let [crossing] = &found.crossings[..] else { panic!("{:?}", found.crossings) };
    assert_eq!(
        (crossing.kind, crossing.worst.value, crossing.outside),
        (LimitKind::Acceleration, -2.0, None)
    );
    assert_eq!(found.undecided, [LimitKind::Jerk]);
    // 6 / h^2 at the ends of a cubic from rest to rest, 12 / h^3 between them.
    let cubic = goal(vec![0.0; 3], Vec::new());
    assert_eq!(cubic.inspected(allowed(6.0, 12.0)).undecided, [LimitKind::Jerk]);
    let kinds = |found: JointFigures| {
        let mut kinds: Vec<LimitKind> = found.crossings.iter().map(|crossing| crossing.kind).collect();
        kinds.dedup();
        kinds
    };
    assert_eq!(kinds(cubic.inspected(allowed(5.9, 12.0))), [LimitKind::Acceleration]);
    assert_eq!(kinds(cubic.inspected(allowed(6.0, 11.9))), [LimitKind::Jerk]);
    // A quintic from rest to rest: 10 / sqrt(3) and 60.
    let quintic = goal(vec![0.0; 3], vec![0.0; 3]);
    let found = quintic.inspected(allowed(5.774, 60.1));
    assert!(found.undecided.is_empty() && found.crossings.is_empty(), "{found:?}");
    assert_eq!(kinds(quintic.inspected(allowed(5.773, 59.9))), [LimitKind::Acceleration, LimitKind::Jerk]);
}
