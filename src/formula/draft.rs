//! Finished rows as text: what a draft leaves out is computed and written in.

use std::fmt::Write as _;

use num_traits::ToPrimitive;

use crate::math::Rational;

use super::check::CheckedRow;
use super::row::Coefficients;

impl CheckedRow {
    /// Returns the row as TOML with the facts that it does not declare filled in, ready to be added to a file.
    ///
    /// What the row does declare is kept as it is, right or wrong. An inconsistent row has no order and no error constant to
    /// fill in. Where the source is missing, a line to be completed stands in its place.
    pub fn to_toml(&self) -> String {
        let (row, analysis) = (self.row(), self.analysis());
        let declared = row.declared();
        let mut text = String::from("[[formula]]\n");
        let mut line = |key: &str, value: Option<String>| {
            if let Some(value) = value {
                // Writing to a String can not fail.
                let _ = writeln!(text, "{key} = {value}");
            }
        };
        line("id", Some(quoted(row.id())));
        line("name", row.name.as_deref().map(quoted));
        line("family", row.family.as_deref().map(quoted));
        match row.coefficients() {
            Coefficients::Difference { numerators, denominator } => {
                line("difference", Some(list(numerators)));
                line("denominator", Some(number(denominator)));
            }
            Coefficients::General { alpha, beta, gamma } => {
                line("alpha", Some(list(alpha)));
                line("beta", Some(list(beta)));
                line("gamma", gamma.as_deref().map(list));
            }
        }
        line("order", declared.order.or(analysis.order()).map(|order| order.to_string()));
        let error_constant = declared.error_constant.clone().or_else(|| analysis.error_constant());
        line("error_constant", error_constant.as_ref().map(|constant| quoted(&constant.to_string())));
        line("zero_stable", Some(declared.zero_stable.unwrap_or(analysis.is_zero_stable()).to_string()));
        let source = row.source.as_deref().map(quoted);
        line(
            "source",
            Some(source.unwrap_or_else(|| "\"unpublished\"  # where the coefficients are from".to_owned())),
        );
        line("attribution", row.attribution.as_deref().map(quoted));
        line("note", row.note.as_deref().map(quoted));
        text
    }
}

fn quoted(text: &str) -> String {
    toml::Value::from(text).to_string()
}

/// Integers that TOML can hold stand bare, everything else in quotes.
fn number(value: &Rational) -> String {
    match value.numer().to_i64().filter(|_| value.is_integer()) {
        Some(integer) => integer.to_string(),
        None => quoted(&value.to_string()),
    }
}

fn list(values: &[Rational]) -> String {
    format!("[{}]", values.iter().map(number).collect::<Vec<_>>().join(", "))
}
