//! The `kinstep` command: arguments in, a document out, an exit code for scripts.

mod arguments;
mod check;
mod export;
mod failure;
mod folder;
mod formats;
mod formula;
mod formula_barrier;
mod formula_card;
mod formula_compare;
mod formula_derive;
mod formula_list;
mod formula_plot;
mod formula_schema;
mod formula_search;
mod loaded;
mod ode;
mod order;
mod output;
mod paint;
mod plan;
mod plot;
mod progress;
mod reproduce;
mod results;
mod robot;
mod robot_export;
mod robot_ik;
mod robot_show;
mod schema;
mod share_out;
mod shell;
mod stopped;
mod sweep;

use std::ffi::OsString;
use std::process::ExitCode;

use clap::Parser;

use arguments::{Arguments, Command};
use failure::{Exit, Failure};
use output::Output;

fn main() -> ExitCode {
    run(std::env::args_os())
}

/// Runs the command that the arguments (the program's name first) ask for, and returns the exit code:
/// 0 done, 1 a check failed, 2 usage or scenario, 3 robot, 4 formula, 5 the run stopped, 6 files.
fn run(arguments: impl IntoIterator<Item = OsString>) -> ExitCode {
    let arguments: Vec<OsString> = arguments.into_iter().collect();
    let wants_json = arguments.iter().any(|argument| argument == "--json");
    let mut output = Output::new(wants_json);
    let outcome = match Arguments::try_parse_from(&arguments) {
        Ok(arguments) => {
            output.listen(&arguments);
            dispatch(&arguments, &mut output)
        }
        Err(e) if !e.use_stderr() => output.help(&e.render()).map(|()| Exit::Done),
        Err(e) => Err(Failure::usage(usage(&e))),
    };
    let exit = outcome.unwrap_or_else(|failure| output.failure(&failure));
    ExitCode::from(exit as u8)
}

/// The parser's own sentence, with its hints.
fn usage(error: &clap::Error) -> String {
    if error.kind() == clap::error::ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand {
        return "name a command; `kinstep --help` lists them with examples".to_owned();
    }
    let text = error.render().to_string();
    let text = text.strip_prefix("error: ").unwrap_or(&text);
    text.replace("\n\nFor more information, try '--help'.", "").trim().to_owned()
}

fn dispatch(arguments: &Arguments, output: &mut Output) -> Result<Exit, Failure> {
    let own = arguments.formulas.as_deref();
    match &arguments.command {
        Command::Plan(command) => plan::run(command, own, output),
        Command::Plot(command) => plot::run(command, output),
        Command::Ode(command) => ode::run(command, own, output),
        Command::Order(command) => order::run(command, own, output),
        Command::Reproduce(command) => reproduce::run(command, output),
        Command::Formula(command) => formula::run(command, own, output),
        Command::Robot(command) => robot::run(command, output),
        Command::Export(command) => export::run(command, output),
        Command::Check(command) => check::run(command, output),
        Command::Sweep(command) => sweep::run(command, own, output),
        Command::Schema(command) => schema::run(*command, output),
    }
}
