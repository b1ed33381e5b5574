//! How long a row may be: what keeps exact decisions bounded in time and memory.

use crate::math::MAX_DIGITS;

/// The most steps a row may have.
pub const MAX_STEPS: usize = 64;

/// The most digits that a list of coefficients may need over its common denominator.
pub(crate) const MAX_ROW_DIGITS: usize = 2 * MAX_DIGITS;
