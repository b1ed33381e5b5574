//! The rows that a scenario may choose from: the built-in ones and those of files.

use std::path::{Path, PathBuf};

use super::document::read_text;
use super::error::{ErrorKind, Place, ScenarioError};
use super::files;
use super::key_path::KeyPath;
use super::model::Scenario;
use kinstep::formula::{Defect, DefectKind, FormulaTable, TableError};

/// The built-in rows with those of files after them. A row of a file that contradicts itself is set aside: it stands in
/// nobody's way until it is asked for.
#[derive(Clone, Debug)]
pub struct FormulaRows {
    table: FormulaTable,
    set_aside: Vec<SetAside>,
    files: Vec<PathBuf>,
}

/// A row that is not what it declares.
#[derive(Clone, Debug)]
struct SetAside {
    id: String,
    file: PathBuf,
    /// The sentence, with the declared value and the computed one.
    refusal: ScenarioError,
}

impl Default for FormulaRows {
    fn default() -> Self {
        Self { table: FormulaTable::builtin().clone(), set_aside: Vec::new(), files: Vec::new() }
    }
}

impl FormulaRows {
    /// Adds the rows of a file; a file that has been added already adds nothing.
    ///
    /// # Errors
    /// [`ScenarioError`] of kind [`ErrorKind::File`] where the file can not be read, of kind [`ErrorKind::Formula`], with
    /// its place, where a row is unreadable or has an id that is taken.
    pub fn add_file(&mut self, file: &Path) -> Result<(), ScenarioError> {
        if self.files.iter().any(|known| files::is_same_file(known, file)) {
            return Ok(());
        }
        let text = read_text(file)?;
        self.add(file, &text).map_err(|e| refused_rows(&e, file, &text))?;
        self.files.push(file.to_owned());
        Ok(())
    }

    /// Adds the rows of a scenario's own formula files, which are looked for from `folder` and then from the working directory.
    ///
    /// # Errors
    /// As [`add_file`](Self::add_file).
    pub fn add_rows_of(&mut self, scenario: &Scenario, folder: Option<&Path>) -> Result<(), ScenarioError> {
        for (index, named) in scenario.formulas.iter().enumerate() {
            if named.trim_start().starts_with("[[formula]]") {
                let place = Path::new("rows in the scenario");
                self.add(place, named).map_err(|e| refused_rows(&e, place, named))?;
                continue;
            }
            let file = files::find(named, folder).ok_or_else(|| files::missing(named, folder));
            file.and_then(|file| self.add_file(&file)).map_err(|e| match e.kind {
                ErrorKind::File => {
                    ScenarioError::at(e.kind, &KeyPath::dotted("formulas").index(index), e.message)
                }
                _ => e,
            })?;
        }
        Ok(())
    }

    fn add(&mut self, file: &Path, text: &str) -> Result<(), TableError> {
        let (more, contradictions) = FormulaTable::believable_rows(text)?;
        let of_good_rows = more.iter().map(|formula| (formula.id(), formula.row().place()));
        let of_others =
            contradictions.iter().filter_map(|defect| Some((defect.row.as_deref()?, defect.place)));
        let taken = of_good_rows.chain(of_others).filter_map(|(id, place)| {
            let kind = DefectKind::CollidingId { id: id.to_owned(), name: self.name_of(id)? };
            Some(Defect { place, row: None, kind })
        });
        TableError::unless_none(taken.collect())?;
        self.table = self.table.extended_with(more)?;
        for rows in contradictions.chunk_by(|one, next| one.row == next.row) {
            self.set_aside.extend(set_aside(rows, file, text));
        }
        Ok(())
    }

    /// The name of the row that has an id already.
    fn name_of(&self, id: &str) -> Option<String> {
        let believed =
            self.table.iter().find(|formula| formula.id() == id).map(|formula| formula.name().to_owned());
        believed.or_else(|| self.set_aside.iter().find(|row| row.id == id).map(|row| row.id.clone()))
    }

    /// Returns the table for a plan with the row `id`.
    ///
    /// # Errors
    /// [`ScenarioError`] of kind [`ErrorKind::Formula`] where that row contradicts itself: with the declared value, the
    /// computed one and the place. An id that no row has is refused by [`Scenario::planner`].
    pub fn table_for(&self, id: &str) -> Result<&FormulaTable, ScenarioError> {
        match self.set_aside.iter().find(|row| row.id == id) {
            Some(row) => Err(row.refusal.clone()),
            None => Ok(&self.table),
        }
    }

    /// Returns a sentence for every row that was set aside.
    pub fn warnings(&self) -> impl Iterator<Item = String> {
        self.set_aside.iter().map(|row| format!("{}: set aside: {}", row.file.display(), row.refusal))
    }
}

impl Scenario {
    /// Returns the built-in rows with those of the scenario's own formula files, which are looked for from `folder` and then
    /// from the working directory.
    ///
    /// # Errors
    /// As [`FormulaRows::add_file`].
    pub fn formula_rows(&self, folder: Option<&Path>) -> Result<FormulaRows, ScenarioError> {
        let mut rows = FormulaRows::default();
        rows.add_rows_of(self, folder)?;
        Ok(rows)
    }
}

/// The contradictions of one row.
fn set_aside(contradictions: &[Defect], file: &Path, text: &str) -> Option<SetAside> {
    let id = contradictions.first()?.row.clone()?;
    let refusals = contradictions.iter().map(|defect| row_refusal(defect, file, text)).collect();
    Some(SetAside { id, file: file.to_owned(), refusal: first_of(refusals)? })
}

/// Returns the refusal of a file of rows: its first defect, and how many there are.
fn refused_rows(error: &TableError, file: &Path, text: &str) -> ScenarioError {
    first_of(row_refusals(error, file, text))
        .unwrap_or_else(|| ScenarioError::new(ErrorKind::Formula, format!("{}: {error}", file.display())))
}

fn first_of(mut refusals: Vec<ScenarioError>) -> Option<ScenarioError> {
    let count = refusals.len();
    refusals.truncate(1);
    let mut first = refusals.pop()?;
    if count > 1 {
        first.message = format!("{} ({count} problems; `kinstep formula check` lists them)", first.message);
    }
    Some(first)
}

/// Returns the refusals of everything that is wrong with a file of rows of formulas and this text, in the order of the file.
pub fn row_refusals(error: &TableError, file: &Path, text: &str) -> Vec<ScenarioError> {
    error.defects().iter().map(|defect| row_refusal(defect, file, text)).collect()
}

fn row_refusal(defect: &Defect, file: &Path, text: &str) -> ScenarioError {
    let row = defect.row.as_ref().map_or_else(String::new, |id| format!("formula \"{id}\": "));
    let (line, column) = (defect.place.line.max(1), defect.place.column.max(1));
    let place = Place::of_line(Some(file.display().to_string()), text, line, column);
    ScenarioError::new(ErrorKind::Formula, format!("{row}{}", defect.kind)).or_placed(Some(place))
}
