//! The JSON Schema of formula files. The reader of rows keeps numbers exact and so reads them by hand; this says
//! the same to editors, and a test holds the built-in table against the keys named here.

use schemars::{Schema, json_schema};

/// Returns the schema of a file of formula rows.
pub(super) fn schema() -> Schema {
    let exact = serde_json::json!({
        "description": "An integer, or an exact number in quotes: \"5/24\", \"0.1\". A bare decimal is refused.",
        "anyOf": [{ "type": "integer" }, { "type": "string", "pattern": r"^\s*[-+]?[0-9._]+([eE][-+]?[0-9]+)?(\s*/\s*[0-9._]+)?\s*$" }]
    });
    let weights = |of: &str| {
        serde_json::json!({
            "description": format!("{of}, newest sample first: entry j belongs to time n+1-j."),
            "type": "array",
            "items": { "$ref": "#/$defs/Exact" },
            "minItems": 2
        })
    };
    let text = |of: &str| serde_json::json!({ "description": of, "type": "string" });
    let exact_of = |of: &str| serde_json::json!({ "description": of, "$ref": "#/$defs/Exact" });
    json_schema!({
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "Formula rows",
        "type": "object",
        "required": ["formula"],
        "additionalProperties": false,
        "properties": { "formula": { "type": "array", "items": { "$ref": "#/$defs/Row" } } },
        "$defs": {
            "Exact": exact,
            "Row": {
                "type": "object",
                "required": ["id", "source", "order", "zero_stable", "error_constant"],
                "additionalProperties": false,
                "oneOf": [{ "required": ["difference", "denominator"] }, { "required": ["alpha", "beta"] }],
                "properties": {
                    "id": text("Unique name of the row: lower-case letters, digits and '-'."),
                    "name": text("Name for people."),
                    "family": text("Family that the row belongs to."),
                    "difference": weights("Numerators of a look-ahead difference formula"),
                    "denominator": exact_of("Common denominator of `difference`."),
                    "alpha": weights("Weights of the states"),
                    "beta": weights("Weights of the right-hand side f"),
                    "gamma": weights("Weights of the second part g of the right-hand side; default: beta"),
                    "order": { "description": "Declared order p.", "type": "integer", "minimum": 0 },
                    "error_constant": exact_of("Declared constant c of formula = x' + c sigma^p x^(p+1)."),
                    "zero_stable": { "description": "Declared root condition.", "type": "boolean" },
                    "source": text("Where the coefficients are from."),
                    "attribution": text("How surely they are from there."),
                    "note": text("What a user should know.")
                }
            }
        }
    })
}

#[cfg(test)]
mod tests {
    #[test]
    fn names_the_keys_of_every_built_in_row_and_requires_no_others() {
        let table: toml::Table = toml::from_str(include_str!("../../../src/formula/table.toml")).unwrap();
        let schema = super::schema();
        let row = schema.pointer("/$defs/Row").unwrap();
        let rows = table["formula"].as_array().unwrap();
        assert!(!rows.is_empty());
        for declared in rows {
            let declared = declared.as_table().unwrap();
            for key in declared.keys() {
                assert!(row["properties"].get(key).is_some(), "{key} is not in the schema");
            }
            for key in row["required"].as_array().unwrap() {
                assert!(
                    declared.contains_key(key.as_str().unwrap()),
                    "{key} is required, but {declared:?} lacks it"
                );
            }
        }
    }
}
