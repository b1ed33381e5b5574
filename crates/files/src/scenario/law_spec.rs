//! How redundancy is resolved, and how strongly the task error is fed back.

use serde::{Deserialize, Serialize};

use super::check::refuse;
use super::criterion_spec::CriterionSpec;
use super::error::{ScenarioError, suggestion};
use super::key_path::KeyPath;
use super::kind_reader::{KindTable, Misread, named};
use super::kinds::Kinds;
use kinstep::kind::{ByJoint, Form, Parameter, Parameters, Real, Value};
use kinstep::law::{LAWS, Law, MakeCriterion, MakeLaw};
use kinstep::planner::Arm;
use kinstep::robot::{Limits, LimitsError, Robot};

/// What is laid over the acceleration limits of the robots.
pub(super) const ACCELERATION_LIMIT: Parameter = Parameter::optional(
    "acceleration_limit",
    Form::ByJoint { noun: "limit" },
    "rad/s^2 or m/s^2",
    "Limit of the joints' accelerations beside those that their robots have: a number, or a table by the names of joints.",
);
/// The keys of the table beside the parameters of laws, before these.
const KEYS: [&str; 3] = ["h", "gain", ACCELERATION_LIMIT.name];

/// How redundancy is resolved, and how strongly the task error is fed back. At most one of `h` and `gain`;
/// without either, h is the formula's optimum.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(transform = super::kind_schema::laws))]
#[serde(expecting = "a table such as { h = 0.4 }")]
pub struct LawSpec {
    /// The law.
    #[serde(default = "first_law")]
    pub kind: String,
    /// Feedback step h, dimensionless: held fixed, the task error falls like sigma^(p+1).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub h: Option<Real>,
    /// Feedback gain k in 1/s: h = sigma k gamma(1).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub gain: Option<Real>,
    /// Limit of the joints' accelerations beside those that their robots have: a number in rad/s^2 or m/s^2, or a table by the
    /// names of joints.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[cfg_attr(feature = "schema", schemars(skip))]
    pub acceleration_limit: Option<Value>,
    /// The parameters of its kind.
    #[serde(flatten)]
    #[cfg_attr(feature = "schema", schemars(skip))]
    pub parameters: Parameters,
    /// What the joints do where the tasks leave them free; criteria add up.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub criterion: Vec<CriterionSpec>,
}

fn first_law() -> String {
    LAWS.first().map_or("", |law| law.name).to_owned()
}

impl Default for LawSpec {
    /// The first built-in law without parameters.
    fn default() -> Self {
        Self {
            kind: first_law(),
            h: None,
            gain: None,
            acceleration_limit: None,
            parameters: Parameters::new(),
            criterion: Vec::new(),
        }
    }
}

impl LawSpec {
    /// Reads the parameters of the law and of its criteria by their kinds.
    pub(super) fn read(&mut self, kinds: &Kinds) -> Vec<Misread> {
        let law = KeyPath::dotted("law");
        let table = law_table(&law, kinds, &self.kind);
        let mut misread: Vec<Misread> = table.read(&mut self.parameters).err().into_iter().collect();
        if let Some(limit) = &mut self.acceleration_limit {
            match ACCELERATION_LIMIT.form.read(limit) {
                Ok(read) => *limit = read,
                Err(wrong) => {
                    let error = refuse(&law.key(ACCELERATION_LIMIT.name), wrong.problem);
                    misread.push(Misread { error, is_of_key: false });
                }
            }
        }
        for (index, criterion) in self.criterion.iter_mut().enumerate() {
            let at = law.key("criterion").index(index);
            let table = criterion_table(&at, kinds, &criterion.kind);
            misread.extend(table.read(&mut criterion.parameters).err());
        }
        misread
    }

    /// Checks the parameters of the law and of its criteria by their kinds.
    pub(super) fn check_kinds(&self, kinds: &Kinds) -> Result<(), ScenarioError> {
        let law = KeyPath::dotted("law");
        let table = law_table(&law, kinds, &self.kind);
        let takes_criteria = table.named()?.make.takes_criteria();
        let keys: &[&str] = if takes_criteria { &["criterion"] } else { &[] };
        let given: &[&str] = if self.criterion.is_empty() { &[] } else { &["criterion"] };
        table.check(&self.parameters, (&KEYS, keys, given), false)?;
        let limit = self.acceleration_limit.as_ref();
        let objection = limit.and_then(|limit| ACCELERATION_LIMIT.objection(limit));
        objection.map_or(Ok(()), |problem| Err(refuse(&law.key(ACCELERATION_LIMIT.name), problem)))?;
        for (index, criterion) in self.criterion.iter().enumerate() {
            let at = law.key("criterion").index(index);
            let table = criterion_table(&at, kinds, &criterion.kind);
            table.check(&criterion.parameters, (&[], &[], &[]), false)?;
        }
        Ok(())
    }

    /// Returns the robot with the limits that are laid over its own.
    pub(super) fn limited(&self, robot: Robot) -> Result<Robot, ScenarioError> {
        let Some(limit) = self.acceleration_limit.as_ref().and_then(ByJoint::of) else { return Ok(robot) };
        let movable = robot.joints().iter().filter(|joint| joint.kind.is_movable());
        let limits: Vec<(String, Limits)> = movable
            .filter_map(|joint| {
                let acceleration = limit.number(&joint.name)?;
                let over = Limits { acceleration, ..Limits::UNLIMITED };
                Some((joint.name.clone(), joint.limits.narrowed_by(&over)))
            })
            .collect();
        let narrowed =
            limits.into_iter().try_fold(robot, |robot, (joint, limits)| robot.with_limits(&joint, limits));
        narrowed.map_err(|e: LimitsError| refuse(&KeyPath::dotted("law").key(ACCELERATION_LIMIT.name), e))
    }

    /// Checks that the joints that are named are joints of the arms.
    pub(super) fn check_joints(&self, kinds: &Kinds, arms: &[Arm]) -> Result<(), ScenarioError> {
        let law = KeyPath::dotted("law");
        let named = named(&kinds.laws, &law.key("kind"), &self.kind)?;
        let by_joint = named.parameters.iter().filter(|own| matches!(own.form, Form::ByJoint { .. }));
        let given = by_joint.filter_map(|own| Some((own.name, self.parameters.by_joint(own.name)?)));
        let limit = self.acceleration_limit.as_ref().and_then(ByJoint::of);
        for (key, by_joint) in given.chain(limit.map(|limit| (ACCELERATION_LIMIT.name, limit))) {
            let joints = || arms.iter().flat_map(|arm| arm.chain().joints()).map(|joint| joint.name.as_str());
            if let Some(unknown) = by_joint.names().find(|name| joints().all(|joint| joint != *name)) {
                let problem = format!("no arm moves a joint `{unknown}`; {}", suggestion(unknown, joints()));
                return Err(refuse(&law.key(key).key(unknown), problem));
            }
        }
        Ok(())
    }

    /// Returns the law of a system whose joints start at `q0` [rad or m].
    pub(super) fn law(&self, kinds: &Kinds, q0: &[f64]) -> Result<Box<dyn Law>, ScenarioError> {
        let at = KeyPath::dotted("law");
        let law = named(&kinds.laws, &at.key("kind"), &self.kind)?;
        let criterion = |(index, spec): (usize, &CriterionSpec)| {
            let at = at.key("criterion").index(index).key("kind");
            Ok((named(&kinds.criteria, &at, &spec.kind)?.make)(&spec.parameters, q0))
        };
        let criteria =
            self.criterion.iter().enumerate().map(criterion).collect::<Result<_, ScenarioError>>()?;
        Ok(law.make.law(&self.parameters, criteria))
    }
}

fn law_table<'a>(at: &'a KeyPath, kinds: &'a Kinds, kind: &'a str) -> KindTable<'a, MakeLaw> {
    KindTable {
        at,
        kinds: &kinds.laws,
        kind,
        keys: [&["kind", "h", "gain", ACCELERATION_LIMIT.name], &["criterion"]],
    }
}

fn criterion_table<'a>(at: &'a KeyPath, kinds: &'a Kinds, kind: &'a str) -> KindTable<'a, MakeCriterion> {
    KindTable { at, kinds: &kinds.criteria, kind, keys: [&["kind"], &[]] }
}
