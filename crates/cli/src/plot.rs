//! `kinstep plot`: what was saved, drawn anew.

use std::path::{Path, PathBuf};

use serde::Serialize;
use serde_json::Value;

use super::arguments::{PictureFormat, PlotArguments};
use super::failure::{Exit, Failure};
use super::folder::Folder;
use super::order;
use super::output::{Output, Show};
use super::stopped::Stopped;
use kinstep::planner::Arm;
use kinstep::robot::names::printable;
use kinstep_files::scenario::{ScenarioText, read_text};
use kinstep_files::trajectory::{About, ArmTrajectory, Recording, Stage, Trajectory, TrajectoryErrorKind};
use kinstep_report::figure::{Figure, PlanFigures, sweep_figures};
use kinstep_study::sweep::SweepTable;
use kinstep_study::{Convergence, Criteria};
use nalgebra::Vector6;

/// Pixels of a PNG file for each of the drawing's own.
#[cfg(feature = "raster")]
const PIXELS: f32 = 2.0;

#[derive(Serialize)]
struct Drawn {
    written: Vec<String>,
    left_out: Vec<String>,
}

impl Show for Drawn {
    fn text(&self) -> String {
        let list: Vec<String> = self.written.iter().map(|file| format!("  {file}\n")).collect();
        let left_out: Vec<String> =
            self.left_out.iter().map(|kind| format!("Nothing to draw of {kind}.\n")).collect();
        format!("Written:\n{}{}", list.concat(), left_out.concat())
    }
}

pub(super) fn run(arguments: &PlotArguments, output: &mut Output) -> Result<Exit, Failure> {
    let saved = &arguments.saved;
    let figures = match Saved::find(saved)? {
        Saved::Plan(folder) => {
            if let Some(stopped) = Stopped::check(&folder)? {
                output.aside(&printable(&stopped.sentence));
            }
            of_plan(arguments, &folder)?
        }
        Saved::Order(files) => {
            refuse_choices(arguments, "an order study")?;
            files.iter().map(|file| of_order(file)).collect::<Result<_, _>>()?
        }
        Saved::Sweep(file) => {
            refuse_choices(arguments, "a sweep")?;
            of_sweep(&file)?
        }
    };
    let figures: Vec<Figure> =
        figures.into_iter().map(|figure| Figure { size: arguments.size, ..figure }).collect();
    if figures.is_empty() {
        return Err(Failure::usage(format!(
            "{}: there is nothing to draw of what was asked for",
            saved.display()
        )));
    }
    let beside = if saved.is_dir() { saved.as_path() } else { saved.parent().unwrap_or(Path::new("")) };
    let out = arguments.out.clone().unwrap_or_else(|| beside.join("figures"));
    let written = write(&out, arguments.force, &figures, &arguments.format)?;
    let is_drawn = |kind: &&String| !figures.iter().any(|figure| figure.name.starts_with(kind.as_str()));
    let left_out = arguments.figure.iter().filter(is_drawn).cloned().collect();
    output.show(&Drawn { written, left_out })?;
    Ok(Exit::Done)
}

/// What a command has saved.
enum Saved {
    /// The folder of `kinstep plan --out`.
    Plan(PathBuf),
    /// The documents of `kinstep order --out`.
    Order(Vec<PathBuf>),
    /// The table of `kinstep sweep --out`.
    Sweep(PathBuf),
}

impl Saved {
    fn find(path: &Path) -> Result<Self, Failure> {
        let name = |path: &Path| path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let ends_in =
            |path: &Path, ending: &str| path.extension().is_some_and(|e| e.eq_ignore_ascii_case(ending));
        let is_order = |path: &Path| ends_in(path, "json") && name(path).starts_with("order-");
        if path.is_dir() {
            if path.join("trajectory.csv").is_file() {
                return Ok(Self::Plan(path.to_owned()));
            }
            let files = std::fs::read_dir(path).map_err(|e| unreadable(path, &e))?;
            let mut studies: Vec<PathBuf> =
                files.flatten().map(|file| file.path()).filter(|file| is_order(file)).collect();
            studies.sort();
            return if studies.is_empty() { Err(unknown(path)) } else { Ok(Self::Order(studies)) };
        }
        match path.metadata() {
            Err(e) => Err(unreadable(path, &e)),
            Ok(_) if is_order(path) => Ok(Self::Order(vec![path.to_owned()])),
            Ok(_) if name(path) == "trajectory.csv" => {
                Ok(Self::Plan(path.parent().unwrap_or(Path::new("")).to_owned()))
            }
            Ok(_) if ends_in(path, "csv") || ends_in(path, "json") => Ok(Self::Sweep(path.to_owned())),
            Ok(_) => Err(unknown(path)),
        }
    }
}

fn unreadable(path: &Path, error: &std::io::Error) -> Failure {
    Failure::new(Exit::File, format!("{} can not be read: {error}", path.display()))
}

fn unknown(path: &Path) -> Failure {
    let message = format!(
        "{}: nothing here was saved by a command; name the folder of kinstep plan --out, the folder of kinstep order \
         --out, or the table of kinstep sweep --out",
        path.display()
    );
    Failure::new(Exit::File, message)
}

/// Choices among the pictures of a plan are none among other pictures.
fn refuse_choices(arguments: &PlotArguments, what: &str) -> Result<(), Failure> {
    let given = [
        ("--figure", !arguments.figure.is_empty()),
        ("--arm", !arguments.arm.is_empty()),
        ("--joint", !arguments.joint.is_empty()),
        ("--from", arguments.from.is_some()),
        ("--to", arguments.to.is_some()),
    ];
    match given.into_iter().find(|(_, given)| *given) {
        None => Ok(()),
        Some((option, _)) => {
            let saved = arguments.saved.display();
            Err(Failure::usage(format!(
                "{option}: this chooses among the pictures of a plan, and {saved} is {what}"
            )))
        }
    }
}

fn of_plan(arguments: &PlotArguments, folder: &Path) -> Result<Vec<Figure>, Failure> {
    let mut trajectory = read_trajectory(&folder.join("trajectory.csv"))?;
    let text = ScenarioText::read(&folder.join("scenario.toml"))?;
    let scenario = text.scenario()?;
    let mut stage = scenario.stage(text.folder()).map_err(|e| text.placed(e))?;
    if trajectory.about.is_none() {
        trajectory.about = about(&folder.join("plan.json"), &stage, text.raw())?;
    }
    let arms = scenario.arms(text.folder()).map_err(|e| text.placed(e))?;
    let mut errors = trajectory.arms.iter().map(|arm| errors(arm, &arms, &trajectory.times)).collect();
    choose_arms(&mut trajectory, &mut errors, &mut stage, &arguments.arm)?;
    check_choices(arguments, &trajectory)?;
    let recording = Recording { trajectory: &trajectory, stage: &stage };
    let (from, to) = (arguments.from.unwrap_or(f64::NEG_INFINITY), arguments.to.unwrap_or(f64::INFINITY));
    let figures = PlanFigures::new(recording, None)
        .with_errors(&errors)
        .of_kinds(arguments.figure.clone())
        .of_joints(arguments.joint.clone())
        .between(from, to);
    Ok(figures.draw())
}

fn read_trajectory(path: &Path) -> Result<Trajectory, Failure> {
    Trajectory::read(path).map_err(|error| {
        let exit = if error.kind == TrajectoryErrorKind::File { Exit::File } else { Exit::Usage };
        Failure::new(exit, error.to_string())
    })
}

/// What made the plan, as its summary has it; nothing where there is none.
fn about(file: &Path, stage: &Stage, scenario: &str) -> Result<Option<About>, Failure> {
    if !file.is_file() {
        return Ok(None);
    }
    let document: Value = document(file)?;
    let word = |key: &str| document[key].as_str().unwrap_or_default().to_owned();
    let number = |key: &str| document[key].as_f64().unwrap_or(f64::NAN);
    let (sigma, h) = (number("sigma"), number("h"));
    Ok(Some(About::new(&word("formula"), [sigma, h], &word("start"), scenario, stage)))
}

fn document(file: &Path) -> Result<Value, Failure> {
    let text = read_text(file)?;
    serde_json::from_str(&text).map_err(|e| {
        Failure::new(Exit::File, format!("{} is not the JSON that a command has saved: {e}", file.display()))
    })
}

/// The task errors of an arm at every sample, by the path that the scenario has for it; none where it has none.
fn errors(moved: &ArmTrajectory, arms: &[Arm], times: &[f64]) -> Vec<Vector6<f64>> {
    let is_it = |arm: &&Arm| arm.name() == moved.name && arm.chain().dof() == moved.joints.len();
    arms.iter().find(is_it).map_or_else(Vec::new, |arm| moved.task_errors(arm, times))
}

/// Keeps the arms that were named; none for all.
fn choose_arms(
    trajectory: &mut Trajectory,
    errors: &mut Vec<Vec<Vector6<f64>>>,
    stage: &mut Stage,
    names: &[String],
) -> Result<(), Failure> {
    let known: Vec<String> = trajectory.arms.iter().map(|arm| arm.name.clone()).collect();
    if let Some(name) = names.iter().find(|name| !known.contains(name)) {
        return Err(Failure::usage(format!(
            "--arm {name}: there is no such arm; there are {}",
            known.join(", ")
        )));
    }
    if names.is_empty() {
        return Ok(());
    }
    let mut keep = known.iter().map(|name| names.contains(name));
    errors.retain(|_| keep.next().unwrap_or(false));
    trajectory.arms.retain(|arm| names.contains(&arm.name));
    // The others stand on the stage as they rest.
    stage.arms.retain(|arm| names.contains(&arm.name));
    Ok(())
}

fn check_choices(arguments: &PlotArguments, trajectory: &Trajectory) -> Result<(), Failure> {
    let kinds: Vec<&str> = PlanFigures::kinds().map(|(name, _)| name).collect();
    if let Some(kind) = arguments.figure.iter().find(|kind| !kinds.contains(&kind.as_str())) {
        return Err(Failure::usage(format!(
            "--figure {kind}: there is no such figure; there are {}",
            kinds.join(", ")
        )));
    }
    let joints: Vec<&str> =
        trajectory.arms.iter().flat_map(|arm| arm.joints.iter().map(String::as_str)).collect();
    if let Some(joint) = arguments.joint.iter().find(|joint| !joints.contains(&joint.as_str())) {
        let message = format!("--joint {joint}: there is no such joint; there are {}", joints.join(", "));
        return Err(Failure::usage(message));
    }
    let (first, last) = (trajectory.times[0], trajectory.times[trajectory.samples() - 1]);
    let (from, to) = (arguments.from.unwrap_or(first), arguments.to.unwrap_or(last));
    let samples = trajectory.times.iter().filter(|t| (from..=to).contains(t)).count();
    if samples < 2 {
        let message = format!(
            "--from {from} --to {to}: less than two samples are within; they go from {first} to {last} s"
        );
        return Err(Failure::usage(message));
    }
    Ok(())
}

fn of_order(file: &Path) -> Result<Figure, Failure> {
    let document = document(file)?;
    let refused = || {
        let message = format!("{} is not what kinstep order --out has saved", file.display());
        Failure::new(Exit::File, message)
    };
    // What is not finite is null there.
    let numbers = |value: &Value| -> Option<Vec<f64>> {
        Some(value.as_array()?.iter().map(|number| number.as_f64().unwrap_or(f64::NAN)).collect())
    };
    let sigmas = numbers(&document["sigma"]).ok_or_else(refused)?;
    let Criteria { tolerance, floor_margin } = Criteria::default();
    let criteria = Criteria {
        tolerance: document["tolerance"].as_f64().unwrap_or(tolerance),
        floor_margin: document["floor_margin"].as_f64().unwrap_or(floor_margin),
    };
    let mut rows = Vec::new();
    for row in document["formulas"].as_array().ok_or_else(refused)? {
        let errors =
            numbers(&row["errors"]).filter(|errors| errors.len() == sigmas.len()).ok_or_else(refused)?;
        let claimed = row["claimed"].as_u64().map(|order| order as usize);
        let floor = row["floor"].as_f64().unwrap_or(f64::INFINITY);
        let seen = Convergence::judge(&sigmas, &errors, floor, claimed, &criteria);
        rows.push((row["id"].as_str().unwrap_or_default().to_owned(), seen));
    }
    let rows: Vec<(&str, &Convergence)> = rows.iter().map(|(id, seen)| (id.as_str(), seen)).collect();
    let stem = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let measure = document["measure"].as_str().unwrap_or_default();
    Ok(order::figure(stem.strip_prefix("order-").unwrap_or(&stem), measure, &sigmas, &rows))
}

pub(super) fn of_sweep(file: &Path) -> Result<Vec<Figure>, Failure> {
    let text = read_text(file)?;
    let table = SweepTable::parse(&text).map_err(|problem| {
        let message = format!("{} is not what kinstep sweep --out has saved: {problem}", file.display());
        Failure::new(Exit::File, message)
    })?;
    Ok(sweep_figures(&table))
}

/// Writes each figure in every format, with its numbers beside it, and returns the files' paths.
pub(super) fn write(
    path: &Path,
    force: bool,
    figures: &[Figure],
    formats: &[PictureFormat],
) -> Result<Vec<String>, Failure> {
    let mut files: Vec<(String, Vec<u8>)> = Vec::new();
    for figure in figures {
        for format in formats {
            files.push((format!("{}.{}", figure.name, format.ending()), picture(figure, *format)?));
        }
        files.push((format!("{}.csv", figure.name), figure.to_csv().into_bytes()));
    }
    let names: Vec<&str> = files.iter().map(|(name, _)| name.as_str()).collect();
    let folder = Folder::open(path, force, &names)?;
    for (name, content) in &files {
        folder.write(name, |out| out.write_all(content))?;
    }
    Ok(names.iter().map(|name| path.join(name).display().to_string()).collect())
}

#[cfg(feature = "raster")]
fn picture(figure: &Figure, format: PictureFormat) -> Result<Vec<u8>, Failure> {
    let svg = figure.to_svg();
    let made = match format {
        PictureFormat::Svg => return Ok(svg.into_bytes()),
        PictureFormat::Png => kinstep_report::to_png(&svg, PIXELS),
        PictureFormat::Pdf => kinstep_report::to_pdf(&svg),
    };
    made.map_err(|e| Failure::usage(e.to_string()))
}

#[cfg(not(feature = "raster"))]
fn picture(figure: &Figure, format: PictureFormat) -> Result<Vec<u8>, Failure> {
    match format {
        PictureFormat::Svg => Ok(figure.to_svg().into_bytes()),
        PictureFormat::Png | PictureFormat::Pdf => Err(Failure::usage(format!(
            "--format {}: this program was built without the feature raster; build it with --features raster, or take svg",
            format.ending()
        ))),
    }
}
