//! Random numbers as functions of their number: nothing is remembered, so any thread can draw any of them.

/// Returns 64 random bits for a number, which have nothing to do with those of the neighbouring numbers: the mixing function of
/// S. Vigna's splitmix64. The same number always gives the same bits.
pub fn mix(value: u64) -> u64 {
    let value = value.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let value = (value ^ (value >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let value = (value ^ (value >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    value ^ (value >> 31)
}

/// Returns a number in [0, 1), evenly spread, from the random bits of [`mix`].
pub fn unit(draw: u64) -> f64 {
    (draw >> 11) as f64 / (1_u64 << 53) as f64
}

/// Returns a number of mean 0 and variance 1, normally distributed, from the random bits of [`mix`], by the transformation of
/// Box and Muller.
pub fn normal(draw: u64) -> f64 {
    let (u, v) = (1.0 - unit(draw), unit(mix(draw)));
    (-2.0 * u.ln()).sqrt() * (std::f64::consts::TAU * v).cos()
}
