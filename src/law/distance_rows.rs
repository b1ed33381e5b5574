use super::{Instant, SystemShape};

/// How much of the way that is left to the margin may be made in a step: small enough for every row to come to rest there
/// without passing it.
const APPROACH: f64 = 0.1;
/// What rounding is left of a bound, as a fraction of what it is compared with.
const ROUNDING: f64 = 1e-12;

/// The rows `G x <= g` of joint velocities that keep near pairs of bodies apart: velocity dampers (Faverjon and Tournassoud 1987).
///
/// With `d` the distance of a pair and `J = dd/dq`, a velocity `x = f + g`, of which the feedback part `g` is given, is held to
/// - `-J x <= v (d - margin) / (influence - margin)`, and no more than a tenth of the way `d - margin` per step;
/// - the next sample `q' = known + first f + second g` with `-J (q' - q) <= d - margin`.
///
/// A pair that is nearer than the margin parts, the faster the nearer it is. The second row is exact but for the curvature of
/// `d`, which the first leaves room for.
#[derive(Clone, Debug, Default)]
pub(super) struct DistanceRows {
    rows: Vec<f64>,
    bounds: Vec<f64>,
    /// The pairs that the rows are about.
    pairs: Vec<usize>,
}

impl DistanceRows {
    pub(super) fn new(shape: &SystemShape) -> Self {
        let (pairs, joints) = (shape.pairs, shape.joints.len());
        Self {
            rows: Vec::with_capacity(pairs * joints),
            bounds: Vec::with_capacity(pairs),
            pairs: Vec::with_capacity(pairs),
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
        self.pairs.get(row).copied()
    }

    /// Finds the rows of the velocities of an instant that have this feedback part.
    pub(super) fn find(&mut self, instant: &Instant<'_>, feedback: &[f64]) {
        self.rows.clear();
        self.bounds.clear();
        self.pairs.clear();
        let Some(avoidance) = instant.avoidance else { return };
        let sigma = instant.sigma;
        let (first, second) = instant.next.map_or((sigma, sigma), |next| (next.first.max(0.0), next.second));
        let fastest = avoidance.speed / (avoidance.influence - avoidance.margin);
        let rate = fastest.min(APPROACH / first.max(sigma));
        for (proximity, row) in avoidance.pairs.iter() {
            if row.iter().all(|entry| *entry == 0.0) {
                continue;
            }
            let left = proximity.separation.distance - avoidance.margin;
            let mut bound = rate * left;
            if let Some(next) = instant.next.filter(|_| left > 0.0 && first > 0.0) {
                let entries = row.iter().zip(next.known).zip(instant.q.iter().zip(feedback));
                let drift = |((row, known), (q, g)): ((&f64, &f64), (&f64, &f64))| {
                    row * (known - q + (second - first) * g)
                };
                bound = bound.min((left + entries.map(drift).sum::<f64>()) / first);
            }
            self.rows.extend(row.iter().map(|entry| -entry));
            self.bounds.push(bound);
            self.pairs.push(proximity.pair);
        }
    }

    /// Whether a velocity of every joint keeps all rows.
    pub(super) fn contain(&self, velocity: &[f64]) -> bool {
        let joints = velocity.len();
        self.rows.chunks_exact(joints.max(1)).zip(&self.bounds).all(|(row, bound)| {
            let product: f64 = row.iter().zip(velocity).map(|(row, velocity)| row * velocity).sum();
            product <= bound + ROUNDING * bound.abs()
        })
    }
}
