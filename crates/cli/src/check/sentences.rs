//! What failed, as sentences.

use std::f64::consts::TAU;

use super::super::output::moment;
use kinstep::planner::LimitKind;
use kinstep_files::trajectory::{
    Course, Crossing, Disagreement, JointFigures, Jump, Met, Rest, Straying, TimeFigures,
};
use kinstep_report::short;

/// The fraction of a whole turn within which a jump is one.
const TURN: f64 = 0.05;

pub(super) fn of_clock(clock: &TimeFigures) -> Vec<String> {
    let sentence = |(count, t)| {
        let samples = if count == 1 { "1 sample repeats" } else { &format!("{count} samples repeat") };
        format!("{samples} the one before in mid-motion, first at t = {} s", moment(t))
    };
    clock.repeated.map(sentence).into_iter().collect()
}

/// What of a path is not done.
pub(super) fn of_course(course: Course) -> Vec<String> {
    let [begin, end] = course.covered.map(moment);
    let missing = |[from, to]: [f64; 2]| {
        let (part, duration) = (short(100.0 * (to - from) / course.duration), moment(course.duration));
        format!(
            "the path takes {duration} s and the samples go from {begin} to {end} s of it: {} to {} s is missing, {part} %",
            moment(from),
            moment(to)
        )
    };
    course.missing().into_iter().map(missing).collect()
}

pub(super) fn of_error(arm: &str, error: Met, max_error: f64) -> Option<String> {
    let (value, bound, t) = (short(error.value), short(max_error), moment(error.t));
    let sentence = format!("{arm}: a task error of {value} at t = {t} s, above --max-error {bound}");
    (!(error.value <= max_error)).then_some(sentence)
}

pub(super) fn of_follower(arm: &str, straying: &Straying) -> String {
    let Straying { joint, driver, multiplier, offset, apart } = straying;
    let (distance, t) = (short(apart.value.abs()), moment(apart.t));
    let rule = if *offset == 0.0 {
        format!("{} {driver}", short(*multiplier))
    } else {
        format!("{} {driver} + {}", short(*multiplier), short(*offset))
    };
    format!("{arm}.{joint}: follows {driver} but is {distance} away from {rule} at t = {t} s")
}

/// What failed of an arm's joints.
pub(super) fn of_arm(arm: &str, figures: &[JointFigures], times: &[f64]) -> Vec<String> {
    let mut failures = Vec::new();
    for figures in figures {
        let joint = format!("{arm}.{}", figures.joint);
        failures.extend(figures.crossings.iter().map(|crossing| of_crossing(&joint, crossing, times)));
        failures.extend(figures.jumps.iter().map(|jump| of_jump(&joint, *jump)));
        for kind in [LimitKind::Velocity, LimitKind::Acceleration] {
            let worst = figures.worst_disagreement(kind);
            failures.extend(worst.map(|worst| of_disagreement(&joint, *worst)));
        }
    }
    failures.extend(of_end(arm, figures, 0, "starts"));
    failures.extend(of_end(arm, figures, 1, "ends"));
    failures
}

fn of_crossing(joint: &str, crossing: &Crossing, times: &[f64]) -> String {
    let Crossing { kind, first, worst, limit, .. } = crossing;
    let excess = short((worst.value - limit).abs());
    let (kind, value, limit, first) = (kind.name(), short(worst.value), short(*limit), moment(*first));
    let Some(outside) = crossing.outside else {
        return format!(
            "{joint}: any smooth motion through the samples from t = {first} s on has {kind} {value}, and its limit is {limit}"
        );
    };
    let whole = times[times.len() - 1] - times[0];
    let worst = moment(worst.t);
    let worst = if worst == first { String::new() } else { format!(", worst at t = {worst} s") };
    let lasting = match short(outside) {
        _ if outside <= 1e-9 * whole => String::new(),
        lasting => format!(", for {lasting} s in all"),
    };
    format!(
        "{joint}: {kind} {value} crosses its limit {limit} by {excess}, first at t = {first} s{lasting}{worst}"
    )
}

fn of_jump(joint: &str, jump: Jump) -> String {
    let (distance, duration, t) = (short(jump.distance), short(jump.duration), moment(jump.t));
    let cause = if (jump.distance.abs() / TAU - 1.0).abs() < TURN {
        "a whole turn; --unwrap takes turns out of continuous joints".to_owned()
    } else {
        format!("which takes an acceleration of {} at least", short(jump.acceleration))
    };
    format!("{joint}: jumps by {distance} within {duration} s at t = {t} s, {cause}")
}

fn of_disagreement(joint: &str, found: Disagreement) -> String {
    let (size, declared, of_values) = (short(found.size()), short(found.declared), short(found.of_values));
    let of = if found.kind == LimitKind::Velocity { "positions" } else { "velocities" };
    let (kind, t) = (found.kind.name(), moment(found.t));
    format!(
        "{joint}: the declared {kind} differs by {size} from that of the {of} at t = {t} s: {declared} and {of_values}"
    )
}

fn of_end(arm: &str, figures: &[JointFigures], end: usize, word: &str) -> Option<String> {
    let moving = figures.iter().filter_map(|figures| match figures.rests[end] {
        Rest::InMotion(velocity) => Some((&figures.joint, velocity)),
        _ => None,
    });
    let (joint, velocity) = moving.max_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
    Some(format!("{arm}: {word} in motion, {joint} at {}", short(velocity)))
}
