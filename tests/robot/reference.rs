//! The robots of `robots/`, held to figures that did not come from this crate: poses and Jacobians that
//! Pinocchio computes from the same files (`robot_*.json`), and tip poses of models that others wrote
//! (`independent_*.json`). The scripts that made the figures are in `scripts/`; `robots/SOURCES.md` says
//! what they are.

use std::path::{Path, PathBuf};

use kinstep::robot::{Chain, Robot, embedded};
use nalgebra::{Matrix3, Vector6};
use serde::Deserialize;

/// Figures of one robot.
#[derive(Deserialize)]
struct Figures {
    robot: String,
    chains: Vec<ChainFigures>,
}

/// Figures of one chain; `joints` in the order of the columns.
#[derive(Deserialize)]
struct ChainFigures {
    base: String,
    tip: String,
    joints: Vec<String>,
    limits: Option<Vec<[f64; 2]>>,
    samples: Vec<Sample>,
}

/// The pose of the tip in the base at joint values `q`; rotation and Jacobian by rows.
#[derive(Deserialize)]
struct Sample {
    q: Vec<f64>,
    position: [f64; 3],
    rotation: [[f64; 3]; 3],
    jacobian: Option<Vec<Vec<f64>>>,
}

/// Largest absolute differences from the figures: position [m], rotation matrix, Jacobian [m and 1].
#[derive(Debug, Default, Clone, Copy)]
struct Differences {
    position: f64,
    rotation: f64,
    jacobian: f64,
}

impl Differences {
    fn worst(self, other: Self) -> Self {
        Self {
            position: self.position.max(other.position),
            rotation: self.rotation.max(other.rotation),
            jacobian: self.jacobian.max(other.jacobian),
        }
    }
}

/// All figures in `tests/data` whose file name starts with `prefix`, in the order of their names.
fn figures(prefix: &str) -> Vec<Figures> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data");
    let entries = std::fs::read_dir(folder).expect("the folder of figures is part of the repository");
    let mut paths: Vec<PathBuf> = entries.map(|entry| entry.expect("a readable entry").path()).collect();
    paths.retain(|path| path.file_name().is_some_and(|name| name.to_string_lossy().starts_with(prefix)));
    paths.sort();
    paths.iter().map(|path| read_figures(path)).collect()
}

fn read_figures(path: &Path) -> Figures {
    let text = std::fs::read_to_string(path).expect("a readable file of figures");
    serde_json::from_str(&text).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

fn chain_of(robot: &Robot, figures: &ChainFigures) -> Chain {
    robot
        .chain(&figures.base, &figures.tip)
        .unwrap_or_else(|error| panic!("{} -> {}: {error}", figures.base, figures.tip))
}

/// How far the chain is from the figures, at the worst of the samples.
fn differences(chain: &Chain, figures: &ChainFigures) -> Differences {
    assert!(!figures.samples.is_empty());
    figures
        .samples
        .iter()
        .map(|sample| difference(chain, sample))
        .fold(Differences::default(), Differences::worst)
}

fn difference(chain: &Chain, sample: &Sample) -> Differences {
    let mut scratch = chain.scratch();
    let posed = chain.forward(&sample.q, &mut scratch);
    let pose = posed.pose();
    let rotation = Matrix3::from_fn(|row, column| sample.rotation[row][column]);
    let mut columns = vec![Vector6::zeros(); chain.dof()];
    posed.geometric_jacobian(&mut columns);
    Differences {
        position: largest(pose.translation.vector.iter().zip(&sample.position)),
        rotation: largest(pose.rotation.matrix().iter().zip(&rotation)),
        jacobian: sample.jacobian.as_ref().map_or(0.0, |rows| jacobian_difference(&columns, rows)),
    }
}

/// The largest absolute difference; not a number counts as infinity.
fn largest<'a>(pairs: impl Iterator<Item = (&'a f64, &'a f64)>) -> f64 {
    let differences = pairs.map(|(a, b)| (a - b).abs());
    differences.fold(0.0, |worst, found| if found.is_nan() { f64::INFINITY } else { worst.max(found) })
}

fn jacobian_difference(columns: &[Vector6<f64>], rows: &[Vec<f64>]) -> f64 {
    assert_eq!(rows.len(), 6);
    assert!(rows.iter().all(|row| row.len() == columns.len()));
    let of_row = |(i, row): (usize, &Vec<f64>)| largest(columns.iter().map(|column| &column[i]).zip(row));
    rows.iter().enumerate().map(of_row).fold(0.0, f64::max)
}

/// Whether a robot is the independent model's, to a micrometre and a microradian at every sample.
fn is_the_independent_robot(robot: &Robot, figures: &Figures) -> bool {
    figures.chains.iter().all(|figures| {
        let found = differences(&chain_of(robot, figures), figures);
        found.position < 1e-6 && found.rotation < 1e-6
    })
}

#[test]
fn poses_and_jacobians_are_pinocchios() {
    let all = figures("robot_");
    for figures in &all {
        let robot = embedded::get(&figures.robot).expect("an embedded robot");
        for figures in &figures.chains {
            let found = differences(&chain_of(&robot, figures), figures);
            let largest = found.position.max(found.rotation).max(found.jacobian);
            assert!(largest < 1e-12, "{} -> {}: {found:?}", figures.base, figures.tip);
        }
    }
}

#[test]
fn every_embedded_robot_has_reference_figures() {
    let known: Vec<String> = figures("robot_").into_iter().map(|figures| figures.robot).collect();
    for name in embedded::names() {
        assert!(known.iter().any(|robot| *robot == name), "no tests/data/robot_{name}.json");
    }
}

#[test]
fn columns_are_the_figures_joints_in_path_order() {
    for figures in figures("robot_").iter().chain(&figures("independent_")) {
        let robot = embedded::get(&figures.robot).expect("an embedded robot");
        for figures in &figures.chains {
            let chain = chain_of(&robot, figures);
            let names: Vec<&str> = chain.joints().iter().map(|joint| joint.name.as_ref()).collect();
            assert_eq!(names, figures.joints, "{} -> {}", figures.base, figures.tip);
        }
    }
}

#[test]
fn tips_are_where_independent_models_put_them() {
    let all = figures("independent_");
    assert!(all.len() >= 4);
    for figures in &all {
        let robot = embedded::get(&figures.robot).expect("an embedded robot");
        assert!(is_the_independent_robot(&robot, figures), "{}", figures.robot);
    }
}

#[test]
fn position_limits_are_the_independent_models() {
    for figures in figures("independent_") {
        let robot = embedded::get(&figures.robot).expect("an embedded robot");
        for figures in &figures.chains {
            let limits = figures.limits.as_ref().expect("independent figures state the limits");
            for (joint, [lower, upper]) in chain_of(&robot, figures).joints().iter().zip(limits) {
                assert!((joint.limits.lower - lower).abs() < 1e-9, "{}: {:?}", joint.name, joint.limits);
                assert!((joint.limits.upper - upper).abs() < 1e-9, "{}: {:?}", joint.name, joint.limits);
            }
        }
    }
}

/// Copies of a URDF with one nonzero number in a joint's origin larger by 1e-5 (m in `xyz`, rad in `rpy`),
/// each beside what it changed.
fn perturbed(urdf: &str) -> Vec<(String, String)> {
    let document = roxmltree::Document::parse(urdf).expect("a file that reads is XML");
    let joints = document.descendants().filter(|node| node.has_tag_name("joint"));
    let origins = joints.flat_map(|joint| joint.children().filter(|node| node.has_tag_name("origin")));
    let mut copies = Vec::new();
    for attribute in origins.flat_map(|origin| origin.attributes()) {
        let numbers: Vec<f64> =
            attribute.value().split(' ').map(|word| word.parse().expect("a number")).collect();
        for index in (0..numbers.len()).filter(|&index| numbers[index] != 0.0) {
            let mut changed = numbers.clone();
            changed[index] += 1e-5;
            let words: Vec<String> = changed.iter().map(f64::to_string).collect();
            let mut copy = urdf.to_owned();
            copy.replace_range(attribute.range_value(), &words.join(" "));
            copies.push((format!("{}[{index}] = {}", attribute.name(), numbers[index]), copy));
        }
    }
    copies
}

#[test]
fn no_length_or_angle_off_by_a_hundred_thousandth_passes_for_the_independent_robot() {
    for figures in figures("independent_") {
        let copies = perturbed(embedded::text(&figures.robot).expect("an embedded robot"));
        assert!(copies.len() >= 4, "{}: nothing to change", figures.robot);
        for (change, copy) in copies {
            let robot = Robot::from_urdf(&copy).expect("a changed number still reads");
            assert!(!is_the_independent_robot(&robot, &figures), "{}: {change} passed", figures.robot);
        }
    }
}
