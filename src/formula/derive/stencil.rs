//! Which instants a formula may use.

use std::collections::BTreeSet;
use std::fmt;

use crate::formula::MAX_STEPS;

use super::error::DeriveError;

/// The instants of a formula as offsets from t_n in units of sigma: states at some, derivatives at others, newest first.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Stencil {
    samples: Vec<i64>,
    derivatives: Vec<i64>,
}

/// A coefficient that is to be found.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Unknown {
    /// The weight of x(t_n + offset sigma).
    State(i64),
    /// The weight of x'(t_n + offset sigma).
    Derivative(i64),
}

impl Stencil {
    /// Returns the stencil of these offsets, in whatever order they are given; 1 is the new state, 0 the present one.
    ///
    /// # Errors
    /// [`DeriveError`] for fewer than two samples, no derivative, an offset given twice, a derivative newer than the newest
    /// sample and a span of more than [`MAX_STEPS`] steps.
    ///
    /// ```
    /// use kinstep::formula::derive::Stencil;
    /// let gaps = Stencil::new(&[1, 0, -2], &[0])?;
    /// assert_eq!(gaps.steps(), 3);
    /// assert!(Stencil::new(&[0, -1], &[1]).is_err());
    /// # Ok::<(), kinstep::formula::derive::DeriveError>(())
    /// ```
    pub fn new(samples: &[i64], derivatives: &[i64]) -> Result<Self, DeriveError> {
        let stencil = Self {
            samples: newest_first("samples", samples)?,
            derivatives: newest_first("derivatives", derivatives)?,
        };
        if stencil.samples.len() < 2 {
            return Err(DeriveError::TooFewSamples { found: samples.len() });
        }
        let Some(&offset) = stencil.derivatives.first() else { return Err(DeriveError::NoDerivative) };
        let newest = stencil.newest();
        if offset > newest {
            return Err(DeriveError::DerivativeBeyondNewest { offset, newest });
        }
        let steps = newest.abs_diff(stencil.oldest());
        if steps > MAX_STEPS as u64 {
            return Err(DeriveError::TooManySteps { steps });
        }
        Ok(stencil)
    }

    /// Returns the offsets of the states, newest first.
    pub fn samples(&self) -> &[i64] {
        &self.samples
    }

    /// Returns the offsets of the derivatives, newest first.
    pub fn derivatives(&self) -> &[i64] {
        &self.derivatives
    }

    /// Returns the number of steps that rows of this stencil have.
    pub fn steps(&self) -> usize {
        self.newest().abs_diff(self.oldest()) as usize
    }

    /// Returns whether there is one derivative, so that formulas are differences for it.
    pub fn is_difference(&self) -> bool {
        self.derivatives.len() == 1
    }

    /// Returns the coefficients to be found: those of the states, then those of the derivatives.
    pub fn unknowns(&self) -> Vec<Unknown> {
        let states = self.samples.iter().copied().map(Unknown::State);
        states.chain(self.derivatives.iter().copied().map(Unknown::Derivative)).collect()
    }

    pub(super) fn newest(&self) -> i64 {
        self.samples[0]
    }

    fn oldest(&self) -> i64 {
        let last = |list: &[i64]| list.last().copied().unwrap_or_else(|| self.newest());
        last(&self.samples).min(last(&self.derivatives))
    }
}

fn newest_first(list: &'static str, offsets: &[i64]) -> Result<Vec<i64>, DeriveError> {
    let mut seen = BTreeSet::new();
    match offsets.iter().find(|offset| !seen.insert(**offset)) {
        Some(&offset) => Err(DeriveError::Repeated { list, offset }),
        None => Ok(seen.into_iter().rev().collect()),
    }
}

/// Writes `x_n+1` or `f_n-2`.
impl fmt::Display for Unknown {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (letter, offset) = match self {
            Self::State(offset) => ('x', *offset),
            Self::Derivative(offset) => ('f', *offset),
        };
        match offset {
            0 => write!(f, "{letter}_n"),
            _ => write!(f, "{letter}_n{offset:+}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn refuses_what_no_formula_can_use() {
        let refusal = |samples: &[i64], derivatives: &[i64]| {
            Stencil::new(samples, derivatives).expect_err("a bad stencil").to_string()
        };
        assert!(refusal(&[1], &[0]).contains("at least two samples"));
        assert!(refusal(&[1, 0], &[]).contains("at least one derivative"));
        assert!(refusal(&[1, 0, 1], &[0]).contains("offset 1 is given twice among the samples"));
        assert!(refusal(&[0, -1], &[1]).contains("newer than the newest sample"));
        assert!(refusal(&[1, -64], &[0]).contains("span 65 steps"));
        assert!(refusal(&[i64::MAX, i64::MIN], &[0]).contains("span 18446744073709551615 steps"));
    }

    #[test]
    fn sorts_newest_first_and_names_instants() {
        let stencil = Stencil::new(&[-2, 1, 0], &[-1]).expect("a stencil");
        let names: Vec<String> = stencil.unknowns().iter().map(ToString::to_string).collect();
        assert_eq!(names, ["x_n+1", "x_n", "x_n-2", "f_n-1"]);
    }
}
