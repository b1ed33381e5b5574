//! `kinstep formula`: what rows can do, decided exactly, and rows of your own checked.

use std::path::Path;

use super::arguments::{FormulaCheck, FormulaCommand, FormulaShow};
use super::failure::{Exit, Failure};
use super::formula_card::{Card, Cards, FormulaList};
use super::output::Output;
use super::{formula_compare, formula_derive, formula_search};
use crate::formula::{CheckedRow, DefectKind, FormulaTable, Row, Strictness, read_rows};
use crate::scenario::{read_text, row_refusals};

/// What a row that is typed at the prompt is called.
const TYPED: &str = "typed";

pub(super) fn run(
    command: &FormulaCommand,
    own: Option<&Path>,
    output: &mut Output,
) -> Result<Exit, Failure> {
    let own_rows = own.map(|file| rows_of(file, Strictness::Finished)).transpose()?.unwrap_or_default();
    match command {
        FormulaCommand::List => {
            let list = FormulaList::new(FormulaTable::builtin(), own_rows);
            output.show(&list)?;
            Ok(verdict(list.is_sound()))
        }
        FormulaCommand::Show(arguments) => show(&cards(arguments, &own_rows)?, output),
        FormulaCommand::Check(arguments) => check(arguments, output),
        FormulaCommand::Derive(arguments) => formula_derive::run(arguments, output),
        FormulaCommand::Search(arguments) => formula_search::run(arguments, &own_rows, output),
        FormulaCommand::Compare(arguments) => formula_compare::run(arguments, &own_rows, output),
    }
}

fn verdict(sound: bool) -> Exit {
    if sound { Exit::Done } else { Exit::CheckFailed }
}

fn show(cards: &Cards, output: &mut Output) -> Result<Exit, Failure> {
    output.show(cards)?;
    Ok(verdict(cards.is_sound()))
}

fn cards(arguments: &FormulaShow, own_rows: &[Row]) -> Result<Cards, Failure> {
    let mut cards = Vec::new();
    for id in &arguments.ids {
        let card = match own_rows.iter().find(|row| row.id() == id) {
            Some(row) => Card::of_row(&row.clone().check(), false),
            None => match FormulaTable::builtin().get(id) {
                Ok(formula) => Card::of_formula(formula),
                Err(unknown) => return Err(Failure::usage(unknown.to_string())),
            },
        };
        cards.push(card);
    }
    if let Some(row) =
        typed_row(arguments).transpose().map_err(|kind| Failure::new(Exit::Formula, kind.to_string()))?
    {
        cards.push(Card::of_row(&row.check(), true));
    }
    if cards.is_empty() {
        let ways = "name rows to show, or type one: --difference 24,-5,-12,-6,-4,3 --denominator 48, \
                    or --alpha 1,-1,0 --beta 0,3/2,-1/2";
        return Err(Failure::usage(ways));
    }
    Ok(Cards::new(cards))
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
