//! Numbers computed several at a time, one in each lane of a register.
//!
//! Kernels are written once, over [`Lanes`], and run on plain `f64` or on vectors of the widest instructions that the
//! machine has. Every operation here is one IEEE operation in each lane and none is fused with another, so all widths
//! and all instruction sets give the same bits.

use fearless_simd::{Level, Select, Simd, SimdBase, SimdFloat, f64x2, f64x4};
use std::fmt::Debug;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// One or more reals that are computed together.
pub(crate) trait Lanes:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    /// The proof that the machine has the instructions.
    type Token: Copy;
    /// The reals in memory.
    type Array: Copy + Debug + AsRef<[f64]> + AsMut<[f64]> + Send;
    /// How many there are.
    const WIDTH: usize;

    fn splat(token: Self::Token, value: f64) -> Self;

    /// `value` in every lane.
    fn like(self, value: f64) -> Self;

    fn load(token: Self::Token, values: &Self::Array) -> Self;

    fn load_slice(token: Self::Token, values: &[f64]) -> Self;

    /// The reals that `value` gives for each lane. They come straight from where they lie: a vector loaded right after its
    /// lanes were written one by one has to wait for them.
    fn gather(token: Self::Token, value: impl FnMut(usize) -> f64) -> Self;

    fn store(self, values: &mut Self::Array);

    fn store_slice(self, values: &mut [f64]);

    fn floor(self) -> Self;

    fn sqrt(self) -> Self;

    /// The smaller of the two; either when one is NaN.
    fn least(self, other: Self) -> Self;

    /// The larger of the two; either when one is NaN.
    fn greatest(self, other: Self) -> Self;

    fn abs(self) -> Self;

    /// `then` in the lanes where `a` is less than `b`, `other` elsewhere.
    fn where_less(a: Self, b: Self, then: Self, other: Self) -> Self;

    /// Whether every lane is at least that of `other`; not so with a NaN.
    fn all_at_least(self, other: Self) -> bool;

    /// `zero` in the lanes where `flag` is zero, `other` elsewhere.
    fn pick(flag: Self, zero: Self, other: Self) -> Self;

    /// Whether every lane lies strictly between `-bound` and `bound`; not so with a NaN.
    fn all_within(self, bound: f64) -> bool;

    fn to_array(self) -> Self::Array;
}

/// Arrays that fill a vector.
pub(crate) trait LaneArray: Copy + Debug + AsRef<[f64]> + AsMut<[f64]> + Send {
    /// The vector on a machine with the instructions `S`.
    type Vector<S: Simd>: Lanes<Token = S, Array = Self>;
    /// One of something for each lane.
    type Of<T: Copy>: Copy + AsRef<[T]> + AsMut<[T]>;
    /// How many reals it holds.
    const WIDTH: usize;
    /// Zero in every lane.
    const ZERO: Self;

    fn each<T: Copy>(value: impl FnMut(usize) -> T) -> Self::Of<T>;

    /// Reals that lie one after the other, as whole arrays.
    fn arrays(reals: &[f64]) -> &[Self];
}

impl LaneArray for [f64; 2] {
    type Vector<S: Simd> = f64x2<S>;
    type Of<T: Copy> = [T; 2];
    const WIDTH: usize = 2;
    const ZERO: Self = [0.0; 2];

    #[inline(always)]
    fn each<T: Copy>(value: impl FnMut(usize) -> T) -> [T; 2] {
        std::array::from_fn(value)
    }

    #[inline(always)]
    fn arrays(reals: &[f64]) -> &[Self] {
        reals.as_chunks().0
    }
}

impl LaneArray for [f64; 4] {
    type Vector<S: Simd> = f64x4<S>;
    type Of<T: Copy> = [T; 4];
    const WIDTH: usize = 4;
    const ZERO: Self = [0.0; 4];

    #[inline(always)]
    fn each<T: Copy>(value: impl FnMut(usize) -> T) -> [T; 4] {
        std::array::from_fn(value)
    }

    #[inline(always)]
    fn arrays(reals: &[f64]) -> &[Self] {
        reals.as_chunks().0
    }
}

impl Lanes for f64 {
    type Token = ();
    type Array = [f64; 1];
    const WIDTH: usize = 1;

    #[inline(always)]
    fn splat((): (), value: f64) -> Self {
        value
    }

    #[inline(always)]
    fn like(self, value: f64) -> Self {
        value
    }

    #[inline(always)]
    fn load((): (), values: &[f64; 1]) -> Self {
        values[0]
    }

    #[inline(always)]
    fn load_slice((): (), values: &[f64]) -> Self {
        values[0]
    }

    #[inline(always)]
    fn gather((): (), mut value: impl FnMut(usize) -> f64) -> Self {
        value(0)
    }

    #[inline(always)]
    fn store(self, values: &mut [f64; 1]) {
        values[0] = self;
    }

    #[inline(always)]
    fn store_slice(self, values: &mut [f64]) {
        values[0] = self;
    }

    #[inline(always)]
    fn floor(self) -> Self {
        f64::floor(self)
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        f64::sqrt(self)
    }

    #[inline(always)]
    fn least(self, other: Self) -> Self {
        if self < other { self } else { other }
    }

    #[inline(always)]
    fn greatest(self, other: Self) -> Self {
        if self > other { self } else { other }
    }

    #[inline(always)]
    fn abs(self) -> Self {
        f64::abs(self)
    }

    #[inline(always)]
    fn where_less(a: Self, b: Self, then: Self, other: Self) -> Self {
        if a < b { then } else { other }
    }

    #[inline(always)]
    fn all_at_least(self, other: Self) -> bool {
        self >= other
    }

    #[inline(always)]
    fn pick(flag: Self, zero: Self, other: Self) -> Self {
        if flag == 0.0 { zero } else { other }
    }

    #[inline(always)]
    fn to_array(self) -> [f64; 1] {
        [self]
    }

    #[inline(always)]
    fn all_within(self, bound: f64) -> bool {
        self.abs() < bound
    }
}

macro_rules! vector_lanes {
    ($vector:ident, $width:literal) => {
        impl<S: Simd> Lanes for $vector<S> {
            type Token = S;
            type Array = [f64; $width];
            const WIDTH: usize = $width;

            #[inline(always)]
            fn splat(token: S, value: f64) -> Self {
                <Self as SimdBase<S>>::splat(token, value)
            }

            #[inline(always)]
            fn like(self, value: f64) -> Self {
                <Self as SimdBase<S>>::splat(self.simd, value)
            }

            #[inline(always)]
            fn load(token: S, values: &[f64; $width]) -> Self {
                <Self as SimdBase<S>>::load_array_ref(token, values)
            }

            #[inline(always)]
            fn load_slice(token: S, values: &[f64]) -> Self {
                <Self as SimdBase<S>>::from_slice(token, values)
            }

            #[inline(always)]
            fn gather(token: S, value: impl FnMut(usize) -> f64) -> Self {
                <Self as SimdBase<S>>::from_fn(token, value)
            }

            #[inline(always)]
            fn store(self, values: &mut [f64; $width]) {
                <Self as SimdBase<S>>::store_array(self, values);
            }

            #[inline(always)]
            fn store_slice(self, values: &mut [f64]) {
                <Self as SimdBase<S>>::store_slice(&self, values);
            }

            #[inline(always)]
            fn floor(self) -> Self {
                <Self as SimdFloat<S>>::floor(self)
            }

            #[inline(always)]
            fn sqrt(self) -> Self {
                <Self as SimdFloat<S>>::sqrt(self)
            }

            #[inline(always)]
            fn least(self, other: Self) -> Self {
                self.min(other)
            }

            #[inline(always)]
            fn greatest(self, other: Self) -> Self {
                self.max(other)
            }

            #[inline(always)]
            fn abs(self) -> Self {
                <Self as SimdBase<S>>::abs(self)
            }

            #[inline(always)]
            fn where_less(a: Self, b: Self, then: Self, other: Self) -> Self {
                a.simd_lt(b).select(then, other)
            }

            #[inline(always)]
            fn all_at_least(self, other: Self) -> bool {
                use fearless_simd::SimdMask;
                self.simd_ge(other).all_true()
            }

            #[inline(always)]
            fn pick(flag: Self, zero: Self, other: Self) -> Self {
                flag.simd_eq(flag.like(0.0)).select(zero, other)
            }

            #[inline(always)]
            fn to_array(self) -> [f64; $width] {
                <Self as SimdBase<S>>::to_array(self)
            }

            #[inline(always)]
            fn all_within(self, bound: f64) -> bool {
                use fearless_simd::SimdMask;
                Lanes::abs(self).simd_lt(self.like(bound)).all_true()
            }
        }
    };
}

vector_lanes!(f64x2, 2);
vector_lanes!(f64x4, 4);

/// A computation that is compiled for each set of instructions.
pub(crate) trait Kernel {
    type Output;

    /// Every function on the way from here to the vectors must be `#[inline(always)]`.
    fn run<S: Simd>(self, simd: S) -> Self::Output;
}

/// Runs a kernel with the widest instructions that `level` proves.
///
/// Of the sets of x86 two are compiled, AVX2 and the base SSE2: those between and beyond have nothing to offer to four
/// lanes of doubles.
#[inline]
pub(crate) fn with_instructions<K: Kernel>(level: Level, kernel: K) -> K::Output {
    #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
    {
        if let Some(simd) = level.as_avx2() {
            return simd.vectorize(
                #[inline(always)]
                || kernel.run(simd),
            );
        }
        if let Some(simd) = level.as_sse2() {
            return simd.vectorize(
                #[inline(always)]
                || kernel.run(simd),
            );
        }
    }
    fearless_simd::dispatch!(level, simd => kernel.run(simd))
}
