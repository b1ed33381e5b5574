//! What a scenario says, as plain values.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::approach::Approach;
use super::arm_task::ArmTask;
use super::collision_spec::{CollisionSpec, ObstacleSpec, obstacle_table};
use super::error::ScenarioError;
use super::exactly::exactly;
use super::key_path::KeyPath;
use super::kind_reader::Misread;
use super::kinds::Kinds;
use super::law_spec::LawSpec;
use super::lock_position::LockPosition;
use super::noise_spec::NoiseSpec;
use super::path_spec::PathSpec;
use super::relation_spec::RelationSpec;
use super::start_pose::StartPose;
use super::study_spec::{ProblemSpec, StudySpec};
use kinstep::integrate::StarterKind;
use kinstep::kind::Real;

/// A plan to be made: how time is discretised, what moves, along what, and how redundancy is resolved.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, expecting = "a scenario")]
pub struct Scenario {
    /// Sampling gap in s. Where it does not divide `duration` it is adjusted so that it does, with a warning.
    pub sigma: Real,
    /// Length of the motion in s.
    pub duration: Real,
    /// Id of the formula row, built-in or from `formulas`. Default: the built-in row that does best in the standard duty.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub formula: Option<String>,
    /// How the first states are made. Default: the cheapest Runge-Kutta start of sufficient order.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub start: Option<StarterKind>,
    /// Files with further formula rows, relative to the scenario's own file, or such rows themselves as text.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub formulas: Vec<String>,
    /// Permit a step size h outside the formula's feedback range, to study what happens there.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub allow_unstable: bool,
    /// How redundancy is resolved, and how strongly the task error is fed back.
    #[serde(default)]
    pub law: LawSpec,
    /// The noise that the loop suffers.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub noise: Option<NoiseSpec>,
    /// How the order of the run is studied by `kinstep order`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub study: Option<StudySpec>,
    /// An initial value problem in place of arms, for `kinstep order`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub problem: Option<ProblemSpec>,
    /// The arms, which move in synchrony.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub arm: Vec<ArmSpec>,
    /// Tasks over the tips of several arms, beside their own. `task` is another name of this key.
    #[serde(default, alias = "task", skip_serializing_if = "Vec::is_empty")]
    pub relation: Vec<RelationSpec>,
    /// What is to be kept apart. Default: nothing is looked at.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub collision: Option<CollisionSpec>,
    /// What stands still around the arms.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub obstacle: Vec<ObstacleSpec>,
}

/// One arm: a chain of a robot, where it stands, how it begins and what its tip follows.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(
    deny_unknown_fields,
    expecting = "a table [[arm]] with name, robot, base, tip, task, q0 or start_pose, and path"
)]
pub struct ArmSpec {
    /// Name of the arm: letters, digits, `-` and `_`.
    pub name: String,
    /// A built-in robot by name, a path to a URDF file or a Denavit-Hartenberg table, relative to the scenario's own
    /// file, or URDF text.
    pub robot: String,
    /// Link at which the chain begins.
    pub base: String,
    /// Link at which the chain ends: what follows the path.
    pub tip: String,
    /// What of the tip follows the path; "none" leaves the arm to its relations.
    pub task: ArmTask,
    /// Joint positions at the start in rad or m, one per joint of the chain in its order. Beside `start_pose`: positions
    /// that those found for it should be near.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub q0: Vec<Real>,
    /// Where the tip starts, in place of `q0`: joint positions are solved for, within the limits.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub start_pose: Option<StartPose>,
    /// How the arm comes to a path that does not begin at its tip: `converge`, `reach`. Default: not at all, such a start is
    /// refused.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub approach: Option<Approach>,
    /// Norm of the task error in m or rad within which an arm that converges counts as on its path. Default: 0.001.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub approach_tolerance: Option<Real>,
    /// Pose of `base` in the world. Default: the world's own.
    #[serde(default, skip_serializing_if = "Mount::is_identity")]
    pub mount: Mount,
    /// Pose of the tool's tip in the link `tip`: what then follows the path. Default: none.
    #[serde(default, skip_serializing_if = "Mount::is_identity")]
    pub tool: Mount,
    /// A file of corrections of this particular arm's joints (tables `[joint.NAME]` with `xyz`, `rpy`, `zero`,
    /// `reversed`), relative to the scenario's own file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub calibration: Option<String>,
    /// A file of joint limits that go over the robot's own (`joint_limits` as in MoveIt's joint_limits.yaml), relative to the
    /// scenario's own file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub limits: Option<String>,
    /// Joints of the robot that are held still, by name; on the arm's path they count as fixed.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub lock: BTreeMap<String, LockPosition>,
    /// Whether the arm has to move by itself: a joint in common with another arm is then refused rather than shared.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub independent: bool,
    /// Whether joints without a `<limit>` element move without limits. Default: no chain passes through them.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub assume_unlimited: bool,
    /// The path of the tip; an arm without a task has none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub path: Option<PathSpec>,
}

/// A pose in the world, or in the link that something is put on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, expecting = "a table such as { xyz = [0, 0, 0], rpy = [0, 0, 0] }")]
pub struct Mount {
    /// Position in m.
    #[serde(default = "zeros", deserialize_with = "exactly")]
    pub xyz: [Real; 3],
    /// Roll, pitch and yaw about fixed axes in rad, as in URDF.
    #[serde(default = "zeros", deserialize_with = "exactly")]
    pub rpy: [Real; 3],
}

fn zeros() -> [Real; 3] {
    [0.0, 0.0, 0.0].map(Real::from)
}

impl Default for Mount {
    fn default() -> Self {
        Self { xyz: zeros(), rpy: zeros() }
    }
}

impl Mount {
    pub(super) fn is_identity(&self) -> bool {
        *self == Self::default()
    }
}

impl Scenario {
    /// All paths: those of arms, then those of relations.
    pub(super) fn paths_mut(&mut self) -> impl Iterator<Item = &mut PathSpec> {
        let relations = self.relation.iter_mut();
        let relations = relations.flat_map(|relation| relation.path.iter_mut().chain(&mut relation.relative));
        self.arm.iter_mut().filter_map(|arm| arm.path.as_mut()).chain(relations)
    }

    /// Reads the parameters of everything that names a kind by the registries of its kinds.
    pub(super) fn read_kinds(&mut self, kinds: &Kinds) -> Vec<Misread> {
        let mut misread = self.law.read(kinds);
        for (index, arm) in self.arm.iter_mut().enumerate() {
            let arms = KeyPath::dotted("arm");
            let at = if arm.name.is_empty() { arms.index(index) } else { arms.key(&arm.name) };
            misread.extend(arm.path.iter_mut().flat_map(|path| path.read(&at.key("path"), kinds)));
        }
        for (index, relation) in self.relation.iter_mut().enumerate() {
            misread.extend(relation.read(&KeyPath::dotted("relation").index(index), kinds));
        }
        for (index, obstacle) in self.obstacle.iter_mut().enumerate() {
            let at = KeyPath::dotted("obstacle").index(index);
            let table = obstacle_table(&at, kinds, &obstacle.kind);
            misread.extend(table.read(&mut obstacle.parameters).err());
        }
        misread
    }

    /// Returns the scenario with everything read and checked.
    ///
    /// # Errors
    /// As [`Scenario::check_with`].
    pub(super) fn read_and_checked(&self, kinds: &Kinds) -> Result<Self, ScenarioError> {
        let mut scenario = self.clone();
        let misread = scenario.read_kinds(kinds);
        ScenarioError::all(misread.iter().map(|misread| &misread.error)).map_or(Ok(()), Err)?;
        scenario.check_with(kinds)?;
        Ok(scenario)
    }

    /// Returns the scenario as TOML that reads back as the same scenario.
    #[expect(
        clippy::missing_panics_doc,
        reason = "a scenario is tables, text and numbers, which TOML can write"
    )]
    pub fn to_toml(&self) -> String {
        toml::to_string(self).expect("a scenario has only tables with text keys, finite numbers and text")
    }
}
