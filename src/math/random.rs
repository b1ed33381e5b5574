//! Random numbers as functions of their number: nothing is remembered, so any thread can draw any of them.

/// The mixing function of S. Vigna's splitmix64: 64 bits that have nothing to do with those of the neighbouring numbers.
pub(crate) fn mix(value: u64) -> u64 {
    let value = value.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let value = (value ^ (value >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let value = (value ^ (value >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    value ^ (value >> 31)
}

/// Makes the random bits into a number in [0, 1).
pub(crate) fn unit(draw: u64) -> f64 {
    (draw >> 11) as f64 / (1_u64 << 53) as f64
}

/// Makes the random bits into a standard normal number, by the transformation of Box and Muller.
pub(crate) fn normal(draw: u64) -> f64 {
    let (u, v) = (1.0 - unit(draw), unit(mix(draw)));
    (-2.0 * u.ln()).sqrt() * (std::f64::consts::TAU * v).cos()
}
