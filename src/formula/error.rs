//! What can be wrong with a row, in sentences that name the place, the cause and the remedy.

use std::fmt;

use crate::math::{ParseRationalError, Rational, RootCondition};

use super::limits::{MAX_ROW_DIGITS, MAX_STEPS};

/// A position in a file, both counted from 1; 0 and 0 where there is no file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Default)]
pub struct Place {
    /// The line, counted from 1; 0 where there is no file.
    pub line: usize,
    /// The column in characters, counted from 1; 0 where there is no file.
    pub column: usize,
}

impl Place {
    /// Returns the place of a byte of a text.
    pub(crate) fn of(text: &str, byte: usize) -> Self {
        let before = &text[..text.floor_char_boundary(byte)];
        let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
        Self { line: before.matches('\n').count() + 1, column: before[line_start..].chars().count() + 1 }
    }
}

/// Why a row can not be read, or, as [`DefectKind::Contradicted`], what contradicts a row that can be read.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum DefectKind {
    /// The text is not TOML.
    #[error("this is not TOML: {message}")]
    Syntax {
        /// What the TOML reader says.
        message: String,
    },
    /// The file holds no rows.
    #[error("there is no formula in this file; a row begins with a line [[formula]]")]
    NoRows,
    /// A key that no row has.
    #[error("unknown key \"{key}\"{}; the keys of {place} are: {known}", did_you_mean(nearest.as_deref()))]
    UnknownKey {
        /// The key as written.
        key: String,
        /// The known key closest to it, if one is close.
        nearest: Option<String>,
        /// The kind of table that the key stands in.
        place: &'static str,
        /// All known keys.
        known: String,
    },
    /// A key that every row must have.
    #[error("\"{key}\" is missing; {remedy}")]
    MissingKey {
        /// The key that is missing.
        key: &'static str,
        /// What to write to mend it.
        remedy: &'static str,
    },
    /// A value of the wrong type.
    #[error("\"{key}\" must be {expected}, but this is {found}")]
    WrongType {
        /// The key, with the index of the entry where it is a list.
        key: String,
        /// What is accepted.
        expected: &'static str,
        /// What was written.
        found: String,
    },
    /// A number that TOML has already rounded.
    #[error(
        "\"{key}\": write \"{text}\" in quotes; a bare {text} in TOML has already been rounded to a binary number"
    )]
    BareFloat {
        /// The key, with the index of the entry where it is a list.
        key: String,
        /// The number as written.
        text: String,
    },
    /// A number that can not be read exactly.
    #[error("\"{key}\": {error}")]
    Number {
        /// The key, with the index of the entry where it is a list.
        key: String,
        /// What is wrong with the number.
        error: ParseRationalError,
    },
    /// Both spellings of the coefficients, or parts of both.
    #[error(
        "\"{first}\" and \"{second}\" are two spellings of the coefficients; write either \"difference\" with \
         \"denominator\", or \"alpha\" with \"beta\" and, if feedback has its own weights, \"gamma\""
    )]
    TwoSpellings {
        /// A key of one spelling.
        first: &'static str,
        /// A key of the other spelling.
        second: &'static str,
    },
    /// Lists of different lengths.
    #[error(
        "\"{key}\" has the length {found}, but \"alpha\" has the length {expected}; every list runs from the new sample to \
         the oldest, so fill up with \"0\""
    )]
    UnequalLengths {
        /// The list that differs.
        key: String,
        /// The length of alpha.
        expected: usize,
        /// The length of this list.
        found: usize,
    },
    /// Not even one step.
    #[error(
        "\"{key}\" has the length {found}; the shortest formula has two coefficients, for the new state and the one before"
    )]
    TooFewCoefficients {
        /// The key of the list.
        key: String,
        /// The length of the list.
        found: usize,
    },
    /// More than [`MAX_STEPS`] steps.
    #[error("a formula of {steps} steps is too long; up to {MAX_STEPS} steps are handled")]
    TooManySteps {
        /// The steps of the row.
        steps: usize,
    },
    /// Numbers that need too many digits together.
    #[error(
        "\"{key}\" needs about {digits} digits when its coefficients are written over one denominator; up to {MAX_ROW_DIGITS} \
         are handled"
    )]
    TooLong {
        /// The key of the list.
        key: String,
        /// About how many digits the numbers have together.
        digits: usize,
    },
    /// The new state is not in the formula.
    #[error(
        "the first coefficient of \"{key}\", that of the new state x_(n+1), is 0, so the row can not be solved for it; \
         coefficients are written newest sample first"
    )]
    ZeroLeadingCoefficient {
        /// The key of the list.
        key: String,
    },
    /// `denominator = 0`.
    #[error("\"denominator\" is 0; it is what all entries of \"difference\" are divided by")]
    ZeroDenominator,
    /// An order below 1, or no count.
    #[error("\"order\" must be a whole number of at least 1, but this is {text}")]
    ImpossibleOrder {
        /// The order as written.
        text: String,
    },
    /// An id that can not be typed on a command line.
    #[error("the id \"{id}\" is not usable; an id has one or more letters, digits and any of - _ . +")]
    UnusableId {
        /// The id as written.
        id: String,
    },
    /// Two rows of one id.
    #[error("the id \"{id}\" is taken by the row at line {first_line}; every row needs an id of its own")]
    DuplicateId {
        /// The id that two rows have.
        id: String,
        /// The line on which the id was first used.
        first_line: usize,
    },
    /// A row with the id of a row in another table.
    #[error(
        "the id \"{id}\" is taken by the row \"{name}\" of the table that this one extends; give the new row another id"
    )]
    CollidingId {
        /// The id that both rows have.
        id: String,
        /// The name of the row that has the id already.
        name: String,
    },
    /// The row can be read, but its numbers say otherwise.
    #[error("{0}")]
    Contradicted(Box<Contradiction>),
}

impl DefectKind {
    /// Returns whether the row can not even be read, as against read and found wrong.
    pub fn is_unreadable(&self) -> bool {
        !matches!(self, Self::Contradicted(_))
    }
}

/// Where the numbers of a readable row contradict what it claims or what every formula must satisfy.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Contradiction {
    /// rho(1) differs from zero.
    #[error(
        "the row is inconsistent: its coefficients of the states, divided by the first, sum to {residual} where they \
         must sum to 0, so it does not even hold a constant"
    )]
    WeightsDoNotSumToZero {
        /// The order defect E_0 = rho(1), for a leading coefficient of 1.
        residual: Rational,
    },
    /// The first moment of alpha differs from beta(1).
    #[error(
        "the row is inconsistent: the first moment of its states is {moment} where the weights of f sum to {weight} (for a \
         first coefficient of 1), so it follows a straight line at the wrong speed; the two must agree"
    )]
    FirstMomentDiffers {
        /// sum_j alpha_j (1 - j), for a leading coefficient of 1.
        moment: Rational,
        /// beta(1), for a leading coefficient of 1.
        weight: Rational,
    },
    /// beta(1) = 0: the formula integrates nothing.
    #[error(
        "the row is inconsistent: its weights of f sum to 0, so nothing is integrated (z = 1 is a repeated root)"
    )]
    NothingIntegrated,
    /// gamma(1) = 0: feedback has no effect.
    #[error(
        "the weights of the feedback, gamma, sum to 0, so no gain gives a feedback step h; they must not cancel"
    )]
    NoFeedback,
    /// The order is another than the row declares.
    #[error("the row declares order {declared}, but its coefficients give order {computed}")]
    Order {
        /// The order that the row declares.
        declared: usize,
        /// The order of the coefficients.
        computed: usize,
    },
    /// The declared order is beyond what any zero-stable formula reaches.
    #[error(
        "the row declares order {declared} and zero-stability with {steps} steps, but no zero-stable {kind} formula \
         of {steps} steps has an order above {barrier} (Dahlquist's first barrier)"
    )]
    BeyondDahlquistBarrier {
        /// The order that the row declares.
        declared: usize,
        /// The steps of the row.
        steps: usize,
        /// `explicit` or `implicit`.
        kind: &'static str,
        /// The highest order of a zero-stable formula of these steps and this kind.
        barrier: usize,
    },
    /// The error constant is another than the row declares.
    #[error("the row declares the error constant {declared}, but its coefficients give {computed}")]
    ErrorConstant {
        /// The error constant that the row declares.
        declared: Rational,
        /// The error constant of the coefficients.
        computed: Rational,
    },
    /// The row declares another zero-stability than the root condition gives.
    #[error(
        "the row declares zero_stable = {declared}, but {}; the largest roots have the moduli {}",
        verdict(*computed),
        moduli_text(moduli)
    )]
    ZeroStability {
        /// Whether the row declares that it is zero-stable.
        declared: bool,
        /// The verdict of the root condition, decided exactly.
        computed: RootCondition,
        /// The largest moduli of the roots, as their decimal digits.
        moduli: Vec<String>,
    },
}

fn verdict(condition: RootCondition) -> &'static str {
    match condition {
        RootCondition::StrictlyStable => "every root but the simple one at 1 lies inside the unit circle",
        RootCondition::WeaklyStable => "no root lies outside the unit circle and those on it are simple",
        RootCondition::Unstable => "a root lies outside the unit circle, or a repeated one on it",
    }
}

fn moduli_text(moduli: &[String]) -> String {
    moduli.join(", ")
}

pub(crate) fn did_you_mean(nearest: Option<&str>) -> String {
    nearest.map(|name| format!(" (did you mean \"{name}\"?)")).unwrap_or_default()
}

/// Returns the known name closest to a misspelt one, if one is close enough to be meant.
pub(crate) fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    known
        .into_iter()
        .map(|candidate| (strsim::jaro_winkler(&name.to_lowercase(), candidate), candidate))
        .filter(|(likeness, _)| *likeness >= 0.75)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, candidate)| candidate)
}

/// One thing that is wrong, and where.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Defect {
    /// Line and column in the text that was read.
    pub place: Place,
    /// The id of the row, where it is known.
    pub row: Option<String>,
    /// What is wrong.
    pub kind: DefectKind,
}

impl fmt::Display for Defect {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.place.line > 0 {
            write!(f, "line {}, column {}: ", self.place.line, self.place.column)?;
        }
        if let Some(id) = &self.row {
            write!(f, "formula \"{id}\": ")?;
        }
        write!(f, "{}", self.kind)
    }
}

/// Everything that is wrong with a text of rows; at least one defect, in the order of the text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct TableError {
    defects: Vec<Defect>,
}

impl TableError {
    /// Collects the defects of a text of rows into an error, in the order of their places.
    ///
    /// # Errors
    /// The error that holds them, if there are any.
    pub fn unless_none(mut defects: Vec<Defect>) -> Result<(), Self> {
        defects.sort_by_key(|defect| defect.place);
        if defects.is_empty() { Ok(()) } else { Err(Self { defects }) }
    }

    /// Returns the defects, at least one, in the order of the text.
    pub fn defects(&self) -> &[Defect] {
        &self.defects
    }

    /// Returns whether some row can not even be read, as against read and found wrong.
    pub fn is_unreadable(&self) -> bool {
        self.defects.iter().any(|defect| defect.kind.is_unreadable())
    }
}

impl fmt::Display for TableError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (k, defect) in self.defects.iter().enumerate() {
            write!(f, "{}{defect}", if k > 0 { "\n" } else { "" })?;
        }
        Ok(())
    }
}

impl std::error::Error for TableError {}

/// A name that no row of the table has.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("there is no formula \"{id}\"{}", suggestions(nearest))]
pub struct UnknownFormula {
    /// The name that was asked for.
    pub id: String,
    /// The closest known names, closest first.
    pub nearest: Vec<String>,
}

fn suggestions(nearest: &[String]) -> String {
    match nearest {
        [] => "; the list of all formulas shows the known names".to_owned(),
        names => format!("; the nearest known names are {}", names.join(", ")),
    }
}

/// Why a formula that is what its row declares can still not be run.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum NotRunnable {
    /// The formula is not zero-stable.
    #[error(
        "the formula \"{id}\" is not zero-stable (the largest root has the modulus {modulus:.6}): errors grow with every \
         step, whatever the step size; it is in the table as a specimen"
    )]
    Unstable {
        /// The id of the formula.
        id: String,
        /// The largest modulus of a root.
        modulus: f64,
    },
    /// The formula is implicit: it needs f at the new state.
    #[error(
        "the formula \"{id}\" is implicit: it needs the velocity at the new state, which is not solved for yet; choose an explicit one"
    )]
    Implicit {
        /// The id of the formula.
        id: String,
    },
    /// The formula has a parasitic root on the unit circle, which feedback pushes outside.
    #[error(
        "the formula \"{id}\" is only weakly stable (a second root on the unit circle) and has no feedback step h for which \
         the closed loop is stable; choose a strictly zero-stable one"
    )]
    WeaklyStable {
        /// The id of the formula.
        id: String,
    },
}
