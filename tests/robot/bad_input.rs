//! Every file of tests/bad_input/urdf, read and compared with the findings written beside it.
//!
//! `NAME.expected` holds `read` or `refused` and then every finding as `line:column: severity: message`. After a
//! change of wording, `KINSTEP_WRITE_EXPECTED=1 cargo test --test robot bad_input` writes the files anew; look at
//! the difference before committing it.

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

use crate::chains::chain_of;
use kinstep::robot::{
    ChainError, Diagnostic, JointKind, MAX_DEPTH, MAX_JOINTS, ReadError, Robot, Severity, UrdfOptions,
};

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/bad_input/urdf")
}

fn read(name: &str) -> Robot {
    let text = fs::read(folder().join(name)).expect("the file is there");
    Robot::from_urdf_bytes(&text, &UrdfOptions::default()).expect("the robot reads")
}

fn listed(verdict: &str, diagnostics: &[Diagnostic]) -> String {
    diagnostics.iter().fold(format!("{verdict}\n"), |mut listed, found| {
        let _ = writeln!(listed, "{found}");
        listed
    })
}

fn findings(bytes: &[u8]) -> String {
    match Robot::from_urdf_bytes(bytes, &UrdfOptions::default()) {
        Ok(robot) => listed("read", robot.diagnostics()),
        Err(error) => listed("refused", error.diagnostics()),
    }
}

#[test]
fn every_bad_file_gets_the_findings_written_beside_it() {
    let mut wrong = Vec::new();
    let mut files: Vec<_> = fs::read_dir(folder()).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.sort();
    files.retain(|path| path.extension().is_some_and(|extension| extension == "urdf"));
    assert!(files.len() > 50);
    for path in files {
        let found = findings(&fs::read(&path).unwrap());
        let beside = path.with_extension("expected");
        if std::env::var_os("KINSTEP_WRITE_EXPECTED").is_some() {
            fs::write(&beside, &found).unwrap();
        } else if fs::read_to_string(&beside).unwrap_or_default() != found {
            wrong.push(format!("{}:\n{found}", path.display()));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn a_file_that_is_missing_or_a_directory_is_named() {
    let options = UrdfOptions::default();
    let missing = Robot::from_urdf_file("no/such/arm.urdf", &options).unwrap_err();
    assert!(matches!(missing, ReadError::File { .. }));
    let message = missing.to_string();
    assert!(
        message.starts_with("can not read no/such/arm.urdf: there is no such file (looked up from "),
        "{message}"
    );
    assert!(message.ends_with("); there is no folder `no/such`"), "{message}");
    let near = Robot::from_urdf_file(folder().join("axis_zeor.urdf"), &options).unwrap_err().to_string();
    assert!(near.contains("; did you mean `") && near.contains("axis_zero.urdf`"), "{near}");
    let directory = Robot::from_urdf_file(folder(), &options).unwrap_err().to_string();
    assert!(directory.contains("it is a directory; name the .urdf file inside it"), "{directory}");
}

#[test]
fn a_robot_without_a_name_is_called_after_its_file() {
    let robot = Robot::from_urdf_file(folder().join("no_name.urdf"), &UrdfOptions::default()).unwrap();
    assert_eq!(robot.name(), "no_name");
}

#[test]
fn a_defect_spoils_only_the_chains_through_it() {
    let robot = read("axis_zero.urdf");
    assert!(robot.joint("moves").unwrap().defect.is_some());
    let error = robot.chain("base", "arm").unwrap_err();
    assert_eq!(
        error.to_string(),
        "the path from `base` to `arm` passes joint `moves`, which is defective (line 8): its axis `0 0 0` has no \
         direction"
    );
    let robot = read("not_finite.urdf");
    assert!(robot.chain("arm", "b").is_err());
    let robot = read("unknown_types.urdf");
    assert!(matches!(robot.chain("b", "c"), Err(ChainError::DefectiveJoint { .. })));
}

#[test]
fn joints_outside_a_loop_stay_usable() {
    let robot = read("loop.urdf");
    assert_eq!(robot.chain("b", "tip").unwrap().dof(), 1);
    let error = robot.chain("a", "tip").unwrap_err().to_string();
    assert!(error.contains("loop through the links"), "{error}");
}

#[test]
fn two_roots_are_no_obstacle_below_one_of_them() {
    let robot = read("two_roots.urdf");
    assert_eq!(robot.chain("other", "right").unwrap().dof(), 1);
    let error = robot.chain("base", "right").unwrap_err().to_string();
    assert_eq!(
        error,
        "no joints connect `base` and `right`: they hang from different roots, `base` and `other`"
    );
}

#[test]
fn a_joint_that_the_tree_can_not_hold_is_named_when_it_is_missed() {
    let robot = read("undefined_links.urdf");
    let error = robot.chain("base", "arm").unwrap_err().to_string();
    assert!(
        error.contains("joint `j1` is defective (line 5): its parent link `bsae` is not defined"),
        "{error}"
    );
}

#[test]
fn free_joints_are_refused_on_the_path_only() {
    let robot = read("free_joints.urdf");
    assert_eq!(robot.chain("base", "d").unwrap().dof(), 1);
    for (tip, kind) in [("arm", JointKind::Floating), ("b", JointKind::Planar), ("c", JointKind::Spherical)] {
        let error = robot.chain("d", tip).unwrap_err();
        assert!(
            matches!(error, ChainError::UnsupportedJoint { kind: found, .. } if found == kind),
            "{error}"
        );
    }
}

#[test]
fn missing_limits_are_unknown_zero_or_assumed_as_asked() {
    let robot = read("limits_missing.urdf");
    let limits = |robot: &Robot, name: &str| {
        let limits = robot.joint(name).unwrap().limits;
        (limits.lower, limits.upper, limits.velocity)
    };
    let inf = f64::INFINITY;
    assert!(robot.joint("j0").unwrap().defect.is_some());
    assert_eq!(limits(&robot, "j1"), (-inf, inf, 1.0));
    assert_eq!(limits(&robot, "j2"), (-1.0, 0.0, 1.0));
    assert_eq!(limits(&robot, "j3"), (0.0, 1.0, 1.0));
    assert_eq!(limits(&robot, "j4"), (-1.0, 1.0, inf));
    assert_eq!(limits(&robot, "j5"), (-inf, inf, inf));
    let newer = read("limits_missing_in_1_2.urdf");
    assert_eq!(limits(&newer, "j2"), (-1.0, inf, 1.0));
    let text = fs::read_to_string(folder().join("limits_missing.urdf")).unwrap();
    let options = UrdfOptions { assume_unlimited: true, ..UrdfOptions::default() };
    let assumed = Robot::from_urdf_with(&text, &options).unwrap();
    assert_eq!(limits(&assumed, "j0"), (-inf, inf, inf));
    assert!(assumed.joint("j0").unwrap().defect.is_none());
}

#[test]
fn strict_reading_refuses_vendor_attributes() {
    let text = fs::read_to_string(folder().join("misspelt.urdf")).unwrap();
    let lenient = Robot::from_urdf(&text).unwrap();
    assert!(lenient.joint("j2").unwrap().defect.is_none());
    let options = UrdfOptions { strict: true, ..UrdfOptions::default() };
    let strict = Robot::from_urdf_with(&text, &options).unwrap();
    assert!(strict.joint("j2").unwrap().defect.is_some());
}

#[test]
fn mimicking_what_stands_still_makes_a_joint_fixed_at_its_offset() {
    let robot = read("mimic_fixed.urdf");
    for (name, angle) in [("j3", 0.5), ("j4", 0.0), ("j5", 1.0)] {
        let joint = robot.joint(name).unwrap();
        assert_eq!(joint.kind, JointKind::Fixed);
        assert!((joint.origin.rotation.angle() - angle).abs() < 1e-15, "{name}");
    }
}

#[test]
fn a_follower_narrows_the_limits_of_its_driver_on_the_path() {
    let robot = Robot::from_urdf(include_str!("../data/two_fingers.urdf")).unwrap();
    let limits = |base: &str, tip: &str| {
        let chain = robot.chain(base, tip).unwrap();
        let driver = chain.joints().iter().find(|joint| joint.name == "left_slide").unwrap();
        driver.limits
    };
    let alone = limits("palm", "left");
    assert_eq!((alone.lower, alone.upper, alone.velocity), (0.0, 0.04, 0.2));
    let followed = limits("palm", "right");
    assert!((followed.lower - 0.0).abs() < 1e-15 && (followed.upper - 0.04).abs() < 1e-15);
    assert!((followed.velocity - 0.1).abs() < 1e-15);
    let chain = robot.chain("left_tip", "right_tip").unwrap();
    let names: Vec<_> = chain.joints().iter().map(|joint| joint.name.as_str()).collect();
    assert_eq!(names, ["left_pad", "left_slide", "right_pad"]);
}

#[test]
fn positions_outside_the_limits_are_named() {
    let robot = Robot::from_urdf(include_str!("../data/two_fingers.urdf")).unwrap();
    let chain = robot.chain("wrist", "left_tip").unwrap();
    assert!(chain.within_limits(&[100.0, 0.02, 0.0]));
    assert!(!chain.within_limits(&[0.0, 0.02]));
    assert!(!chain.within_limits(&[f64::INFINITY, 0.02, 0.0]), "unlimited is not infinite");
    let outside: Vec<_> = chain.limit_violations(&[0.0, -0.01, f64::NAN]).collect();
    assert_eq!(outside.iter().map(|one| one.joint.as_str()).collect::<Vec<_>>(), ["left_slide", "left_pad"]);
}

#[test]
fn an_axis_of_any_length_keeps_its_direction() {
    let robot = read("axis_tiny_or_huge.urdf");
    let axis = |name: &str| robot.joint(name).unwrap().axis;
    assert_eq!(axis("tiny"), kinstep::nalgebra::Vector3::z());
    let half = std::f64::consts::FRAC_1_SQRT_2;
    assert!((axis("huge") - kinstep::nalgebra::Vector3::new(0.0, half, half)).norm() < 1e-15);
}

#[test]
fn quaternions_keep_their_digits_where_angles_would_lose_them() {
    // A pitch of 89.9 degrees, where conversion to roll, pitch and yaw snaps to 90.
    let half = (89.9f64).to_radians() / 2.0;
    let text = format!(
        r#"<robot name="q" version="1.1"><link name="a"/><link name="b"/><joint name="j" type="continuous">
           <origin quat_xyzw="0 {:?} 0 {:?}"/><parent link="a"/><child link="b"/></joint></robot>"#,
        half.sin(),
        half.cos()
    );
    let robot = Robot::from_urdf(&text).unwrap();
    assert!((robot.joints()[0].origin.rotation.angle() - 2.0 * half).abs() < 1e-14);
}

#[test]
fn base_and_tip_must_be_two_links_of_the_robot() {
    let robot = Robot::from_urdf(include_str!("../data/two_fingers.urdf")).unwrap();
    let message = |base: &str, tip: &str| robot.chain(base, tip).unwrap_err().to_string();
    assert_eq!(message("wrst", "left"), "the robot has no link `wrst`; did you mean `wrist`?");
    assert!(message("left_pad", "wrist").contains("is a joint, between the links `left` and `left_tip`"));
    assert!(message("zzz", "wrist").contains("its links are `wrist`, `palm`, `left`"));
    assert!(message("palm", "palm").starts_with("base and tip are both `palm`"));
    assert!(robot.chain("left_tip", "wrist").is_ok() && robot.chain("left", "right").is_ok());
}

fn first_error(text: &str) -> String {
    let error = Robot::from_urdf(text).expect_err("the text is refused");
    assert!(error.first().is_some_and(|found| found.severity == Severity::Error));
    error.to_string()
}

#[test]
fn two_million_nested_tags_are_refused_at_once() {
    let text = format!("<robot name=\"deep\">{}", "<a>".repeat(2_000_000));
    let begun = Instant::now();
    let message = first_error(&text);
    assert!(message.contains(&format!("nested deeper than {MAX_DEPTH} elements")), "{message}");
    assert!(begun.elapsed().as_secs() < 10);
}

#[test]
fn the_deepest_allowed_nesting_is_read() {
    let (open, close) = ("<a>".repeat(MAX_DEPTH - 1), "</a>".repeat(MAX_DEPTH - 1));
    let joint = r#"<joint name="j" type="continuous"><parent link="b"/><child link="c"/></joint>"#;
    let text =
        format!("<robot name=\"deep\"><link name=\"b\"/><link name=\"c\"/>{joint}{open}{close}</robot>");
    assert!(Robot::from_urdf(&text).is_ok());
}

#[test]
fn a_chain_of_ten_thousand_joints_is_read_and_posed_without_recursion() {
    let robot = Robot::from_urdf(&chain_of(10_000)).unwrap();
    let chain = robot.chain("l10000", "l0").unwrap();
    assert_eq!(chain.dof(), 10_000);
    let q = vec![1e-3; chain.dof()];
    let mut scratch = chain.scratch();
    assert!(chain.forward(&q, &mut scratch).pose().rotation.angle().is_finite());
}

#[test]
fn too_many_links_elements_or_bytes_are_refused() {
    assert_eq!(Robot::from_urdf(&chain_of(MAX_JOINTS)).unwrap().joints().len(), MAX_JOINTS);
    let message = first_error(&chain_of(MAX_JOINTS + 1));
    assert!(message.contains("20002 links, more than the 20001"), "{message}");
    let message = first_error(&format!("<robot name=\"wide\">{}</robot>", "<a/>".repeat(2_000_001)));
    assert!(message.contains("more than 2000000 elements"), "{message}");
    let attributes: String = (0..300).fold(String::new(), |mut all, index| {
        let _ = write!(all, " a{index}=\"\"");
        all
    });
    assert!(
        first_error(&format!("<robot{attributes}/>")).contains("more than 256 attributes in one element")
    );
    let huge = format!("<robot name=\"big\"><link name=\"{}\"/></robot>", "x".repeat(50 << 20));
    let message = first_error(&huge);
    assert!(message.contains("has a name of 52428800 bytes") && message.len() < 500, "{message}");
    assert!(
        first_error(&" ".repeat((64 << 20) + 1)).contains("more than the 67108864 (64 MiB) that are read")
    );
}

#[test]
fn twenty_thousand_misspelt_joints_are_all_reported_in_bounded_time() {
    let mut text = chain_of(10_000);
    text = text.replace("parent link=\"l", "parent link=\"k");
    let robot = Robot::from_urdf(&text).unwrap();
    let errors = robot.diagnostics().iter().filter(|found| found.severity == Severity::Error);
    assert_eq!(errors.count(), 10_000);
}
