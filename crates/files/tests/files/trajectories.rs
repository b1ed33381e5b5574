//! Random trajectories.

use kinstep_files::trajectory::{About, ArmTrajectory, Trajectory};
use proptest::collection::vec;
use proptest::prelude::*;

/// Any finite double, of both signs, subnormal ones and zeros included.
fn double() -> impl Strategy<Value = f64> {
    use proptest::num::f64::{NEGATIVE, NORMAL, POSITIVE, SUBNORMAL, ZERO};
    NORMAL | SUBNORMAL | ZERO | POSITIVE | NEGATIVE
}

/// One to three arms with one to four joints, velocities and errors known or not, two to six samples.
pub(crate) fn trajectories() -> impl Strategy<Value = Trajectory> {
    (2_usize..7, 1_usize..4).prop_flat_map(|(samples, arms)| {
        let gaps = vec(1e-6..10.0_f64, samples);
        (gaps, -5.0..5.0_f64, (0..arms).map(|index| arm(index, samples)).collect::<Vec<_>>(), any::<bool>())
            .prop_map(|(gaps, start, arms, known)| {
                let mut time = start;
                let times = gaps
                    .iter()
                    .map(|gap| {
                        time += gap;
                        time
                    })
                    .collect();
                Trajectory { about: known.then(|| about(&arms)), times, arms }
            })
    })
}

fn arm(index: usize, samples: usize) -> impl Strategy<Value = ArmTrajectory> {
    (1_usize..5, any::<[bool; 3]>(), "[a-z]{1,6}").prop_flat_map(
        move |(joints, [moves, rates, errs], stem)| {
            let names = (0..joints).map(|joint| format!("{stem}_joint.\u{e9} {joint}")).collect::<Vec<_>>();
            let values = |known: bool, count: usize| vec(double(), if known { count } else { 0 });
            let all = joints * samples;
            (values(true, all), values(moves, all), values(rates, all), values(errs, samples)).prop_map(
                move |(positions, velocities, accelerations, errors)| ArmTrajectory {
                    name: format!("{}-{index}", ["left", "right", "third"][index]),
                    joints: names.clone(),
                    positions,
                    velocities,
                    accelerations,
                    errors,
                },
            )
        },
    )
}

fn about(arms: &[ArmTrajectory]) -> About {
    About {
        version: "0.1.0".to_owned(),
        formula: "la6-wang-guo".to_owned(),
        sigma: 0.1 + 0.2,
        h: 1.0 / 3.0,
        start: "rk4".to_owned(),
        scenario: "00ff".to_owned(),
        robots: arms
            .iter()
            .rev()
            .map(|arm| (arm.name.clone(), format!("{:064x}", arm.joints.len())))
            .collect(),
    }
}

/// Whether two trajectories are the same to the last bit, signs of zeros included.
pub(crate) fn assert_same_bits(one: &Trajectory, other: &Trajectory) {
    let bits = |values: &[f64]| values.iter().map(|value| value.to_bits()).collect::<Vec<_>>();
    assert_eq!(one.about, other.about);
    assert_eq!(bits(&one.times), bits(&other.times));
    assert_eq!(one.arms.len(), other.arms.len());
    for (one, other) in one.arms.iter().zip(&other.arms) {
        assert_eq!((&one.name, &one.joints), (&other.name, &other.joints));
        assert_eq!(bits(&one.positions), bits(&other.positions));
        assert_eq!(bits(&one.velocities), bits(&other.velocities));
        assert_eq!(bits(&one.accelerations), bits(&other.accelerations));
        assert_eq!(bits(&one.errors), bits(&other.errors));
    }
}
