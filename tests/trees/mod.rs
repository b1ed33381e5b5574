//! Random trees of all joint types, and their kinematics worked out frame by frame.

#![allow(dead_code, reason = "each test file uses its own part")]

use std::fmt::Write;

use kinstep::nalgebra::{Isometry3, IsometryMatrix3, Translation3, UnitQuaternion, Vector3};
use kinstep::robot::{Chain, Robot};
use proptest::prelude::*;

/// One random joint; it leads to link `l{index + 1}`.
#[derive(Debug, Clone)]
pub(crate) struct TestJoint {
    kind: &'static str,
    parent: usize,
    xyz: [f64; 3],
    rpy: [f64; 3],
    axis: [f64; 3],
    mimic: Option<(usize, f64, f64)>,
}

#[derive(Debug, Clone)]
pub(crate) struct TestTree {
    pub(crate) joints: Vec<TestJoint>,
    is_reversed: bool,
    pub(crate) q: Vec<f64>,
}

fn axis() -> impl Strategy<Value = [f64; 3]> {
    let coordinate = (0..3usize, prop::bool::ANY).prop_map(|(i, negative)| {
        let mut axis = [0.0; 3];
        axis[i] = if negative { -1.0 } else { 1.0 };
        axis
    });
    let skew = prop::array::uniform3(-1.0..1.0)
        .prop_filter("long enough", |axis: &[f64; 3]| axis.iter().map(|x| x * x).sum::<f64>() > 0.01);
    prop_oneof![coordinate, skew]
}

fn joint(index: usize) -> impl Strategy<Value = TestJoint> {
    let kind = prop_oneof![
        3 => Just("revolute"), 2 => Just("continuous"), 2 => Just("prismatic"), 1 => Just("fixed")
    ];
    let multiplier = prop_oneof![0.3..2.0, -2.0..-0.3];
    let mimic = prop::option::weighted(0.3, (0..index.max(1), multiplier, -1.0..1.0));
    let vectors = (prop::array::uniform3(-1.0..1.0), prop::array::uniform3(-3.0..3.0), axis());
    (kind, 0..=index, vectors, mimic).prop_map(move |(kind, parent, (xyz, rpy, axis), mimic)| TestJoint {
        kind,
        parent,
        xyz,
        rpy,
        axis,
        mimic: mimic.filter(|_| kind != "fixed" && index > 0),
    })
}

fn tree() -> impl Strategy<Value = TestTree> {
    (2..10usize).prop_flat_map(|count| {
        let joints: Vec<_> = (0..count).map(joint).collect();
        (joints, prop::bool::ANY, prop::collection::vec(-2.0..2.0, count)).prop_map(
            |(mut joints, is_reversed, q)| {
                for index in 0..joints.len() {
                    let target = joints[index].mimic.map(|(target, ..)| joints[target].kind);
                    joints[index].mimic = joints[index].mimic.filter(|_| target != Some("fixed"));
                }
                TestTree { joints, is_reversed, q }
            },
        )
    })
}

impl TestTree {
    fn urdf(&self) -> String {
        let mut elements: Vec<String> =
            self.joints.iter().enumerate().map(|(index, own)| own.urdf(index)).collect();
        if self.is_reversed {
            elements.reverse();
        }
        let links: String = (0..=self.joints.len()).fold(String::new(), |mut links, index| {
            let _ = write!(links, "<link name=\"l{index}\"/>");
            links
        });
        format!("<robot name=\"random\">{}{links}</robot>", elements.concat())
    }

    pub(crate) fn robot(&self) -> Robot {
        Robot::from_urdf(&self.urdf()).expect("the tree is sound")
    }

    /// Position of a joint, its driver's followed through.
    pub(crate) fn position(&self, index: usize) -> f64 {
        match self.joints[index].mimic {
            Some((driver, multiplier, offset)) => multiplier * self.position(driver) + offset,
            None => self.q[index],
        }
    }

    /// Poses of all links in link 0, with quaternions and one frame per joint: nothing is folded.
    pub(crate) fn poses(&self) -> Vec<Isometry3<f64>> {
        let mut poses = vec![Isometry3::identity()];
        for (index, own) in self.joints.iter().enumerate() {
            let axis = Vector3::from(own.axis).normalize() * self.position(index);
            let motion = match own.kind {
                "fixed" => Isometry3::identity(),
                "prismatic" => Isometry3::from_parts(axis.into(), UnitQuaternion::identity()),
                _ => Isometry3::from_parts(Translation3::identity(), UnitQuaternion::from_scaled_axis(axis)),
            };
            let [roll, pitch, yaw] = own.rpy;
            let turn = UnitQuaternion::from_scaled_axis(Vector3::z() * yaw)
                * UnitQuaternion::from_scaled_axis(Vector3::y() * pitch)
                * UnitQuaternion::from_scaled_axis(Vector3::x() * roll);
            let origin = Isometry3::from_parts(Vector3::from(own.xyz).into(), turn);
            poses.push(poses[own.parent] * origin * motion);
        }
        poses
    }

    /// The positions of a chain's joints.
    pub(crate) fn q_of(&self, chain: &Chain) -> Vec<f64> {
        chain
            .joints()
            .iter()
            .map(|own| self.q[own.name[1..].parse::<usize>().expect("joints are j0, j1, ...")])
            .collect()
    }
}

impl TestJoint {
    fn urdf(&self, index: usize) -> String {
        let ([x, y, z], [roll, pitch, yaw], [a, b, c]) = (self.xyz, self.rpy, self.axis);
        let mimic = self.mimic.map_or(String::new(), |(driver, multiplier, offset)| {
            format!("<mimic joint=\"j{driver}\" multiplier=\"{multiplier:?}\" offset=\"{offset:?}\"/>")
        });
        format!(
            "<joint name=\"j{index}\" type=\"{}\"><origin xyz=\"{x:?} {y:?} {z:?}\" rpy=\"{roll:?} {pitch:?} {yaw:?}\"/>\
             <parent link=\"l{}\"/><child link=\"l{}\"/><axis xyz=\"{a:?} {b:?} {c:?}\"/>\
             <limit lower=\"-20\" upper=\"20\" effort=\"1\" velocity=\"1\"/>{mimic}</joint>",
            self.kind,
            self.parent,
            index + 1
        )
    }
}

pub(crate) fn distance(a: &IsometryMatrix3<f64>, b: &IsometryMatrix3<f64>) -> f64 {
    (a.translation.vector - b.translation.vector).norm() + (a.rotation.matrix() - b.rotation.matrix()).norm()
}

/// A tree and three of its links.
pub(crate) fn case() -> impl Strategy<Value = (TestTree, [usize; 3])> {
    tree().prop_flat_map(|tree| {
        let count = tree.joints.len() + 1;
        (Just(tree), prop::array::uniform3(0..count))
    })
}
