//! A task over the tips of several arms, beside their own.

use nalgebra::IsometryMatrix3;
use serde::{Deserialize, Serialize};

use super::arm_task::RowsSpec;
use super::check::{check_path, refuse, require};
use super::error::{ScenarioError, suggestion};
use super::key_path::KeyPath;
use super::kind_reader::{KindTable, Misread, named};
use super::kinds::Kinds;
use super::model::{Mount, Scenario};
use super::path_spec::PathSpec;
use kinstep::kind::{Parameters, Real};
use kinstep::planner::Arm;
use kinstep::task::{LayPath, MakeTask, Motion, Task, TaskKind, TaskStart};

/// What the tips of several arms do together, beside what each of them does: these arms are resolved as one system.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(transform = super::kind_schema::relations))]
#[serde(expecting = "a table such as { kind = \"relative\", arms = [\"left\", \"right\"] }")]
pub struct RelationSpec {
    /// Name in reports. Default: its kind.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// The relation.
    pub kind: String,
    /// The arms whose tips it is about, by name, in the relation's own order.
    pub arms: Vec<String>,
    /// Place in a stack of tasks, for the law "prioritized": what comes first is met first; the arms' own tasks stand at 0.
    /// Default: 0.
    #[serde(default, skip_serializing_if = "is_zero")]
    pub priority: usize,
    /// Weight beside other tasks where not all can be met, for the law "qp" in least squares. Default: 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub weight: Option<Real>,
    /// The parameters of its kind.
    #[serde(flatten)]
    #[cfg_attr(feature = "schema", schemars(skip))]
    pub parameters: Parameters,
    /// Rows that are asked for, of `x`, `y`, `z`, `rx`, `ry` and `rz`. Default: all.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rows: Option<Vec<String>>,
    /// Axes of the rows: `base` (those of the first tip, of an object the world's), `tip` or `path`. Default: base.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub axes: Option<String>,
    /// Axis of the tip (`x`, `y` or `z`) that points where the path has it, in place of rows of the turn.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub point: Option<String>,
    /// Pose of the object at the start, in the world. Default: the mean of the tips' positions, along the world's axes.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pose: Option<Mount>,
    /// Path of the relative pose in the frame of the first tip, of the object or of the pose between the tips in the world.
    /// Default: that pose stays; an object is moved by the task of one of its hands.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub path: Option<PathSpec>,
    /// Path of the relative pose of tips that cooperate. Default: it stays.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub relative: Option<PathSpec>,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde asks so")]
fn is_zero(priority: &usize) -> bool {
    *priority == 0
}

/// The keys of a relation before the parameters of its kind, and after them.
pub(super) const KEYS: [&[&str]; 2] =
    [&["name", "kind", "arms", "priority", "weight"], &["rows", "axes", "point", "pose", "path", "relative"]];

impl RelationSpec {
    /// Returns a relation of that kind over the tips of these arms, without parameters.
    pub fn new(kind: &str, arms: impl IntoIterator<Item = impl Into<String>>) -> Self {
        Self {
            name: None,
            kind: kind.to_owned(),
            arms: arms.into_iter().map(Into::into).collect(),
            priority: 0,
            weight: None,
            parameters: Parameters::new(),
            rows: None,
            axes: None,
            point: None,
            pose: None,
            path: None,
            relative: None,
        }
    }

    /// The name that it was given, or that of its kind.
    pub fn called(&self) -> &str {
        self.name.as_deref().unwrap_or(&self.kind)
    }

    fn table<'a>(&'a self, at: &'a KeyPath, kinds: &'a Kinds) -> KindTable<'a, MakeTask> {
        KindTable { at, kinds: &kinds.tasks, kind: &self.kind, keys: KEYS }
    }

    /// Reads the parameters by their kind, and those of its paths.
    pub(super) fn read(&mut self, at: &KeyPath, kinds: &Kinds) -> Vec<Misread> {
        let mut parameters = std::mem::take(&mut self.parameters);
        let mut misread: Vec<Misread> =
            self.table(at, kinds).read(&mut parameters).err().into_iter().collect();
        self.parameters = parameters;
        for (key, path) in [("path", &mut self.path), ("relative", &mut self.relative)] {
            misread.extend(path.iter_mut().flat_map(|path| path.read(&at.key(key), kinds)));
        }
        misread
    }

    fn mask(&self) -> RowsSpec {
        RowsSpec { rows: self.rows.clone(), axes: self.axes.clone(), point: self.point.clone() }
    }

    fn paths(&self) -> impl Iterator<Item = (&'static str, &PathSpec)> {
        let paths = [("path", &self.path), ("relative", &self.relative)];
        paths.into_iter().filter_map(|(key, path)| Some((key, path.as_ref()?)))
    }

    /// The keys beside the parameters of its kind that are given.
    fn given(&self) -> Vec<&'static str> {
        let given = [
            self.rows.is_some(),
            self.axes.is_some(),
            self.point.is_some(),
            self.pose.is_some(),
            self.path.is_some(),
            self.relative.is_some(),
        ];
        KEYS[1].iter().copied().zip(given).filter(|(_, given)| *given).map(|(key, _)| key).collect()
    }

    /// Checks what it says, and which arms it names.
    pub(super) fn check(
        &self,
        at: &KeyPath,
        kinds: &Kinds,
        scenario: &Scenario,
    ) -> Result<(), ScenarioError> {
        let table = self.table(at, kinds);
        let make = table.named()?.make;
        let rows: &[&str] = if make.takes_rows { &KEYS[1][..3] } else { &[] };
        let pose: &[&str] = if make.takes_pose { &KEYS[1][3..4] } else { &[] };
        let after = [rows, pose, make.paths].concat();
        table.check(
            &self.parameters,
            (&["name", "arms", "priority", "weight"], &after, &self.given()),
            false,
        )?;
        self.check_arms(at, &make, scenario)?;
        if let Some(weight) = &self.weight {
            require(weight.value() > 0.0, &at.key("weight"), || {
                format!("{weight} is not a weight; it is positive")
            })?;
        }
        if self.mask().is_given() {
            self.mask().mask(at)?;
        }
        require(self.pose.is_none() || self.path.is_some(), &at.key("pose"), || {
            "without a path it does not matter where the object is; give it a `path`, or take this away"
                .to_owned()
        })?;
        for (key, path) in self.paths() {
            check_path(&at.key(key), path, &TaskKind::Pose.into(), kinds)?;
        }
        Ok(())
    }

    fn check_arms(&self, at: &KeyPath, make: &MakeTask, scenario: &Scenario) -> Result<(), ScenarioError> {
        let (at_arms, got) = (at.key("arms"), self.arms.len());
        let is_enough = got == make.tips || (make.or_more && got > make.tips);
        require(is_enough, &at_arms, || {
            let (kind, tips) = (&self.kind, make.tips);
            let more = if make.or_more { " or more" } else { "" };
            format!("a {kind} is about the tips of {tips}{more} arms, got {got}")
        })?;
        for (index, name) in self.arms.iter().enumerate() {
            let at_arm = at_arms.index(index);
            require(scenario.arm.iter().any(|arm| arm.name == *name), &at_arm, || {
                let hint = suggestion(name, scenario.arm.iter().map(|arm| arm.name.as_str()));
                format!("there is no arm \"{name}\"; {hint}")
            })?;
            require(!self.arms[..index].contains(name), &at_arm, || {
                format!("the arm \"{name}\" is named twice")
            })?;
        }
        Ok(())
    }

    /// Returns the task of arms as they start.
    pub(super) fn task(
        &self,
        at: &KeyPath,
        kinds: &Kinds,
        arms: &[Arm],
        duration: f64,
    ) -> Result<Box<dyn Task>, ScenarioError> {
        let kind = named(&kinds.tasks, &at.key("kind"), &self.kind)?;
        let own = self.arms.iter().filter_map(|name| arms.iter().find(|arm| arm.name() == name));
        let tips: Vec<IsometryMatrix3<f64>> = own.map(tip_at_start).collect();
        let mask = self.mask();
        let mask = mask.is_given().then(|| mask.mask(at)).transpose()?;
        let laid: Vec<(&'static str, Laid<'_>)> =
            self.paths().map(|(key, path)| (key, Laid { path, kinds, duration })).collect();
        let paths: Vec<(&'static str, &dyn LayPath)> =
            laid.iter().map(|(key, laid)| (*key, laid as &dyn LayPath)).collect();
        let start = TaskStart {
            paths: &paths,
            mask: mask.as_ref(),
            pose: self.pose.as_ref().map(Mount::pose),
            ..TaskStart::new(&tips, duration)
        };
        (kind.make.make)(&self.parameters, &start).map_err(|problem| refuse(at, problem))
    }
}

/// A path that waits for where its task has it begin.
#[derive(Debug)]
struct Laid<'a> {
    path: &'a PathSpec,
    kinds: &'a Kinds,
    duration: f64,
}

impl LayPath for Laid<'_> {
    fn laid_at(&self, start: &IsometryMatrix3<f64>) -> Motion {
        // Its curve and its time law were found when it was read.
        self.path.motion_with(self.kinds, start, self.duration).unwrap_or_else(|| Motion::held(start))
    }
}

fn tip_at_start(arm: &Arm) -> IsometryMatrix3<f64> {
    let (chain, joints) = (arm.chain(), arm.chain().joints().iter());
    let q0: Vec<f64> = joints.filter_map(|joint| arm.start_of(&joint.name)).collect();
    chain.forward(&q0, &mut chain.scratch()).pose()
}

impl Scenario {
    /// Checks the relations, and that every arm without a task of its own has one.
    pub(super) fn check_relations(&self, kinds: &Kinds) -> Vec<Result<(), ScenarioError>> {
        let mut found = Vec::new();
        for (index, relation) in self.relation.iter().enumerate() {
            let at = KeyPath::dotted("relation").index(index);
            found.push(relation.check(&at, kinds, self));
            let taken = |other: &RelationSpec| relation.name.is_some() && other.called() == relation.called();
            found.push(require(!self.relation[..index].iter().any(taken), &at.key("name"), || {
                format!("two relations are called \"{}\"; give each a name of its own", relation.called())
            }));
        }
        for arm in self.arm.iter().filter(|arm| arm.task.is_none()) {
            let is_about_it = |relation: &RelationSpec| relation.arms.contains(&arm.name);
            let at = KeyPath::dotted("arm").key(&arm.name).key("task");
            found.push(require(self.relation.iter().any(is_about_it), &at, || {
                "\"none\" leaves the arm to its relations, and no [[relation]] names it; give it a task, or a relation"
                    .to_owned()
            }));
        }
        found
    }

    /// The name of a relation in reports: where several of one kind have none, they are numbered.
    pub(super) fn relation_name(&self, index: usize) -> String {
        let relation = &self.relation[index];
        let before =
            self.relation[..index].iter().filter(|other| other.called() == relation.called()).count();
        match before {
            0 => relation.called().to_owned(),
            before => format!("{}-{}", relation.called(), before + 1),
        }
    }

    /// Where the relation of that name stands.
    pub(super) fn place_of_relation(&self, name: &str) -> KeyPath {
        let index = (0..self.relation.len()).find(|&index| self.relation_name(index) == name);
        index.map_or_else(KeyPath::default, |index| KeyPath::dotted("relation").index(index))
    }
}
