//! Where results and failures are written: documents and tables to standard output, sentences to standard error.

use std::io::{self, IsTerminal, Write};

use serde::Serialize;
use serde_json::{Value, json};

use super::arguments::{Arguments, ColourChoice};
use super::failure::{Exit, Failure};
use super::paint::painted;
use kinstep::robot::names::{is_odd, printable};

/// A result that people read as text and programs as JSON.
pub(super) trait Show: Serialize {
    /// The result for people.
    fn text(&self) -> String;
}

/// How much is said.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Loudness {
    /// Warnings and failures.
    Quiet,
    Usual,
    /// Details too.
    Verbose,
}

/// Standard output and standard error, in the form that was asked for.
pub(super) struct Output {
    wants_json: bool,
    closed: bool,
    loudness: Loudness,
    colour: ColourChoice,
}

impl Output {
    pub(super) fn new(wants_json: bool) -> Self {
        Self { wants_json, closed: false, loudness: Loudness::Usual, colour: ColourChoice::Auto }
    }

    /// Takes over what the arguments say of the output itself.
    pub(super) fn listen(&mut self, arguments: &Arguments) {
        self.loudness = match (arguments.quiet, arguments.verbose) {
            (true, _) => Loudness::Quiet,
            (_, true) => Loudness::Verbose,
            _ => Loudness::Usual,
        };
        self.colour = arguments.color;
    }

    pub(super) fn wants_json(&self) -> bool {
        self.wants_json
    }

    pub(super) fn is_quiet(&self) -> bool {
        self.loudness == Loudness::Quiet && !self.wants_json
    }

    pub(super) fn is_verbose(&self) -> bool {
        self.loudness == Loudness::Verbose
    }

    /// Writes a report to standard output, with its verdicts in colour on a terminal; nothing where it was asked to be quiet.
    pub(super) fn report(&mut self, text: &str) -> Result<(), Failure> {
        if self.is_quiet() {
            return Ok(());
        }
        if self.paints(io::stdout().is_terminal()) { self.text(&painted(text)) } else { self.text(text) }
    }

    /// Writes a sentence that is neither a warning nor a failure to standard error, unless it was asked to be quiet.
    pub(super) fn aside(&self, sentence: &str) {
        if self.loudness != Loudness::Quiet {
            self.remark(sentence);
        }
    }

    /// Whether text may be coloured that goes to a terminal or not.
    fn paints(&self, to_terminal: bool) -> bool {
        match self.colour {
            ColourChoice::Auto => to_terminal && !is_colourless(),
            ColourChoice::Always => true,
            ColourChoice::Never => false,
        }
    }

    /// Writes a result in the form that was asked for.
    pub(super) fn show(&mut self, result: &impl Show) -> Result<(), Failure> {
        if !self.wants_json {
            return self.report(&result.text());
        }
        let document = serde_json::to_string_pretty(result)
            .map_err(|e| Failure::new(Exit::File, format!("the result can not be written as JSON: {e}")))?;
        self.text(&(document + "\n"))
    }

    /// Writes help, in the parser's style where standard output is a terminal.
    pub(super) fn help(&mut self, help: &clap::builder::StyledStr) -> Result<(), Failure> {
        let painted = self.paints(io::stdout().is_terminal());
        self.text(&if painted { help.ansi().to_string() } else { help.to_string() })
    }

    pub(super) fn json(&mut self, document: &Value) -> Result<(), Failure> {
        self.text(&format!("{document:#}\n"))
    }

    /// Writes text to standard output; a reader that has gone away is no failure.
    pub(super) fn text(&mut self, text: &str) -> Result<(), Failure> {
        let mut out = io::stdout().lock();
        match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
            Err(e) if e.kind() == io::ErrorKind::BrokenPipe => self.closed = true,
            Err(e) => {
                return Err(Failure::new(Exit::File, format!("standard output can not be written: {e}")));
            }
            Ok(()) => {}
        }
        Ok(())
    }

    /// Writes a sentence for people to standard error; it is not part of any document.
    pub(super) fn remark(&self, sentence: &str) {
        if !self.closed {
            let _ = writeln!(io::stderr().lock(), "{sentence}");
        }
    }

    /// Writes what was recognised of a file, unless that is not wanted, and what is questionable about it.
    pub(super) fn remarks(&self, notes: &[String], warnings: &[String]) {
        for note in notes {
            self.aside(&format!("note: {note}"));
        }
        for warning in warnings {
            self.remark(&format!("warning: {warning}"));
        }
    }

    /// Reports a failure in the form that was asked for, and returns its exit code.
    pub(super) fn failure(&mut self, failure: &Failure) -> Exit {
        let exit = failure.exit;
        if self.wants_json {
            // Standard output may be what failed; then standard error is all that is left.
            if self.json(&failure_document(failure)).is_err() {
                self.remark(&failure.message);
            }
        } else {
            for failure in std::iter::once(failure).chain(&failure.also) {
                self.remark(&failure_text(failure, self.paints(io::stderr().is_terminal())));
            }
        }
        exit
    }
}

/// A time without the digits that a sum of gaps leaves behind.
pub(super) fn moment(t: f64) -> String {
    let text = format!("{t:.6}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    (if text == "-0" { "0" } else { text }).to_owned()
}

fn failure_document(failure: &Failure) -> Value {
    let mut document = error_document(failure);
    if !failure.also.is_empty() {
        document["also"] = failure.also.iter().map(error_document).collect();
    }
    json!({ "error": document })
}

fn error_document(failure: &Failure) -> Value {
    let place = failure.place.as_ref();
    json!({
        "code": failure.exit as u8,
        "kind": failure.exit.word(),
        "message": failure.message,
        "file": failure.file,
        "line": place.map(|place| place.line),
        "column": place.map(|place| place.column),
    })
}

/// `file:line:column: sentence`, and below it the line with a caret.
fn failure_text(failure: &Failure, painted: bool) -> String {
    let message = lines(&failure.message);
    let word = if painted { "\u{1b}[1;31merror:\u{1b}[0m" } else { "error:" };
    let Some(place) = &failure.place else {
        return match &failure.file {
            Some(file) if !message.contains(&*printable(file)) => {
                format!("{word} {}: {message}", printable(file))
            }
            _ => format!("{word} {message}"),
        };
    };
    let file = printable(failure.file.as_deref().unwrap_or("scenario"));
    let head = format!("{file}:{}:{}: {word} {message}", place.line, place.column);
    if place.source_line.trim().is_empty() {
        return head;
    }
    let number = place.line.to_string();
    let source = excerpt(&place.source_line, place.column);
    let (indent, line) = (" ".repeat(number.len()), source.0);
    format!("{head}\n {number} | {line}\n {indent} | {}^", " ".repeat(source.1))
}

/// A message of several lines with nothing in them that a terminal would obey.
fn lines(message: &str) -> String {
    message.split('\n').map(printable).collect::<Vec<_>>().join("\n")
}

/// Returns the part of a line around a column, and how far the caret stands in.
fn excerpt(line: &str, column: usize) -> (String, usize) {
    const WIDTH: usize = 90;
    let plain: Vec<char> = line.chars().map(|c| if is_odd(c) { ' ' } else { c }).collect();
    let caret = column.saturating_sub(1).min(plain.len());
    let start = if plain.len() <= WIDTH { 0 } else { caret.saturating_sub(WIDTH / 2) };
    let end = (start + WIDTH).min(plain.len());
    (plain[start..end].iter().collect(), caret - start)
}

fn is_colourless() -> bool {
    std::env::var_os("NO_COLOR").is_some_and(|value| !value.is_empty())
}

#[cfg(test)]
mod tests {
    use super::*;
    use kinstep_files::scenario::Place;

    #[test]
    fn a_failure_shows_its_place_and_a_caret() {
        let place = Place::of_byte(None, "a = 1\nsigma = 0\n", 14);
        let failure =
            Failure { place: Some(Box::new(place)), ..Failure::usage("sigma: no").in_file("s.toml") };
        assert_eq!(
            failure_text(&failure, false),
            "s.toml:2:9: error: sigma: no\n 2 | sigma = 0\n   |         ^"
        );
    }

    #[test]
    fn a_long_line_is_cut_around_the_caret() {
        let line = "x".repeat(500) + "!" + &"y".repeat(500);
        let (part, caret) = excerpt(&line, 501);
        assert_eq!(part.chars().nth(caret), Some('!'));
        assert!(part.len() <= 90);
    }
}
