//! A polynomial over the time between two samples.

/// The most coefficients of a polynomial here: one of degree five.
const MOST: usize = 6;
/// How often a bracket of a root is halved: until its ends are neighbours.
const HALVINGS: usize = 60;

/// A polynomial of degree five at most in `s = (t - start) / duration`, `s` from 0 to 1.
#[derive(Clone, Copy, Debug)]
pub(super) struct Segment {
    pub(super) start: f64,
    pub(super) duration: f64,
    /// The coefficients of `1, s, s^2, ...`.
    pub(super) coefficients: [f64; MOST],
    /// The value at `s = 1`, where it is known better than the sum of the coefficients.
    pub(super) end: f64,
}

impl Segment {
    /// The polynomial with these coefficients.
    pub(super) fn new([start, duration]: [f64; 2], coefficients: [f64; MOST]) -> Self {
        Self { start, duration, coefficients, end: coefficients.iter().sum() }
    }

    /// The same, with a value at its end that is known better.
    pub(super) fn ending(self, end: f64) -> Self {
        Self { end, ..self }
    }

    /// The same, with values at both ends that are known better.
    pub(super) fn between(mut self, [start, end]: [f64; 2]) -> Self {
        self.coefficients[0] = start;
        self.ending(end)
    }

    /// The value at `s`.
    pub(super) fn value(&self, s: f64) -> f64 {
        if s == 1.0 { self.end } else { horner(&self.coefficients, s) }
    }

    /// The time \[s\] at `s`.
    pub(super) fn time(&self, s: f64) -> f64 {
        self.start + s * self.duration
    }

    /// The derivative by time.
    pub(super) fn derivative(&self) -> Self {
        let mut coefficients = derivative(&self.coefficients);
        for coefficient in &mut coefficients {
            *coefficient /= self.duration;
        }
        Self::new([self.start, self.duration], coefficients)
    }

    /// Bounds of the values between the ends: the least and the largest coefficient in Bernstein's basis. They are met at
    /// the ends, and may be missed between them.
    pub(super) fn bounds(&self) -> [f64; 2] {
        // b_i = sum over j <= i of C(i, j) / C(n, j) a_j with n = 5.
        const BINOMIAL: [[f64; MOST]; MOST] = [
            [1.0, 0.0, 0.0, 0.0, 0.0, 0.0],
            [1.0, 1.0, 0.0, 0.0, 0.0, 0.0],
            [1.0, 2.0, 1.0, 0.0, 0.0, 0.0],
            [1.0, 3.0, 3.0, 1.0, 0.0, 0.0],
            [1.0, 4.0, 6.0, 4.0, 1.0, 0.0],
            [1.0, 5.0, 10.0, 10.0, 5.0, 1.0],
        ];
        let mut scaled = self.coefficients;
        scaled.iter_mut().zip(BINOMIAL[MOST - 1]).for_each(|(a, whole)| *a /= whole);
        let (mut least, mut largest) =
            (self.coefficients[0].min(self.end), self.coefficients[0].max(self.end));
        for row in &BINOMIAL[1..MOST - 1] {
            let value: f64 = row.iter().zip(&scaled).map(|(binomial, a)| binomial * a).sum();
            (least, largest) = (least.min(value), largest.max(value));
        }
        [least, largest]
    }

    /// Where between its ends the polynomial turns round, or may.
    pub(super) fn turning_points(&self) -> Vec<f64> {
        roots(&derivative(&self.coefficients))
    }

    /// Where between its ends the polynomial passes a level, in rising order.
    pub(super) fn passes(&self, level: f64) -> Vec<f64> {
        let mut shifted = self.coefficients;
        shifted[0] -= level;
        roots(&shifted)
    }
}

fn horner(coefficients: &[f64], s: f64) -> f64 {
    coefficients.iter().rev().fold(0.0, |value, coefficient| value * s + coefficient)
}

fn derivative(coefficients: &[f64; MOST]) -> [f64; MOST] {
    let mut derived = [0.0; MOST];
    for (power, coefficient) in coefficients.iter().enumerate().skip(1) {
        derived[power - 1] = power as f64 * coefficient;
    }
    derived
}

/// The places between 0 and 1 at which a polynomial changes its sign, in rising order: between two neighbouring roots of its
/// derivative it is monotone and has one at most.
fn roots(coefficients: &[f64; MOST]) -> Vec<f64> {
    let Some(degree) = coefficients.iter().rposition(|&coefficient| coefficient != 0.0).filter(|&d| d > 0)
    else {
        return Vec::new();
    };
    if degree == 1 {
        let root = -coefficients[0] / coefficients[1];
        return if root > 0.0 && root < 1.0 { vec![root] } else { Vec::new() };
    }
    let mut found = Vec::new();
    let mut from = 0.0;
    for to in roots(&derivative(coefficients)).into_iter().chain([1.0]) {
        found.extend(root_between(coefficients, from, to));
        from = to;
    }
    found
}

/// The place between two others at which a monotone polynomial changes its sign, if it does.
fn root_between(coefficients: &[f64], mut from: f64, mut to: f64) -> Option<f64> {
    let at_start = horner(coefficients, from);
    if !(at_start * horner(coefficients, to) < 0.0) {
        return None;
    }
    for _ in 0..HALVINGS {
        let middle = f64::midpoint(from, to);
        if horner(coefficients, middle) * at_start > 0.0 {
            from = middle;
        } else {
            to = middle;
        }
    }
    Some(f64::midpoint(from, to))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::array::uniform5;
    use proptest::prelude::*;

    /// The product of the factors `s - root`.
    fn with_roots(wanted: [f64; 5]) -> [f64; MOST] {
        let mut coefficients = [0.0; MOST];
        coefficients[0] = 1.0;
        for root in wanted {
            for power in (0..MOST).rev() {
                let below = if power == 0 { 0.0 } else { coefficients[power - 1] };
                coefficients[power] = below - root * coefficients[power];
            }
        }
        coefficients
    }

    proptest! {
        #[test]
        fn roots_are_found_and_no_others(mut wanted in uniform5(-1.0..2.0_f64)) {
            wanted.sort_by(f64::total_cmp);
            prop_assume!(wanted.windows(2).all(|pair| pair[1] - pair[0] > 0.03));
            prop_assume!(wanted.iter().all(|root| root.abs() > 1e-6 && (root - 1.0).abs() > 1e-6));
            let found = roots(&with_roots(wanted));
            let inside: Vec<f64> = wanted.into_iter().filter(|root| *root > 0.0 && *root < 1.0).collect();
            prop_assert_eq!(found.len(), inside.len(), "{:?} {:?}", found, inside);
            for (found, wanted) in found.iter().zip(inside) {
                prop_assert!((found - wanted).abs() < 1e-8, "{} {}", found, wanted);
            }
        }

        #[test]
        fn bounds_hold_and_turning_points_have_the_extremes(
            low in uniform5(-3.0..3.0_f64), high in -3.0..3.0_f64, s in 0.0..1.0_f64,
        ) {
            let coefficients = [low[0], low[1], low[2], low[3], low[4], high];
            let segment = Segment::new([2.0, 0.5], coefficients);
            let [least, largest] = segment.bounds();
            let value = segment.value(s);
            prop_assert!(least - 1e-12 <= value && value <= largest + 1e-12);
            let places = segment.turning_points().into_iter().chain([0.0, 1.0]);
            let extremes: Vec<f64> = places.map(|s| segment.value(s)).collect();
            let (low, high) = extremes.iter().fold((f64::MAX, f64::MIN), |(low, high), v| (low.min(*v), high.max(*v)));
            prop_assert!(low - 1e-9 <= value && value <= high + 1e-9, "{} {:?}", value, extremes);
            let step = 1e-6;
            let slope = (segment.value(s) - segment.value(s - step)) / (step * segment.duration);
            prop_assert!((segment.derivative().value(s) - slope).abs() < 1e-2);
        }
    }
}
