//! Random numbers from a seed, and a search that learns the shape of its valley.

/// Reproducible random numbers (SplitMix64; Steele, Lea and Flood 2014).
#[derive(Debug, Clone)]
pub(super) struct Random {
    state: u64,
}

impl Random {
    /// Returns the stream of a seed and a number: different for every pair, whatever else is drawn.
    pub(super) fn new(seed: u64, stream: u64) -> Self {
        let mut random = Self { state: seed.wrapping_mul(0xD129_0D3B_3B2C_7F65) ^ stream };
        random.state = random.next_u64().wrapping_add(stream);
        random
    }

    fn next_u64(&mut self) -> u64 {
        self.state = self.state.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.state;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// Returns a number in (0, 1).
    pub(super) fn uniform(&mut self) -> f64 {
        ((self.next_u64() >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
    }

    /// Returns a normally distributed number (Box and Muller).
    pub(super) fn normal(&mut self) -> f64 {
        let radius = (-2.0 * self.uniform().ln()).sqrt();
        radius * (std::f64::consts::TAU * self.uniform()).cos()
    }
}

/// A point and its merit; lower is better.
#[derive(Debug, Clone)]
pub(super) struct Best {
    pub(super) point: Vec<f64>,
    pub(super) merit: f64,
}

/// Walks downhill from a point with random steps whose size and shape follow their success: the (1+1)-CMA evolution strategy
/// with a Cholesky factor (Igel, Suttorp and Hansen 2006), begun anew from where it is whenever the steps have become tiny.
pub(super) fn evolve(
    merit: impl Fn(&[f64]) -> f64,
    start: Best,
    step: f64,
    evaluations: usize,
    random: &mut Random,
    stop: impl Fn() -> bool,
) -> Best {
    const TARGET: f64 = 2.0 / 11.0;
    const SMOOTHING: f64 = 1.0 / 12.0;
    const TINY: f64 = 1e-9;
    let n = start.point.len();
    let damping = 1.0 + n as f64 / 2.0;
    let mut shape = Shape::round(n);
    let (mut best, mut size, mut success) = (start, step, TARGET);
    for _ in 0..evaluations {
        if stop() {
            break;
        }
        let direction: Vec<f64> = (0..n).map(|_| random.normal()).collect();
        let change = shape.times(&direction);
        let point: Vec<f64> = best.point.iter().zip(&change).map(|(x, d)| x + size * d).collect();
        let found = merit(&point);
        let better = found < best.merit;
        success += SMOOTHING * (f64::from(u8::from(better)) - success);
        size *= ((success - TARGET) / (damping * (1.0 - TARGET))).exp();
        if better {
            best = Best { point, merit: found };
            if success < 0.44 {
                shape.learn(&direction, &change);
            }
        }
        if size < TINY {
            (size, success, shape) = (0.3 * step, TARGET, Shape::round(n));
        }
    }
    best
}

/// The factor A of the covariance A A^T of the steps.
struct Shape {
    rows: Vec<Vec<f64>>,
}

impl Shape {
    fn round(n: usize) -> Self {
        Self { rows: (0..n).map(|i| (0..n).map(|j| f64::from(u8::from(i == j))).collect()).collect() }
    }

    fn times(&self, z: &[f64]) -> Vec<f64> {
        self.rows.iter().map(|row| row.iter().zip(z).map(|(a, b)| a * b).sum()).collect()
    }

    /// Stretches the steps along one that was a success.
    fn learn(&mut self, z: &[f64], az: &[f64]) {
        let n = z.len() as f64;
        let rate = 2.0 / (n * n + 6.0);
        let length: f64 = z.iter().map(|x| x * x).sum();
        let keep = (1.0 - rate).sqrt();
        let stretch = keep / length * ((1.0 + rate * length / (1.0 - rate)).sqrt() - 1.0);
        for (row, along) in self.rows.iter_mut().zip(az) {
            for (a, z) in row.iter_mut().zip(z) {
                *a = keep * *a + stretch * along * z;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn finds_the_bottom_of_a_bent_valley() {
        let valley = |x: &[f64]| (1.0 - x[0]).powi(2) + 100.0 * (x[1] - x[0] * x[0]).powi(2);
        let start = Best { point: vec![-1.2, 1.0], merit: f64::INFINITY };
        let found = evolve(valley, start, 0.5, 4000, &mut Random::new(1, 1), || false);
        assert!(found.merit < 1e-8, "{found:?}");
    }

    #[test]
    fn streams_differ_and_repeat() {
        let draw = |seed, stream| Random::new(seed, stream).uniform();
        assert_eq!(draw(3, 4), draw(3, 4));
        assert_ne!(draw(3, 4), draw(4, 3));
        assert_ne!(draw(3, 4), draw(3, 5));
    }
}
