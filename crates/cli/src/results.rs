//! The folder of `plan --out`: what is written there, known before anything is computed.

use std::path::Path;

use super::arguments::{PictureFormat, PlanArguments};
use super::failure::Failure;
use super::folder::Folder;
use super::formats::{self, Exports};
use super::plot;
use kinstep::planner::Plan;
use kinstep_files::trajectory::{About, Export, Recording, Stage, Trajectory};
use kinstep_report::figure::plan_figures;
use kinstep_report::{PlanFormat, PlanJson, PlanPage, Suggestion};

/// The files beside the trajectory.
const NAMES: [&str; 2] = ["plan.json", "scenario.toml"];
/// The page that is among them unless it is not wanted.
const PAGE: &str = "report.html";
/// The folder of the pictures in it, where they are wanted.
const FIGURES: &str = "figures";

/// A folder with what is to be written there, and the robots that it is about.
pub(super) struct Results<'a> {
    arguments: &'a PlanArguments,
    folder: Folder,
    stage: &'a Stage,
    exports: Exports,
}

/// What is told of a plan beside the plan itself.
pub(super) struct PageContext<'a> {
    /// The scenario as it was run.
    pub(super) scenario: &'a str,
    /// What the page is called.
    pub(super) title: &'a str,
    /// What to try next.
    pub(super) suggestions: &'a [Suggestion],
}

impl<'a> Results<'a> {
    /// Opens the folder, if one was asked for and there are robots to write of; refuses what could not be written in the end.
    pub(super) fn open(
        arguments: &'a PlanArguments,
        stage: Option<&'a Stage>,
    ) -> Result<Option<Self>, Failure> {
        let Some(stage) = stage.filter(|_| arguments.written.out.is_some()) else { return Ok(None) };
        let chosen = formats::formats(&arguments.format, &[Export::Csv])?;
        let exports = Exports::new(&chosen, &formats::machines(stage), arguments.append_stop)?;
        let names: Vec<&str> = names(arguments, &exports).collect();
        let folder = arguments.written.folder(&names)?;
        Ok(folder.map(|folder| Self { arguments, folder, stage, exports }))
    }

    /// Where the folder is.
    pub(super) fn path(&self) -> &Path {
        self.folder.path()
    }

    /// Writes what was planned and returns the names of the files. Of a run that stopped all is written that can be, with the
    /// reasons for what can not among the plan's warnings.
    pub(super) fn write(
        mut self,
        plan: &mut Plan,
        context: &PageContext<'_>,
    ) -> Result<Vec<String>, Failure> {
        let folder = self.folder.interruptible(formats::interruption());
        let trajectory = Trajectory::of(plan, Some(About::of(plan, context.scenario, self.stage)));
        let recording = Recording { trajectory: &trajectory, stage: self.stage };
        if !plan.is_completed() {
            plan.warnings.extend(self.exports.keep_possible(recording));
        }
        self.exports.write(&folder, recording)?;
        folder.write("plan.json", |out| PlanJson.write(plan, out))?;
        folder.write("scenario.toml", |out| out.write_all(context.scenario.as_bytes()))?;
        look(self.arguments, &folder, plan, recording, context)?;
        Ok(names(self.arguments, &self.exports).map(str::to_owned).collect())
    }
}

/// The names of the files that are written.
fn names<'e>(arguments: &PlanArguments, exports: &'e Exports) -> impl Iterator<Item = &'e str> {
    let page = (!arguments.no_report).then_some(PAGE);
    exports.names().chain(NAMES).chain(page)
}

/// Writes what people look at: pictures and the page.
fn look(
    arguments: &PlanArguments,
    folder: &Folder,
    plan: &Plan,
    recording: Recording<'_>,
    context: &PageContext<'_>,
) -> Result<(), Failure> {
    if !arguments.figures && arguments.no_report {
        return Ok(());
    }
    let figures = plan_figures(recording, Some(plan));
    if arguments.figures {
        let pictures = folder.path().join(FIGURES);
        plot::write(&pictures, arguments.written.force, &figures, &[PictureFormat::Svg])?;
    }
    if arguments.no_report {
        return Ok(());
    }
    let page = PlanPage {
        title: context.title,
        plan,
        recording,
        figures: &figures,
        scenario: context.scenario,
        command: "kinstep plan scenario.toml",
        suggestions: context.suggestions,
    };
    folder.write(PAGE, |out| page.write(out))
}
