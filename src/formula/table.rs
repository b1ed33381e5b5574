//! The table of formulas: the built-in rows and anybody's own, through one door.

use std::sync::LazyLock;

use num_traits::Signed;

use super::error::{Defect, DefectKind, TableError, UnknownFormula};
use super::formula::Formula;
use super::read::{Strictness, read_rows};
use super::row::Row;

/// The built-in rows; adding a formula is adding a row to this file.
const BUILTIN: &str = include_str!("table.toml");

/// Formulas by id, in the order of their files.
#[derive(Debug, Clone, Default)]
pub struct FormulaTable {
    formulas: Vec<Formula>,
}

impl FormulaTable {
    /// Returns the built-in table, every row of it checked.
    ///
    /// # Panics
    /// Never in a build whose tests have passed: they read this table.
    pub fn builtin() -> &'static Self {
        static TABLE: LazyLock<FormulaTable> = LazyLock::new(|| {
            FormulaTable::from_toml(BUILTIN)
                .unwrap_or_else(|error| panic!("the built-in table is at fault: {error}"))
        });
        &TABLE
    }

    /// Returns the table of the rows of a TOML text.
    ///
    /// # Errors
    /// [`TableError`] with every unreadable row or, when all can be read, with every contradiction between what a row
    /// declares and what its numbers say.
    pub fn from_toml(text: &str) -> Result<Self, TableError> {
        let (table, contradictions) = Self::believable_rows(text)?;
        TableError::unless_none(contradictions).map(|()| table)
    }

    /// Returns the table of those rows of a TOML text that are what they declare, and the contradictions of the others, which
    /// are left out of the table.
    ///
    /// # Errors
    /// [`TableError`] with every unreadable row: a text that can not be read as a whole gives no table.
    pub fn believable_rows(text: &str) -> Result<(Self, Vec<Defect>), TableError> {
        let mut formulas = Vec::new();
        let mut contradicted = Vec::new();
        for checked in read_rows(text, Strictness::Finished)?.into_iter().map(Row::check) {
            match checked.into_formula() {
                Ok(formula) => formulas.push(formula),
                Err(contradictions) => contradicted.extend(contradictions),
            }
        }
        Ok((Self { formulas }, contradicted))
    }

    /// Returns the formula of an id.
    ///
    /// # Errors
    /// [`UnknownFormula`] with the nearest known ids.
    pub fn get(&self, id: &str) -> Result<&Formula, UnknownFormula> {
        self.iter()
            .find(|formula| formula.id() == id)
            .ok_or_else(|| UnknownFormula { id: crate::math::shortened(id), nearest: self.nearest_ids(id) })
    }

    fn nearest_ids(&self, id: &str) -> Vec<String> {
        const OFFERED: usize = 3;
        let asked = crate::math::shortened(id).to_lowercase();
        let mut likeness: Vec<(f64, &str)> =
            self.iter().map(|formula| (strsim::jaro_winkler(&asked, formula.id()), formula.id())).collect();
        likeness.sort_by(|a, b| b.0.total_cmp(&a.0));
        likeness
            .iter()
            .take_while(|(near, _)| *near >= 0.7)
            .take(OFFERED)
            .map(|(_, id)| (*id).to_owned())
            .collect()
    }

    /// Returns the formulas in the order of their files.
    pub fn iter(&self) -> std::slice::Iter<'_, Formula> {
        self.formulas.iter()
    }

    /// Returns the number of formulas.
    pub fn len(&self) -> usize {
        self.formulas.len()
    }

    /// Returns whether there is no formula.
    pub fn is_empty(&self) -> bool {
        self.formulas.is_empty()
    }

    /// Returns this table with the rows of another after its own.
    ///
    /// # Errors
    /// [`TableError`] for every id of the other table that this one has already.
    pub fn extended_with(&self, other: Self) -> Result<Self, TableError> {
        let collision = |formula: &Formula| {
            let known = self.get(formula.id()).ok()?;
            let kind = DefectKind::CollidingId { id: formula.id().to_owned(), name: known.name().to_owned() };
            Some(Defect { place: formula.row().place(), row: None, kind })
        };
        TableError::unless_none(other.iter().filter_map(collision).collect())?;
        let formulas = self.formulas.iter().cloned().chain(other.formulas).collect();
        Ok(Self { formulas })
    }

    /// Returns the formulas of these families, in the order of this table; all of them for no family.
    #[must_use]
    pub fn of_families<S: AsRef<str>>(&self, families: &[S]) -> Self {
        let is_wanted = |formula: &&Formula| {
            families.is_empty() || families.iter().any(|name| name.as_ref() == formula.family())
        };
        Self { formulas: self.iter().filter(is_wanted).cloned().collect() }
    }

    /// Returns the formula that carries a start on when only `known_states` states are known: of the same family as `formula`,
    /// explicit, strictly zero-stable, with no more steps than that and no more than it has itself.
    ///
    /// The highest order wins, then the smallest error constant, then the first in the table.
    pub fn ramp(&self, formula: &Formula, known_states: usize) -> Option<&Formula> {
        self.iter()
            .filter(|row| row.family() == formula.family())
            .filter(|row| row.steps() <= known_states.min(formula.steps()))
            .filter(|row| row.is_explicit() && row.is_strictly_zero_stable())
            .reduce(|best, row| {
                let better = row.order() > best.order()
                    || (row.order() == best.order()
                        && row.error_constant().abs() < best.error_constant().abs());
                if better { row } else { best }
            })
    }
}

impl<'a> IntoIterator for &'a FormulaTable {
    type Item = &'a Formula;
    type IntoIter = std::slice::Iter<'a, Formula>;
    fn into_iter(self) -> Self::IntoIter {
        self.iter()
    }
}
