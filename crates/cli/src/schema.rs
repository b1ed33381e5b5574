//! `kinstep schema`: the JSON Schemas of the files that people write.

use super::arguments::{SchemaArguments, SchemaKind};
use super::failure::{Exit, Failure};
use super::output::Output;
use kinstep_files::scenario::Scenario;

pub(super) fn run(arguments: SchemaArguments, output: &mut Output) -> Result<Exit, Failure> {
    let schema = match arguments.kind {
        SchemaKind::Scenario => schemars::schema_for!(Scenario),
        SchemaKind::Formula => super::formula_schema::schema(),
    };
    output.json(schema.as_value())?;
    Ok(Exit::Done)
}
