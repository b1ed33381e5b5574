//! `kinstep sweep`: a scenario many times, into one table.

use std::fmt::Write as _;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use serde::Serialize;

use super::arguments::{PictureFormat, SweepArguments};
use super::failure::{Exit, Failure};
use super::output::{Output, Show};
use super::plot;
use super::progress::Progress;
use super::shell::quoted;
use kinstep_files::scenario::{FormulaRows, ScenarioText};
use kinstep_report::{WriteError, write_whole};
use kinstep_study::sweep::{self, Axis, Sweep, SweepError, Swept, Table};

#[derive(Clone, Serialize)]
struct Summary {
    out: String,
    cases: usize,
    done: usize,
    resumed: usize,
    statuses: std::collections::BTreeMap<String, usize>,
    /// The pictures that were written.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    drawn: Vec<String>,
}

impl Show for Summary {
    fn text(&self) -> String {
        let mut text = format!("{} of {} cases", self.done, self.cases);
        // Writing to a String can not fail.
        if self.resumed > 0 {
            let _ = write!(text, ", {} of them by an earlier run", self.resumed);
        }
        text.push('\n');
        for (status, count) in &self.statuses {
            let _ = writeln!(text, "  {count} {status}");
        }
        if self.done == self.cases {
            let _ = writeln!(text, "Written to {}.", self.out);
            self.drawn.iter().for_each(|file| _ = writeln!(text, "  {file}"));
            if self.drawn.is_empty() {
                let _ =
                    writeln!(text, "\nNext:\n  kinstep plot {}  # the table as pictures", quoted(&self.out));
            }
        } else {
            text.push_str("Interrupted; the same command goes on from here.\n");
        }
        text
    }
}

pub(super) fn run(
    arguments: &SweepArguments,
    own: Option<&Path>,
    output: &mut Output,
) -> Result<Exit, Failure> {
    let table = table(&arguments.out)?;
    let (sweep, rows) = prepare(arguments, own)?;
    if arguments.out.symlink_metadata().is_ok() && !arguments.force {
        return Err(failed(&arguments.out, &WriteError::Exists(arguments.out.clone())));
    }
    let threads = rayon::ThreadPoolBuilder::new().num_threads(arguments.threads.unwrap_or(0)).build();
    let threads = threads.map_err(|e| Failure::usage(format!("no threads can be made: {e}")))?;
    let interrupted = interruption();
    let started = Instant::now();
    let mut progress = Progress::of(sweep.len().unwrap_or(0), "cases");
    let fingerprint = fingerprint(&sweep, own)?;
    let place = (arguments.out.as_path(), table, arguments.force);
    let swept = threads.install(|| {
        sweep::run(&sweep, &rows, place, &fingerprint, |so_far| {
            progress.step(so_far.done);
            !interrupted.load(Ordering::Relaxed)
        })
    });
    let swept = swept.map_err(|e| refused(&e))?;
    drop(progress);
    let (summary, exit) = finish(swept, arguments)?;
    let drawn = draw(arguments, &summary)?;
    output.show(&Summary { drawn, ..summary.clone() })?;
    let seconds = started.elapsed().as_secs_f64();
    let speed = (summary.done - summary.resumed) as f64 / seconds.max(1e-9);
    output.aside(&format!(
        "{seconds:.1} s, {speed:.0} cases a second on {} threads",
        threads.current_num_threads()
    ));
    Ok(exit)
}

/// Draws the table that was written, if that was asked for and it is whole; returns the files.
fn draw(arguments: &SweepArguments, summary: &Summary) -> Result<Vec<String>, Failure> {
    match &arguments.plot {
        Some(folder) if summary.done == summary.cases => {
            let figures = plot::of_sweep(&arguments.out)?;
            plot::write(folder, arguments.force, &figures, &[PictureFormat::Svg])
        }
        _ => Ok(Vec::new()),
    }
}

/// Writes the table, if it is whole.
fn finish(mut swept: Swept<'_>, arguments: &SweepArguments) -> Result<(Summary, Exit), Failure> {
    let out = &arguments.out;
    if swept.progress.is_whole() {
        write_whole(out, arguments.force, |file| swept.write(file)).map_err(|e| failed(out, &e))?;
    }
    let progress = swept.progress.clone();
    let summary = Summary {
        out: out.display().to_string(),
        cases: progress.total,
        done: progress.done,
        resumed: progress.resumed,
        statuses: progress.statuses.iter().cloned().collect(),
        drawn: Vec::new(),
    };
    if !progress.is_whole() {
        return Ok((summary, Exit::Stopped));
    }
    let closed = swept.close();
    closed.map_err(|source| failed(out, &WriteError::Io { path: out.clone(), source }))?;
    let completed = summary.statuses.contains_key("completed");
    Ok((summary, if completed { Exit::Done } else { Exit::CheckFailed }))
}

fn table(out: &Path) -> Result<Table, Failure> {
    match out.extension().and_then(|extension| extension.to_str()) {
        Some("csv") => Ok(Table::Csv),
        Some("json") => Ok(Table::Json),
        _ => Err(Failure::usage(format!("--out {}: name a file that ends in .csv or .json", out.display()))),
    }
}

/// The sweep and the rows; the first case of every scenario has to read, so that a misspelt key is seen at once.
fn prepare(arguments: &SweepArguments, own: Option<&Path>) -> Result<(Sweep, FormulaRows), Failure> {
    let axes: Result<Vec<Axis>, _> = arguments.vary.iter().map(|text| Axis::parse(text)).collect();
    let axes = axes.map_err(|e| Failure::usage(e.to_string()))?;
    if arguments.samples == 0 {
        return Err(Failure::usage("--samples 0: draw at least once"));
    }
    let mut rows = FormulaRows::default();
    let mut scenarios = Vec::new();
    for file in &arguments.scenarios {
        let mut text = ScenarioText::read(file)?;
        arguments.set.iter().try_for_each(|assignment| text.set(assignment))?;
        let scenario = text.scenario()?;
        if scenario.problem.is_some() {
            let message = format!("{}: this is an initial value problem; sweeps are of arms", file.display());
            return Err(Failure::usage(message));
        }
        rows.add_rows_of(&scenario, text.folder()).map_err(|e| text.placed(e))?;
        scenarios.push((file.display().to_string(), text));
    }
    own.map_or(Ok(()), |file| rows.add_file(file))?;
    let sweep = Sweep { scenarios, axes, samples: arguments.samples, seed: arguments.seed };
    let total = sweep.len().ok_or_else(|| refused(&SweepError::TooMany))?;
    let each = total / sweep.scenarios.len();
    for first in (0..sweep.scenarios.len()).map(|k| k * each) {
        let text = sweep.text(&sweep.case(first))?;
        text.scenario()?;
    }
    Ok((sweep, rows))
}

/// What a journal has to agree in: the program, the scenarios, what varies, and the rows of one's own.
fn fingerprint(sweep: &Sweep, own: Option<&Path>) -> Result<String, Failure> {
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    let mut add = |text: &str| {
        for byte in text.bytes().chain([0]) {
            hash = (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
        }
    };
    add(env!("CARGO_PKG_VERSION"));
    add(&format!("{} {} {:?}", sweep.samples, sweep.seed, sweep.axes));
    for (name, text) in &sweep.scenarios {
        add(name);
        add(text.raw());
    }
    if let Some(own) = own {
        add(&kinstep_files::scenario::read_text(own)?);
    }
    Ok(format!("{hash:016x}"))
}

/// Set when the user interrupts: the cases at hand are finished and written down first.
fn interruption() -> Arc<AtomicBool> {
    let flag = Arc::new(AtomicBool::new(false));
    let handler = flag.clone();
    // Without a handler an interruption ends the program; the journal is whole even then.
    let _ = ctrlc::set_handler(move || handler.store(true, Ordering::Relaxed));
    flag
}

fn refused(error: &SweepError) -> Failure {
    let exit = if matches!(error, SweepError::TooMany) { Exit::Usage } else { Exit::File };
    Failure::new(exit, error.to_string())
}

fn failed(out: &Path, error: &WriteError) -> Failure {
    Failure::new(Exit::File, error.to_string()).in_file(&out.display().to_string())
}
