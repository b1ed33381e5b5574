//! `kinstep formula derive`: a stencil and an order in, the exact family out.

use std::fmt::Write as _;

use serde::Serialize;

use super::arguments::FormulaDerive;
use super::failure::{Exit, Failure};
use super::formula_card::{Card, Cards};
use super::output::{Output, Show};
use kinstep::formula::derive::{Affine, DeriveError, DerivedFamily, Stencil};
use kinstep::math::{Rational, parse_rational};
use kinstep_report::Table;

/// What the row of given parameters is called.
const DERIVED: &str = "derived";

pub(super) fn run(arguments: &FormulaDerive, output: &mut Output) -> Result<Exit, Failure> {
    let refuse = |error: DeriveError| Failure::usage(error.to_string());
    let stencil = Stencil::new(&arguments.samples, &arguments.derivatives).map_err(refuse)?;
    let family = DerivedFamily::of_order(stencil, arguments.order).map_err(refuse)?;
    let member = match parameters(arguments, &family)? {
        Some(values) => {
            let row = family.row(DERIVED, &values).map_err(refuse)?;
            Some(Cards::new(vec![Card::of_row(&row.check(), true)]))
        }
        None => None,
    };
    output.show(&Derivation::new(&family, member))?;
    Ok(Exit::Done)
}

/// The values given, or none at all where the family is a single formula.
fn parameters(arguments: &FormulaDerive, family: &DerivedFamily) -> Result<Option<Vec<Rational>>, Failure> {
    let Some(text) = &arguments.parameters else {
        return Ok(family.parameters().is_empty().then(Vec::new));
    };
    let value = |(k, number): (usize, &str)| {
        parse_rational(number).map_err(|error| Failure::usage(format!("--parameters, p{}: {error}", k + 1)))
    };
    text.split(',').enumerate().map(value).collect::<Result<Vec<_>, _>>().map(Some)
}

#[derive(Serialize)]
struct Derivation {
    samples: Vec<i64>,
    derivatives: Vec<i64>,
    steps: usize,
    order: usize,
    conditions: usize,
    unknowns: usize,
    parameters: Vec<Parameter>,
    coefficients: Vec<Coefficient>,
    error_constant: Polynomial,
    #[serde(flatten)]
    member: Option<Cards>,
    #[serde(skip)]
    is_difference: bool,
}

#[derive(Serialize)]
struct Parameter {
    name: String,
    coefficient: String,
}

#[derive(Serialize)]
struct Coefficient {
    of: String,
    #[serde(flatten)]
    value: Polynomial,
}

/// constant + slopes times p1, p2, ...
#[derive(Serialize)]
struct Polynomial {
    constant: String,
    slopes: Vec<String>,
    text: String,
}

impl Polynomial {
    fn of(affine: &Affine) -> Self {
        Self {
            constant: affine.constant.to_string(),
            slopes: affine.slopes.iter().map(ToString::to_string).collect(),
            text: affine.to_string(),
        }
    }
}

impl Derivation {
    fn new(family: &DerivedFamily, member: Option<Cards>) -> Self {
        let stencil = family.stencil();
        let coefficients = family.coefficients();
        let names = family.parameters().into_iter().enumerate();
        Self {
            samples: stencil.samples().to_vec(),
            derivatives: stencil.derivatives().to_vec(),
            steps: stencil.steps(),
            order: family.order(),
            conditions: family.order() + 1,
            unknowns: coefficients.len() - 1,
            parameters: names
                .map(|(k, unknown)| Parameter {
                    name: format!("p{}", k + 1),
                    coefficient: unknown.to_string(),
                })
                .collect(),
            coefficients: coefficients
                .iter()
                .map(|(unknown, affine)| Coefficient {
                    of: unknown.to_string(),
                    value: Polynomial::of(affine),
                })
                .collect(),
            error_constant: Polynomial::of(&family.error_constant()),
            is_difference: stencil.is_difference(),
            member,
        }
    }

    fn heading(&self) -> String {
        let form = if self.is_difference {
            "sigma f = sum of weights times x, for one derivative f"
        } else {
            "sum of weights times x = sigma times sum of weights times f, newest x with weight 1"
        };
        let freedom = match self.parameters.len() {
            0 => "one formula".to_owned(),
            1 => "1 free parameter".to_owned(),
            n => format!("{n} free parameters"),
        };
        format!(
            "{form}\norder {}: {} conditions, {} unknown coefficients: {freedom}\n",
            self.order, self.conditions, self.unknowns
        )
    }

    fn table(&self) -> Table {
        let names = self.parameters.iter().map(|parameter| format!("{} times", parameter.name));
        let mut table =
            Table::new(["weight of".to_owned(), "particular".to_owned()].into_iter().chain(names));
        for Coefficient { of, value } in &self.coefficients {
            table.row([of, &value.constant].into_iter().chain(&value.slopes).cloned());
        }
        table
    }
}

impl Show for Derivation {
    fn text(&self) -> String {
        let parameters: Vec<String> = self
            .parameters
            .iter()
            .map(|p| format!("{} is the weight of {}", p.name, p.coefficient))
            .collect();
        let mut text = format!("{}\n{}\n", self.heading(), self.table());
        for Coefficient { of, value } in &self.coefficients {
            // Writing to a String can not fail.
            let _ = writeln!(text, "{of:<6} {}", value.text);
        }
        let constant = if self.is_difference { "error constant c" } else { "constant C of one step" };
        let _ = writeln!(text, "\n{constant} = {}", self.error_constant.text);
        let _ = match &self.member {
            Some(cards) => write!(text, "\n{}", cards.text()),
            None => writeln!(text, "{}; give --parameters for a row.", parameters.join(", ")),
        };
        text
    }
}
