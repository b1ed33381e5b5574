//! Sines and cosines of many angles together.

use super::lanes::{Lane, Lanes};
use fearless_simd::Simd;
use std::hint::black_box;

/// Beyond this angle \[rad\] the reduction by three parts of pi/2 would lose digits; few joints turn so far.
const FARTHEST: f64 = 1e6;

/// A constant as the vectors that it is combined with.
type Constant = [f64; 4];

/// What the two functions are computed with.
struct Constants {
    half: Constant,
    one: Constant,
    two: Constant,
    two_over_pi: Constant,
    /// pi/2 in three parts: the first two have 33 bits, so that their products with whole numbers below 2^20 are exact
    /// (the splitting of fdlibm, Sun Microsystems 1993).
    half_pi: [Constant; 3],
    /// Minimax coefficients of `(sin r - r) / r^3` in `r^2` for `|r| <= pi/4` (fdlibm).
    sine: [Constant; 6],
    /// Minimax coefficients of `(cos r - 1 + r^2/2) / r^4` in `r^2` for `|r| <= pi/4` (fdlibm).
    cosine: [Constant; 6],
}

static CONSTANTS: Constants = Constants {
    half: [0.5; 4],
    one: [1.0; 4],
    two: [2.0; 4],
    two_over_pi: [std::f64::consts::FRAC_2_PI; 4],
    half_pi: [[1.570_796_326_734_125_6; 4], [6.077_100_506_303_966e-11; 4], [2.022_266_248_795_950_6e-21; 4]],
    sine: [
        [-1.666_666_666_666_663_2e-1; 4],
        [8.333_333_333_322_49e-3; 4],
        [-1.984_126_982_985_795e-4; 4],
        [2.755_731_370_707_006_8e-6; 4],
        [-2.505_076_025_340_686_3e-8; 4],
        [1.589_690_995_211_55e-10; 4],
    ],
    cosine: [
        [4.166_666_666_666_66e-2; 4],
        [-1.388_888_888_887_411e-3; 4],
        [2.480_158_728_947_673e-5; 4],
        [-2.755_731_435_139_066_3e-7; 4],
        [2.087_572_321_298_175e-9; 4],
        [-1.135_964_755_778_819_5e-11; 4],
    ],
};

/// Writes the sines and cosines of the angles \[rad\] that `angle` gives by index, `V::WIDTH` at a time; what does not fill
/// the last vector is left alone.
#[inline(always)]
pub(crate) fn sines_and_cosines<V: Lanes>(
    token: V::Token,
    angle: impl Fn(usize) -> f64,
    sines: &mut [f64],
    cosines: &mut [f64],
) {
    let constants = black_box(&CONSTANTS);
    let out = sines.chunks_exact_mut(V::WIDTH).zip(cosines.chunks_exact_mut(V::WIDTH));
    for (chunk, (sines, cosines)) in out.enumerate() {
        let x = V::gather(
            token,
            #[inline(always)]
            |lane| angle(chunk * V::WIDTH + lane),
        );
        write(x, (token, constants), sines, cosines);
    }
}

/// The same for angles that lie one after the other; what does not fill the last vector is left alone.
#[inline(always)]
pub(crate) fn sines_and_cosines_of<V: Lanes>(
    token: V::Token,
    angles: &[f64],
    sines: &mut [f64],
    cosines: &mut [f64],
) {
    // Constants that the compiler knows would be spread into registers one by one before every use; those that it has to
    // read are operands where they lie.
    let constants = black_box(&CONSTANTS);
    let out = sines.chunks_exact_mut(V::WIDTH).zip(cosines.chunks_exact_mut(V::WIDTH));
    for (angles, (sines, cosines)) in angles.chunks_exact(V::WIDTH).zip(out) {
        write(V::load_slice(token, angles), (token, constants), sines, cosines);
    }
}

#[inline(always)]
fn write<V: Lanes>(x: V, with: (V::Token, &Constants), sines: &mut [f64], cosines: &mut [f64]) {
    if x.all_within(FARTHEST) {
        let (sine, cosine) = sin_cos(x, with);
        sine.store_slice(sines);
        cosine.store_slice(cosines);
    } else {
        one_by_one(with, x.to_array().as_ref(), sines, cosines);
    }
}

/// Angles too large for [`sin_cos`], and those that are not finite.
#[cold]
fn one_by_one<S: Simd>(
    (simd, constants): (S, &Constants),
    angles: &[f64],
    sines: &mut [f64],
    cosines: &mut [f64],
) {
    for ((&angle, sine), cosine) in angles.iter().zip(sines).zip(cosines) {
        (*sine, *cosine) = if angle.abs() < FARTHEST {
            let (sine, cosine) = sin_cos(Lane::splat(simd, angle), (simd, constants));
            (sine.value, cosine.value)
        } else {
            angle.sin_cos()
        };
    }
}

/// The sine and the cosine, each to two units in the last place of one: `|x| < 1e6`.
#[inline(always)]
fn sin_cos<V: Lanes>(x: V, (token, constants): (V::Token, &Constants)) -> (V, V) {
    let constant = |constant: &Constant| V::load_slice(token, &constant[..V::WIDTH]);
    let (half, one) = (constant(&constants.half), constant(&constants.one));
    let turns = x.times_plus(constant(&constants.two_over_pi), half).floor();
    let mut r = x;
    for part in &constants.half_pi {
        r = r.less_product(turns, constant(part));
    }
    let square = r * r;
    let polynomial = |coefficients: &[Constant; 6]| {
        let mut value = constant(&coefficients[5]);
        for coefficient in coefficients[..5].iter().rev() {
            value = value.times_plus(square, constant(coefficient));
        }
        value
    };
    let sine = (square * r).times_plus(polynomial(&constants.sine), r);
    let halved = square * half;
    let near_one = one - halved;
    let lost = (one - near_one) - halved;
    let cosine = near_one + (square * square).times_plus(polynomial(&constants.cosine), lost);
    into_quadrant(turns, (sine, cosine), (half, one, constant(&constants.two)))
}

/// Turns the pair by `turns` quarter turns: an odd number swaps it, and the signs follow.
#[inline(always)]
fn into_quadrant<V: Lanes>(turns: V, (sine, cosine): (V, V), (half, one, two): (V, V, V)) -> (V, V) {
    let pairs = (turns * half).floor();
    let odd = turns.less_product(two, pairs);
    let sign = one.less_product(two, pairs.less_product(two, (pairs * half).floor()));
    (V::pick(odd, sine, cosine) * sign, V::pick(odd, cosine, -sine) * sign)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::lanes::{Kernel, with_instructions};
    use fearless_simd::{Level, Simd, f64x2, f64x4};
    use proptest::prelude::*;

    /// By four, by two and one by one, with every set of instructions of this machine.
    struct AllWidths<'a>(&'a [f64; 4]);

    impl Kernel for AllWidths<'_> {
        type Output = [[f64; 8]; 3];

        #[inline(always)]
        fn run<S: Simd>(self, simd: S) -> Self::Output {
            let mut all = [[0.0; 8]; 3];
            let [four, two, one] = &mut all;
            let (sines, cosines) = four.split_at_mut(4);
            sines_and_cosines::<f64x4<S>>(simd, |i| self.0[i], sines, cosines);
            let (sines, cosines) = two.split_at_mut(4);
            sines_and_cosines::<f64x2<S>>(simd, |i| self.0[i], sines, cosines);
            let (sines, cosines) = one.split_at_mut(4);
            sines_and_cosines::<Lane<S>>(simd, |i| self.0[i], sines, cosines);
            all
        }
    }

    fn check(angles: [f64; 4]) {
        for level in [Level::new(), Level::baseline()] {
            let found = with_instructions(level, AllWidths(&angles));
            for row in &found[1..] {
                assert_eq!(format!("{row:?}"), format!("{:?}", found[0]), "{angles:?}");
            }
            for (i, angle) in angles.into_iter().enumerate().filter(|(_, angle)| angle.is_finite()) {
                let (sine, cosine) = angle.sin_cos();
                assert!((found[0][i] - sine).abs() <= 2.5e-16, "sin {angle}");
                assert!((found[0][i + 4] - cosine).abs() <= 2.5e-16, "cos {angle}");
            }
        }
    }

    proptest! {
        #[test]
        fn all_widths_agree_and_are_right(
            angles in proptest::array::uniform4(-10.0..10.0_f64), exponent in -9.0..7.0_f64,
        ) {
            check(angles);
            check(angles.map(|angle| angle * 10_f64.powf(exponent)));
        }

        #[test]
        fn small_results_keep_their_relative_accuracy(turns in -1000..1000_i32) {
            let angle = f64::from(turns) * std::f64::consts::FRAC_PI_2;
            let exact = angle.sin_cos();
            for level in [Level::new(), Level::baseline()] {
                let found = with_instructions(level, AllWidths(&[angle; 4]))[0];
                prop_assert!((found[0] - exact.0).abs() <= 4e-16 * exact.0.abs());
                prop_assert!((found[4] - exact.1).abs() <= 4e-16 * exact.1.abs());
            }
        }
    }

    #[test]
    fn what_is_not_finite_gives_nan_and_harms_no_neighbour() {
        check([f64::NAN, 1.0, f64::INFINITY, 1e300]);
        let found = with_instructions(Level::new(), AllWidths(&[0.0; 4]))[0];
        assert_eq!((found[0], found[4]), (0.0, 1.0));
    }
}
