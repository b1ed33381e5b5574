//! Where a tip starts, and the joint positions found for it.

use std::fmt;

use nalgebra::{IsometryMatrix3, Rotation3, Translation3, Vector3};
use serde::de::value::MapAccessDeserializer;
use serde::{Deserialize, Deserializer, Serialize};

use super::build::vector;
use super::error::{ErrorKind, ScenarioError};
use super::exactly::some_exactly;
use super::key_path::KeyPath;
use super::kinds::Kinds;
use super::model::ArmSpec;
use super::path_spec::PathSpec;
use kinstep::inverse::{Search, Solution, Target};
use kinstep::kind::Real;
use kinstep::robot::Chain;
use kinstep::task::TaskKind;

/// Where the tip of an arm starts: on its path, or at a pose in the world.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(untagged)]
pub enum StartPose {
    /// At the first point of its path, which `center` lays into the world.
    Path(OnPath),
    /// At a pose in world axes.
    Pose(TipPose),
}

/// The word for the first point of the path.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum OnPath {
    /// The first point of the path.
    Path,
}

/// A pose of the tip in world axes, as far as it is asked for.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct TipPose {
    /// Position in m: x, y and z; in the plane x and y will do. Default: the first point of the path.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub xyz: Option<Vec<Real>>,
    /// Roll, pitch and yaw about fixed axes in rad, as in URDF. Needed where the task is "pose", else free.
    #[serde(default, deserialize_with = "some_exactly", skip_serializing_if = "Option::is_none")]
    pub rpy: Option<[Real; 3]>,
}

impl<'de> Deserialize<'de> for StartPose {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(StartPoseVisitor)
    }
}

struct StartPoseVisitor;

impl<'de> serde::de::Visitor<'de> for StartPoseVisitor {
    type Value = StartPose;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a table such as { xyz = [0.4, 0, 0.3], rpy = [\"pi\", 0, 0] }, or the word \"path\"")
    }

    fn visit_str<E: serde::de::Error>(self, text: &str) -> Result<StartPose, E> {
        match text {
            "path" => Ok(StartPose::Path(OnPath::Path)),
            _ => Err(E::unknown_variant(text, &["path"])),
        }
    }

    fn visit_map<A: serde::de::MapAccess<'de>>(self, map: A) -> Result<StartPose, A::Error> {
        TipPose::deserialize(MapAccessDeserializer::new(map)).map(StartPose::Pose)
    }
}

impl StartPose {
    /// Position and orientation, as far as they are given.
    pub(super) fn parts(&self) -> (Option<&[Real]>, Option<&[Real; 3]>) {
        match self {
            Self::Path(_) => (None, None),
            Self::Pose(TipPose { xyz, rpy }) => (xyz.as_deref(), rpy.as_ref()),
        }
    }

    /// What the arm's tip is asked to reach, in world axes.
    fn target(&self, arm: &ArmSpec, kinds: &Kinds, duration: f64) -> Target {
        let (xyz, rpy) = self.parts();
        // A path without a place of its own has been refused, so that where the tip stands does not matter.
        let path = arm.path.as_ref();
        let motion = path.and_then(|path| path.motion_with(kinds, &IsometryMatrix3::identity(), duration));
        let beginning = motion.map(|motion| motion.at(0.0));
        let place = match (xyz, &beginning) {
            (Some(xyz), _) => vector(xyz),
            (None, beginning) => beginning.map_or_else(Vector3::zeros, |beginning| beginning.position),
        };
        if let (None, true, Some(beginning)) = (rpy, arm.task.turns(), &beginning) {
            return Target::of_task(TaskKind::Pose, beginning);
        }
        let is_planar = xyz.or(center(arm)).is_some_and(|given| given.len() == 2);
        match rpy {
            Some(rpy) => {
                let [roll, pitch, yaw] = rpy.each_ref().map(Real::value);
                let rotation = Rotation3::from_euler_angles(roll, pitch, yaw);
                Target::pose(&IsometryMatrix3::from_parts(Translation3::from(place), rotation))
            }
            None if is_planar => Target::position_xy(place.x, place.y),
            None => Target::position(place),
        }
    }

    /// Joint positions with which the tip starts there, near the arm's q0 if it has one; `held` are the joints, by their
    /// places in the chain, that other arms move too and have positions for.
    pub(super) fn solve(
        &self,
        at: &KeyPath,
        arm: &ArmSpec,
        (chain, held): (&Chain, &[(usize, f64)]),
        (kinds, duration): (&Kinds, f64),
    ) -> Result<Solution, ScenarioError> {
        let target = self.target(arm, kinds, duration);
        let mut search = Search::new();
        if !arm.q0.is_empty() {
            search = search.near(&arm.q0.iter().map(Real::value).collect::<Vec<_>>());
        }
        for &(joint, position) in held {
            search = search.holding(joint, position);
        }
        let refuse = |problem: String| ScenarioError::at(ErrorKind::Scenario, &at.key("start_pose"), problem);
        let solution = search.solve(chain, &target).map_err(|e| refuse(e.to_string()))?;
        if solution.is_found() {
            return Ok(solution);
        }
        let asked = place(&target.reference().translation.vector);
        let came = place(&solution.tip.translation.vector);
        let turned = match solution.orientation_error() {
            0.0 => String::new(),
            angle => format!(" and {angle:.4} rad"),
        };
        let joints = held.iter().map(|&(joint, _)| chain.joints()[joint].name.as_str()).collect::<Vec<_>>();
        let holding = match joints.as_slice() {
            [] => String::new(),
            joints => format!(" with {} where another arm has it", joints.join(", ")),
        };
        Err(refuse(format!(
            "the tip can not start at {asked} m within the joint limits{holding}; the nearest that was found is {came} m, {:.4} m{turned} away",
            solution.position_error()
        )))
    }
}

fn place(p: &Vector3<f64>) -> String {
    format!("({:.4}, {:.4}, {:.4})", p.x, p.y, p.z)
}

/// The centre of the arm's path, where it has one.
fn center(arm: &ArmSpec) -> Option<&[Real]> {
    arm.path.as_ref()?.center.as_deref()
}

/// Whether a start on the path makes sense: the sentence against it, if not.
pub(super) fn objection(arm: &ArmSpec, start: &StartPose) -> Option<String> {
    let (xyz, rpy) = start.parts();
    // Waypoints may say how the tip is turned, which is known once they are read.
    let says = |path: &PathSpec| path.center.is_some() && (path.has_orientations() || path.awaits_file());
    let is_turned = xyz.is_none() && arm.path.as_ref().is_some_and(says);
    if rpy.is_none() && arm.task.turns() && !is_turned {
        return Some("the task \"pose\" needs to know how the tip is turned: give rpy".to_owned());
    }
    if xyz.is_none() && center(arm).is_none() {
        let Some(path) = &arm.path else {
            return Some("an arm without a path starts where it is told: give xyz".to_owned());
        };
        return Some(format!(
            "where the {} begins is not known, since it begins at the tip; give xyz (a curve with a `center` begins on its own)",
            path.kind
        ));
    }
    let is_planar = xyz.or(center(arm)).is_some_and(|given| given.len() == 2);
    (rpy.is_some() && is_planar)
        .then(|| "beside an orientation the position needs all of x, y and z".to_owned())
}
