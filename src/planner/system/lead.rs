//! The way of an arm to where its path begins.

/// A motion of the joints from rest to rest before the run: `q(s) = from + s (q0 - from)` with
/// `s(tau) = 10 tau^3 - 15 tau^4 + 6 tau^5`, which begins and ends without acceleration.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::planner) struct Lead {
    /// Where the joints begin [rad or m].
    pub(in crate::planner) from: Vec<f64>,
    /// How long it takes \[s\].
    pub(in crate::planner) duration: f64,
}

impl Lead {
    /// Positions [rad or m] and velocities [rad/s or m/s] at the fraction `tau` of the way to `q0`, taken in `duration` \[s\].
    pub(in crate::planner) fn at(&self, tau: f64, q0: &[f64], duration: f64) -> (Vec<f64>, Vec<f64>) {
        let square = tau * tau;
        let s = square * tau * (10.0 + tau * (6.0 * tau - 15.0));
        let rate = 30.0 * square * (1.0 - tau) * (1.0 - tau) / duration;
        let joints = || self.from.iter().zip(q0);
        let positions = joints().map(|(from, to)| from + s * (to - from)).collect();
        (positions, joints().map(|(from, to)| rate * (to - from)).collect())
    }
}
