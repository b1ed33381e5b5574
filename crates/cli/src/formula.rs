//! `kinstep formula`: what rows can do, decided exactly, and rows of your own checked.

use std::path::Path;

use serde::Serialize;

use super::arguments::{FormulaCheck, FormulaCommand, FormulaDocs, FormulaList as Wanted, FormulaShow};
use super::failure::{Exit, Failure};
use super::formula_card::{Card, Cards};
use super::formula_list::{FormulaList, Recommended, RuleList};
use super::formula_plot::{plot, write_all};
use super::output::{Output, Show};
use super::{formula_barrier, formula_compare, formula_derive, formula_search};
use kinstep::formula::{
    Analysis, CheckedRow, DefectKind, Formula, FormulaTable, Row, Snippet, Strictness, bibtex, read_rows,
};
use kinstep_files::scenario::{FormulaRows, read_text, row_refusals};
use kinstep_report::FormulaPage;

/// What a row that is typed at the prompt is called.
const TYPED: &str = "typed";

pub(super) fn run(
    command: &FormulaCommand,
    own: Option<&Path>,
    output: &mut Output,
) -> Result<Exit, Failure> {
    let own_rows = own.map(|file| rows_of(file, Strictness::Finished)).transpose()?.unwrap_or_default();
    match command {
        FormulaCommand::List(wanted) => list(wanted, own, own_rows, output),
        FormulaCommand::Show(arguments) => show_rows(arguments, &own_rows, output),
        FormulaCommand::Check(arguments) => check(arguments, output),
        FormulaCommand::Derive(arguments) => formula_derive::run(arguments, output),
        FormulaCommand::Search(arguments) => formula_search::run(arguments, &own_rows, output),
        FormulaCommand::Compare(arguments) => formula_compare::run(arguments, &own_rows, output),
        FormulaCommand::Barrier(arguments) => formula_barrier::run(arguments, output),
        FormulaCommand::Docs(arguments) => docs(arguments, output),
    }
}

fn list(
    wanted: &Wanted,
    own: Option<&Path>,
    own_rows: Vec<Row>,
    output: &mut Output,
) -> Result<Exit, Failure> {
    if wanted.derivative_rules {
        output.show(&RuleList::new(wanted.order))?;
        return Ok(Exit::Done);
    }
    if wanted.recommended {
        let mut rows = FormulaRows::default();
        if let Some(file) = own {
            rows.add_file(file)?;
        }
        // No row has an empty id: this is the table of all rows that hold what they declare.
        output.show(&Recommended::new(rows.table_for("")?, wanted)?)?;
        return Ok(Exit::Done);
    }
    let list = FormulaList::new(FormulaTable::builtin(), own_rows, wanted)?;
    output.show(&list)?;
    Ok(verdict(list.is_sound()))
}

fn docs(arguments: &FormulaDocs, output: &mut Output) -> Result<Exit, Failure> {
    let FormulaPage { markdown, pictures } = FormulaPage::of(FormulaTable::builtin());
    let folder = arguments.out.parent().unwrap_or(Path::new(""));
    let folder = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
    let name = arguments.out.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let mut written = write_all("--out", folder, arguments.force, &[(name, markdown)])?;
    written.extend(write_all("--out", &folder.join("pictures"), arguments.force, &pictures)?);
    output.show(&Written { written })?;
    Ok(Exit::Done)
}

/// Names of files.
#[derive(Serialize)]
struct Written {
    written: Vec<String>,
}

impl Show for Written {
    fn text(&self) -> String {
        self.written.join("\n") + "\n"
    }
}

fn verdict(sound: bool) -> Exit {
    if sound { Exit::Done } else { Exit::CheckFailed }
}

fn show(cards: &Cards, output: &mut Output) -> Result<Exit, Failure> {
    output.show(cards)?;
    Ok(verdict(cards.is_sound()))
}

fn show_rows(arguments: &FormulaShow, own_rows: &[Row], output: &mut Output) -> Result<Exit, Failure> {
    let shown = shown(arguments, own_rows)?;
    if let Some(path) = &arguments.plot {
        let rows: Vec<(&str, &Analysis)> = shown.iter().map(Shown::analysed).collect();
        let written = plot(path, arguments.force, &rows)?;
        if !output.wants_json() {
            output.aside(&format!("written: {}", written.join(", ")));
        }
    }
    let cards = shown.iter().map(|shown| with_snippets(shown.card(), shown, arguments)).collect();
    show(&Cards::new(cards), output)
}

/// What is shown: a formula of the table, or a row of somebody's own.
enum Shown {
    Builtin(&'static Formula),
    Own(Box<CheckedRow>, bool),
}

impl Shown {
    fn analysed(&self) -> (&str, &Analysis) {
        match self {
            Self::Builtin(formula) => (formula.id(), formula.analysis()),
            Self::Own(checked, _) => (checked.row().id(), checked.analysis()),
        }
    }

    fn source(&self) -> Option<&str> {
        match self {
            Self::Builtin(formula) => Some(formula.source()),
            Self::Own(checked, _) => checked.row().source(),
        }
    }

    fn card(&self) -> Card {
        match self {
            Self::Builtin(formula) => Card::of_formula(formula),
            Self::Own(checked, is_typed) => Card::of_row(checked, *is_typed),
        }
    }
}

fn with_snippets(card: Card, shown: &Shown, arguments: &FormulaShow) -> Card {
    let (id, analysis) = shown.analysed();
    let languages = [
        (arguments.latex, "latex", Snippet::Latex),
        (arguments.rust, "rust", Snippet::Rust),
        (arguments.python, "python", Snippet::Python),
    ];
    let asked = languages.into_iter().filter(|(asked, ..)| *asked);
    let card =
        asked.fold(card, |card, (_, name, language)| card.with_snippet(name, language.of(id, analysis)));
    if !arguments.bibtex {
        return card;
    }
    let source = shown.source().unwrap_or_default();
    let entry = bibtex(source).map_or_else(
        || format!("% {id}: there is no entry for the source \"{source}\"\n"),
        |entry| format!("{entry}\n"),
    );
    card.with_snippet("bibtex", entry)
}

fn shown(arguments: &FormulaShow, own_rows: &[Row]) -> Result<Vec<Shown>, Failure> {
    let mut shown = Vec::new();
    for id in &arguments.ids {
        shown.push(match own_rows.iter().find(|row| row.id() == id) {
            Some(row) => Shown::Own(Box::new(row.clone().check()), false),
            None => match FormulaTable::builtin().get(id) {
                Ok(formula) => Shown::Builtin(formula),
                Err(unknown) => return Err(Failure::usage(unknown.to_string())),
            },
        });
    }
    if let Some(row) =
        typed_row(arguments).transpose().map_err(|kind| Failure::new(Exit::Formula, kind.to_string()))?
    {
        shown.push(Shown::Own(Box::new(row.check()), true));
    }
    if shown.is_empty() {
        let ways = "name rows to show, or type one: --difference 24,-5,-12,-6,-4,3 --denominator 48, \
                    or --alpha 1,-1,0 --beta 0,3/2,-1/2";
        return Err(Failure::usage(ways));
    }
    Ok(shown)
}

/// The row of an id, the user's own before the built-in ones.
pub(super) fn checked(id: &str, own_rows: &[Row]) -> Result<CheckedRow, Failure> {
    let row = match own_rows.iter().find(|row| row.id() == id) {
        Some(row) => row,
        None => FormulaTable::builtin().get(id).map_err(|unknown| Failure::usage(unknown.to_string()))?.row(),
    };
    Ok(row.clone().check())
}

fn typed_row(arguments: &FormulaShow) -> Option<Result<Row, DefectKind>> {
    let FormulaShow { difference, denominator, alpha, beta, gamma, .. } = arguments;
    match (difference, alpha, beta) {
        (Some(difference), ..) => {
            Some(Row::from_difference(TYPED, difference, denominator.as_deref().unwrap_or("1")))
        }
        (None, Some(alpha), Some(beta)) => Some(Row::from_weights(TYPED, alpha, beta, gamma.as_deref())),
        _ => None,
    }
}

fn check(arguments: &FormulaCheck, output: &mut Output) -> Result<Exit, Failure> {
    let strictness = if arguments.draft { Strictness::Draft } else { Strictness::Finished };
    let rows = rows_of(&arguments.file, strictness)?;
    let card = |row: Row| {
        let taken = FormulaTable::builtin().get(row.id()).is_ok();
        let card = Card::of_row(&row.check(), arguments.draft);
        if taken {
            card.with_remark("a built-in row has this id; give the row another before a scenario uses it")
        } else {
            card
        }
    };
    show(&Cards::new(rows.into_iter().map(card).collect()), output)
}

fn rows_of(file: &Path, strictness: Strictness) -> Result<Vec<Row>, Failure> {
    let text = read_text(file)?;
    read_rows(&text, strictness).map_err(|error| {
        let mut all = row_refusals(&error, file, &text).into_iter().map(Failure::from);
        let first = all.next().unwrap_or_else(|| Failure::new(Exit::Formula, error.to_string()));
        Failure { also: all.collect(), ..first }
    })
}
