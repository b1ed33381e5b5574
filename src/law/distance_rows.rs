use super::{Avoidance, Instant, SystemShape};

/// How much of the way that is left to the margin may be made in a step: small enough for every row to come to rest there
/// without passing it.
const APPROACH: f64 = 0.1;
/// What rounding is left of a bound, as a fraction of what it is compared with.
const ROUNDING: f64 = 1e-12;
/// How many times what curvature may take the damper keeps in reserve, so that it alone acts where bodies slide along each other:
/// a row that holds the next sample itself makes the differences of multistep rows jump.
const RESERVE: f64 = 4.0;
/// How much longer a step is thought to be than the one that asked for tighter rows.
const ROOM: f64 = 1.1;

/// The rows `G x <= g` of joint velocities that keep near pairs of bodies apart: velocity dampers (Faverjon and Tournassoud 1987).
///
/// With `d` the distance of a pair and `J = dd/dq`, a velocity `x = f + g`, of which the feedback part `g` is given, is held to
/// - `-J x <= v (d - margin - 4 s) / (influence - margin)`, and no more than a tenth of that way per step;
/// - the next sample `q' = known + first f + second g` with `-J (q' - q) <= d - margin - s`.
///
/// `s = 1/2 L (sum |q' - q|)^2`, with `L` the longest lever by which a joint moves the points, bounds what the second derivative
/// takes from the distance, so that the next sample keeps the margin and not only its tangent. A pair that is nearer than the
/// margin parts, the faster the nearer it is.
#[derive(Clone, Debug, Default)]
pub(super) struct DistanceRows {
    rows: Vec<f64>,
    bounds: Vec<f64>,
    /// What each row is about.
    contacts: Vec<Contact>,
    /// What of `q' - q` does not depend on the velocity that is looked for, and what the velocity is multiplied by.
    drift: Vec<f64>,
    first: f64,
    /// How fast the way that is left may shrink [1/s].
    rate: f64,
    /// The length `sum |q' - q|` of the step that the bounds allow for.
    step: f64,
}

/// What a row is about.
#[derive(Clone, Copy, Debug)]
struct Contact {
    pair: usize,
    /// The way that is left to the margin \[m\].
    left: f64,
    lever: f64,
    /// What the drift alone changes the distance by \[m\].
    change: f64,
}

impl DistanceRows {
    pub(super) fn new(shape: &SystemShape) -> Self {
        let (contacts, joints) = (shape.contacts, shape.joints.len());
        Self {
            rows: Vec::with_capacity(contacts * joints),
            bounds: Vec::with_capacity(contacts),
            contacts: Vec::with_capacity(contacts),
            drift: vec![0.0; joints],
            ..Self::default()
        }
    }

    /// `G`, row after row.
    pub(super) fn rows(&self) -> &[f64] {
        &self.rows
    }

    /// `g`.
    pub(super) fn bounds(&self) -> &[f64] {
        &self.bounds
    }

    /// The pair that a row is about.
    pub(super) fn pair(&self, row: usize) -> Option<usize> {
        self.contacts.get(row).map(|contact| contact.pair)
    }

    /// Finds the rows of the velocities of an instant that have this feedback part, for a step as long as that of the velocity `x`.
    pub(super) fn find(&mut self, instant: &Instant<'_>, feedback: &[f64], x: &[f64]) {
        self.rows.clear();
        self.contacts.clear();
        self.bounds.clear();
        let Some(avoidance) = &instant.avoidance else { return };
        self.find_drift(instant, feedback);
        let fastest = avoidance.speed / (avoidance.influence - avoidance.margin);
        self.rate = fastest.min(APPROACH / self.first.max(instant.sigma));
        self.add_rows(avoidance);
        self.step = self.length(x);
        self.write_bounds();
    }

    /// What the next sample makes of a velocity.
    fn find_drift(&mut self, instant: &Instant<'_>, feedback: &[f64]) {
        self.drift.fill(0.0);
        self.first = instant.sigma;
        let Some(next) = &instant.next else { return };
        self.first = next.first;
        for (joint, drift) in self.drift.iter_mut().enumerate() {
            *drift = next.known[joint] - instant.q[joint] + (next.second - next.first) * feedback[joint];
        }
    }

    fn add_rows(&mut self, avoidance: &Avoidance<'_>) {
        for (proximity, row) in avoidance.contacts.iter() {
            if row.iter().all(|entry| *entry == 0.0) {
                continue;
            }
            self.rows.extend(row.iter().map(|entry| -entry));
            self.contacts.push(Contact {
                pair: proximity.pair,
                left: proximity.separation.distance - avoidance.margin,
                lever: proximity.lever,
                change: row.iter().zip(&self.drift).map(|(row, drift)| row * drift).sum(),
            });
        }
    }

    fn write_bounds(&mut self) {
        self.bounds.clear();
        for &Contact { left, lever, change, .. } in &self.contacts {
            let curvature = 0.5 * lever * self.step * self.step;
            let safe = left - curvature;
            let mut bound = self.rate * (left - RESERVE * curvature);
            if left > 0.0 && self.first > 0.0 {
                bound = bound.min((safe + change) / self.first);
            }
            self.bounds.push(bound);
        }
    }

    /// `sum |q' - q|` of a velocity.
    fn length(&self, x: &[f64]) -> f64 {
        self.drift.iter().zip(x).map(|(drift, x)| (drift + self.first * x).abs()).sum()
    }

    /// Allows for the step of a velocity where that is longer than what was allowed for; whether the rows have changed.
    pub(super) fn tighten(&mut self, x: &[f64]) -> bool {
        let length = self.length(x);
        if self.contacts.is_empty() || length <= self.step {
            return false;
        }
        self.step = ROOM * length;
        self.write_bounds();
        true
    }

    /// Whether a velocity of every joint keeps all rows.
    pub(super) fn contain(&self, x: &[f64]) -> bool {
        self.rows.chunks_exact(x.len().max(1)).zip(&self.bounds).all(|(row, bound)| {
            let product: f64 = row.iter().zip(x).map(|(row, x)| row * x).sum();
            product <= bound + ROUNDING * bound.abs()
        })
    }
}
