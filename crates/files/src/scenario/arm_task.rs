//! What of an arm's tip follows its path.

use std::fmt;

use nalgebra::Rotation3;
use serde::de::value::{MapAccessDeserializer, StrDeserializer};
use serde::{Deserialize, Deserializer, Serialize};

use super::check::{refuse, require};
use super::error::{ScenarioError, not_one_of};
use super::key_path::KeyPath;
use kinstep::task::{Axes, Component, Mask, Masked, Motion, Task, TaskKind, Tracking};

/// What of an arm's tip follows its path: rows by one of their short names, any rows in axes of choice, or nothing.
///
/// ```
/// use kinstep_files::scenario::{ArmTask, TaskKind};
///
/// assert!(ArmTask::from(TaskKind::Pose).turns() && !ArmTask::from(TaskKind::Position).turns());
/// ```
#[derive(Clone, Debug, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(untagged)]
pub enum ArmTask {
    /// The leading rows of the pose, by a short name.
    Kind(TaskKind),
    /// Nothing: the arm is left to its relations.
    None(NoTask),
    /// Any rows.
    Rows(RowsSpec),
}

/// The word for an arm that is left to its relations.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum NoTask {
    /// No task of its own.
    None,
}

/// Rows of a pose, and the axes in which they are counted.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields)]
pub struct RowsSpec {
    /// Rows: `x`, `y`, `z` for the position in m, `rx`, `ry`, `rz` for the turn about these axes in rad.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rows: Option<Vec<String>>,
    /// Axes of the rows: `base`, `tip` or `path`. Default: base.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub axes: Option<String>,
    /// Axis of the tip (`x`, `y` or `z`) that points where the path has it, in place of rows of the turn.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub point: Option<String>,
}

impl From<TaskKind> for ArmTask {
    fn from(kind: TaskKind) -> Self {
        Self::Kind(kind)
    }
}

impl<'de> Deserialize<'de> for ArmTask {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(ArmTaskVisitor)
    }
}

struct ArmTaskVisitor;

impl<'de> serde::de::Visitor<'de> for ArmTaskVisitor {
    type Value = ArmTask;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("one of position-xy, position, pose, none, or a table such as { rows = [\"x\", \"y\", \"z\"], axes = \"base\" }")
    }

    fn visit_str<E: serde::de::Error>(self, text: &str) -> Result<ArmTask, E> {
        if text == "none" {
            return Ok(ArmTask::None(NoTask::None));
        }
        let kind = TaskKind::deserialize(StrDeserializer::<E>::new(text));
        kind.map(ArmTask::Kind)
            .map_err(|_| E::unknown_variant(text, &["position-xy", "position", "pose", "none"]))
    }

    fn visit_map<A: serde::de::MapAccess<'de>>(self, map: A) -> Result<ArmTask, A::Error> {
        RowsSpec::deserialize(MapAccessDeserializer::new(map)).map(ArmTask::Rows)
    }
}

impl ArmTask {
    /// Whether the arm has no task of its own.
    pub fn is_none(&self) -> bool {
        matches!(self, Self::None(_))
    }

    /// Whether it lies in the plane of x and y.
    pub(super) fn is_planar(&self) -> bool {
        *self == Self::Kind(TaskKind::PositionXy)
    }

    /// Whether it asks for anything of the orientation.
    pub fn turns(&self) -> bool {
        match self {
            Self::Kind(kind) => *kind == TaskKind::Pose,
            Self::None(_) => false,
            Self::Rows(rows) => rows.turns(),
        }
    }

    /// The plain task that it is a part of: the whole pose for an arm without a task.
    pub fn whole(&self) -> TaskKind {
        match self {
            Self::Kind(kind) => *kind,
            Self::Rows(rows) if !rows.turns() => TaskKind::Position,
            Self::None(_) | Self::Rows(_) => TaskKind::Pose,
        }
    }

    /// Checks its names.
    pub(super) fn check(&self, at: &KeyPath) -> Result<(), ScenarioError> {
        match self {
            Self::Rows(rows) => rows.mask(at).map(|_| ()),
            Self::Kind(_) | Self::None(_) => Ok(()),
        }
    }

    /// The task of a tip that follows a motion, of an arm whose base is turned like that in the world.
    pub(super) fn of_motion(
        &self,
        at: &KeyPath,
        motion: Motion,
        base: Rotation3<f64>,
    ) -> Result<Box<dyn Task>, ScenarioError> {
        let mask = match self {
            Self::Kind(kind) => return Ok(Box::new(Tracking { kind: *kind, motion })),
            Self::None(_) => return Ok(Box::new(kinstep::task::Free)),
            Self::Rows(rows) => rows.mask(at)?,
        };
        if let Some(kind) = mask.plain(&base) {
            return Ok(Box::new(Tracking { kind, motion }));
        }
        let refused = |problem: String| refuse(&at.key("axes"), format!("the path {problem}"));
        Masked::based(mask, motion, base).map(|task| Box::new(task) as _).map_err(refused)
    }
}

impl RowsSpec {
    /// Whether anything is said.
    pub(super) fn is_given(&self) -> bool {
        *self != Self::default()
    }

    fn turns(&self) -> bool {
        let is_angular = |row: &String| Component::named(row).is_some_and(Component::is_angular);
        self.point.is_some() || self.rows.iter().flatten().any(is_angular)
    }

    /// The mask that it asks for.
    pub(super) fn mask(&self, at: &KeyPath) -> Result<Mask, ScenarioError> {
        let rows = self.rows.as_deref().unwrap_or_default();
        let at_rows = at.key("rows");
        require(!rows.is_empty() || self.point.is_some(), &at_rows, || {
            let known = Component::NAMES.join(", ");
            format!("no row is asked for; name some of {known}, or with `point` an axis of the tip")
        })?;
        let mut components = Vec::new();
        for (index, name) in rows.iter().enumerate() {
            let at_row = at_rows.index(index);
            let known = || refuse(&at_row, format!("\"{name}\" is {}", not_one_of(name, &Component::NAMES)));
            let component = Component::named(name).ok_or_else(known)?;
            require(!components.contains(&component), &at_row, || {
                format!("the row \"{name}\" is named twice; once is enough")
            })?;
            components.push(component);
        }
        let axes = self.axes.as_deref().map_or(Ok(Axes::Base), |name| {
            let known = Axes::ALL.map(Axes::name);
            let problem = || refuse(&at.key("axes"), format!("\"{name}\" is {}", not_one_of(name, &known)));
            Axes::named(name).ok_or_else(problem)
        })?;
        let Some(name) = &self.point else { return Ok(Mask::of(components, axes)) };
        let (at_point, known) = (at.key("point"), &Component::NAMES[..3]);
        let problem = || refuse(&at_point, format!("\"{name}\" is {}", not_one_of(name, known)));
        let axis = known.iter().position(|own| own == name).ok_or_else(problem)?;
        require(!components.iter().any(|own| own.is_angular()), &at_point, || {
            "rows of the turn say where all axes of the tip point; leave out rx, ry and rz, or this"
                .to_owned()
        })?;
        Ok(Mask::of(components, axes).with_pointing(axis))
    }
}
