//! The functions that expressions may call, in numbers of any kind.

use std::ops::RangeInclusive;

use super::scalar::Elementary;

/// A function that an expression may call.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Function {
    Sin,
    Cos,
    Tan,
    Asin,
    Acos,
    Atan,
    Atan2,
    Sinh,
    Cosh,
    Tanh,
    Exp,
    Ln,
    Sqrt,
    Abs,
    Sign,
    Min,
    Max,
}

/// The most arguments of `min` and `max`.
const MOST_ARGUMENTS: usize = 64;

impl Function {
    /// Every function with its name.
    pub(crate) const NAMES: [(&'static str, Self); 17] = [
        ("sin", Self::Sin),
        ("cos", Self::Cos),
        ("tan", Self::Tan),
        ("asin", Self::Asin),
        ("acos", Self::Acos),
        ("atan", Self::Atan),
        ("atan2", Self::Atan2),
        ("sinh", Self::Sinh),
        ("cosh", Self::Cosh),
        ("tanh", Self::Tanh),
        ("exp", Self::Exp),
        ("ln", Self::Ln),
        ("sqrt", Self::Sqrt),
        ("abs", Self::Abs),
        ("sign", Self::Sign),
        ("min", Self::Min),
        ("max", Self::Max),
    ];

    /// The function of a name.
    pub(crate) fn named(name: &str) -> Option<Self> {
        Self::NAMES.iter().find(|(known, _)| *known == name).map(|(_, function)| *function)
    }

    /// How many arguments it takes.
    pub(crate) fn arguments(self) -> RangeInclusive<usize> {
        match self {
            Self::Atan2 => 2..=2,
            Self::Min | Self::Max => 2..=MOST_ARGUMENTS,
            _ => 1..=1,
        }
    }

    /// How many arguments it takes, in words.
    pub(crate) fn arguments_in_words(self) -> &'static str {
        match self {
            Self::Atan2 => "two arguments, atan2(y, x)",
            Self::Min | Self::Max => "two arguments or more, separated by commas",
            _ => "one argument",
        }
    }

    /// The value for as many arguments as [`Self::arguments`] allows.
    pub(crate) fn value<T: Elementary>(self, arguments: &[T]) -> T {
        let x = arguments[0];
        match self {
            Self::Sin => x.sin_cos().0,
            Self::Cos => x.sin_cos().1,
            Self::Tan => {
                let (sine, cosine) = x.sin_cos();
                sine / cosine
            }
            Self::Asin => x.asin(),
            Self::Acos => x.acos(),
            Self::Atan => x.atan2(T::one()),
            Self::Atan2 => x.atan2(arguments[1]),
            Self::Sinh => x.sinh(),
            Self::Cosh => x.cosh(),
            Self::Tanh => x.tanh(),
            Self::Exp => x.exp(),
            Self::Ln => x.ln(),
            Self::Sqrt => x.sqrt(),
            Self::Abs => magnitude(x),
            Self::Sign => sign(x),
            Self::Min => arguments[1..].iter().fold(x, |least, &other| smaller(least, other)),
            Self::Max => -arguments[1..].iter().fold(-x, |least, &other| smaller(least, -other)),
        }
    }
}

fn magnitude<T: Elementary>(x: T) -> T {
    if x < T::zero() { -x } else { x }
}

/// -1, 0 or 1; NaN stays what it is.
fn sign<T: Elementary>(x: T) -> T {
    if x > T::zero() {
        T::one()
    } else if x < T::zero() {
        -T::one()
    } else {
        x
    }
}

/// The smaller of two numbers; NaN where one of them is.
fn smaller<T: Elementary>(a: T, b: T) -> T {
    if a < b {
        a
    } else if b <= a {
        b
    } else {
        a + b
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::DoubleDouble;

    #[test]
    fn what_is_not_a_number_stays_so() {
        for (_, function) in Function::NAMES {
            let two = [f64::NAN, f64::NAN];
            assert!(function.value(&two[..*function.arguments().start()]).is_nan(), "{function:?}");
        }
        assert!(
            Function::Min.value(&[1.0, f64::NAN]).is_nan() && Function::Max.value(&[f64::NAN, 1.0]).is_nan()
        );
    }

    #[test]
    fn doubles_and_extended_numbers_agree() {
        for (name, function) in Function::NAMES {
            for x in [-0.75, -0.1, 0.0, 0.3, 0.9] {
                let count = *function.arguments().start();
                let doubles = function.value(&[x, 0.4][..count]);
                let extended = function.value(&[x, 0.4].map(DoubleDouble::from)[..count]).to_f64();
                let same = (doubles - extended).abs() <= 4.0 * f64::EPSILON * doubles.abs();
                assert!(
                    same || (doubles.is_nan() && extended.is_nan()) || doubles == extended,
                    "{name}({x})"
                );
            }
        }
    }
}
