//! A plan as one page for a browser: `report.html`, which opens from disk and loads nothing.
//!
//! [`PlanPage`] puts together what the other files make: the words of the summary, the numbers, the figures, and the data
//! of the replay, which `replay.js` draws. The page allows itself no connection and no script but its own, by the hash of it.

mod keyframes;
mod limits;
mod looks;
mod markup;
mod replay;
mod summary;

use std::fmt::Write as _;
use std::io::{self, Write};

use sha2::{Digest, Sha256};

use super::Suggestion;
use super::figure::{DARK_THEME, Figure};
use kinstep::planner::Plan;
use kinstep_files::trajectory::Recording;
use markup::{base64, escaped, fill};

const TEMPLATE: &str = include_str!("page.html");
const STYLE: &str = include_str!("page.css");
const SCRIPT: &str = include_str!("replay.js");

/// What a page is made of.
#[derive(Clone, Copy, Debug)]
pub struct PlanPage<'a> {
    /// What the page is called: as a rule the scenario's file name.
    pub title: &'a str,
    /// The plan.
    pub plan: &'a Plan,
    /// Its samples and its robots.
    pub recording: Recording<'a>,
    /// Figures to show, in this order.
    pub figures: &'a [Figure],
    /// The scenario as it was run.
    pub scenario: &'a str,
    /// The command that makes the plan again.
    pub command: &'a str,
    /// What to try next.
    pub suggestions: &'a [Suggestion],
}

impl PlanPage<'_> {
    /// Writes the page.
    ///
    /// # Errors
    /// What the writer says.
    pub fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        out.write_all(self.to_html().as_bytes())
    }

    /// Returns the page; the same for the same plan, byte by byte.
    pub fn to_html(&self) -> String {
        fill(TEMPLATE, |place| match place {
            "title" => escaped(self.title),
            "policy" => base64(&Sha256::digest(SCRIPT)),
            "style" => style(),
            "script" => SCRIPT.to_owned(),
            "lead" => summary::lead(self),
            "verdict" => summary::verdict(self.plan),
            "warnings" => summary::warnings(self.plan),
            "next" => summary::next(self),
            "numbers" => summary::numbers(self.plan),
            "limits" => limits::section(self),
            "replay" => replay::section(self),
            "figures" => self.figures.iter().fold(String::new(), |all, figure| all + &figure_markup(figure)),
            "scenario" => escaped(self.scenario),
            "command" => escaped(self.command),
            "about" => self.about(),
            _ => String::new(),
        })
    }

    fn about(&self) -> String {
        let entries =
            self.recording.trajectory.about.iter().flat_map(kinstep_files::trajectory::About::entries);
        entries.fold(String::new(), |mut rows, (key, value)| {
            let (key, value) = (escaped(&key), escaped(&value));
            // Writing to a String can not fail.
            let _ = write!(rows, "<dt>{key}</dt><dd><code>{value}</code></dd>");
            rows
        })
    }
}

/// The page's style sheet, with the colours of figures on a dark page.
fn style() -> String {
    format!(
        "{STYLE}:root[data-theme=\"dark\"] .kinstep-figure {{ {DARK_THEME} }}\n\
         @media (prefers-color-scheme: dark) {{ :root:not([data-theme=\"light\"]) .kinstep-figure {{ {DARK_THEME} }} }}\n\
         @media print {{ :root .kinstep-figure.kinstep-figure {{ {} }} }}\n",
        light_theme()
    )
}

/// What undoes the dark colours: every property without a value of its own falls back to paper.
fn light_theme() -> String {
    let names = DARK_THEME.split(';').filter_map(|declaration| declaration.split(':').next());
    names.fold(String::new(), |all, name| all + name + ":initial;")
}

/// A figure in the page; one over time says where its axes are, so that the replay can point into it.
fn figure_markup(figure: &Figure) -> String {
    let window = if figure.x.column == "t" {
        let numbers = figure.window().map(|number| number.to_string());
        format!(" data-time=\"{}\"", numbers.join(" "))
    } else {
        String::new()
    };
    format!("<figure class=\"figure\"{window}>{}</figure>\n", figure.to_svg_themed())
}
