//! A row as somebody wrote it: coefficients, what it claims of them, and where they are from.

use num_traits::{One, Zero};

use crate::math::{Rational, common_denominator, parse_rational};

use super::error::{DefectKind, Place};
use super::limits::{MAX_ROW_DIGITS, MAX_STEPS};
use super::weights::Weights;

/// The coefficients of a row in one of the two spellings, newest sample first.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Coefficients {
    /// A look-ahead difference formula x'(t_n) ~ (1/sigma) sum_j (numerators_j/denominator) x_(n+1-j).
    Difference {
        /// Weights of x_(n+1), x_n, x_(n-1), ... before the division.
        numerators: Vec<Rational>,
        /// What all numerators are divided by.
        denominator: Rational,
    },
    /// sum_j alpha_j x_(n+1-j) = sigma sum_j beta_j f_(n+1-j) + sigma sum_j gamma_j g_(n+1-j).
    General {
        /// Weights of the states.
        alpha: Vec<Rational>,
        /// Weights of f.
        beta: Vec<Rational>,
        /// Weights of g; those of f when absent.
        gamma: Option<Vec<Rational>>,
    },
}

/// The facts that a row declares about itself, each checked against the coefficients.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Declared {
    /// The order p of (alpha, beta).
    pub order: Option<usize>,
    /// The error constant c = E_(p+1)/((p+1)! beta(1)).
    pub error_constant: Option<Rational>,
    /// Whether the root condition holds.
    pub zero_stable: Option<bool>,
}

/// A readable row: its coefficients have the right lengths and sizes and can be normalised. Nothing else is checked yet.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Row {
    pub(crate) id: String,
    pub(crate) name: Option<String>,
    pub(crate) family: Option<String>,
    pub(crate) coefficients: Coefficients,
    pub(crate) declared: Declared,
    pub(crate) source: Option<String>,
    pub(crate) attribution: Option<String>,
    pub(crate) note: Option<String>,
    pub(crate) places: Places,
}

/// Where the row and its parts stand in their file; 0, 0 throughout for a row that is in no file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Places {
    pub(crate) row: Place,
    pub(crate) coefficients: Place,
    pub(crate) gamma: Place,
    pub(crate) order: Place,
    pub(crate) error_constant: Place,
    pub(crate) zero_stable: Place,
}

impl Row {
    /// Returns a row of these coefficients that declares nothing.
    ///
    /// # Errors
    /// [`DefectKind`] when lengths differ, there are fewer than two or more than [`MAX_STEPS`] + 1 of them, the
    /// coefficient of the new state or the denominator is zero, or the numbers are too long.
    pub fn new(id: &str, coefficients: Coefficients) -> Result<Self, DefectKind> {
        check_shape(&coefficients)?;
        Ok(Self {
            id: id.to_owned(),
            name: None,
            family: None,
            coefficients,
            declared: Declared::default(),
            source: None,
            attribution: None,
            note: None,
            places: Places::default(),
        })
    }

    /// Returns the row of a difference formula typed as text, such as `"24,-5,-12,-6,-4,3"` over `"48"`.
    ///
    /// # Errors
    /// As [`Row::new`], and for numbers that can not be read.
    ///
    /// ```
    /// use kinstep::formula::Row;
    /// let row = Row::from_difference("mine", "24,-5,-12,-6,-4,3", "48")?;
    /// assert_eq!(row.check().analysis().order(), Some(3));
    /// # Ok::<(), kinstep::formula::DefectKind>(())
    /// ```
    pub fn from_difference(id: &str, numerators: &str, denominator: &str) -> Result<Self, DefectKind> {
        let numerators = parse_list("difference", numerators)?;
        let denominator = parse_rational(denominator)
            .map_err(|error| DefectKind::Number { key: "denominator".to_owned(), error })?;
        Self::new(id, Coefficients::Difference { numerators, denominator })
    }

    /// Returns the row of a general or additive method typed as text; gamma is beta when absent.
    ///
    /// # Errors
    /// As [`Row::new`], and for numbers that can not be read.
    pub fn from_weights(id: &str, alpha: &str, beta: &str, gamma: Option<&str>) -> Result<Self, DefectKind> {
        let alpha = parse_list("alpha", alpha)?;
        let beta = parse_list("beta", beta)?;
        let gamma = gamma.map(|text| parse_list("gamma", text)).transpose()?;
        Self::new(id, Coefficients::General { alpha, beta, gamma })
    }

    /// Returns the id, by which the row is found.
    pub fn id(&self) -> &str {
        &self.id
    }

    /// Returns the name for people, if the row gives one.
    pub fn name(&self) -> Option<&str> {
        self.name.as_deref()
    }

    /// Returns the family, such as `look-ahead` or `adams-bashforth`, if the row gives one.
    pub fn family(&self) -> Option<&str> {
        self.family.as_deref()
    }

    /// Returns where the coefficients are from, a key of the bibliography and a place, if the row says so.
    pub fn source(&self) -> Option<&str> {
        self.source.as_deref()
    }

    /// Returns how the source was consulted, such as `read` or `recalled`, if the row says so.
    pub fn attribution(&self) -> Option<&str> {
        self.attribution.as_deref()
    }

    /// Returns the remark, if the row has one.
    pub fn note(&self) -> Option<&str> {
        self.note.as_deref()
    }

    /// Returns the coefficients as they were written.
    pub fn coefficients(&self) -> &Coefficients {
        &self.coefficients
    }

    /// Returns what the row claims.
    pub fn declared(&self) -> &Declared {
        &self.declared
    }

    /// Returns line and column of the row in its file, counted from 1; 0 and 0 for a row from elsewhere.
    pub fn place(&self) -> Place {
        self.places.row
    }

    /// The normalised weights; the shape has been checked.
    pub(crate) fn weights(&self) -> Weights {
        match &self.coefficients {
            Coefficients::Difference { numerators, denominator } => {
                let lead = &numerators[0];
                let mut beta = vec![Rational::zero(); numerators.len()];
                beta[1] = denominator / lead;
                let alpha = numerators.iter().map(|a| a / lead).collect();
                Weights { alpha, gamma: beta.clone(), beta }
            }
            Coefficients::General { alpha, beta, gamma } => {
                let over_lead = |row: &[Rational]| row.iter().map(|c| c / &alpha[0]).collect::<Vec<_>>();
                let gamma = over_lead(gamma.as_ref().unwrap_or(beta));
                Weights { alpha: over_lead(alpha), beta: over_lead(beta), gamma }
            }
        }
    }
}

/// Reads numbers between commas.
fn parse_list(key: &str, text: &str) -> Result<Vec<Rational>, DefectKind> {
    text.split(',')
        .enumerate()
        .map(|(j, number)| {
            parse_rational(number).map_err(|error| DefectKind::Number { key: format!("{key}[{j}]"), error })
        })
        .collect()
}

fn check_shape(coefficients: &Coefficients) -> Result<(), DefectKind> {
    let one = [Rational::one()];
    let (lists, lead_key): (Vec<(&str, &[Rational])>, &str) = match coefficients {
        Coefficients::Difference { numerators, denominator } => {
            if denominator.is_zero() {
                return Err(DefectKind::ZeroDenominator);
            }
            (vec![("difference", numerators)], "difference")
        }
        Coefficients::General { alpha, beta, gamma } => {
            let gamma = gamma.iter().map(|gamma| ("gamma", gamma.as_slice()));
            (
                [("alpha", alpha.as_slice()), ("beta", beta.as_slice())].into_iter().chain(gamma).collect(),
                "alpha",
            )
        }
    };
    let (first_key, first) = lists[0];
    for (key, list) in &lists[1..] {
        if list.len() != first.len() {
            let lengths = (first.len(), list.len());
            return Err(DefectKind::UnequalLengths {
                key: (*key).to_owned(),
                expected: lengths.0,
                found: lengths.1,
            });
        }
    }
    match first.len() {
        0 | 1 => {
            return Err(DefectKind::TooFewCoefficients { key: first_key.to_owned(), found: first.len() });
        }
        n if n > MAX_STEPS + 1 => return Err(DefectKind::TooManySteps { steps: n - 1 }),
        _ => {}
    }
    if first[0].is_zero() {
        return Err(DefectKind::ZeroLeadingCoefficient { key: lead_key.to_owned() });
    }
    for (key, list) in &lists {
        let digits = digits_over_common_denominator(list.iter().chain(&one));
        if digits > MAX_ROW_DIGITS {
            return Err(DefectKind::TooLong { key: (*key).to_owned(), digits });
        }
    }
    Ok(())
}

/// About how many decimal digits the longest number has once all are written over one denominator.
fn digits_over_common_denominator<'a>(list: impl Iterator<Item = &'a Rational> + Clone) -> usize {
    let denominator = common_denominator(list.clone());
    let bits = list.map(|c| (c.numer() * (&denominator / c.denom())).bits()).max().unwrap_or(0);
    (bits as f64 * std::f64::consts::LOG10_2).ceil() as usize
}
