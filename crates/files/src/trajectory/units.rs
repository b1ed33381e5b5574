//! Units that are not what they should be: what the numbers themselves make likely.

use super::quantity::Quantity;
use super::times::TimeUnit;
use super::{ArmTrajectory, KnownJoint, Trajectory};
use kinstep::robot::{JointKind, Limits};

/// How many times farther than its range allows a joint goes before its unit is questioned.
const BEYOND: f64 = 2.0;
/// What is allowed where a turning joint has no range \[rad\]: two turns.
const TURNS: f64 = 4.0 * std::f64::consts::PI;
/// What is allowed where a sliding joint has no range \[m\].
const TRAVEL: f64 = 10.0;
/// The largest angle that is taken for degrees: two turns.
const DEGREES: f64 = 720.0;
/// The longest time that a trajectory is not asked about \[s\]: ten days.
const LONGEST: f64 = 864_000.0;
/// How near the ratio of declared and travelled distance is to that of two units.
const NEAR: f64 = 0.2;

/// Returns what is to be asked about the units of a trajectory whose joints are known: sentences with the likely cause and the
/// option that converts it. Nothing is returned where the numbers may be what they should be: radians, metres and seconds.
///
///     use kinstep::robot::embedded;
///     use kinstep_files::trajectory::{KnownJoint, Trajectory, units};
///     let text = "t,shoulder_pan_joint\n0,-90\n1,-80\n";
///     let trajectory = Trajectory::from_bytes("a.csv".as_ref(), text.as_bytes()).unwrap();
///     let joints = KnownJoint::of(&embedded::get("ur5e").unwrap());
///     assert!(units::questions(&trajectory, &joints)[0].contains("--degrees"));
pub fn questions(trajectory: &Trajectory, joints: &[KnownJoint]) -> Vec<String> {
    let mut questions: Vec<String> = time_question(trajectory).into_iter().collect();
    for arm in &trajectory.arms {
        questions.extend(name_question(arm, joints));
        questions.extend(degree_question(arm, joints));
        questions.extend(millimetre_question(arm, joints));
        questions.extend(rate_question(arm, &trajectory.times, !questions.is_empty()));
    }
    questions
}

/// Whether a joint that no robot is known to have is called after another quantity.
fn name_question(arm: &ArmTrajectory, joints: &[KnownJoint]) -> Option<String> {
    const OTHERS: [&str; 7] =
        ["velocity", "velocities", "speed", "acceleration", "effort", "torque", "current"];
    let is_other = |name: &&String| {
        let lower = name.to_ascii_lowercase();
        joints.iter().all(|joint| joint.name != **name) && OTHERS.iter().any(|word| lower.ends_with(word))
    };
    let name = arm.joints.iter().find(is_other)?;
    Some(format!(
        "`{name}` is taken for the position of a joint, and its name says something else; --map takes other columns"
    ))
}

/// The largest size of a joint's positions.
fn reach(arm: &ArmTrajectory, place: usize) -> f64 {
    let column = arm.positions.iter().skip(place).step_by(arm.joints.len());
    column.fold(0.0, |most, q| f64::max(most, q.abs()))
}

/// The places of an arm's joints of some kinds, with their limits.
fn of_kind<'a>(
    arm: &'a ArmTrajectory,
    joints: &'a [KnownJoint],
    kinds: &'a [JointKind],
) -> impl Iterator<Item = (usize, Limits)> + 'a {
    arm.joints.iter().enumerate().filter_map(move |(place, name)| {
        let joint = joints.iter().find(|joint| joint.name == *name && kinds.contains(&joint.kind))?;
        Some((place, joint.limits))
    })
}

/// The farthest that limits allow, or a bound where they have none.
fn farthest(limits: Limits, otherwise: f64) -> f64 {
    let most = f64::max(limits.lower.abs(), limits.upper.abs());
    if most.is_finite() { most } else { otherwise }
}

fn degree_question(arm: &ArmTrajectory, joints: &[KnownJoint]) -> Option<String> {
    let turning: Vec<(usize, Limits)> =
        of_kind(arm, joints, &[JointKind::Revolute, JointKind::Continuous]).collect();
    let sizes = turning.iter().map(|&(place, limits)| (place, reach(arm, place), farthest(limits, TURNS)));
    let (place, size, _) =
        sizes.clone().filter(|(_, size, most)| *size > BEYOND * most).max_by(|a, b| a.1.total_cmp(&b.1))?;
    let fits = sizes.clone().all(|(_, size, most)| size <= DEGREES && size.to_radians() <= most * 1.001);
    let joint = &arm.joints[place];
    fits.then(|| {
        format!(
            "{}.{joint} goes to {size:.4} rad, which is {:.1} turns; as degrees all joints would be within their limits: --degrees \
             converts them",
            arm.name,
            size / std::f64::consts::TAU
        )
    })
}

fn millimetre_question(arm: &ArmTrajectory, joints: &[KnownJoint]) -> Option<String> {
    let sliding: Vec<(usize, Limits)> = of_kind(arm, joints, &[JointKind::Prismatic]).collect();
    let sizes = sliding.iter().map(|&(place, limits)| (place, reach(arm, place), farthest(limits, TRAVEL)));
    let (place, size, most) = sizes.clone().find(|(_, size, most)| *size > 10.0 * most)?;
    let fits = sizes.clone().all(|(_, size, most)| size / 1000.0 <= most * 1.001);
    let (name, joint) = (&arm.name, &arm.joints[place]);
    fits.then(|| {
        format!(
            "{name}.{joint} slides to {size:.4} m, and its range ends at {most:.4} m; as millimetres it would be within its limits: \
             divide its column by 1000"
        )
    })
}

/// Whether the samples are days apart, or the whole takes longer than anything that moves.
fn time_question(trajectory: &Trajectory) -> Option<String> {
    let (first, last) = (trajectory.times.first()?, trajectory.times.last()?);
    let duration = last - first;
    if duration <= LONGEST {
        return None;
    }
    let gap = duration / (trajectory.samples() - 1) as f64;
    let units = [TimeUnit::Nanoseconds, TimeUnit::Microseconds, TimeUnit::Milliseconds];
    let likely =
        units.into_iter().find(|unit| gap / unit.per_second() > 1e-4).unwrap_or(TimeUnit::Nanoseconds);
    let (days, symbol) = (duration / 86_400.0, likely.symbol());
    Some(format!(
        "the trajectory takes {days:.0} days, with samples {gap:.0} s apart; are the times in {symbol}? --time-unit {symbol} reads them so"
    ))
}

/// Holds declared velocities against the way that is gone: a ratio of a thousand, or of a radian and a degree, is one of units.
fn rate_question(arm: &ArmTrajectory, times: &[f64], is_asked: bool) -> Option<String> {
    let width = arm.joints.len();
    if arm.velocities.is_empty() || is_asked {
        return None;
    }
    let (mut declared, mut gone) = (0.0, 0.0);
    for (n, pair) in times.windows(2).enumerate() {
        for place in n * width..(n + 1) * width {
            let mean = f64::midpoint(arm.velocities[place], arm.velocities[place + width]);
            declared += (mean * (pair[1] - pair[0])).abs();
            gone += (arm.positions[place + width] - arm.positions[place]).abs();
        }
    }
    let ratio = declared / gone;
    let is_near = |wanted: f64| (ratio / wanted - 1.0).abs() < NEAR;
    let degree = 180.0 / std::f64::consts::PI;
    let of_time = TimeUnit::ALL[1..].iter().find(|unit| is_near(unit.per_second()));
    let (name, word) = (&arm.name, Quantity::Velocity.plural());
    let cause = if let Some(unit) = of_time {
        let symbol = unit.symbol();
        format!("are the times in {symbol}? --time-unit {symbol} reads them so")
    } else if is_near(degree) {
        format!("are the {word} in degrees per second, and the positions in radians?")
    } else if is_near(1.0 / degree) {
        format!("are the positions in degrees, and the {word} in radians per second?")
    } else {
        return None;
    };
    Some(format!("{name}: the declared {word} lead {ratio:.3} times as far as the positions go; {cause}"))
}
