//! The path of an arm's tip.

use serde::{Deserialize, Serialize};

use super::arm_task::ArmTask;
use super::check::require;
use super::error::ScenarioError;
use super::exactly::exactly;
use super::key_path::KeyPath;
use super::kind_reader::{KindTable, Misread};
use super::kinds::Kinds;
use super::time_law_spec::TimeLawSpec;
use kinstep::kind::{Parameters, Real, Value};
use kinstep::task::{MakeCurve, Plane};

/// A path for the tip. Curves are drawn in `plane`, turned by `rotation`, and shifted so that they begin at the
/// tip's position at q0 unless `center` is given.
///
/// ```
/// use kinstep_files::scenario::PathSpec;
///
/// let circle = PathSpec::new("circle").with("radius", 0.1);
/// assert_eq!(circle.parameters.number("radius"), Some(0.1));
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schema", schemars(transform = super::kind_schema::curves))]
#[serde(expecting = "a table such as { kind = \"circle\", radius = 0.1 }")]
pub struct PathSpec {
    /// Kind of curve.
    pub kind: String,
    /// The parameters of its kind.
    #[serde(flatten)]
    #[cfg_attr(feature = "schema", schemars(skip))]
    pub parameters: Parameters,
    /// Plane that the curve is drawn in, in world axes. Default: xy.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub plane: Option<Plane>,
    /// Turn of the curve in its plane in rad. Default: 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rotation: Option<Real>,
    /// Angle at which the curve begins in rad. Default: 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub from: Option<Real>,
    /// Angle that the curve sweeps, with its sign in rad. Default: 2 pi.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sweep: Option<Real>,
    /// Centre of the curve in world coordinates in m, 2 or 3 of them. Default: such that the curve begins at the tip.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub center: Option<Vec<Real>>,
    /// How the path is travelled in time. Default: sin2.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub time_law: Option<TimeLawSpec>,
    /// Turn of the tip in the course of a path of task `pose`. Default: the orientation is held.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub turn: Option<TurnSpec>,
}

/// A turn about a fixed axis in the course of the path.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, expecting = "a table such as { axis = [0, 0, 1], angle = 0.5 }")]
pub struct TurnSpec {
    /// Axis in world coordinates; its length does not matter, but it must have one.
    #[serde(deserialize_with = "exactly")]
    pub axis: [Real; 3],
    /// Angle of the whole turn in rad.
    pub angle: Real,
    /// Whether the tip turns over until half-way and then back, instead of evenly. Default: no.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub back: bool,
}

/// The keys of a path beside its kind and the parameters of that.
const KEYS: [&str; 7] = ["plane", "rotation", "from", "sweep", "center", "time_law", "turn"];

impl PathSpec {
    /// Returns a path of that kind with no parameter yet.
    pub fn new(kind: &str) -> Self {
        Self {
            kind: kind.to_owned(),
            parameters: Parameters::new(),
            plane: None,
            rotation: None,
            from: None,
            sweep: None,
            center: None,
            time_law: None,
            turn: None,
        }
    }

    /// Returns the same with a parameter of its kind.
    #[must_use]
    pub fn with(mut self, name: &str, value: impl Into<Value>) -> Self {
        self.parameters.set(name, value);
        self
    }

    fn table<'a>(&'a self, at: &'a KeyPath, kinds: &'a Kinds) -> KindTable<'a, MakeCurve> {
        KindTable { at, kinds: &kinds.curves, kind: &self.kind, keys: [&["kind"], &KEYS] }
    }

    /// Reads the parameters by their kind.
    pub(super) fn read(&mut self, at: &KeyPath, kinds: &Kinds) -> Vec<Misread> {
        let mut parameters = std::mem::take(&mut self.parameters);
        let mut misread: Vec<Misread> =
            self.table(at, kinds).read(&mut parameters).err().into_iter().collect();
        self.parameters = parameters;
        let time_law = self.time_law.as_mut().map(|law| law.read(&at.key("time_law"), kinds));
        misread.extend(time_law.and_then(Result::err));
        misread
    }

    /// Checks that the curve has the parameters of its kind and no others.
    pub(super) fn check_kind(
        &self,
        at: &KeyPath,
        kinds: &Kinds,
        task: &ArmTask,
    ) -> Result<(), ScenarioError> {
        self.time_law.as_ref().map_or(Ok(()), |law| law.check(&at.key("time_law"), kinds))?;
        let table = self.table(at, kinds);
        let (before, after): (&[&str], &[&str]) = match table.named()?.make {
            MakeCurve::Planar(_) => (&KEYS[..5], &KEYS[5..]),
            MakeCurve::Centered(_) => (&[], &KEYS[4..]),
            MakeCurve::FromTip(_) => (&[], &KEYS[5..]),
        };
        table.check(&self.parameters, (before, after, &self.given()), task.is_planar())?;
        require(!self.has_orientations() || self.turn.is_none(), &at.key("turn"), || {
            "the waypoints say how the tip is turned; take this away, or their orientations".to_owned()
        })
    }

    /// Returns every length and angle that lays the curve, by its key and, in a list, its place there.
    pub(super) fn numbers(&self) -> impl Iterator<Item = (&'static str, Option<usize>, &Real)> {
        let single = [("rotation", &self.rotation), ("from", &self.from), ("sweep", &self.sweep)];
        let single = single.into_iter().filter_map(|(key, number)| Some((key, None, number.as_ref()?)));
        let center = self.center.iter().flatten().enumerate();
        single.chain(center.map(|(index, number)| ("center", Some(index), number)))
    }

    /// The keys beside those of the kind that are given.
    fn given(&self) -> Vec<&'static str> {
        let given = [
            self.plane.is_some(),
            self.rotation.is_some(),
            self.from.is_some(),
            self.sweep.is_some(),
            self.center.is_some(),
            self.time_law.is_some(),
            self.turn.is_some(),
        ];
        KEYS.into_iter().zip(given).filter(|(_, given)| *given).map(|(key, _)| key).collect()
    }
}
