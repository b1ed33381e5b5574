// split-ab3: x_n+1 = x_n + sigma (23/12 f_n - 4/3 f_n-1 + 5/12 f_n-2) + sigma g_n
// Newest sample first: entry j belongs to time n+1-j.
pub const ALPHA: [f64; 4] = [1.0, -1.0, 0.0, 0.0];
pub const BETA: [f64; 4] = [0.0, 23.0 / 12.0, -4.0 / 3.0, 5.0 / 12.0];
pub const GAMMA: [f64; 4] = [0.0, 1.0, 0.0, 0.0];

/// Returns x_n+1 from past samples, newest first: `x` holds x_n, x_n-1, ...; `f` and `g` hold their values there.
pub fn step(x: &[f64], f: &[f64], g: &[f64], sigma: f64) -> f64 {
    (1..ALPHA.len()).map(|j| -ALPHA[j] * x[j - 1] + sigma * (BETA[j] * f[j - 1] + GAMMA[j] * g[j - 1])).sum()
}
