//! `kinstep order`: which order runs really show.

use std::path::Path;

use serde_json::{Value, json};

use super::arguments::OrderArguments;
use super::failure::{Exit, Failure};
use super::folder::Folder;
use super::output::Output;
use kinstep_files::scenario::{ScenarioText, suite};
use kinstep_report::figure::{Figure, order_figure};
use kinstep_report::{OrderPage, Table};
use kinstep_study::{Convergence, RowStudy, ScenarioStudy};

/// A scenario with what was seen.
struct Studied {
    name: String,
    study: ScenarioStudy,
    rows: Vec<RowStudy>,
    warnings: Vec<String>,
}

impl Studied {
    fn page(&self) -> OrderPage<'_> {
        OrderPage { name: &self.name, study: &self.study, rows: &self.rows }
    }

    /// The stem of the names of its files.
    fn stem(&self) -> String {
        Path::new(&self.name).file_stem().unwrap_or_default().to_string_lossy().into_owned()
    }

    fn file_names(&self) -> [String; 3] {
        ["json", "csv", "svg"].map(|kind| format!("order-{}.{kind}", self.stem()))
    }

    fn exit(&self) -> Exit {
        if self.rows.iter().any(|row| !row.is_finished()) {
            return Exit::Stopped;
        }
        let missed = |row: &RowStudy| row.claimed.is_some() && row.seen.verdict.is_not_reached();
        if self.rows.iter().any(missed) { Exit::CheckFailed } else { Exit::Done }
    }
}

pub(super) fn run(
    arguments: &OrderArguments,
    own: Option<&Path>,
    output: &mut Output,
) -> Result<Exit, Failure> {
    if arguments.scenarios.is_empty() {
        return list(output);
    }
    let texts = arguments
        .scenarios
        .iter()
        .map(|name| scenario_text(name, &arguments.set))
        .collect::<Result<Vec<_>, _>>()?;
    let mut prepared = Vec::new();
    for (name, text) in arguments.scenarios.iter().zip(&texts) {
        prepared.push(prepare(name, text, own, &arguments.formula)?);
    }
    let folder = open(arguments, &prepared)?;
    for (studied, text) in prepared.iter_mut().zip(&texts) {
        studied.rows = studied.study.run().map_err(|e| text.placed(e))?;
        if let Some(folder) = &folder {
            write(folder, studied)?;
        }
    }
    if output.wants_json() {
        output.json(&document(&prepared))?;
    } else {
        let pages: Vec<String> = prepared.iter().map(|studied| studied.page().text()).collect();
        output.report(&pages.join("\n"))?;
        let warnings = prepared.iter().flat_map(|studied| &studied.warnings);
        warnings.for_each(|warning| output.remark(&format!("warning: {warning}")));
        if let Some(folder) = &folder {
            output.report(&format!("\nWritten to {}.\n", folder.path().display()))?;
        }
    }
    let exits = prepared.iter().map(Studied::exit);
    Ok(exits.max_by_key(|exit| *exit as u8).unwrap_or(Exit::Done))
}

/// A file, or else a built-in problem.
pub(super) fn scenario_text(name: &str, set: &[String]) -> Result<ScenarioText, Failure> {
    let file = Path::new(name);
    let mut text = match suite::text(name) {
        Some(problem) if !file.exists() => ScenarioText::parse(problem)?,
        None if file.extension().is_none() && !file.exists() && !name.contains(['/', '\\']) => {
            let known = suite::names();
            let near = known.iter().min_by_key(|known| strsim::damerau_levenshtein(known, name));
            let near = near.filter(|near| strsim::damerau_levenshtein(near, name) <= 2);
            let hint = near.map_or_else(String::new, |near| format!("did you mean {near}? "));
            let message = format!(
                "\"{name}\" is neither a file nor a built-in problem; {hint}built-in are {}",
                known.join(", ")
            );
            return Err(Failure::usage(message));
        }
        _ => ScenarioText::read(file)?,
    };
    set.iter().try_for_each(|assignment| text.set(assignment))?;
    Ok(text)
}

fn prepare(name: &str, text: &ScenarioText, own: Option<&Path>, ids: &[String]) -> Result<Studied, Failure> {
    let scenario = text.scenario()?;
    let mut rows = scenario.formula_rows(text.folder()).map_err(|e| text.placed(e))?;
    own.map_or(Ok(()), |file| rows.add_file(file))?;
    let study = ScenarioStudy::new(&scenario, text.folder(), &rows, ids).map_err(|e| text.placed(e))?;
    let warnings = rows.warnings().collect();
    Ok(Studied { name: name.to_owned(), study, rows: Vec::new(), warnings })
}

fn open(arguments: &OrderArguments, prepared: &[Studied]) -> Result<Option<Folder>, Failure> {
    if arguments.written.out.is_none() {
        return Ok(None);
    }
    let names: Vec<String> = prepared.iter().flat_map(Studied::file_names).collect();
    let mut sorted = names.clone();
    sorted.sort_unstable();
    if let Some([name, _]) = sorted.windows(2).find(|pair| pair[0] == pair[1]) {
        return Err(Failure::usage(format!(
            "{name} would be written twice; study scenarios of one name one by one"
        )));
    }
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    arguments.written.folder(&names)
}

fn write(folder: &Folder, studied: &Studied) -> Result<(), Failure> {
    let [json, csv, svg] = studied.file_names();
    let page = studied.page();
    let seen: Vec<(&str, &Convergence)> =
        studied.rows.iter().map(|row| (row.id.as_str(), &row.seen)).collect();
    let measure = studied.study.measure().name();
    let figure = figure(&studied.stem(), measure, &studied.study.ladder().sigmas(), &seen);
    folder.write(&json, |out| writeln!(out, "{:#}", page.json()))?;
    folder.write(&csv, |out| out.write_all(page.csv().as_bytes()))?;
    folder.write(&svg, |out| out.write_all(figure.to_svg().as_bytes()))
}

/// Draws the study of the scenario `name`.
pub(super) fn figure(name: &str, measure: &str, sigmas: &[f64], seen: &[(&str, &Convergence)]) -> Figure {
    let title = format!("{name}: {measure} error by sampling gap");
    order_figure(&format!("order-{name}"), &title, sigmas, seen)
}

/// One study is the document itself; several are a list in it.
fn document(studied: &[Studied]) -> Value {
    match studied {
        [one] => with_warnings(one),
        several => json!({ "studies": several.iter().map(with_warnings).collect::<Vec<_>>() }),
    }
}

fn with_warnings(studied: &Studied) -> Value {
    let mut document = studied.page().json();
    document["warnings"] = studied.warnings.iter().map(String::as_str).collect();
    document
}

/// The built-in problems, and what they are.
pub(super) fn problems() -> Result<Vec<(&'static str, String)>, Failure> {
    let mut problems = Vec::new();
    for name in suite::names() {
        let scenario = ScenarioText::parse(suite::text(name).unwrap_or_default())?.scenario()?;
        problems.push((name, scenario.problem.and_then(|problem| problem.source).unwrap_or_default()));
    }
    Ok(problems)
}

fn list(output: &mut Output) -> Result<Exit, Failure> {
    let problems = problems()?;
    if output.wants_json() {
        let problems: Vec<Value> =
            problems.iter().map(|(name, source)| json!({ "name": name, "source": source })).collect();
        output.json(&json!({ "problems": problems }))?;
    } else {
        let mut table = Table::new(["problem", "what it is"]);
        for (name, source) in &problems {
            table.row([*name, source.as_str()]);
        }
        output.report(&format!(
            "{table}\nNext:\n  kinstep order kepler --formula ab4\n  kinstep order mine.toml --out study\n"
        ))?;
    }
    Ok(Exit::Done)
}
