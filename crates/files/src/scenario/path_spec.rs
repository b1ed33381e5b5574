//! The path of an arm's tip, and which parameters each kind of path takes.

use serde::{Deserialize, Serialize};

use super::real::{Real, exactly, some_exactly, some_triples};
use kinstep::task::Plane;

/// A path for the tip. Curves are drawn in `plane`, turned by `rotation`, and shifted so that they begin at the
/// tip's position at q0 unless `center` is given.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(deny_unknown_fields, expecting = "a table such as { kind = \"circle\", radius = 0.1 }")]
pub struct PathSpec {
    /// Kind of curve.
    pub kind: PathKind,
    /// Size of a circle, tricuspid, astroid or rose in m.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub radius: Option<Real>,
    /// Number of petals parameter of a rose: radius * cos(petals * a).
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub petals: Option<Real>,
    /// End of a line in world coordinates in m, 2 or 3 of them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub to: Option<Vec<Real>>,
    /// End of a line from its beginning, along world axes in m, 2 or 3 of them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub displacement: Option<Vec<Real>>,
    /// Half width and half height of a Lissajous curve in m.
    #[serde(default, deserialize_with = "some_exactly", skip_serializing_if = "Option::is_none")]
    pub amplitudes: Option<[Real; 2]>,
    /// Periods of a Lissajous curve per turn of the angle, in x and in y.
    #[serde(default, deserialize_with = "some_exactly", skip_serializing_if = "Option::is_none")]
    pub frequencies: Option<[Real; 2]>,
    /// Phase of the x part of a Lissajous curve in rad. Default: 0.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub phase: Option<Real>,
    /// Vectors a_1, a_2, ... of a Fourier path in m, in world axes.
    #[serde(default, deserialize_with = "some_triples", skip_serializing_if = "Option::is_none")]
    pub cosines: Option<Vec<[Real; 3]>>,
    /// Vectors b_1, b_2, ... of a Fourier path in m, in world axes.
    #[serde(default, deserialize_with = "some_triples", skip_serializing_if = "Option::is_none")]
    pub sines: Option<Vec<[Real; 3]>>,
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
    pub time_law: Option<TimeLawKind>,
    /// Turn of the tip in the course of a path of task `pose`. Default: the orientation is held.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub turn: Option<TurnSpec>,
}

/// Kinds of curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum PathKind {
    /// radius (cos a, sin a).
    Circle,
    /// radius (2 cos a + cos 2a, 2 sin a - sin 2a): three cusps.
    Tricuspid,
    /// radius (cos^3 a, sin^3 a): four cusps.
    Astroid,
    /// A straight line.
    Line,
    /// (a_x sin(f_x a + phase), a_y sin(f_y a)).
    Lissajous,
    /// radius cos(petals a) (cos a, sin a).
    Rose,
    /// sum of a_m (cos 2 pi m u - 1) + b_m sin 2 pi m u: any smooth closed path in space.
    Fourier,
}

/// How the angle of a path runs from its beginning to its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "kebab-case")]
pub enum TimeLawKind {
    /// sin^2(pi t / 2T): at rest at both ends.
    Sin2,
    /// sin^2((pi/2) sin^2(pi t / 2T)): velocity, acceleration and jerk vanish at both ends.
    Sin2sin2,
    /// t / T.
    Linear,
    /// The polynomial of degree 5 with velocity and acceleration zero at both ends.
    Quintic,
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

/// Parameters that every curve by angle takes.
const BY_ANGLE: [&str; 6] = ["plane", "rotation", "from", "sweep", "center", "radius"];

impl PathKind {
    /// Returns the name that scenarios use.
    pub fn name(self) -> &'static str {
        match self {
            Self::Circle => "circle",
            Self::Tricuspid => "tricuspid",
            Self::Astroid => "astroid",
            Self::Line => "line",
            Self::Lissajous => "lissajous",
            Self::Rose => "rose",
            Self::Fourier => "fourier",
        }
    }

    /// Returns the parameters that the kind must have; a line has one of `to` and `displacement`.
    pub fn required(self) -> &'static [&'static str] {
        match self {
            Self::Circle | Self::Tricuspid | Self::Astroid => &["radius"],
            Self::Rose => &["radius", "petals"],
            Self::Lissajous => &["amplitudes", "frequencies"],
            Self::Fourier => &["cosines", "sines"],
            Self::Line => &[],
        }
    }

    /// Returns every parameter that the kind uses, `kind` apart.
    pub fn parameters(self) -> Vec<&'static str> {
        let mut known: Vec<&str> = match self {
            Self::Circle | Self::Tricuspid | Self::Astroid => BY_ANGLE.to_vec(),
            Self::Rose => [&BY_ANGLE[..], &["petals"]].concat(),
            Self::Lissajous => [&BY_ANGLE[..5], &["amplitudes", "frequencies", "phase"]].concat(),
            Self::Line => vec!["to", "displacement"],
            Self::Fourier => vec!["cosines", "sines", "center"],
        };
        known.extend(["time_law", "turn"]);
        known
    }
}

impl PathSpec {
    /// Returns a path of one kind with no parameter yet.
    pub fn new(kind: PathKind) -> Self {
        Self {
            kind,
            radius: None,
            petals: None,
            to: None,
            displacement: None,
            amplitudes: None,
            frequencies: None,
            phase: None,
            cosines: None,
            sines: None,
            plane: None,
            rotation: None,
            from: None,
            sweep: None,
            center: None,
            time_law: None,
            turn: None,
        }
    }

    /// Returns every length, angle and frequency that is given, by its key and, in a list, its place there.
    pub fn numbers(&self) -> impl Iterator<Item = (&'static str, Option<usize>, &Real)> {
        let single = [
            ("radius", &self.radius),
            ("petals", &self.petals),
            ("phase", &self.phase),
            ("rotation", &self.rotation),
            ("from", &self.from),
            ("sweep", &self.sweep),
        ];
        let lists = [
            ("to", self.to.as_deref()),
            ("displacement", self.displacement.as_deref()),
            ("center", self.center.as_deref()),
            ("amplitudes", self.amplitudes.as_ref().map(<[Real; 2]>::as_slice)),
            ("frequencies", self.frequencies.as_ref().map(<[Real; 2]>::as_slice)),
        ];
        let single = single.into_iter().filter_map(|(key, number)| Some((key, None, number.as_ref()?)));
        let entries = lists.into_iter().flat_map(|(key, list)| {
            let numbers = list.unwrap_or_default().iter().enumerate();
            numbers.map(move |(index, number)| (key, Some(index), number))
        });
        let triples = [("cosines", &self.cosines), ("sines", &self.sines)];
        let triples = triples.into_iter().flat_map(|(key, vectors)| {
            let vectors = vectors.iter().flatten().enumerate();
            vectors
                .flat_map(move |(index, vector)| vector.iter().map(move |number| (key, Some(index), number)))
        });
        single.chain(entries).chain(triples)
    }

    /// Returns the names of the parameters that are given.
    pub fn given(&self) -> Vec<&'static str> {
        let all = [
            ("radius", self.radius.is_some()),
            ("petals", self.petals.is_some()),
            ("to", self.to.is_some()),
            ("displacement", self.displacement.is_some()),
            ("amplitudes", self.amplitudes.is_some()),
            ("frequencies", self.frequencies.is_some()),
            ("phase", self.phase.is_some()),
            ("cosines", self.cosines.is_some()),
            ("sines", self.sines.is_some()),
            ("plane", self.plane.is_some()),
            ("rotation", self.rotation.is_some()),
            ("from", self.from.is_some()),
            ("sweep", self.sweep.is_some()),
            ("center", self.center.is_some()),
            ("time_law", self.time_law.is_some()),
            ("turn", self.turn.is_some()),
        ];
        all.into_iter().filter(|(_, given)| *given).map(|(name, _)| name).collect()
    }
}
