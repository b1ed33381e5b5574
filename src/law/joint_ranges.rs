use super::{Conflict, Infeasible, Instant, LimitKind};
use crate::robot::Limits;

/// How fast a joint may still come nearer to a position limit, as a fraction of the way that is left per step: small enough for
/// every row to come to rest there without passing it.
const APPROACH: f64 = 0.1;
/// How much nearer a velocity may come to its limit from one sample to the next, as a fraction of what is left: a velocity that
/// ran straight into its limit would have the next samples pass it, and stands out in the differences that the rows make.
const VELOCITY_APPROACH: f64 = 0.25;
/// What rounding is left of an interval, as a fraction of its bounds.
const ROUNDING: f64 = 1e-12;

/// The joint velocities that keep all limits of an instant, joint by joint: those of the velocities themselves, and those of the
/// samples that they lead to.
///
/// A velocity `x = f + g`, of which the feedback part `g` is given, is held to
/// - `|x| <= v` and `|f| <= v`, which is approached by a fraction of what is left, and `|f - f_before| <= a sigma` for an
///   acceleration limit `a`;
/// - `x <= k (upper - q)`, which lets a position limit be approached and not passed, and `x <= sqrt(a^2 sigma^2 + 2 a (upper -
///   q)) - a sigma`, from which the joint can still stop;
/// - the next sample `q' = known + first f + second g` with `q' <= upper`, `|q' - q| <= v sigma` and `|q' - 2 q + q_before| <=
///   a sigma^2`.
///
/// A joint beyond a position limit comes back, the faster the farther it is.
#[derive(Clone, Debug, Default)]
pub(super) struct JointRanges {
    pub(super) lower: Vec<f64>,
    pub(super) upper: Vec<f64>,
    /// Which limits these come from.
    kinds: Vec<[LimitKind; 2]>,
    /// The feedforward velocities and the positions one sample ago.
    velocity_before: Vec<f64>,
    before: Vec<f64>,
    has_before: bool,
}

/// One side of a range, and the limit that it comes from.
#[derive(Clone, Copy)]
struct Side {
    value: f64,
    kind: LimitKind,
}

impl Side {
    fn at_most(self, value: f64, kind: LimitKind) -> Self {
        if value < self.value { Self { value, kind } } else { self }
    }
}

/// What decides the upper side of the range of a joint; the lower side is that of the mirrored joint.
#[derive(Clone, Copy)]
struct Upwards {
    limits: Limits,
    q: f64,
    /// The feedforward velocity and the position one sample ago.
    before: Option<(f64, f64)>,
    /// The feedback part of the velocity.
    feedback: f64,
    /// What of the next sample does not depend on the velocity that is looked for.
    known: f64,
    first: f64,
    sigma: f64,
}

impl Upwards {
    fn mirrored(self) -> Self {
        let Limits { lower, upper, .. } = self.limits;
        Self {
            limits: Limits { lower: -upper, upper: -lower, ..self.limits },
            q: -self.q,
            before: self.before.map(|(velocity, position)| (-velocity, -position)),
            feedback: -self.feedback,
            known: -self.known,
            ..self
        }
    }

    fn side(self) -> Side {
        let Limits { upper, velocity, acceleration, .. } = self.limits;
        let mut side = Side { value: f64::INFINITY, kind: LimitKind::Velocity };
        side = side.at_most(velocity + self.feedback.min(0.0), LimitKind::Velocity);
        let left = upper - self.q;
        if left.is_finite() {
            side = side.at_most(self.towards(left).max(-velocity), LimitKind::Position);
        }
        side = side.at_most(self.leading_to(velocity * self.sigma * (1.0 - ROUNDING)), LimitKind::Velocity);
        if let Some((before, _)) = self.before.filter(|_| velocity.is_finite()) {
            let nearer = before + VELOCITY_APPROACH * (velocity - before).max(0.0);
            side = side.at_most(nearer + self.feedback, LimitKind::Velocity);
        }
        if let Some((before, position)) = self.before.filter(|_| acceleration.is_finite()) {
            let change = acceleration * self.sigma * (1.0 - ROUNDING);
            side = side.at_most(before + change + self.feedback, LimitKind::Acceleration);
            side = side
                .at_most(self.leading_to(self.q - position + change * self.sigma), LimitKind::Acceleration);
            // What can no longer be braked down to is not asked for.
            side.value = side.value.max(before - change + self.feedback);
        }
        side
    }

    /// The velocity towards a position limit that is `left` away, or back from one that was passed.
    fn towards(self, left: f64) -> f64 {
        if left < 0.0 {
            return APPROACH * left / self.sigma;
        }
        let change = self.limits.acceleration * self.sigma;
        let stopping = if change.is_finite() {
            (change * change + 2.0 * self.limits.acceleration * left).sqrt() - change
        } else {
            f64::INFINITY
        };
        let next = if self.first > 0.0 { (left + self.q - self.known) / self.first } else { f64::INFINITY };
        let approaching = APPROACH * left / self.first.max(self.sigma);
        approaching.min(stopping).min(next)
    }

    /// The velocity that leads to a sample at most `way` further on.
    fn leading_to(self, way: f64) -> f64 {
        if self.first > 0.0 && way.is_finite() {
            (self.q + way - self.known) / self.first
        } else {
            f64::INFINITY
        }
    }
}

impl JointRanges {
    pub(super) fn with_capacity(joints: usize) -> Self {
        Self {
            lower: vec![f64::NEG_INFINITY; joints],
            upper: vec![f64::INFINITY; joints],
            kinds: vec![[LimitKind::Velocity; 2]; joints],
            velocity_before: vec![0.0; joints],
            before: vec![0.0; joints],
            has_before: false,
        }
    }

    /// Takes note of where the joints are at a sample, and of their feedforward velocities there.
    pub(super) fn accept(&mut self, instant: &Instant<'_>, feedforward: &[f64]) {
        self.velocity_before.copy_from_slice(feedforward);
        self.before.copy_from_slice(instant.q);
        self.has_before = true;
    }

    /// Finds the ranges of the velocities of an instant that have this feedback part.
    ///
    /// # Errors
    /// [`Infeasible`] where the limits of one joint contradict each other.
    pub(super) fn find(&mut self, instant: &Instant<'_>, feedback: &[f64]) -> Result<(), Infeasible> {
        for (joint, (&q, limits)) in instant.q.iter().zip(instant.limits).enumerate() {
            let (feedback, sigma) = (feedback[joint], instant.sigma);
            let (known, first) = instant.next.as_ref().map_or((q, sigma), |next| {
                (next.known[joint] + (next.second - next.first) * feedback, next.first)
            });
            // Between samples there is no gap to what was before.
            let before = (self.has_before && instant.is_sample)
                .then(|| (self.velocity_before[joint], self.before[joint]));
            let upwards = Upwards { limits: *limits, q, before, feedback, known, first, sigma };
            let (upper, lower) = (upwards.side(), upwards.mirrored().side());
            (self.lower[joint], self.upper[joint]) = (-lower.value, upper.value);
            self.kinds[joint] = [lower.kind, upper.kind];
            if -lower.value > upper.value {
                let kinds =
                    if lower.kind == upper.kind { vec![lower.kind] } else { vec![lower.kind, upper.kind] };
                let conflicts = kinds.into_iter().map(|kind| Conflict::Limit { joint, kind }).collect();
                return Err(Infeasible { conflicts });
            }
        }
        Ok(())
    }

    /// Which limit the lower or upper side of a joint comes from.
    pub(super) fn kind(&self, joint: usize, is_upper: bool) -> LimitKind {
        self.kinds[joint][usize::from(is_upper)]
    }

    /// Takes back what rounding left a velocity outside.
    pub(super) fn clamp(&self, velocity: &mut [f64]) {
        for (velocity, (lower, upper)) in velocity.iter_mut().zip(self.lower.iter().zip(&self.upper)) {
            *velocity = velocity.clamp(*lower, *upper);
        }
    }

    /// Whether a velocity of every joint lies within.
    pub(super) fn contains(&self, velocity: &[f64]) -> bool {
        let mut all = velocity.iter().zip(&self.lower).zip(&self.upper);
        all.all(|((velocity, lower), upper)| lower <= velocity && velocity <= upper)
    }
}
