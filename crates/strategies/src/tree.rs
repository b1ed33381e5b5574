//! Random trees of joints of every kind that a chain passes through, and chains between any two of their links.

use super::arm::in_twentieths;
use kinstep::robot::{Chain, JointKind, Robot};
use proptest::prelude::*;
use proptest::sample::Index;
use std::fmt::{self, Write as _};

/// The limits of joints that have some [rad or m]: wide enough for every follower.
const LIMIT: &str = "<limit lower=\"-19.5\" upper=\"19.5\" effort=\"1\" velocity=\"100\"/>";

/// How a joint follows another: `multiplier * driver + offset`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Follower {
    /// Index of the joint that drives it, an earlier one; it may be a follower itself, or lie on another branch.
    pub driver: usize,
    /// How far it moves for its driver \[1/4\]; not zero.
    pub multiplier: i8,
    /// Where it stands when its driver stands at zero \[1/10 rad or m\].
    pub offset: i8,
}

/// One joint of a random tree. The joint of index `i` is called `j{i + 1}` and leads to link `l{i + 1}`; the root is `l0`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TreeJoint {
    /// Revolute, continuous, prismatic or fixed.
    pub kind: JointKind,
    /// Number of the link that it stands on.
    pub parent: usize,
    /// Where it stands on that link \[1/20 m\].
    pub xyz: [i8; 3],
    /// How it is turned there: roll, pitch and yaw \[1/10 rad\].
    pub rpy: [i8; 3],
    /// Direction of its axis, of any length but zero.
    pub axis: [i8; 3],
    /// The joint that it follows, if any.
    pub follower: Option<Follower>,
    /// Its position, if it moves on its own \[1/10 rad or m\].
    pub at: i8,
}

/// A random tree and where its joints stand.
#[derive(Clone, PartialEq, Eq)]
pub struct TreeCase {
    /// The joints, parents before their children.
    pub joints: Vec<TreeJoint>,
    /// Whether the file has the children before their parents: URDF leaves the order open.
    pub children_first: bool,
}

impl TreeCase {
    /// The number of links, the root among them.
    pub fn links(&self) -> usize {
        self.joints.len() + 1
    }

    /// The robot file.
    pub fn urdf(&self) -> String {
        let mut lines: Vec<String> =
            self.joints.iter().enumerate().map(|(i, joint)| joint.urdf(i + 1)).collect();
        if self.children_first {
            lines.reverse();
        }
        let links: Vec<String> = (0..self.links()).map(|link| format!("<link name=\"l{link}\"/>")).collect();
        format!("<robot name=\"random\">\n  {}\n{}</robot>\n", links.concat(), lines.concat())
    }

    /// The robot, read from the robot file. `None` if the file does not read, which its own tests rule out.
    pub fn robot(&self) -> Option<Robot> {
        Robot::from_urdf(&self.urdf()).ok()
    }

    /// The position of joint `j{i + 1}` [rad or m], that of a follower worked out from its driver's.
    ///
    /// # Panics
    /// If there is no such joint.
    pub fn position(&self, i: usize) -> f64 {
        let joint = &self.joints[i];
        match joint.follower {
            Some(Follower { driver, multiplier, offset }) => {
                f64::from(multiplier) / 4.0 * self.position(driver) + f64::from(offset) / 10.0
            }
            None => f64::from(joint.at) / 10.0,
        }
    }

    /// The position of the joint of that name [rad or m].
    pub fn position_of(&self, joint: &str) -> Option<f64> {
        let number: usize = joint.strip_prefix('j')?.parse().ok()?;
        (1..self.links()).contains(&number).then(|| self.position(number - 1))
    }

    /// The positions [rad or m] of the joints of a chain through the tree, in the chain's order.
    pub fn q_of(&self, chain: &Chain) -> Vec<f64> {
        chain.joints().iter().map(|joint| self.position_of(&joint.name).unwrap_or(f64::NAN)).collect()
    }
}

impl TreeJoint {
    fn urdf(&self, number: usize) -> String {
        let tenths = |rpy: [i8; 3]| rpy.map(|entry| (f64::from(entry) / 10.0).to_string()).join(" ");
        let rpy = if self.rpy == [0; 3] { String::new() } else { format!(" rpy=\"{}\"", tenths(self.rpy)) };
        let mut text = format!(
            "  <joint name=\"j{number}\" type=\"{}\"><parent link=\"l{}\"/><child link=\"l{number}\"/><origin xyz=\"{}\"{rpy}/>",
            self.kind.as_str(),
            self.parent,
            in_twentieths(self.xyz)
        );
        if self.kind != JointKind::Fixed {
            // Writing to a String can not fail.
            let _ = write!(text, "<axis xyz=\"{}\"/>", self.axis.map(|entry| entry.to_string()).join(" "));
        }
        if matches!(self.kind, JointKind::Revolute | JointKind::Prismatic) {
            text += LIMIT;
        }
        if let Some(Follower { driver, multiplier, offset }) = self.follower {
            let (multiplier, offset) = (f64::from(multiplier) / 4.0, f64::from(offset) / 10.0);
            let driver = driver + 1;
            let _ =
                write!(text, "<mimic joint=\"j{driver}\" multiplier=\"{multiplier}\" offset=\"{offset}\"/>");
        }
        text + "</joint>\n"
    }
}

impl fmt::Display for TreeCase {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let is_free = |joint: &TreeJoint| joint.kind != JointKind::Fixed && joint.follower.is_none();
        let free = (0..self.joints.len()).filter(|&i| is_free(&self.joints[i]));
        let positions: Vec<_> = free.map(|i| format!("j{} = {}", i + 1, self.position(i))).collect();
        write!(f, "{}\n{}", positions.join(", "), self.urdf())
    }
}

impl fmt::Debug for TreeCase {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "\n{self}")
    }
}

/// A chain through a random tree, up or down or both; at least one joint moves it.
#[derive(Clone, PartialEq, Eq)]
pub struct ChainCase {
    /// The tree.
    pub tree: TreeCase,
    /// Number of the link where the chain begins.
    pub base: usize,
    /// Number of the link where it ends, another one.
    pub tip: usize,
}

impl ChainCase {
    /// The chain. `None` if the tree does not read, which its own tests rule out.
    pub fn chain(&self) -> Option<Chain> {
        self.tree.robot()?.chain(&format!("l{}", self.base), &format!("l{}", self.tip)).ok()
    }

    /// Where its joints stand [rad or m].
    pub fn q(&self) -> Vec<f64> {
        self.chain().map(|chain| self.tree.q_of(&chain)).unwrap_or_default()
    }
}

impl fmt::Display for ChainCase {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "base = l{}, tip = l{}, {}", self.base, self.tip, self.tree)
    }
}

impl fmt::Debug for ChainCase {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "\n{self}")
    }
}

/// Planar and spatial trees of 2 to 10 joints: revolute, continuous, prismatic and fixed ones, some of which follow others. At least
/// one of them moves.
pub fn trees() -> impl Strategy<Value = TreeCase> + Clone {
    let mixed = prop_oneof![
        3 => Just(JointKind::Revolute),
        2 => Just(JointKind::Continuous),
        2 => Just(JointKind::Prismatic),
        1 => Just(JointKind::Fixed),
    ];
    let moves = |tree: &TreeCase| tree.joints.iter().any(|joint| joint.kind != JointKind::Fixed);
    of_joints(2, mixed, true).prop_filter("a joint moves", moves)
}

/// Trees of 4 to 10 joints that turn on their own.
pub(super) fn turning_trees() -> impl Strategy<Value = TreeCase> + Clone {
    of_joints(4, prop_oneof![1 => Just(JointKind::Revolute), 2 => Just(JointKind::Continuous)], false)
}

/// Two links of a tree between which something moves.
pub fn chains() -> impl Strategy<Value = ChainCase> + Clone {
    chains_through(trees())
}

pub(super) fn chains_through(
    trees: impl Strategy<Value = TreeCase> + Clone,
) -> impl Strategy<Value = ChainCase> + Clone {
    (trees, any::<[Index; 2]>()).prop_filter_map("a joint moves between the links", |(tree, ends)| {
        let [base, tip] = ends.map(|end| end.index(tree.links()));
        let case = ChainCase { tree, base, tip };
        // From a link to itself there is no chain.
        case.chain().is_some_and(|chain| chain.dof() > 0).then_some(case)
    })
}

/// A joint before its place in a tree is known.
#[derive(Clone, Debug)]
struct Loose {
    joint: TreeJoint,
    /// How many links before the last one it stands on; never beyond the root.
    back: usize,
    driver: Index,
}

fn of_joints(
    fewest: usize,
    kind: impl Strategy<Value = JointKind> + Clone + 'static,
    may_follow: bool,
) -> impl Strategy<Value = TreeCase> + Clone {
    let planar = prop::collection::vec(loose(kind.clone(), planar_place(), may_follow), fewest..=10);
    let spatial = prop::collection::vec(loose(kind, spatial_place(), may_follow), fewest..=10);
    (prop_oneof![1 => planar, 3 => spatial], any::<bool>()).prop_map(|(joints, children_first)| {
        let mut tree = TreeCase { joints: Vec::new(), children_first };
        for loose in joints {
            let joint = loose.placed(&tree.joints);
            tree.joints.push(joint);
        }
        tree
    })
}

impl Loose {
    /// The joint on a tree of the joints before it. It follows only what moves.
    fn placed(self, earlier: &[TreeJoint]) -> TreeJoint {
        let mut joint = self.joint;
        joint.parent = earlier.len().saturating_sub(self.back);
        joint.follower = joint
            .follower
            .filter(|_| joint.kind != JointKind::Fixed && !earlier.is_empty())
            .map(|follower| Follower { driver: self.driver.index(earlier.len()), ..follower })
            .filter(|follower| earlier[follower.driver].kind != JointKind::Fixed);
        joint
    }
}

/// Where a joint stands on its link, how it is turned there, and its axis: one for turning, one for sliding.
type Place = ([i8; 3], [i8; 3], [[i8; 3]; 2]);

/// In the plane of x and y.
fn planar_place() -> impl Strategy<Value = Place> + Clone {
    let sign = prop_oneof![Just(1_i8), Just(-1)];
    let slide = (-2_i8..=2, -2_i8..=2).prop_filter("a direction", |axis| *axis != (0, 0));
    (-20_i8..=20, -20_i8..=20, -30_i8..=30, sign, slide)
        .prop_map(|(x, y, yaw, sign, slide)| ([x, y, 0], [0, 0, yaw], [[0, 0, sign], [slide.0, slide.1, 0]]))
}

/// In space, with axes along the coordinates as most robots have them, or any other way.
fn spatial_place() -> impl Strategy<Value = Place> + Clone {
    let along = (0..3_usize, any::<bool>()).prop_map(|(i, negative)| {
        let mut axis = [0; 3];
        axis[i] = if negative { -1 } else { 1 };
        axis
    });
    let skew = prop::array::uniform3(-5_i8..=5).prop_filter("a direction", |axis| *axis != [0; 3]);
    let turn = prop_oneof![1 => Just([0; 3]), 3 => prop::array::uniform3(-30_i8..=30)];
    (prop::array::uniform3(-20_i8..=20), turn, prop_oneof![along, skew])
        .prop_map(|(xyz, rpy, axis)| (xyz, rpy, [axis, axis]))
}

fn loose(
    kind: impl Strategy<Value = JointKind> + Clone,
    place: impl Strategy<Value = Place> + Clone,
    may_follow: bool,
) -> impl Strategy<Value = Loose> + Clone {
    let multiplier = prop_oneof![1_i8..=8, -8_i8..=-1];
    let follower = prop::option::weighted(0.3, (multiplier, -10_i8..=10))
        .prop_map(move |follower| follower.filter(|_| may_follow));
    let back = prop_oneof![2 => Just(0_usize), 1 => 0..10_usize];
    (kind, place, follower, -20_i8..=20, back, any::<Index>()).prop_map(
        |(kind, (xyz, rpy, [turn, slide]), follower, at, back, driver)| {
            let axis = if kind == JointKind::Prismatic { slide } else { turn };
            let follower = follower.map(|(multiplier, offset)| Follower { driver: 0, multiplier, offset });
            let joint = TreeJoint { kind, parent: 0, xyz, rpy, axis, follower, at };
            Loose { joint, back, driver }
        },
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use kinstep::robot::Severity;
    use proptest::test_runner::{Config, TestError, TestRunner};

    /// Fails on any tree of that nature, and returns the smallest that shrinking comes to.
    fn smallest(is_such: impl Fn(&TreeCase) -> bool) -> TreeCase {
        let config = Config { cases: 1000, failure_persistence: None, ..Config::default() };
        let failed = TestRunner::new(config).run(&trees(), |tree| {
            prop_assert!(!is_such(&tree));
            Ok(())
        });
        let Err(TestError::Fail(_, tree)) = failed else { panic!("no such tree was drawn") };
        tree
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        #[test]
        fn trees_read_without_complaint_whatever_the_order_of_their_joints(tree in trees()) {
            let robot = tree.robot().unwrap();
            let loud = robot.diagnostics().iter().any(|found| found.severity > Severity::Note);
            prop_assert!(!loud, "{:?}", robot.diagnostics());
            prop_assert_eq!((robot.links().len(), robot.roots().count()), (tree.links(), 1));
            let reordered = TreeCase { children_first: !tree.children_first, ..tree }.robot().unwrap();
            for joint in robot.joints() {
                let other = reordered.joint(&joint.name).unwrap();
                prop_assert_eq!((joint.kind, joint.axis, joint.origin), (other.kind, other.axis, other.origin));
            }
        }

        #[test]
        fn every_joint_of_a_chain_has_a_position(case in chains()) {
            let (chain, q) = (case.chain().unwrap(), case.q());
            prop_assert!(chain.dof() > 0 && q.len() == chain.dof());
            prop_assert!(q.iter().all(|q| q.is_finite()));
        }
    }

    #[test]
    fn trees_have_everything_that_is_promised() {
        let on_another_branch = |tree: &TreeCase| {
            let robot = tree.robot().unwrap();
            let tips: Vec<String> = (1..tree.links()).map(|link| format!("l{link}")).collect();
            let chains = tips.iter().filter_map(|tip| robot.chain("l0", tip).ok());
            let mut off_the_path = chains.flat_map(|chain| {
                let path: Vec<usize> = path_to(tree, chain.tip()[1..].parse().unwrap());
                let name = |joint: &kinstep::robot::ChainJoint| joint.name[1..].parse::<usize>().unwrap();
                chain.joints().iter().map(name).filter(|number| !path.contains(number)).collect::<Vec<_>>()
            });
            off_the_path.next().is_some()
        };
        assert!(on_another_branch(&smallest(on_another_branch)));
        let of_followers = |tree: &TreeCase| {
            let driver = |joint: &TreeJoint| joint.follower.map(|follower| follower.driver);
            tree.joints.iter().filter_map(driver).any(|driver| tree.joints[driver].follower.is_some())
        };
        assert!(of_followers(&smallest(of_followers)));
        let flat =
            |tree: &TreeCase| tree.joints.iter().all(|joint| joint.xyz[2] == 0 && joint.rpy[..2] == [0, 0]);
        assert!(flat(&smallest(flat)));
    }

    /// The numbers of the links from the root to one, that one among them.
    fn path_to(tree: &TreeCase, link: usize) -> Vec<usize> {
        let above = |&link: &usize| (link > 0).then(|| tree.joints[link - 1].parent);
        std::iter::successors(Some(link), above).collect()
    }

    #[test]
    fn a_failure_shrinks_to_few_joints_and_small_numbers() {
        let tree = smallest(|tree| tree.joints.iter().any(|joint| joint.kind == JointKind::Prismatic));
        assert_eq!(tree.joints.len(), 2, "{tree}");
        assert!(
            tree.joints.iter().all(|joint| joint.follower.is_none() && joint.xyz == [0; 3] && joint.at == 0)
        );
        let text = format!("{tree:?}");
        assert!(text.contains("<robot name=\"random\">") && text.contains("type=\"prismatic\""), "{text}");
        assert!(text.len() < 700, "{text}");
    }
}
