//! Numbers computed several at a time, one in each lane of a register.
//!
//! Kernels are written once, over [`Lanes`], and run on single reals or on vectors of the widest instructions that the
//! machine has. Every operation here is one IEEE operation in each lane, so all widths give the same bits. A product and a
//! sum are fused ([`Lanes::times_plus`]) by every set of instructions that can: by AVX2 and Neon, not by SSE2, which
//! therefore differs in the last places.

use fearless_simd::{Level, Select, Simd, SimdBase, SimdCombine, SimdFloat, f64x2, f64x4};
use std::fmt::Debug;
use std::ops::{Add, Div, Mul, Neg, Sub};
use std::sync::LazyLock;

/// One or more reals that are computed together.
pub(crate) trait Lanes:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Div<Output = Self> + Neg<Output = Self>
{
    /// The proof that the machine has the instructions.
    type Token: Simd;
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

    /// `self factor + term`, rounded once where the instructions can.
    fn times_plus(self, factor: Self, term: Self) -> Self;

    /// `self factor - term`, rounded once where the instructions can.
    fn times_less(self, factor: Self, term: Self) -> Self;

    /// `self - a b`, rounded once where the instructions can.
    #[inline(always)]
    fn less_product(self, a: Self, b: Self) -> Self {
        (-a).times_plus(b, self)
    }

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

    /// The reals of arrays, one after the other.
    fn reals(arrays: &[Self]) -> &[f64];

    /// Writes rows, each of which holds one entry of every lane, as lanes that hold all entries, one lane after the other, each
    /// filled up with zeros to whole arrays.
    fn write_lanes<S: Simd>(simd: S, rows: &[Self], lanes: &mut [Self]);
}

/// Writes four rows of four as columns.
#[inline(always)]
fn write_square<S: Simd>(simd: S, rows: &[[f64; 4]; 4], columns: [&mut [f64; 4]; 4]) {
    let load = |i: usize| <f64x4<S> as Lanes>::load(simd, &rows[i]);
    let (a, b, c, d) = (load(0), load(1), load(2), load(3));
    let (low, other_low) = (a.zip_low(c), b.zip_low(d));
    let (high, other_high) = (a.zip_high(c), b.zip_high(d));
    let [first, second, third, fourth] = columns;
    Lanes::store(low.zip_low(other_low), first);
    Lanes::store(low.zip_high(other_low), second);
    Lanes::store(high.zip_low(other_high), third);
    Lanes::store(high.zip_high(other_high), fourth);
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

    #[inline(always)]
    fn reals(arrays: &[Self]) -> &[f64] {
        arrays.as_flattened()
    }

    #[inline(always)]
    fn write_lanes<S: Simd>(simd: S, rows: &[Self], lanes: &mut [Self]) {
        let (pairs, last) = rows.as_chunks::<2>();
        let (first, second) = lanes.split_at_mut(lanes.len() / 2);
        let mut out = first.iter_mut().zip(second);
        for ([a, b], (first, second)) in pairs.iter().zip(&mut out) {
            let (a, b) = (<f64x2<S> as Lanes>::load(simd, a), <f64x2<S> as Lanes>::load(simd, b));
            Lanes::store(a.zip_low(b), first);
            Lanes::store(a.zip_high(b), second);
        }
        if let (&[[a, b]], Some((first, second))) = (last, out.next()) {
            (*first, *second) = ([a, 0.0], [b, 0.0]);
        }
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

    #[inline(always)]
    fn reals(arrays: &[Self]) -> &[f64] {
        arrays.as_flattened()
    }

    #[inline(always)]
    fn write_lanes<S: Simd>(simd: S, rows: &[Self], lanes: &mut [Self]) {
        let (squares, rest) = rows.as_chunks::<4>();
        let (half, other_half) = lanes.split_at_mut(lanes.len() / 2);
        let (first, second) = half.split_at_mut(half.len() / 2);
        let (third, fourth) = other_half.split_at_mut(other_half.len() / 2);
        let mut out = first.iter_mut().zip(second).zip(third.iter_mut().zip(fourth));
        for (rows, ((first, second), (third, fourth))) in squares.iter().zip(&mut out) {
            write_square(simd, rows, [first, second, third, fourth]);
        }
        if let Some(((first, second), (third, fourth))) = out.next() {
            let row = |i: usize| rest.get(i).copied().unwrap_or(Self::ZERO);
            write_square(simd, &[row(0), row(1), row(2), row(3)], [first, second, third, fourth]);
        }
    }
}

/// A single real, computed as each lane of the instructions `S` is.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lane<S> {
    pub(crate) value: f64,
    simd: S,
}

impl<S: Simd> Lane<S> {
    #[inline(always)]
    fn with(self, value: f64) -> Self {
        Self { value, ..self }
    }

    /// Whether the instructions can fuse a product and a sum: a constant once they are known.
    #[inline(always)]
    fn is_fused(self) -> bool {
        #[cfg(any(target_arch = "x86", target_arch = "x86_64"))]
        return self.simd.level().as_avx2().is_some();
        #[cfg(not(any(target_arch = "x86", target_arch = "x86_64")))]
        return cfg!(target_arch = "aarch64");
    }
}

macro_rules! operators_of_lanes {
    ($($operator:ident $method:ident),*) => {$(
        impl<S: Simd> $operator for Lane<S> {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                self.with(self.value.$method(other.value))
            }
        }
    )*};
}

operators_of_lanes!(Add add, Sub sub, Mul mul, Div div);

impl<S: Simd> Neg for Lane<S> {
    type Output = Self;

    #[inline(always)]
    fn neg(self) -> Self {
        self.with(-self.value)
    }
}

impl<S: Simd> Lanes for Lane<S> {
    type Token = S;
    type Array = [f64; 1];
    const WIDTH: usize = 1;

    #[inline(always)]
    fn splat(simd: S, value: f64) -> Self {
        Self { value, simd }
    }

    #[inline(always)]
    fn like(self, value: f64) -> Self {
        self.with(value)
    }

    #[inline(always)]
    fn load(simd: S, values: &[f64; 1]) -> Self {
        Self { value: values[0], simd }
    }

    #[inline(always)]
    fn load_slice(simd: S, values: &[f64]) -> Self {
        Self { value: values[0], simd }
    }

    #[inline(always)]
    fn gather(simd: S, mut value: impl FnMut(usize) -> f64) -> Self {
        Self { value: value(0), simd }
    }

    #[inline(always)]
    fn store(self, values: &mut [f64; 1]) {
        values[0] = self.value;
    }

    #[inline(always)]
    fn store_slice(self, values: &mut [f64]) {
        values[0] = self.value;
    }

    #[inline(always)]
    fn times_plus(self, factor: Self, term: Self) -> Self {
        self.with(if self.is_fused() {
            self.value.mul_add(factor.value, term.value)
        } else {
            self.value * factor.value + term.value
        })
    }

    #[inline(always)]
    fn times_less(self, factor: Self, term: Self) -> Self {
        self.times_plus(factor, -term)
    }

    #[inline(always)]
    fn floor(self) -> Self {
        self.with(self.value.floor())
    }

    #[inline(always)]
    fn sqrt(self) -> Self {
        self.with(self.value.sqrt())
    }

    #[inline(always)]
    fn least(self, other: Self) -> Self {
        if self.value < other.value { self } else { other }
    }

    #[inline(always)]
    fn greatest(self, other: Self) -> Self {
        if self.value > other.value { self } else { other }
    }

    #[inline(always)]
    fn abs(self) -> Self {
        self.with(self.value.abs())
    }

    #[inline(always)]
    fn where_less(a: Self, b: Self, then: Self, other: Self) -> Self {
        if a.value < b.value { then } else { other }
    }

    #[inline(always)]
    fn all_at_least(self, other: Self) -> bool {
        self.value >= other.value
    }

    #[inline(always)]
    fn pick(flag: Self, zero: Self, other: Self) -> Self {
        if flag.value == 0.0 { zero } else { other }
    }

    #[inline(always)]
    fn to_array(self) -> [f64; 1] {
        [self.value]
    }

    #[inline(always)]
    fn all_within(self, bound: f64) -> bool {
        self.value.abs() < bound
    }
}

/// Two reals from where they lie: an array of them would be written to memory first.
#[inline(always)]
fn gather_two<S: Simd>(simd: S, mut value: impl FnMut(usize) -> f64) -> f64x2<S> {
    let [low, high] = [value(0), value(1)].map(|value| <f64x2<S> as SimdBase<S>>::splat(simd, value));
    low.zip_low(high)
}

/// Four reals from where they lie.
#[inline(always)]
fn gather_four<S: Simd>(simd: S, mut value: impl FnMut(usize) -> f64) -> f64x4<S> {
    let low = gather_two(simd, &mut value);
    low.combine(gather_two(simd, |lane| value(lane + 2)))
}

macro_rules! vector_lanes {
    ($vector:ident, $width:literal, $gather:ident) => {
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
                $gather(token, value)
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
            fn times_plus(self, factor: Self, term: Self) -> Self {
                self.mul_add(factor, term)
            }

            #[inline(always)]
            fn times_less(self, factor: Self, term: Self) -> Self {
                self.mul_sub(factor, term)
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

vector_lanes!(f64x2, 2, gather_two);
vector_lanes!(f64x4, 4, gather_four);

/// The instructions of this machine.
pub(crate) fn level() -> Level {
    static LEVEL: LazyLock<Level> = LazyLock::new(Level::new);
    *LEVEL
}

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
