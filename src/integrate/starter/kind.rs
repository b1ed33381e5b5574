use serde::{Deserialize, Serialize};

/// A starter that has a name and needs nothing else: what scenario files and the command line offer.
///
/// ```
/// use kinstep::integrate::StarterKind;
/// let names = StarterKind::ALL.map(StarterKind::name);
/// assert_eq!(names, ["paper", "ramp", "rk4", "rk8"]);
/// assert_eq!(StarterKind::by_name("rk8"), Some(StarterKind::Rk8));
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    // The schema is a format of its own: the type has its own name and description there.
    schemars(rename = "Start", description = "How the first states of a run are made.")
)]
#[serde(rename_all = "kebab-case")]
pub enum StarterKind {
    /// Euler steps with the same h, as in the paper: leaves a residual of (sigma^2/2) phi''.
    Paper,
    /// Rows of the same family of rising order; begins like `paper`.
    Ramp,
    /// The classical Runge-Kutta method of order 4.
    Rk4,
    /// A Runge-Kutta method of order 8.
    Rk8,
}

impl StarterKind {
    /// All of them, in the order in which they are listed.
    pub const ALL: [Self; 4] = [Self::Paper, Self::Ramp, Self::Rk4, Self::Rk8];

    /// Returns the name used in scenario files, on the command line and in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Paper => "paper",
            Self::Ramp => "ramp",
            Self::Rk4 => "rk4",
            Self::Rk8 => "rk8",
        }
    }

    /// Returns the starter of that name.
    pub fn by_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.name() == name)
    }

    /// Returns the order of the start: a row of higher order shows it in the maximum over the whole run.
    pub fn order(self) -> usize {
        match self {
            Self::Paper | Self::Ramp => 1,
            Self::Rk4 => 4,
            Self::Rk8 => 8,
        }
    }

    /// Returns the cheapest one that does not hide a row of order `order`: [`Rk4`](Self::Rk4) up to 4, else [`Rk8`](Self::Rk8).
    pub fn sufficient_for(order: usize) -> Self {
        if order <= 4 { Self::Rk4 } else { Self::Rk8 }
    }
}
