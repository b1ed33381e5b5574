//! Random serial arms, away from singularity where they stand.

use super::configuration::{is_away, singular_values};
use kinstep::robot::{Chain, Robot};
use kinstep::task::TaskKind;
use proptest::prelude::*;
use proptest::sample::select;
use std::fmt::{self, Write as _};

/// The axes drawn for spatial arms; URDF normalises them.
const AXES: [[i8; 3]; 8] =
    [[0, 0, 1], [0, 1, 0], [1, 0, 0], [0, 1, 1], [1, 0, 1], [1, 1, 0], [1, -1, 1], [2, -1, 2]];

/// One joint of a random arm, and where the next one (or the tip) sits on its link.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct JointCase {
    /// Whether it slides instead of turning.
    pub slides: bool,
    /// Direction of its axis, of any length.
    pub axis: [i8; 3],
    /// From this joint to the next \[1/20 m\].
    pub offset: [i8; 3],
    /// Where it starts \[5 degrees or 1/20 m\].
    pub at: i8,
}

/// A random serial arm from link `base` to link `tip`, where it starts, and which task it can take on.
#[derive(Clone, PartialEq, Eq)]
pub struct ArmCase {
    /// The joints, from the base.
    pub joints: Vec<JointCase>,
    /// The components of the tip's pose that it controls.
    pub task: TaskKind,
}

impl ArmCase {
    /// The robot file.
    pub fn urdf(&self) -> String {
        let mut text = String::from("<robot name=\"random\">\n  <link name=\"base\"/>\n");
        let mut parent = "base".to_owned();
        let mut origin = [0, 0, 0];
        for (i, joint) in self.joints.iter().enumerate() {
            let child = format!("link{}", i + 1);
            let (kind, limit) = if joint.slides {
                ("prismatic", "<limit lower=\"-2\" upper=\"2\" effort=\"1\" velocity=\"100\"/>")
            } else {
                ("continuous", "")
            };
            let axis = joint.axis.map(|entry| entry.to_string()).join(" ");
            // Writing to a String can not fail.
            let _ = writeln!(
                text,
                "  <link name=\"{child}\"/>\n  <joint name=\"j{}\" type=\"{kind}\"><parent link=\"{parent}\"/><child link=\"{child}\"/><origin xyz=\"{}\"/><axis xyz=\"{axis}\"/>{limit}</joint>",
                i + 1,
                in_twentieths(origin)
            );
            (parent, origin) = (child, joint.offset);
        }
        let _ = writeln!(
            text,
            "  <link name=\"tip\"/>\n  <joint name=\"flange\" type=\"fixed\"><parent link=\"{parent}\"/><child link=\"tip\"/><origin xyz=\"{}\"/></joint>\n</robot>",
            in_twentieths(origin)
        );
        text
    }

    /// The chain from base to tip, read from the robot file. `None` if the file does not read, which its own tests rule out.
    pub fn chain(&self) -> Option<Chain> {
        Robot::from_urdf(&self.urdf()).ok()?.chain("base", "tip").ok()
    }

    /// Where the joints start \[rad or m\].
    pub fn q0(&self) -> Vec<f64> {
        let value = |joint: &JointCase| {
            let at = f64::from(joint.at);
            if joint.slides { at / 20.0 } else { (5.0 * at).to_radians() }
        };
        self.joints.iter().map(value).collect()
    }

    /// The smallest and the largest singular value of the task Jacobian at `q`.
    pub fn singular_values(&self, chain: &Chain, q: &[f64]) -> (f64, f64) {
        singular_values(chain, self.task, q)
    }

    fn starts_well(&self) -> bool {
        self.chain()
            .is_some_and(|chain| chain.dof() == self.joints.len() && is_away(&chain, self.task, &self.q0()))
    }
}

/// A place on a link, in metres.
pub(super) fn in_twentieths(offset: [i8; 3]) -> String {
    offset.map(|entry| (f64::from(entry) / 20.0).to_string()).join(" ")
}

impl fmt::Display for ArmCase {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "task = {}, q0 = {:?}\n{}", self.task.name(), self.q0(), self.urdf())
    }
}

impl fmt::Debug for ArmCase {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        fmt::Display::fmt(self, f)
    }
}

/// Planar and spatial arms of 4 to 9 joints, most of them turning, with a condition number of at most 25 where they start.
/// Planar arms control the position in their plane, spatial ones position or, from 7 joints on, the pose.
pub fn arms() -> impl Strategy<Value = ArmCase> + Clone {
    let planar = prop::collection::vec(planar_joint(), 4..=9)
        .prop_map(|joints| ArmCase { joints, task: TaskKind::PositionXy });
    let spatial =
        (prop::collection::vec(spatial_joint(), 4..=9), any::<bool>()).prop_map(|(joints, pose)| {
            let task = if pose && joints.len() >= 7 { TaskKind::Pose } else { TaskKind::Position };
            ArmCase { joints, task }
        });
    prop_oneof![1 => planar, 2 => spatial].prop_filter("well conditioned at the start", ArmCase::starts_well)
}

fn planar_joint() -> impl Strategy<Value = JointCase> + Clone {
    (prop::bool::weighted(0.1), 4_i8..=20, -30_i8..=30).prop_map(|(slides, length, at)| JointCase {
        slides,
        axis: if slides { [1, 0, 0] } else { [0, 0, 1] },
        offset: [length, 0, 0],
        at: if slides { at / 6 } else { at },
    })
}

fn spatial_joint() -> impl Strategy<Value = JointCase> + Clone {
    let offset = prop::array::uniform3(-6_i8..=10);
    (prop::bool::weighted(0.1), select(&AXES[..]), offset, -30_i8..=30).prop_map(
        |(slides, axis, offset, at)| JointCase { slides, axis, offset, at: if slides { at / 6 } else { at } },
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use kinstep::robot::Severity;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        #[test]
        fn arms_read_without_complaint_and_start_away_from_singularity(arm in arms()) {
            let robot = Robot::from_urdf(&arm.urdf()).unwrap();
            let loud = robot.diagnostics().iter().any(|found| found.severity > Severity::Note);
            prop_assert!(!loud, "{:?}", robot.diagnostics());
            let chain = arm.chain().unwrap();
            prop_assert!((4..=9).contains(&chain.dof()));
            prop_assert!(chain.limit_violations(&arm.q0()).next().is_none());
            let (smallest, largest) = arm.singular_values(&chain, &arm.q0());
            prop_assert!(largest / smallest <= 25.0);
        }
    }
}
