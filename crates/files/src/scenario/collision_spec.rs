//! What stands around the arms, and what is to be kept apart.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::build::read_robot;
use super::check::{believable, refuse, require};
use super::document::read_text;
use super::error::{ErrorKind, Place, ScenarioError, suggestion};
use super::files;
use super::key_path::KeyPath;
use super::kind_reader::{KindTable, named};
use super::kinds::Kinds;
use super::model::{ArmSpec, Scenario};
use super::robots::RobotSource;
use kinstep::collision::{CollisionError, CollisionModel, Pairings};
use kinstep::kind::{Parameters, Real};
use kinstep::planner::Surroundings;
use kinstep::robot::{Diagnostic, Robot, Severity, Srdf, embedded};

/// What is to be kept apart, and how far. With this table a plan says how near bodies came to each other, and the law "qp" and
/// the criterion "clearance" keep them apart.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, expecting = "a table such as { margin = 0.02 }")]
pub struct CollisionSpec {
    /// How near bodies may come to each other in m.
    pub margin: Real,
    /// From where on pairs count in m. Default: 0.1 beyond the margin.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub influence: Option<Real>,
    /// How fast a pair may come nearer where it begins to count in m/s; less the nearer it is. Default: five times the way from
    /// `influence` to `margin` per second.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub closing_speed: Option<Real>,
    /// Whether links of one machine are kept apart too.
    #[serde(rename = "self", default = "yes", skip_serializing_if = "is_yes")]
    pub within_machines: bool,
    /// Pairs that are not looked at: two links, or a link and an obstacle, by name.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub allowed: Vec<[String; 2]>,
    /// A file with pairs of links that are not looked at, as MoveIt writes it (SRDF), relative to the scenario's own file.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub srdf: Option<String>,
    /// A file with the capsules of the robot's links (`[[capsule]]`, `[[sphere]]`, `[[allowed]]`), relative to the scenario's own
    /// file. Default: those that come with a built-in robot, or capsules about the `<collision>` shapes of a URDF.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub model: Option<String>,
}

fn yes() -> bool {
    true
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "serde passes a reference")]
fn is_yes(flag: &bool) -> bool {
    *flag
}

/// Something that stands still in the world.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(transform = super::kind_schema::obstacles))]
#[serde(expecting = "a table such as { kind = \"sphere\", center = [0.4, 0, 0.5], radius = 0.1 }")]
pub struct ObstacleSpec {
    /// What it is.
    pub kind: String,
    /// What it is called. Default: its kind, with its number where there are several of that kind.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// The parameters of its kind.
    #[serde(flatten)]
    #[cfg_attr(feature = "schema", schemars(skip))]
    pub parameters: Parameters,
}

/// The keys of an obstacle beside the parameters of its kind.
const KEYS: [&str; 2] = ["kind", "name"];

/// The table of an obstacle, to be read by its kind.
pub(super) fn obstacle_table<'a>(
    at: &'a KeyPath,
    kinds: &'a Kinds,
    kind: &'a str,
) -> KindTable<'a, kinstep::collision::MakeObstacle> {
    KindTable { at, kinds: &kinds.obstacles, kind, keys: [&KEYS, &[]] }
}

impl CollisionSpec {
    fn check(&self) -> Result<(), ScenarioError> {
        let at = KeyPath::dotted("collision");
        let margin = &self.margin;
        believable(&at.key("margin"), margin)?;
        require(margin.value() >= 0.0, &at.key("margin"), || {
            format!("{margin} m is not a margin; it is a length, zero or more")
        })?;
        if let Some(influence) = &self.influence {
            believable(&at.key("influence"), influence)?;
            require(influence.value() > margin.value(), &at.key("influence"), || {
                format!(
                    "{influence} m is not beyond the margin of {margin} m; pairs have to count before they touch it"
                )
            })?;
        }
        if let Some(speed) = &self.closing_speed {
            believable(&at.key("closing_speed"), speed)?;
            require(speed.value() > 0.0, &at.key("closing_speed"), || {
                format!("{speed} m/s is not a closing speed; it is positive")
            })?;
        }
        Ok(())
    }
}

impl Scenario {
    /// What is found in the tables about obstacles, each by itself.
    pub(super) fn check_surroundings(&self, kinds: &Kinds) -> Vec<Result<(), ScenarioError>> {
        let mut found: Vec<_> = self.collision.iter().map(CollisionSpec::check).collect();
        let obstacles = KeyPath::dotted("obstacle");
        found.push(require(self.obstacle.is_empty() || self.collision.is_some(), &obstacles, || {
            "nothing looks at obstacles without a table [collision]; give it a margin in m, such as margin = 0.02"
                .to_owned()
        }));
        let names = self.obstacle_names();
        for (index, obstacle) in self.obstacle.iter().enumerate() {
            let at = obstacles.index(index);
            let table = obstacle_table(&at, kinds, &obstacle.kind);
            found.push(table.check(&obstacle.parameters, (&["name"], &[], &[]), false));
            found.push(require(!names[..index].contains(&names[index]), &at.key("name"), || {
                format!("two obstacles are called \"{}\"; each needs a name of its own", names[index])
            }));
        }
        found
    }

    /// What the obstacles are called.
    fn obstacle_names(&self) -> Vec<String> {
        let of_kind = |kind: &str, among: &[ObstacleSpec]| {
            among.iter().filter(|other| other.kind == kind && other.name.is_none()).count()
        };
        let name = |(index, obstacle): (usize, &ObstacleSpec)| match &obstacle.name {
            Some(name) => name.clone(),
            None if of_kind(&obstacle.kind, &self.obstacle) == 1 => obstacle.kind.clone(),
            None => format!("{} {}", obstacle.kind, of_kind(&obstacle.kind, &self.obstacle[..=index])),
        };
        self.obstacle.iter().enumerate().map(name).collect()
    }

    /// Returns what stands around the arms, if the scenario says so.
    pub(super) fn surroundings(
        &self,
        kinds: &Kinds,
        folder: Option<&Path>,
    ) -> Result<Option<Surroundings>, ScenarioError> {
        let Some(spec) = &self.collision else { return Ok(None) };
        let mut around = Surroundings::new(spec.margin.value())
            .with_pairings(Pairings { within_machines: spec.within_machines, ..Pairings::default() });
        if let Some(influence) = &spec.influence {
            around = around.with_influence(influence.value());
        }
        if let Some(speed) = &spec.closing_speed {
            around = around.with_closing_speed(speed.value());
        }
        let mut links = Vec::new();
        for (index, arm) in self.arm.iter().enumerate() {
            if self.arm[..index].iter().any(|other| other.is_same_machine(arm)) {
                continue;
            }
            let (robot, model) = self.bodies(spec, arm, folder)?;
            links.extend(robot.links().iter().map(|link| link.name.clone()));
            let arms = self.arm.iter().filter(|other| other.is_same_machine(arm)).map(|arm| &arm.name);
            around = around.with_machine(&arm.name, robot, model, &arm.base, arm.mount.pose(), arms);
        }
        let names = self.obstacle_names();
        for (index, (obstacle, name)) in self.obstacle.iter().zip(&names).enumerate() {
            let at = KeyPath::dotted("obstacle").index(index);
            let kind = named(&kinds.obstacles, &at.key("kind"), &obstacle.kind)?;
            let shape = (kind.make)(&obstacle.parameters).map_err(|error| refuse(&at, error))?;
            around = around.with_obstacle(name, shape);
        }
        for (index, pair) in spec.allowed.iter().enumerate() {
            for (side, name) in pair.iter().enumerate() {
                let known = || links.iter().chain(&names).map(String::as_str);
                let at = KeyPath::dotted("collision").key("allowed").index(index).index(side);
                require(known().any(|own| own == name), &at, || {
                    format!("there is no link or obstacle \"{name}\"; {}", suggestion(name, known()))
                })?;
            }
            around = around.allowing(&pair[0], &pair[1]);
        }
        Ok(Some(around))
    }

    /// The robot of an arm and its bodies.
    fn bodies(
        &self,
        spec: &CollisionSpec,
        arm: &ArmSpec,
        folder: Option<&Path>,
    ) -> Result<(Robot, CollisionModel), ScenarioError> {
        let at = KeyPath::dotted("arm").key(&arm.name);
        let collision = KeyPath::dotted("collision");
        let (source, robot) = read_robot(&at, arm, folder)?;
        let robot = arm.changed(&at, robot, &self.law, folder)?;
        let mut model = match &spec.model {
            Some(reference) => by_text(&collision.key("model"), reference, folder, |text| {
                CollisionModel::from_toml(&robot, text).map_err(|error| match error {
                    CollisionError::Text(found) => found,
                    // A text is refused by what stands in it.
                    _ => Vec::new(),
                })
            })?,
            None => own_bodies(&at.key("robot"), &source, &robot)?,
        };
        if let Some(reference) = &spec.srdf {
            let at = collision.key("srdf");
            let srdf = by_text(&at, reference, folder, |text| {
                Srdf::from_text(text, &robot).map_err(|error| error.diagnostics().to_vec())
            })?;
            model = model.with_srdf(&srdf.pairs).map_err(|error| refuse(&at, error))?;
        }
        Ok((robot, model))
    }
}

/// The bodies that a robot comes with.
fn own_bodies(at: &KeyPath, source: &RobotSource, robot: &Robot) -> Result<CollisionModel, ScenarioError> {
    let refuse = |problem: String| ScenarioError::at(ErrorKind::Robot, at, problem);
    let model = match (source, source.urdf()) {
        (RobotSource::Embedded(name), _) => match embedded::collision_text(name) {
            Some(text) => {
                CollisionModel::from_toml(robot, text).map_err(|error| refuse(error.to_string()))?
            }
            None => return Err(refuse(CollisionError::NoCapsules { name: name.clone() }.to_string())),
        },
        (_, Some(text)) => CollisionModel::from_urdf(robot, &text, source.folder().as_deref()),
        (_, None) => CollisionModel::new(robot),
    };
    if model.capsules().is_empty() {
        let reason =
            model.missing().first().map_or_else(String::new, |missing| format!(" ({})", missing.reason));
        let label = source.label();
        return Err(refuse(format!(
            "robot {label} has no bodies: it has no <collision> shapes that can be used{reason}; give them in a file that `collision.model` names"
        )));
    }
    Ok(model)
}

/// Reads the file that a key names.
fn by_text<T>(
    at: &KeyPath,
    reference: &str,
    folder: Option<&Path>,
    read: impl FnOnce(&str) -> Result<T, Vec<Diagnostic>>,
) -> Result<T, ScenarioError> {
    let named = |e: ScenarioError| {
        let path = Some(at.clone()).filter(|_| e.place.is_none());
        ScenarioError { message: format!("{at}: {}", e.message), path, ..e }
    };
    let file = files::find(reference, folder).ok_or_else(|| named(files::missing(reference, folder)))?;
    let text = read_text(&file).map_err(named)?;
    read(&text).map_err(|found| {
        let errors = || found.iter().filter(|found| found.severity == Severity::Error);
        let more = errors().count().saturating_sub(1);
        let more = if more > 0 { format!(" (and {more} more)") } else { String::new() };
        let (line, column, message) =
            errors().next().map_or((1, 1, ""), |first| (first.line, first.column, &first.message));
        let place = Place::of_line(Some(file.display().to_string()), &text, line, column);
        named(ScenarioError::new(ErrorKind::Robot, format!("{message}{more}")).or_placed(Some(place)))
    })
}
