//! Every format that is read back: the same bits, the same bytes, and what is refused.

#![allow(clippy::unwrap_used, reason = "a test that can not go on stops")]

use crate::trajectories::{assert_same_bits, trajectories};
use kinstep::nalgebra::IsometryMatrix3;
use kinstep::robot::embedded;
use kinstep::task::TaskKind;
#[cfg(feature = "parquet")]
use kinstep_files::trajectory::Parquet;
use kinstep_files::trajectory::{
    ArmTrajectory, Machine, Mcap, MoveItYaml, Npz, Recording, Ros2Yaml, Stage, StagedArm, Trajectory,
    TrajectoryFormat,
};
use proptest::prelude::*;

fn written(format: &dyn TrajectoryFormat, trajectory: &Trajectory) -> Vec<u8> {
    let recording = Recording { trajectory, stage: &Stage::default() };
    format.check(recording).unwrap();
    let mut bytes = Vec::new();
    format.write(recording, &mut bytes).unwrap();
    bytes
}

fn refused(format: &dyn TrajectoryFormat, trajectory: &Trajectory) -> String {
    let recording = Recording { trajectory, stage: &Stage::default() };
    format.check(recording).unwrap_err().to_string()
}

fn read(name: &str, bytes: &[u8]) -> Trajectory {
    Trajectory::from_bytes(name.as_ref(), bytes).unwrap()
}

/// What messages hold of a trajectory: times since the first in nanoseconds, no task errors, an end at rest.
fn as_messages(trajectory: &Trajectory) -> Trajectory {
    let mut messages = trajectory.clone();
    let first = trajectory.times[0];
    messages.times.iter_mut().for_each(|time| *time = ((*time - first) * 1e9).round() / 1e9);
    for arm in &mut messages.arms {
        arm.errors.clear();
    }
    // Keys of a map have an order of their own.
    messages.about.iter_mut().for_each(|about| about.robots.sort());
    messages
}

fn at_rest(mut trajectory: Trajectory) -> Trajectory {
    for arm in &mut trajectory.arms {
        let joints = arm.joints.len();
        arm.velocities.iter_mut().rev().take(joints).for_each(|velocity| *velocity = 0.0);
    }
    trajectory
}

proptest! {
    #[test]
    fn arrays_read_back_as_they_were(trajectory in trajectories()) {
        let bytes = written(&Npz, &trajectory);
        assert_same_bits(&read("a.npz", &bytes), &trajectory);
        assert_same_bits(&read("a.unknown", &bytes), &trajectory);
        prop_assert_eq!(written(&Npz, &trajectory), bytes);
    }

    #[cfg(feature = "parquet")]
    #[test]
    fn tables_of_parquet_read_back_as_they_were(trajectory in trajectories()) {
        let bytes = written(&Parquet, &trajectory);
        assert_same_bits(&read("a.parquet", &bytes), &trajectory);
        assert_same_bits(&read("a.unknown", &bytes), &trajectory);
        prop_assert_eq!(written(&Parquet, &trajectory), bytes);
    }

    #[test]
    fn recordings_read_back_as_they_were(trajectory in trajectories()) {
        let bytes = written(&Mcap, &trajectory);
        assert_same_bits(&read("a.mcap", &bytes), &as_messages(&trajectory));
        prop_assert_eq!(written(&Mcap, &trajectory), bytes);
    }

    #[test]
    fn messages_read_back_as_they_were(trajectory in trajectories()) {
        let trajectory = at_rest(trajectory);
        for arm in &trajectory.arms {
            let alone = Trajectory { arms: vec![ArmTrajectory { errors: Vec::new(), ..arm.clone() }], ..trajectory.clone() };
            let mut alone = as_messages(&alone);
            alone.about.clone_from(&trajectory.about);
            for format in [
                &Ros2Yaml { machine: arm.name.clone() } as &dyn TrajectoryFormat,
                &MoveItYaml { machine: arm.name.clone() },
            ] {
                let bytes = written(format, &trajectory);
                assert_same_bits(&read("a.yaml", &bytes), &alone);
                prop_assert_eq!(written(format, &trajectory), bytes);
            }
        }
    }

    #[test]
    fn spoilt_files_are_refused_without_a_panic(
        trajectory in trajectories(), place in any::<prop::sample::Index>(), byte in any::<u8>(), cuts in any::<bool>(),
    ) {
        let trajectory = at_rest(trajectory);
        let yaml = Ros2Yaml { machine: trajectory.arms[0].name.clone() };
        let formats = [
            ("a.npz", &Npz as &dyn TrajectoryFormat),
            ("a.mcap", &Mcap),
            ("a.yaml", &yaml),
            #[cfg(feature = "parquet")]
            ("a.parquet", &Parquet),
        ];
        for (name, format) in formats {
            let mut bytes = written(format, &trajectory);
            let at = place.index(bytes.len());
            if cuts { bytes.truncate(at) } else { bytes[at] ^= byte }
            let _ = Trajectory::from_bytes(name.as_ref(), &bytes);
        }
    }
}

#[cfg(feature = "parquet")]
#[test]
fn a_table_of_parquet_is_written_in_groups_that_memory_holds() {
    let footer = |samples: u32| -> u32 {
        let times: Vec<f64> = (0..samples).map(|n| f64::from(n) * 0.001).collect();
        let long = moving(&times);
        let bytes = written(&Parquet, &long);
        assert_same_bits(&read("a.parquet", &bytes), &long);
        // The footer's length stands in front of the last four bytes.
        u32::from_le_bytes(*bytes[..bytes.len() - 4].last_chunk().unwrap())
    };
    // Four columns of 2^18 rows fill a group; the footer lists the columns of every group, and does not grow with the rows.
    let [short, full, more] = [1_000, 1 << 18, (1 << 18) + 1].map(footer);
    assert!(full < short + 64 && more > full + 128, "{short} {full} {more}");
}

#[cfg(feature = "parquet")]
#[test]
fn a_table_of_parquet_that_is_cut_short_says_what_it_is() {
    let bytes = written(&Parquet, &moving(&[0.0, 0.1]));
    for end in 4..bytes.len() {
        let error = Trajectory::from_bytes("a.parquet".as_ref(), &bytes[..end]).unwrap_err();
        assert!(error.message.contains("Parquet"), "{error}");
    }
}

/// One joint along `q = t^2 / 2`, which ends in motion.
fn moving(times: &[f64]) -> Trajectory {
    Trajectory {
        about: None,
        times: times.to_vec(),
        arms: vec![ArmTrajectory {
            name: "arm".to_owned(),
            joints: vec!["joint".to_owned()],
            positions: times.iter().map(|t| t * t / 2.0).collect(),
            velocities: times.to_vec(),
            accelerations: Vec::new(),
            errors: vec![0.0; times.len()],
        }],
    }
}

#[test]
fn what_controllers_refuse_is_refused() {
    let yaml = Ros2Yaml { machine: "arm".to_owned() };
    let moveit = MoveItYaml { machine: "arm".to_owned() };
    let resting = |times: &[f64]| at_rest(moving(times));
    let even = resting(&[0.0, 0.1, 0.2]);
    for format in [&yaml as &dyn TrajectoryFormat, &moveit] {
        written(format, &even);
        assert!(refused(format, &moving(&[0.0, 0.1])).contains("--append-stop"));
        assert!(refused(format, &moving(&[1.0])).contains("there is no second sample"));
    }
    written(&Mcap, &moving(&[0.0, 0.1]));
    for format in [&yaml as &dyn TrajectoryFormat, &moveit, &Mcap] {
        assert!(refused(format, &resting(&[0.0, 0.1, 0.1 + 1e-10])).contains("nanoseconds"));
        assert!(refused(format, &resting(&[0.0, 0.2, 0.1])).contains("increase"));
        assert!(refused(format, &resting(&[0.0, 2_147_483_648.0])).contains("2^31"));
        written(format, &resting(&[-5.0, 2_147_483_000.0]));
        let mut broken = even.clone();
        broken.arms[0].positions[1] = f64::NAN;
        assert!(refused(format, &broken).contains("`arm.joint` is not a finite number in sample 1"));
    }
    let other = Ros2Yaml { machine: "other".to_owned() };
    assert!(refused(&other, &even).contains("there are arm"));
}

#[test]
fn a_stop_decelerates_no_harder_than_the_motion_accelerated() {
    let moving = moving(&[0.0, 0.1, 0.2, 0.3]);
    let stopped = moving.with_stop(&Stage::default()).unwrap();
    let (arm, times) = (&stopped.arms[0], &stopped.times);
    // The acceleration was 1, the velocity is 0.3: the stop takes 0.3 s and goes 0.045 on.
    assert_eq!(stopped.samples(), 5);
    assert!((times[4] - 0.6).abs() < 1e-12, "{times:?}");
    assert!((arm.positions[4] - 0.09).abs() < 1e-12 && arm.velocities[4] == 0.0, "{arm:?}");
    assert!(arm.errors.is_empty());
    assert_eq!(stopped.with_stop(&Stage::default()).unwrap(), stopped);
    written(&Ros2Yaml { machine: "arm".to_owned() }, &stopped);
}

#[test]
fn a_stop_stays_within_the_limits_or_is_refused() {
    let robot = embedded::get("panda").unwrap();
    let chain = robot.chain("panda_link0", "panda_link1").unwrap();
    let upper = chain.joints()[0].limits.upper;
    let machine = Machine::new("arm", robot, "panda_link0", &IsometryMatrix3::identity());
    let arm = StagedArm::new("arm", (0, &machine.robot), chain, TaskKind::Pose).unwrap();
    let stage = Stage { machines: vec![machine], arms: vec![arm] };
    let mut near = moving(&[0.0, 0.1, 0.2]);
    near.arms[0].joints[0] = "panda_joint1".to_owned();
    near.arms[0].positions = vec![upper - 0.02, upper - 0.015, upper - 0.001];
    let refusal = near.with_stop(&stage).unwrap_err().to_string();
    assert!(refusal.contains("panda_joint1") && refusal.contains("limits"), "{refusal}");
}

#[test]
fn a_recording_has_the_robots_that_move() {
    let robot = embedded::get("panda").unwrap();
    let chain = robot.chain("panda_link0", "panda_hand_tcp").unwrap();
    let joints: Vec<String> = chain.joints().iter().map(|joint| joint.name.clone()).collect();
    let machine = Machine::new("left-arm", robot, "panda_link0", &IsometryMatrix3::identity());
    let arm = StagedArm::new("left-arm", (0, &machine.robot), chain, TaskKind::Pose).unwrap();
    let stage = Stage { machines: vec![machine], arms: vec![arm] };
    let arm = ArmTrajectory {
        name: "left-arm".to_owned(),
        positions: (0..2 * joints.len()).map(|n| 0.01 * n as f64).collect(),
        joints,
        velocities: Vec::new(),
        accelerations: Vec::new(),
        errors: Vec::new(),
    };
    let mut trajectory = Trajectory { about: None, times: vec![0.0, 0.5], arms: vec![arm.clone()] };
    let topics = |trajectory: &Trajectory, stage: &Stage| -> Vec<(String, usize)> {
        let mut bytes = Vec::new();
        Mcap.write(Recording { trajectory, stage }, &mut bytes).unwrap();
        let summary = mcap::Summary::read(&bytes).unwrap().unwrap();
        let counts = &summary.stats.as_ref().unwrap().channel_message_counts;
        let mut topics: Vec<(String, usize)> = summary
            .channels
            .iter()
            .map(|(id, channel)| (channel.topic.clone(), counts[id] as usize))
            .collect();
        topics.sort();
        topics
    };
    let named = |names: &[(&str, usize)]| -> Vec<(String, usize)> {
        names.iter().map(|(name, count)| ((*name).to_owned(), *count)).collect()
    };
    let one = [
        ("/display_planned_path", 1),
        ("/joint_states", 2),
        ("/joint_trajectory", 1),
        ("/left_arm/path", 1),
        ("/robot_description", 1),
        ("/tf", 2),
        ("/tf_static", 1),
    ];
    assert_eq!(topics(&trajectory, &stage), named(&one));
    trajectory.arms.push(ArmTrajectory { name: "right".to_owned(), ..arm });
    let two = topics(&trajectory, &stage);
    for topic in ["/left_arm/joint_states", "/left_arm/robot_description", "/right/joint_trajectory"] {
        assert!(two.iter().any(|(name, _)| name == topic), "{two:?}");
    }
    // Frames at 0, 10 and 20 ms and at the last sample; states at every sample.
    trajectory.arms.pop();
    let dense: Vec<f64> = (0..22).map(|n| f64::from(n) * 0.001).collect();
    let joints = trajectory.arms[0].joints.len();
    trajectory.arms[0].positions = vec![0.1; dense.len() * joints];
    trajectory.times = dense;
    let dense = topics(&trajectory, &stage);
    for topic in [("/joint_states", 22), ("/tf", 4)] {
        assert!(dense.contains(&named(&[topic])[0]), "{dense:?}");
    }
}
