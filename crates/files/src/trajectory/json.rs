//! Messages and tables as JSON: one document, or one a line.

use serde::de::IgnoredAny;
use serde_json::Deserializer;

use super::error::Problem;
use super::messages::Messages;
use super::read::{Source, TrajectoryReader};
use super::yaml;
use super::{ReadOptions, Reading};

/// What the YAML formats hold as JSON: joint trajectories and what wraps them, joint states, messages of rosbridge
/// (`{"op", "topic", "msg"}`), one document or one after another; and tables: `{"t": [...], "elbow": [...]}`, or records
/// `[{"t": 0, "elbow": 0.1}, ...]`.
#[derive(Clone, Copy, Debug, Default)]
pub struct Json;

impl TrajectoryReader for Json {
    fn knows(&self, source: Source<'_>) -> bool {
        let first = source.bytes.iter().find(|byte| !byte.is_ascii_whitespace());
        let is_named = source.has_extension(&["json", "jsonl", "ndjson"]);
        is_named || !source.has_extension(&["yaml", "yml"]) && matches!(first, Some(b'{' | b'['))
    }

    fn read(&self, source: Source<'_>, options: &ReadOptions) -> Result<Reading, Problem> {
        let text = source.text()?;
        let mut messages = Messages::new(options);
        let mut documents = Deserializer::from_str(text).into_iter::<IgnoredAny>();
        let mut start = 0;
        while let Some(document) = documents.next() {
            document.map_err(|e| not_json(text, &e))?;
            let end = documents.byte_offset();
            yaml::document(&text[start..end], start, &mut |node| messages.take(node))?;
            start = end;
        }
        messages.finish(None)
    }
}

fn not_json(text: &str, error: &serde_json::Error) -> Problem {
    let before: usize = text.split_inclusive('\n').take(error.line().saturating_sub(1)).map(str::len).sum();
    let at = (before + error.column().saturating_sub(1)).min(text.len());
    let whole = error.to_string();
    let sentence = whole.split(" at line ").next().unwrap_or_default();
    Problem::at(at, format!("not JSON: {sentence}"))
}
