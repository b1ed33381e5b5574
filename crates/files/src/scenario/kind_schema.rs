//! The JSON schemas of tables that name a kind, made of the registries.

use schemars::Schema;
use serde_json::{Map, Value, json};

use super::kinds::Kinds;
use super::law_spec::ACCELERATION_LIMIT;
use kinstep::kind::{Form, Parameter, Registry};

/// Puts the curves and their parameters into the schema of a path.
pub(super) fn curves(schema: &mut Schema) {
    extend(schema, &Kinds::builtin().curves);
}

/// The time laws with their parameters: a name, or a table.
pub(super) fn time_laws() -> Schema {
    let kinds = Kinds::builtin();
    let word = names(&kinds.time_laws, "");
    let mut table = schemars::json_schema!({ "type": "object", "required": ["kind"] });
    extend(&mut table, &kinds.time_laws);
    schemars::json_schema!({ "anyOf": [word, table] })
}

/// Puts the laws and their parameters into the schema of `[law]`.
pub(super) fn laws(schema: &mut Schema) {
    extend(schema, &Kinds::builtin().laws);
    let limit = &ACCELERATION_LIMIT;
    let described = format!("[{}] {}", limit.unit, limit.description);
    set(schema, limit.name, |_| with_description(form(limit), &described));
}

/// Puts the criteria and their parameters into the schema of a criterion.
pub(super) fn criteria(schema: &mut Schema) {
    extend(schema, &Kinds::builtin().criteria);
}

/// Puts the tasks over several tips and their parameters into the schema of a relation.
pub(super) fn relations(schema: &mut Schema) {
    extend(schema, &Kinds::builtin().tasks);
}

/// Puts the kinds of obstacles and their parameters into the schema of an obstacle.
pub(super) fn obstacles(schema: &mut Schema) {
    extend(schema, &Kinds::builtin().obstacles);
}

fn extend<Make: Copy>(schema: &mut Schema, kinds: &Registry<Make>) {
    schema.insert("additionalProperties".to_owned(), false.into());
    set(schema, "kind", |described| names(kinds, described));
    for parameter in kinds.parameters() {
        let described = description(kinds, parameter.name);
        set(schema, parameter.name, |_| with_description(form(parameter), &described));
    }
}

/// Replaces a property by one that is made of its description.
fn set(schema: &mut Schema, key: &str, property: impl FnOnce(&str) -> Value) {
    let properties = schema.ensure_object().entry("properties").or_insert_with(|| Map::new().into());
    let Some(properties) = properties.as_object_mut() else { return };
    let described =
        properties.get(key).and_then(|property| property["description"].as_str()).unwrap_or_default();
    let property = property(described);
    properties.insert(key.to_owned(), property);
}

fn names<Make: Copy>(kinds: &Registry<Make>, described: &str) -> Value {
    let one = |(name, description)| json!({ "type": "string", "const": name, "description": description });
    let all: Vec<Value> = kinds.iter().map(|kind| one((kind.name, kind.description))).collect();
    with_description(json!({ "oneOf": all }), described)
}

/// What a parameter is in each of the kinds that take it.
fn description<Make: Copy>(kinds: &Registry<Make>, name: &str) -> String {
    let of_kind = |(kind, parameter): (&str, &Parameter)| {
        let unit = if parameter.unit.is_empty() { String::new() } else { format!(" [{}]", parameter.unit) };
        format!("{kind}{unit}: {}", parameter.description)
    };
    let takers = kinds.iter().filter_map(|kind| Some((kind.name, kind.parameter(name)?)));
    takers.map(of_kind).collect::<Vec<_>>().join(" ")
}

fn form(parameter: &Parameter) -> Value {
    let real = json!({ "$ref": "#/$defs/Real" });
    let list = |items: Value| json!({ "type": "array", "items": items });
    let of_length = |items: Value, least: usize, most: usize| json!({ "type": "array", "items": items, "minItems": least, "maxItems": most });
    match parameter.form {
        Form::Number | Form::Positive { .. } => real,
        Form::Numbers => list(real),
        Form::Pair => of_length(real, 2, 2),
        Form::Point => of_length(real, 2, 3),
        Form::Vectors => list(of_length(real, 3, 3)),
        Form::Quaternions => list(of_length(real, 4, 4)),
        Form::Text => json!({ "type": "string" }),
        Form::OneOf(words) => json!({ "type": "string", "enum": words }),
        Form::ByJoint { .. } => {
            json!({ "anyOf": [real, { "type": "object", "additionalProperties": real }] })
        }
        Form::Flag => json!({ "type": "boolean" }),
    }
}

fn with_description(mut schema: Value, description: &str) -> Value {
    if let Some(schema) = schema.as_object_mut().filter(|_| !description.is_empty()) {
        schema.insert("description".to_owned(), description.into());
    }
    schema
}
