//! Lists of numbers of a given length.

use serde::{Deserialize, Deserializer};

use kinstep::kind::Real;

/// Reads exactly `N` numbers; serde's own arrays take the first `N` and drop the rest in silence.
pub(super) fn exactly<'de, D: Deserializer<'de>, const N: usize>(
    deserializer: D,
) -> Result<[Real; N], D::Error> {
    let numbers = Vec::<Real>::deserialize(deserializer)?;
    let got = numbers.len();
    numbers.try_into().map_err(|_| serde::de::Error::custom(format_args!("expected {N} numbers, got {got}")))
}

/// As [`exactly`], for a key that may be left out.
pub(super) fn some_exactly<'de, D: Deserializer<'de>, const N: usize>(
    deserializer: D,
) -> Result<Option<[Real; N]>, D::Error> {
    exactly(deserializer).map(Some)
}
